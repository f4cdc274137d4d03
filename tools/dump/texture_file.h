// Files that have texels as they are in memory behind a head that says what they are: DDS, KTX2 and
// raw. One file holds one frame of one texture of two or three dimensions, or of an array.
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

/// What a head says. It does not contradict itself; what it claims is not yet compared with the
/// bytes that there are.
struct TextureHead {
  std::optional<Format> format;  ///< nullopt: none that is known here, or none is told
  std::string format_name;       ///< as the file has it, for messages: "DXGI format 29"
  Grid texels;                   ///< width, height, and depth or elements of an array; 1 or more
  bool volume = false;           ///< of three dimensions, rather than an array
  std::uint64_t offset = 0;      ///< of the first texel in the file
  std::uint64_t bytes = 0;       ///< of all texels
  Attributes attributes;
};

/// Heads beyond are refused.
inline constexpr std::uint64_t kMaxHeadBytes = std::uint64_t{16} << 20;

/// A regular file, read piece by piece. Throws Error.
class TextureFile {
 public:
  explicit TextureFile(std::string path);
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Throws where the file ends before.
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
/// An attribute of bytes: their hexadecimal digits behind 0x.
[[nodiscard]] Attribute bytes_attribute(std::string name, std::span<const std::byte> bytes);
/// The inverse; throws for text that is none.
[[nodiscard]] std::vector<std::byte> attribute_bytes(const Attribute& attribute,
                                                     const std::string& path);
/// Of files that have text alone: of the type that it has in EXR files where it is one of ours,
/// else a string.
[[nodiscard]] Attribute text_attribute(std::string name, std::string_view text);

/// A format's texels in a record along x and y: 4 for compressed blocks, else 1.
[[nodiscard]] constexpr std::uint32_t texels_of_record(Format format) noexcept {
  return format >= Format::BC6H_UFLOAT_BLOCK && format <= Format::BC7_SRGB_BLOCK ? 4 : 1;
}
/// Size in texels of the file of a texture, where a compressed block is full.
[[nodiscard]] Grid texels_of(const TextureDesc& desc) noexcept;
/// Size of a file in records of a format.
[[nodiscard]] Grid records_of(const Grid& texels, Format format) noexcept;
/// Whether a texture is stored as one of three dimensions, or else as an array.
[[nodiscard]] inline bool is_volume(const TextureDesc& desc) noexcept { return desc.block.z > 1; }

// Attributes of these names are no metadata of a file but fields of its head, where these do not
// follow from the texture.
inline constexpr const char* kDdsHeader = "dds:header";    ///< the whole header
inline constexpr const char* kKtx2Header = "ktx2:header";  ///< the first 48 bytes
inline constexpr const char* kKtx2Format = "ktx2:dfd";     ///< the data format descriptor
inline constexpr const char* kRawSidecar = "raw:sidecar";  ///< "shared" by all frames, or "none"
inline constexpr const char* kRawExtent = "raw:extent";    ///< where compressed blocks are not full
[[nodiscard]] bool is_head_field(std::string_view name) noexcept;
/// Whether a head can be that of a file of this texture, of another format with as many bytes even.
[[nodiscard]] bool fits(const TextureHead& head, const TextureDesc& desc) noexcept;

/// With all attributes of the file's head.
/// The texture of a head, and of its attributes those that do not follow from that.
[[nodiscard]] DumpInfo texture_info(const TextureHead& head, ImageKind kind, const Hints& hints,
                                    const std::string& path);

[[nodiscard]] bool dds_has_format(Format format) noexcept;
[[nodiscard]] TextureHead read_dds_head(TextureFile& file);
/// Takes away those that follow from the texture.
void drop_implied_dds(DumpInfo& info);
/// All bytes before the first texel. Throws for a format that DDS files cannot have, and for an
/// attribute dds:header of another texture.
[[nodiscard]] std::vector<std::byte> dds_head(const DumpInfo& info, const std::string& path);

[[nodiscard]] TextureHead read_ktx2_head(TextureFile& file);
void drop_implied_ktx2(DumpInfo& info);
[[nodiscard]] std::vector<std::byte> ktx2_head(const DumpInfo& info, const std::string& path);

/// Of a raw file, from its sidecar: NAME.FFFF.json or NAME.json. Where there is none, what `known`
/// says.
[[nodiscard]] TextureHead read_raw_head(TextureFile& file, const std::optional<TextureDesc>& known);
void drop_implied_raw(DumpInfo& info);
/// The same of a sidecar's text; nothing is said of the texels' bytes.
[[nodiscard]] TextureHead parse_sidecar(const std::string& text, const std::string& path);
/// Text of the sidecar; empty if the file has none.
[[nodiscard]] std::string raw_sidecar(const DumpInfo& info, const std::string& path);
/// Where it stands.
[[nodiscard]] std::string raw_sidecar_path(const std::string& path, bool shared);

}  // namespace gicodec::tools
