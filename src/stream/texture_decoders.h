// Decoders of the textures of a volume, or of several: one of each texture, or of each region that
// it is cut into. They are made when they are first needed and share their working memory.
#pragma once

#include <gicodec/decoder.h>
#include <gicodec/delivery.h>
#include <gicodec/kind.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

class TextureDecoders {
 public:
  struct Texture {
    TextureDesc desc;                           ///< as views have it
    Grid region{};                              ///< zeros: it is not cut
    std::optional<std::uint8_t> presence = {};  ///< whose blocks say which records exist
  };
  /// Creates a scratch. out_of_memory.
  [[nodiscard]] static Result<TextureDecoders> create(std::vector<Texture> textures,
                                                      DecoderOptions options);

  /// Of a region as RegionGrid counts it, or StreamId::kWholeVolume of a texture that is not cut.
  /// Errors: those of Decoder::create(), limit_exceeded where all take more than max_total_bytes.
  Result<Decoder*> decoder(std::uint8_t texture, std::uint32_t region);
  /// Null if none was needed.
  [[nodiscard]] const Decoder* find(std::uint8_t texture, std::uint32_t region) const noexcept;
  /// Applies a packet. Errors: those of decoder() and Decoder::decode().
  Status decode(std::uint8_t texture, std::uint32_t region, std::span<const std::byte> packet);
  /// All that was decoded is gone.
  void clear() noexcept;

  /// Writes a texture, or some blocks, ascending; zeros where nothing was received.
  Status read(std::uint8_t texture, const TextureView& view) const;
  Status read(std::uint8_t texture, const TextureView& view,
              std::span<const std::uint32_t> blocks) const;

  /// Nothing has changed; from here on decode() notes what does, if it is to be `noted`.
  void begin_changes(bool noted) noexcept;
  /// Makes the lists ascending, each block once; or `all` blocks of textures that have decoders.
  void settle_changes(bool all);
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept {
    return changed_[texture];
  }

  /// Where views have the blocks of a texture that has no decoder yet, else out_of_order.
  Status set_layout(std::uint8_t texture, const Layout& layout);
  [[nodiscard]] const Texture& operator[](std::uint8_t texture) const noexcept {
    return textures_[texture];
  }
  [[nodiscard]] std::size_t size() const noexcept { return textures_.size(); }

  /// Bytes that are held, at their worst.
  [[nodiscard]] std::uint64_t memory() const noexcept { return held_ + scratched_; }
  /// Bytes that the caller holds beside, which count too: limit_exceeded beyond max_total_bytes.
  Status set_beside(std::uint64_t bytes) noexcept;
  /// Bytes that the last decode() or set_beside() compared with max_total_bytes; 0 if it did not.
  [[nodiscard]] std::uint64_t needed() const noexcept { return needed_; }

 private:
  using Part = std::pair<std::uint8_t, std::uint32_t>;

  TextureDecoders(std::vector<Texture> textures, DecoderOptions options);
  [[nodiscard]] bool is_cut(std::uint8_t texture) const noexcept {
    return !(textures_[texture].region == Grid{});
  }
  [[nodiscard]] RegionGrid regions(std::uint8_t texture) const noexcept {
    return regions_of(textures_[texture].desc, textures_[texture].region);
  }
  [[nodiscard]] bool has_decoders(std::uint8_t texture) const noexcept {
    const auto first = decoders_.lower_bound({texture, 0});
    return first != decoders_.end() && first->first.first == texture;
  }
  Status check_memory(std::uint64_t more, std::uint64_t shared) noexcept;
  Status read_region(std::uint8_t texture, std::uint32_t region, const TextureView& view,
                     std::span<const std::uint32_t> numbers,
                     std::span<const std::uint32_t> blocks) const;

  std::vector<Texture> textures_;
  DecoderOptions options_;
  std::map<Part, Decoder> decoders_;
  std::uint64_t held_ = 0, scratched_ = 0;  ///< bytes of decoders, and of what they share
  std::uint64_t beside_ = 0, needed_ = 0;
  bool noting_ = false;
  std::vector<std::vector<std::uint32_t>> changed_;  ///< by texture
};

/// The textures of a volume, not cut.
[[nodiscard]] std::vector<TextureDecoders::Texture> textures_of(const VolumeDesc& volume);

}  // namespace gicodec
