// What an encoder holds of one texture, and its steps: those of several textures can be taken
// together, and taken back.
#pragma once

#include <gicodec/encoder.h>

#include "backend/find_backend.h"
#include "stream/update_stream.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace gicodec {

/// select(), keep_changed() as wanted, write(), then commit() or cancel(): until commit() nothing
/// has changed but that the next packet may have to be a keyframe.
class TextureEncoder {
 public:
  /// Errors: those of Encoder::create().
  [[nodiscard]] static Result<std::unique_ptr<TextureEncoder>> create(
      const TextureDesc& desc, const EncoderOptions& options);

  /// Makes the selected blocks of a view the current ones.
  Status select(const ConstTextureView& texture, Selection selection);
  /// Drops the blocks that the decoder has already; at a keyframe it has nothing.
  void keep_changed(bool keyframe);
  /// Those that are selected, ascending.
  [[nodiscard]] std::span<const std::uint32_t> blocks() const noexcept { return blocks_; }
  /// Codes these, which were selected.
  Status write(std::span<const std::uint32_t> blocks, bool keyframe);
  /// What write() made.
  [[nodiscard]] Packet& packet() noexcept { return written_.packets().front().packet; }
  void commit(bool keyframe) noexcept;
  /// Takes select() back, unless commit() came after it.
  void cancel() noexcept;

  Status snapshot(Packet& out);
  [[nodiscard]] bool keyframe_due() const noexcept {
    return keyframe_wanted_ || (gop_ > 0 && since_keyframe_ >= gop_);
  }
  void request_keyframe() noexcept { keyframe_wanted_ = true; }
  void set_active(Vector<std::uint8_t> active) noexcept { active_ = std::move(active); }
  /// Of every block; the right size.
  void set_presence(std::span<const std::byte> presence) {
    presence_.assign(presence.begin(), presence.end());
  }
  /// Of the blocks that are selected in the texture that says it. presence_invalid.
  Status take_presence(const TextureEncoder& from);

  Status read(const TextureView& texture) const;
  [[nodiscard]] const TextureDesc& desc() const noexcept { return stream_.desc(); }
  [[nodiscard]] std::size_t bound(std::size_t blocks) const noexcept;
  [[nodiscard]] std::uint32_t sequence() const noexcept { return stream_.sequence(); }
  [[nodiscard]] bool lossy() const noexcept { return backend_->lossy() || history_.lossy(); }

  TextureEncoder(const TextureDesc& desc, const EncoderOptions& options, const Backend& backend,
                 std::unique_ptr<BackendEncoder> encoder);

 private:
  Status select_list(std::span<const std::uint32_t> list);

  Isa isa_;
  Threads threads_;
  std::uint32_t gop_, since_keyframe_ = 0;
  bool keyframe_wanted_ = true;
  bool pending_ = false;  ///< select() without commit() or cancel()
  std::unique_ptr<BackendEncoder> backend_;
  BlockHistory history_;  ///< what is current, and what the decoder holds
  UpdateStream stream_;
  Vector<std::uint8_t> active_;
  Vector<std::byte> presence_;  ///< of every block; empty until it is told

  // Scratch of one packet, kept for its capacity.
  Vector<std::uint32_t> blocks_;
  PacketWriter writer_;
  Written written_;
};

/// Takes back what was not committed when it goes.
class Pending {
 public:
  explicit Pending(std::span<const std::unique_ptr<TextureEncoder>> textures) noexcept
      : textures_(textures) {}
  Pending(const Pending&) = delete;
  Pending& operator=(const Pending&) = delete;
  ~Pending() {
    for (const auto& texture : textures_) texture->cancel();
  }

 private:
  std::span<const std::unique_ptr<TextureEncoder>> textures_;
};

}  // namespace gicodec
