#include "stream/texture_encoder.h"

#include <gicodec/error_bound.h>

#include "base/parallel.h"
#include "texture/blocks.h"
#include "texture/presence.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gicodec {

TextureEncoder::TextureEncoder(const TextureDesc& desc, const EncoderOptions& options,
                               const Backend& backend, std::unique_ptr<BackendEncoder> encoder)
    : isa_(options.settings.isa),
      threads_(options.settings.threads),
      gop_(options.gop),
      backend_(std::move(encoder)),
      history_(desc, isa_, BlockHistory::Use::encoder, threads_, options.max_error),
      stream_(history_, desc, {}, PacketChain{backend.id(), options.texture_id}, 0) {}

Result<std::unique_ptr<TextureEncoder>> TextureEncoder::create(const TextureDesc& desc,
                                                               const EncoderOptions& options) {
  if (const Status status = validate(desc); status != Status::ok) return status;
  const Backend* backend = find_backend(options.backends, options.backend);
  if (backend == nullptr) return Status::unknown_backend;
  const BackendSettings& settings = options.settings;
  if (!valid_error(options.max_error)) return Status::invalid_bound;
  if (!is_valid(settings.threads) || !is_supported(settings.isa)) return Status::invalid_settings;
  auto encoder = backend->make_encoder(desc, settings);
  if (!encoder) return encoder.status();
  // The errors of the backend and of max_error would add up.
  if ((*encoder)->lossy() && options.max_error > 0) return Status::invalid_bound;
  return std::make_unique<TextureEncoder>(desc, options, *backend, *std::move(encoder));
}

Status TextureEncoder::select_list(std::span<const std::uint32_t> list) {
  if (list.size() > stream_.size()) return Status::block_repeated;
  blocks_.assign(list.begin(), list.end());
  if (!std::is_sorted(blocks_.begin(), blocks_.end())) std::sort(blocks_.begin(), blocks_.end());
  if (!blocks_.empty() && blocks_.back() >= stream_.size()) return Status::block_out_of_range;
  return std::adjacent_find(blocks_.begin(), blocks_.end()) == blocks_.end()
             ? Status::ok
             : Status::block_repeated;
}

Status TextureEncoder::select(const ConstTextureView& texture, Selection selection) {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  const bool presence_set = desc().presence == Presence::all || !presence_.empty();
  if (!presence_set) return Status::out_of_order;
  if (selection.type() == Selection::Type::list) {
    if (const Status status = select_list(selection.list()); status != Status::ok) return status;
  } else {
    blocks_.resize(stream_.size());
    std::iota(blocks_.begin(), blocks_.end(), 0U);
    if (selection.type() == Selection::Type::changed && !active_.empty()) {
      std::erase_if(blocks_, [&](std::uint32_t block) { return active_[block] == 0; });
    }
  }
  history_.publish(*view, blocks_, presence_);
  pending_ = true;
  return Status::ok;
}

void TextureEncoder::keep_changed(bool keyframe) {
  std::erase_if(blocks_, [&](std::uint32_t block) {
    const BlockId sent = keyframe ? kNothing : stream_.sent(block);
    if (sent == kNothing && active_.empty()) return history_.is_zero(stream_.current(block));
    return sent == stream_.current(block);
  });
}

Status TextureEncoder::write(std::span<const std::uint32_t> blocks, bool keyframe) {
  // The state of a backend changes from here on: if there is no commit(), a keyframe must follow.
  if (backend_->is_stateful()) keyframe_wanted_ = true;
  // An encoder's blocks do not scroll, so that there is one packet.
  return stream_.write(keyframe ? UpdateStream::From::keyframe : UpdateStream::From::sent, blocks,
                       *backend_, writer_, written_);
}

void TextureEncoder::commit(bool keyframe) noexcept {
  pending_ = false;
  stream_.commit(written_);
  keyframe_wanted_ = false;
  since_keyframe_ = keyframe ? 1 : since_keyframe_ + 1;
}

void TextureEncoder::cancel() noexcept {
  // Later contents are compared with what was sent.
  if (std::exchange(pending_, false)) history_.undo();
}

Status TextureEncoder::snapshot(Packet& out) {
  if (stream_.sequence() == 0) return Status::out_of_order;
  if (backend_->is_stateful()) return Status::unsupported_backend;
  const Status status = stream_.catch_up(nullptr, {}, *backend_, writer_, written_);
  if (status == Status::ok) out = std::move(packet());
  return status;
}

Status TextureEncoder::take_presence(const TextureEncoder& from) {
  const std::size_t size = presence_bytes(desc());
  presence_.resize(size * stream_.size());
  for (const std::uint32_t block : from.blocks()) {
    const auto records = from.history_.records(from.stream_.current(block));
    if (!is_sound(desc(), records)) return Status::presence_invalid;
    std::copy(records.begin(), records.end(), presence_.data() + block * size);
  }
  return Status::ok;
}

Status TextureEncoder::read(const TextureView& texture) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  const auto read_range = [&](unsigned, std::size_t first, std::size_t count) {
    const auto end = static_cast<std::uint32_t>(first + count);
    for (auto block = static_cast<std::uint32_t>(first); block < end; ++block) {
      const BlockId id = stream_.sent(block);
      reconstruct(isa_, desc(), *view, {&block, 1}, history_.records(id));
      const auto band = history_.stale_band(id);
      if (!band.empty()) scatter_band(desc(), *view, block, band);
    }
  };
  for_each_range(threads_, stream_.size(), blocks_per_thread(desc()), read_range);
  return Status::ok;
}

std::size_t TextureEncoder::bound(std::size_t blocks) const noexcept {
  return packet_bound(desc(), *backend_, std::min<std::size_t>(blocks, stream_.size()));
}

}  // namespace gicodec
