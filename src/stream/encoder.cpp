// select() reads the view and publishes it: it strips each block and numbers new contents.
// keep_changed() drops blocks that the decoder has. write() codes the rest into a packet. commit()
// notes what the decoder now holds.
#include <gicodec/encoder.h>

#include "base/guard.h"
#include "stream/texture_encoder.h"
#include "texture/presence.h"

#include <algorithm>
#include <utility>

namespace gicodec {

struct Encoder::State {
  Status encode(const ConstTextureView& view, Selection selection, std::size_t max_size,
                Packet& out);

  std::unique_ptr<TextureEncoder> texture;
  Packet to_copy;  ///< to the memory of the caller
};

Status Encoder::State::encode(const ConstTextureView& view, Selection selection,
                              std::size_t max_size, Packet& out) {
  const bool keyframe = texture->keyframe_due();
  const CancelUncommitted pending({&texture, 1});
  Status status = texture->select(view, selection);
  if (status != Status::ok) return status;
  if (selection.type() == Selection::Type::changed) texture->keep_changed(keyframe);
  status = texture->write(texture->blocks(), keyframe);
  if (status != Status::ok) return status;
  if (texture->packet().size() > max_size) return Status::buffer_too_small;
  texture->commit(keyframe);
  std::swap(out, texture->packet());
  return Status::ok;
}

Encoder::Encoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;
Encoder::~Encoder() = default;

Result<Encoder> Encoder::create(const TextureDesc& desc, const EncoderOptions& options) {
  return guarded([&]() -> Result<Encoder> {
    auto texture = TextureEncoder::create(desc, options);
    if (!texture) return texture.status();
    return Encoder(std::make_unique<State>(State{*std::move(texture), {}}));
  });
}

Status Encoder::encode_to(ConstTextureView view, Selection selection, Packet& out) {
  return guarded([&]() -> Status { return state_->encode(view, selection, SIZE_MAX, out); });
}

Result<Packet> Encoder::encode(ConstTextureView view, Selection selection) {
  Packet packet;
  const Status status = encode_to(view, selection, packet);
  if (status != Status::ok) return status;
  return packet;
}

Result<std::size_t> Encoder::encode_to(ConstTextureView view, Selection selection,
                                       std::span<std::byte> out) {
  return guarded([&]() -> Result<std::size_t> {
    Packet& packet = state_->to_copy;
    const Status status = state_->encode(view, selection, out.size(), packet);
    if (status != Status::ok) return status;
    std::copy(packet.begin(), packet.end(), out.begin());
    return packet.size();
  });
}

Result<Packet> Encoder::snapshot() {
  return guarded([&]() -> Result<Packet> {
    Packet packet;
    const Status status = state_->texture->snapshot(packet);
    if (status != Status::ok) return status;
    return packet;
  });
}

void Encoder::request_keyframe() noexcept { state_->texture->request_keyframe(); }

Status Encoder::set_preset(std::string_view preset) {
  return guarded([&] { return state_->texture->set_preset(preset); });
}

Status Encoder::set_active(std::span<const std::uint8_t> active) {
  if (!active.empty() && active.size() != block_count(desc())) return Status::mask_mismatch;
  return guarded([&]() -> Status {
    state_->texture->set_active({active.begin(), active.end()});
    return Status::ok;
  });
}

Status Encoder::set_presence(std::span<const std::byte> presence) {
  if (presence.size() != presence_bytes(desc()) * block_count(desc())) return Status::mask_mismatch;
  if (!is_sound(desc(), presence)) return Status::presence_invalid;
  return guarded([&]() -> Status {
    state_->texture->set_presence(presence);
    return Status::ok;
  });
}

Status Encoder::read(TextureView view) const { return state_->texture->read(view); }
std::size_t Encoder::bound(std::size_t blocks) const noexcept {
  return state_->texture->bound(blocks);
}
const TextureDesc& Encoder::desc() const noexcept { return state_->texture->desc(); }
std::uint32_t Encoder::sequence() const noexcept { return state_->texture->sequence(); }
bool Encoder::lossy() const noexcept { return state_->texture->lossy(); }

}  // namespace gicodec
