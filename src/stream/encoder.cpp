// texture view → select → publish (strip, drop unchanged blocks) → backend → packet; then the
// mirror follows.
#include <gicodec/encoder.h>

#include <gicodec/error_bound.h>

#include "backend/find_backend.h"
#include "base/guard.h"
#include "base/parallel.h"
#include "stream/update_stream.h"
#include "texture/blocks.h"
#include "texture/presence.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

namespace gicodec {

struct Encoder::State {
  State(const TextureDesc& desc, const EncoderOptions& options, const Backend& backend,
        std::unique_ptr<BackendEncoder> encoder)
      : isa(options.settings.isa),
        threads(options.settings.threads),
        gop(options.gop),
        backend_encoder(std::move(encoder)),
        history(desc, isa, BlockHistory::Use::encoder, threads, options.max_error),
        stream(history, desc, {}, PacketChain{backend.id(), options.texture_id}, 0) {}

  Status select(Selection selection);
  Status select_list(std::span<const std::uint32_t> list);
  void keep_changed(bool keyframe);
  Status encode(const ConstTextureView& view, Selection selection, std::size_t max_size,
                Packet& out);
  Status snapshot(Packet& out);

  Isa isa;
  Threads threads;
  std::uint32_t gop;
  std::uint32_t since_keyframe = 0;
  bool keyframe_wanted = true;
  std::unique_ptr<BackendEncoder> backend_encoder;
  BlockHistory history;  ///< current contents, and the decoder's
  UpdateStream stream;
  Vector<std::uint8_t> active;
  Vector<std::byte> presence;  ///< of all blocks; empty before set_presence()

  // Scratch of one call, kept for its capacity.
  Vector<std::uint32_t> blocks;
  PacketWriter writer;
  Written written;
  Packet to_copy;  ///< copied to the caller's memory
};

Status Encoder::State::select_list(std::span<const std::uint32_t> list) {
  blocks.assign(list.begin(), list.end());
  if (!std::is_sorted(blocks.begin(), blocks.end())) std::sort(blocks.begin(), blocks.end());
  if (!blocks.empty() && blocks.back() >= stream.size()) return Status::block_out_of_range;
  return std::adjacent_find(blocks.begin(), blocks.end()) == blocks.end() ? Status::ok
                                                                          : Status::block_repeated;
}

/// Lists the blocks of a selection, changed or not.
Status Encoder::State::select(Selection selection) {
  if (selection.kind() == Selection::Kind::list) return select_list(selection.list());
  blocks.resize(stream.size());
  std::iota(blocks.begin(), blocks.end(), 0U);
  if (selection.kind() == Selection::Kind::changed && !active.empty()) {
    const auto inactive = [&](std::uint32_t block) { return active[block] == 0; };
    blocks.erase(std::remove_if(blocks.begin(), blocks.end(), inactive), blocks.end());
  }
  return Status::ok;
}

/// Drops blocks that the decoder already holds; at a keyframe it holds nothing.
void Encoder::State::keep_changed(bool keyframe) {
  const auto held = [&](std::uint32_t block) {
    const BlockId sent = keyframe ? kNothing : stream.sent(block);
    if (sent == kNothing && active.empty()) return history.is_zero(stream.current(block));
    return sent == stream.current(block);
  };
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(), held), blocks.end());
}

Status Encoder::State::encode(const ConstTextureView& texture, Selection selection,
                              std::size_t max_size, Packet& out) {
  const auto view = check_view(stream.desc(), texture);
  if (!view) return view.status();
  const bool told = stream.desc().presence == Presence::all || !presence.empty();
  if (!told) return Status::out_of_order;
  const bool keyframe = keyframe_wanted || (gop > 0 && since_keyframe >= gop);
  Status status = select(selection);
  if (status != Status::ok) return status;
  history.publish(*view, blocks, presence);
  // Undoes publish() on failure: later contents are compared with what was sent.
  struct Published {
    BlockHistory* history;
    ~Published() {
      if (history != nullptr) history->undo();
    }
  } published{&history};
  if (selection.kind() == Selection::Kind::changed) keep_changed(keyframe);

  // A stateful backend may change from here on, so after a failure only a keyframe can follow.
  if (backend_encoder->is_stateful()) keyframe_wanted = true;
  status = stream.write(keyframe ? UpdateStream::From::keyframe : UpdateStream::From::sent, blocks,
                        *backend_encoder, writer, written);
  if (status != Status::ok) return status;
  Packet& packet = written.packets().front().packet;  // blocks never move: one packet
  if (packet.size() > max_size) return Status::buffer_too_small;

  published.history = nullptr;
  stream.commit(written);
  keyframe_wanted = false;
  since_keyframe = keyframe ? 1 : since_keyframe + 1;
  std::swap(out, packet);
  return Status::ok;
}

