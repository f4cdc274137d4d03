// Texture files hold texels as in memory, behind a head that describes them: DDS, KTX2 and raw. One
// file holds one frame of a texture of two or three dimensions, or of an array.
#pragma once

#include "dump/dump.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// A file's head. It is consistent, but its sizes are not yet compared with the file's.
struct TextureHead {
  std::optional<Format> format;  ///< nullopt: unknown
  std::string format_name;       ///< the file's name for it, for messages: "DXGI format 29"
  Grid texels;                   ///< width, height, depth or array elements; each 1 or more
  bool volume = false;           ///< three dimensions, not an array
  std::uint64_t offset = 0;      ///< of the first texel in the file
  std::uint64_t bytes = 0;       ///< of all texels
  Attributes attributes;
};

/// Largest head that is read.
inline constexpr std::uint64_t kMaxHeadBytes = std::uint64_t{16} << 20;

/// Reads parts of a regular file. Throws Error.
class TextureFile {
 public:
  explicit TextureFile(std::string path);
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Throws if the file is too short.
  void read(std::uint64_t offset, std::span<std::byte> into);
  [[nodiscard]] std::vector<std::byte> read(std::uint64_t offset, std::size_t bytes);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

[[nodiscard]] inline std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, &bytes[offset], sizeof word);
  return word;
}
inline void set_word(std::span<std::byte> bytes, std::size_t offset, std::uint32_t word) {
  std::memcpy(&bytes[offset], &word, sizeof word);
}
/// An attribute of type "bytes": 0x and hexadecimal digits.
[[nodiscard]] Attribute bytes_attribute(std::string name, std::span<const std::byte> bytes);
/// The inverse; throws for any other text.
[[nodiscard]] std::vector<std::byte> attribute_bytes(const Attribute& attribute,
                                                     const std::string& path);
/// An attribute of a file whose attributes are all text: a gicodec:* attribute gets its type in EXR
/// files, others are strings.
[[nodiscard]] Attribute text_attribute(std::string name, std::string_view text);

/// Texels of a record along x and y: 4 for compressed blocks, else 1.
[[nodiscard]] constexpr std::uint32_t texels_of_record(Format format) noexcept {
  return format >= Format::BC6H_UFLOAT_BLOCK && format <= Format::BC7_SRGB_BLOCK ? 4 : 1;
}
/// Size of a texture's file, in texels; compressed blocks count in full.
[[nodiscard]] Grid texels_of(const TextureDesc& desc) noexcept;
/// Size of a file, in records of a format.
[[nodiscard]] Grid records_of(const Grid& texels, Format format) noexcept;
/// True if a texture is stored with three dimensions, false if as an array.
[[nodiscard]] inline bool is_volume(const TextureDesc& desc) noexcept { return desc.block.z > 1; }

// Attributes of these names are fields of a file's head that do not follow from the texture.
inline constexpr const char* kDdsHeader = "dds:header";    ///< the whole header
inline constexpr const char* kKtx2Header = "ktx2:header";  ///< the first 48 bytes
inline constexpr const char* kKtx2Format = "ktx2:dfd";     ///< the data format descriptor
inline constexpr const char* kRawSidecar = "raw:sidecar";  ///< "shared" by all frames, or "none"
inline constexpr const char* kRawExtent = "raw:extent";  ///< set if compressed blocks are not full
[[nodiscard]] bool is_head_field(std::string_view name) noexcept;
/// True if a file of this texture can have such a head; a format of the same size also fits.
[[nodiscard]] bool fits(const TextureHead& head, const TextureDesc& desc) noexcept;

/// The texture of a head, with the attributes that do not follow from it.
[[nodiscard]] DumpInfo texture_info(const TextureHead& head, ImageKind kind, const Hints& hints,
                                    const std::string& path);

[[nodiscard]] bool dds_has_format(Format format) noexcept;
[[nodiscard]] TextureHead read_dds_head(TextureFile& file);
/// Removes attributes that follow from the texture.
void drop_implied_dds(DumpInfo& info);
/// All bytes before the first texel. Throws for a format that DDS files cannot hold, and for an
/// attribute dds:header of another texture.
[[nodiscard]] std::vector<std::byte> dds_head(const DumpInfo& info, const std::string& path);

[[nodiscard]] TextureHead read_ktx2_head(TextureFile& file);
void drop_implied_ktx2(DumpInfo& info);
[[nodiscard]] std::vector<std::byte> ktx2_head(const DumpInfo& info, const std::string& path);

/// The head of a raw file from its sidecar, NAME.FFFF.json or NAME.json; without one from `known`.
[[nodiscard]] TextureHead read_raw_head(TextureFile& file, const std::optional<TextureDesc>& known);
void drop_implied_raw(DumpInfo& info);
/// The head in a sidecar's text, without the size of texels.
[[nodiscard]] TextureHead parse_sidecar(const std::string& text, const std::string& path);
/// Text of a file's sidecar; empty if it has none.
[[nodiscard]] std::string raw_sidecar(const DumpInfo& info, const std::string& path);
/// Path of the sidecar.
[[nodiscard]] std::string raw_sidecar_path(const std::string& path, bool shared);

}  // namespace gicodec::tools
