// Shared by the readers in this folder.
#pragma once

#include "dump/dump.h"

#include <OpenEXR/ImfForward.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// Larger images are refused before memory is allocated for them.
inline constexpr std::int64_t kMaxImageSide = 1 << 22;
inline constexpr std::uint64_t kMaxImageBytes = std::uint64_t{1} << 30;  ///< 4 bytes per sample

/// A channel of a file.
struct FoundChannel {
  std::string name;
  SampleType type;
};

/// What a file's header gives besides attributes.
struct FoundImage {
  Grid texels;  ///< width, height and slices
  /// Channels of an image; its slices lie below each other, so texels.z is 1. Texture files: empty.
  std::vector<FoundChannel> channels;
  std::optional<Format> format;  ///< of a texture file, if known
  std::string format_name;       ///< the file's name for it
  bool volume = false;           ///< slices are those of a 3D texture
  std::uint64_t bytes = 0;       ///< of all texels of a texture file, if known
};

/// Determines format, grid, block, tiling and channels of an image. Sets info.desc, info.channels
/// and, where a hint replaces them, info.attributes.
void resolve(DumpInfo& info, const FoundImage& found, const Hints& hints, const std::string& path);

[[nodiscard]] std::string to_hex(std::string_view bytes);
/// False unless the text is pairs of hexadecimal digits.
[[nodiscard]] bool from_hex(std::string_view text, std::string& bytes);

/// Throws Error for a sample that is no code.
[[noreturn]] void fail_sample(const DumpInfo& info, const Component& component, SampleType type,
                              std::uint32_t sample, std::uint32_t x, std::uint32_t y,
                              const std::string& path);

/// Throws for an image beyond 64 MiB that is more than 2,000 times as large as its file. No
/// lossless compression reaches that, and the header's sizes determine allocations.
void check_image_bytes(std::uint64_t bytes, const std::string& path);

/// Checks an EXR header without allocating by its sizes. Throws unless it is a small single-part
/// scanline image whose sizes agree with the file's.
void check_exr_header(const std::string& path);

/// Sets info.attributes and info.dropped.
void read_attributes(const Imf::Header& header, DumpInfo& info);
/// The inverse; throws for a malformed attribute.
void set_attributes(Imf::Header& header, const Attributes& attributes, const std::string& path);

[[nodiscard]] Dump read_exr(const std::string& path, const Hints& hints, bool texels);
/// Reads DDS, KTX2 and raw files.
[[nodiscard]] Dump read_texture_file(const std::string& path, ImageKind kind, const Hints& hints,
                                     bool texels);
void write_texture_file(const std::string& path, ImageKind kind, const DumpInfo& info,
                        std::span<const std::byte> texels, Existing existing);
/// Throws unless the texture is valid and `texels` has its size.
void check_texels(const DumpInfo& info, std::span<const std::byte> texels, const std::string& path);
[[nodiscard]] Dump read_image(const std::string& path, ImageKind kind, const Hints& hints,
                              bool texels);

}  // namespace gicodec::tools
