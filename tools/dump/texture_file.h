// Texture files hold texels as in memory, behind a head that describes them: DDS, KTX2 and raw. One
// file holds one frame of a texture of two or three dimensions, or of an array, with its mip levels
// and the faces of cubes: an image for each level and face.
#pragma once

#include "dump/dump.h"
#include "dump/file_system.h"
#include "dump/supercompression.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// Where a level's bytes are, in a file that lists its levels.
struct StoredLevel {
  std::uint64_t offset = 0, bytes = 0, unpacked = 0;
};

/// A file's head. It is consistent, but its sizes are not yet compared with the file's.
struct TextureHead {
  std::optional<Format> format;     ///< nullopt: unknown
  std::string format_name;          ///< the file's name for it, for messages: "DXGI format 29"
  Grid texels;                      ///< width, height, depth or array elements; each 1 or more
  bool volume = false;              ///< three dimensions, not an array
  std::uint32_t levels = 1;         ///< mip levels
  std::uint32_t faces = 1;          ///< of each element, 6 for cubes
  std::uint64_t offset = 0;         ///< of the first texel in the file
  std::uint64_t bytes = 0;          ///< of all texels, in the file
  std::vector<StoredLevel> stored;  ///< of KTX2, by level
  Scheme scheme = Scheme::none;     ///< of KTX2
  Attributes attributes;
};
/// Most levels of a texture: sides are below 2^32.
inline constexpr std::uint32_t kMaxLevels = 32;

/// Levels down to one texel.
[[nodiscard]] std::uint32_t max_levels(const TextureHead& head) noexcept;
/// Size of a level.
[[nodiscard]] Grid level_texels(const TextureHead& head, std::uint32_t level) noexcept;
/// "py.mip2"; empty for the only image of a file and the first level of a texture that is no cube.
[[nodiscard]] std::string image_name(const TextureHead& head, const ImagePlace& place);
/// All images of a file, level by level.
[[nodiscard]] std::vector<ImagePlace> places_of(const TextureHead& head);

/// Runs of bytes, one for each slice of an image.
struct Runs {
  std::uint64_t first = 0, stride = 0;
  std::size_t bytes = 0;
  std::uint32_t count = 0;
};
/// Where an image's slices are: in all texels of a file that goes element by element, as DDS does,
/// or in those of its level.
[[nodiscard]] Runs runs_by_element(const TextureHead& head, const ImagePlace& place, Format format);
[[nodiscard]] Runs runs_by_level(const TextureHead& head, const ImagePlace& place, Format format);
/// Bytes of a level, and of all.
[[nodiscard]] std::uint64_t level_bytes(const TextureHead& head, std::uint32_t level,
                                        Format format) noexcept;
[[nodiscard]] std::uint64_t all_bytes(const TextureHead& head, Format format) noexcept;
/// Puts an image's slices in their places.
void scatter(std::span<const std::byte> texels, const Runs& runs, std::span<std::byte> into);
/// The inverse.
void gather(std::span<const std::byte> from, const Runs& runs, std::span<std::byte> texels);

/// The head of a file of these images, if no other is kept. Throws unless they are all levels and
/// faces of a texture, level by level.
[[nodiscard]] TextureHead head_of(std::span<const Dump> images, const std::string& path);
/// Throws unless the images are those of the head, and have its sizes.
void require_fit(const TextureHead& head, std::span<const Dump> images, const char* attribute,
                 const std::string& path);

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
  std::string path_;
  OwnedFile file_;
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

/// Texels of a record along x and y: more than 1 for compressed blocks.
[[nodiscard]] bool is_compressed(Format format) noexcept;
/// Size of a texture's file, in texels; compressed blocks count in full.
[[nodiscard]] Grid texels_of(const TextureDesc& desc) noexcept;
/// Size of a file, in records of a format.
[[nodiscard]] Grid records_of(const Grid& texels, Format format) noexcept;
/// True if a texture is stored with three dimensions, false if as an array.
[[nodiscard]] inline bool is_volume(const TextureDesc& desc) noexcept { return desc.block.z > 1; }

// Attributes of these names are fields of a file's head that do not follow from the texture.
inline constexpr const char* kDdsHeader = "dds:header";    ///< the whole header
inline constexpr const char* kKtx2Head = "ktx2:head";      ///< all bytes that are no texels
inline constexpr const char* kKtx2Scheme = "ktx2:scheme";  ///< of supercompression
inline constexpr const char* kRawSidecar = "raw:sidecar";  ///< "shared" by all frames, or "none"
inline constexpr const char* kRawExtent = "raw:extent";  ///< set if compressed blocks are not full
[[nodiscard]] bool is_head_field(std::string_view name) noexcept;

/// The images of a head, or the one that the hints name; the first has the attributes.
[[nodiscard]] std::vector<DumpInfo> texture_infos(const TextureHead& head, const Hints& hints,
                                                  const std::string& path);

[[nodiscard]] bool dds_has_format(Format format) noexcept;
[[nodiscard]] TextureHead read_dds_head(TextureFile& file);
/// A whole file. Throws for a format that DDS files cannot hold, and for an attribute dds:header of
/// another texture.
[[nodiscard]] std::vector<std::byte> dds_file(std::span<const Dump> images,
                                              const std::string& path);
/// Sets attribute dds:header unless it follows from the texture.
void keep_dds_header(const TextureHead& head, DumpInfo& first);

[[nodiscard]] TextureHead read_ktx2_head(TextureFile& file);
/// A whole file.
[[nodiscard]] std::vector<std::byte> ktx2_file(std::span<const Dump> images,
                                               const std::string& path);
/// Sets attribute ktx2:head unless it follows from the texture and the attributes, and notes what
/// cannot be kept.
void keep_ktx2_head(TextureFile& file, const TextureHead& head, DumpInfo& first);

/// The head of a raw file from its sidecar, NAME.FFFF.json or NAME.json; without one from the
/// hints: a texture, or format and extent.
[[nodiscard]] TextureHead read_raw_head(TextureFile& file, const Hints& hints);
void drop_implied_raw(DumpInfo& info);
/// The head in a sidecar's text, without the size of texels.
[[nodiscard]] TextureHead parse_sidecar(const std::string& text, const std::string& path);
/// Text of a file's sidecar; empty if it has none.
[[nodiscard]] std::string raw_sidecar(const DumpInfo& info, const std::string& path);
/// Path of the sidecar.
[[nodiscard]] std::string raw_sidecar_path(const std::string& path, bool shared);

}  // namespace gicodec::tools