Status Encoder::State::snapshot(Packet& out) {
  if (stream.sequence() == 0) return Status::out_of_order;
  if (backend_encoder->is_stateful()) return Status::unsupported_backend;
  const Status status = stream.catch_up(nullptr, {}, *backend_encoder, writer, written);
  if (status == Status::ok) out = std::move(written.packets().front().packet);
  return status;
}

Encoder::Encoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;
Encoder::~Encoder() = default;

Result<Encoder> Encoder::create(const TextureDesc& desc, const EncoderOptions& options) {
  return guarded([&]() -> Result<Encoder> {
    if (const Status status = validate(desc); status != Status::ok) return status;
    const Backend* backend = find_backend(options.backends, options.backend);
    if (backend == nullptr) return Status::unknown_backend;
    const BackendSettings& settings = options.settings;
    if (!valid_error(options.max_error)) return Status::invalid_bound;
    if (!is_valid(settings.threads) || !is_supported(settings.isa)) {
      return Status::invalid_settings;
    }
    auto encoder = backend->make_encoder(desc, settings);
    if (!encoder) return encoder.status();
    // Both errors would add up.
    if ((*encoder)->lossy() && options.max_error > 0) return Status::invalid_bound;
    return Encoder(std::make_unique<State>(desc, options, *backend, *std::move(encoder)));
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
    const Status status = state_->snapshot(packet);
    if (status != Status::ok) return status;
    return packet;
  });
}

std::size_t Encoder::bound(std::size_t blocks) const noexcept {
  return packet_bound(desc(), *state_->backend_encoder,
                      std::min<std::size_t>(blocks, state_->stream.size()));
}

void Encoder::request_keyframe() noexcept { state_->keyframe_wanted = true; }

Status Encoder::set_active(std::span<const std::uint8_t> active) {
  if (!active.empty() && active.size() != state_->stream.size()) return Status::mask_mismatch;
  return guarded([&]() -> Status {
    state_->active.assign(active.begin(), active.end());
    return Status::ok;
  });
}

Status Encoder::set_presence(std::span<const std::byte> presence) {
  if (presence.size() != presence_bytes(desc()) * block_count(desc())) return Status::mask_mismatch;
  if (!is_sound(desc(), presence)) return Status::presence_invalid;
  return guarded([&]() -> Status {
    state_->presence.assign(presence.begin(), presence.end());
    return Status::ok;
  });
}

Status Encoder::read(TextureView texture) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  const auto read_range = [&](unsigned, std::size_t first, std::size_t count) {
    const auto end = static_cast<std::uint32_t>(first + count);
    for (auto block = static_cast<std::uint32_t>(first); block < end; ++block) {
      const BlockId id = state_->stream.sent(block);
      reconstruct(state_->isa, desc(), *view, {&block, 1}, state_->history.records(id));
      const auto band = state_->history.stale_band(id);
      if (!band.empty()) scatter_band(desc(), *view, block, band);
    }
  };
  for_each_range(state_->threads, state_->stream.size(), blocks_per_thread(desc()), read_range);
  return Status::ok;
}

const TextureDesc& Encoder::desc() const noexcept { return state_->stream.desc(); }
std::uint32_t Encoder::sequence() const noexcept { return state_->stream.sequence(); }
bool Encoder::lossy() const noexcept {
  return state_->backend_encoder->lossy() || state_->history.lossy();
}

}  // namespace gicodec
