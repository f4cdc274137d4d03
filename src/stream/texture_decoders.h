// Decoders of the textures of one or more volumes: one per texture, or per region of a texture that
// is cut into regions. They are created on first use and share their working memory.
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
    TextureDesc desc;                           ///< with the layout of views
    Grid region{};                              ///< region size; zeros: not cut
    std::optional<std::uint8_t> presence = {};  ///< the texture that holds its presence
  };
  /// out_of_memory.
  [[nodiscard]] static Result<TextureDecoders> create(std::vector<Texture> textures,
                                                      DecoderOptions options);

  /// Creates the decoder if there is none yet. `region`: its number in RegionGrid, or
  /// StreamId::kWholeVolume for a texture that is not cut. Errors: those of Decoder::create();
  /// limit_exceeded if all decoders take more than max_total_bytes.
  Result<Decoder*> decoder(std::uint8_t texture, std::uint32_t region);
  /// Null if it was not created.
  [[nodiscard]] const Decoder* find(std::uint8_t texture, std::uint32_t region) const noexcept;
  /// Applies a packet. Errors: those of decoder() and Decoder::decode().
  Status decode(std::uint8_t texture, std::uint32_t region, std::span<const std::byte> packet);
  /// Deletes all decoders.
  void clear() noexcept;

  /// Writes a texture, or some blocks, ascending; blocks that were not received are zero.
  Status read(std::uint8_t texture, const TextureView& view) const;
  Status read(std::uint8_t texture, const TextureView& view,
              std::span<const std::uint32_t> blocks) const;

  /// Empties changed(). If `noted`, decode() notes changed blocks from here on.
  void begin_changes(bool noted) noexcept;
  /// Sorts changed(), each block once; or, if `all`, lists all blocks of textures with decoders.
  void settle_changes(bool all);
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept {
    return changed_[texture];
  }

  /// Sets the layout of a texture's views. out_of_order if the texture has a decoder.
  Status set_layout(std::uint8_t texture, const Layout& layout);
  [[nodiscard]] const Texture& operator[](std::uint8_t texture) const noexcept {
    return textures_[texture];
  }
  [[nodiscard]] std::size_t size() const noexcept { return textures_.size(); }

  /// Peak bytes of all decoders.
  [[nodiscard]] std::uint64_t memory() const noexcept { return held_ + scratched_; }
  /// Sets the bytes that the caller holds itself, which count as well. limit_exceeded beyond
  /// max_total_bytes.
  Status set_callers_bytes(std::uint64_t bytes) noexcept;
  /// Bytes that the last decode() or set_callers_bytes() compared with max_total_bytes; 0: it did
  /// not.
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
  std::uint64_t held_ = 0, scratched_ = 0;  ///< bytes of decoders, and of their shared memory
  std::uint64_t beside_ = 0, needed_ = 0;
  bool noting_ = false;
  std::vector<std::vector<std::uint32_t>> changed_;  ///< by texture
};

}  // namespace gicodec
