// Texture encoder: the state and steps of encoding one texture. The steps of several textures can
// be committed together, or cancelled.
#pragma once

#include <gicodec/encoder.h>

#include "backend/find_backend.h"
#include "stream/update_stream.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace gicodec {

/// Call select(), keep_changed() if wanted, write(), then commit() or cancel(). Before commit()
/// nothing changes, except that the next packet may have to be a keyframe.
class TextureEncoder {
 public:
  /// Errors: those of Encoder::create().
  [[nodiscard]] static Result<std::unique_ptr<TextureEncoder>> create(
      const TextureDesc& desc, const EncoderOptions& options);

  /// Reads the selected blocks of a view as their current versions.
  Status select(const ConstTextureView& texture, Selection selection);
  /// Deselects blocks whose contents the decoder has; before a keyframe it has none.
  void keep_changed(bool keyframe);
  /// The selected blocks, ascending.
  [[nodiscard]] std::span<const std::uint32_t> blocks() const noexcept { return blocks_; }
  /// Codes these blocks, which must be selected, into packet().
  Status write(std::span<const std::uint32_t> blocks, bool keyframe);
  [[nodiscard]] Packet& packet() noexcept { return written_.packets().front().packet; }
  void commit(bool keyframe) noexcept;
  /// Reverts select(), unless commit() came after it.
  void cancel() noexcept;

  Status snapshot(Packet& out);
  [[nodiscard]] bool keyframe_due() const noexcept {
    return keyframe_wanted_ || (gop_ > 0 && since_keyframe_ >= gop_);
  }
  void request_keyframe() noexcept { keyframe_wanted_ = true; }
  Status set_preset(std::string_view preset) { return backend_->set_preset(preset); }
  void set_active(Vector<std::uint8_t> active) noexcept { active_ = std::move(active); }
  /// `presence`: presence_bytes() of every block.
  void set_presence(std::span<const std::byte> presence) {
    presence_.assign(presence.begin(), presence.end());
  }
  /// Takes the presence of the selected blocks of `from`, the texture that holds it.
  /// presence_invalid.
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
  Vector<std::byte> presence_;  ///< of every block; empty until it is set

  // Scratch of one packet, kept for its capacity.
  Vector<std::uint32_t> blocks_;
  PacketWriter writer_;
  Written written_;
};

/// Its destructor cancels what was not committed.
class CancelUncommitted {
 public:
  explicit CancelUncommitted(std::span<const std::unique_ptr<TextureEncoder>> textures) noexcept
      : textures_(textures) {}
  CancelUncommitted(const CancelUncommitted&) = delete;
  CancelUncommitted& operator=(const CancelUncommitted&) = delete;
  ~CancelUncommitted() {
    for (const auto& texture : textures_) texture->cancel();
  }

 private:
  std::span<const std::unique_ptr<TextureEncoder>> textures_;
};

}  // namespace gicodec
