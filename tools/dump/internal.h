// Shared by the readers of this folder.
#pragma once

#include "dump/dump.h"

#include <OpenEXR/ImfForward.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// Images beyond these are refused before anything is allocated for them.
inline constexpr std::int64_t kMaxImageSide = 1 << 22;
inline constexpr std::uint64_t kMaxImageBytes = std::uint64_t{1} << 30;  ///< 4 bytes per sample

/// The channels found in a file, with the names they have there.
struct FoundChannel {
  std::string name;
  SampleType type;
};

/// What a file holds besides attributes.
struct FoundImage {
  Grid texels;  ///< width, height and slices
  /// Of an image of samples, whose slices, if there are several, stand one below the other, so that
  /// texels.z is 1. Empty for a texture file.
  std::vector<FoundChannel> channels;
  std::optional<Format> format;  ///< of a texture file, if it is known here
  std::string format_name;       ///< in the file's words
  bool volume = false;           ///< slices are those of a 3D texture
  std::uint64_t bytes = 0;       ///< of all texels of a texture file, if that is known
};

/// Settles format, grid, block and tiling of an image, and what its channels are. Sets
/// info.desc, info.channels and, where a hint replaces it, info.attributes.
void resolve(DumpInfo& info, const FoundImage& found, const Hints& hints, const std::string& path);

[[nodiscard]] std::string to_hex(std::string_view bytes);
/// False for text that is no pairs of hexadecimal digits.
[[nodiscard]] bool from_hex(std::string_view text, std::string& bytes);

/// Throws the error for a sample that is no code.
[[noreturn]] void fail_sample(const DumpInfo& info, const Component& component, SampleType type,
                              std::uint32_t sample, std::uint32_t x, std::uint32_t y,
                              const std::string& path);

/// Throws for an image beyond 64 MiB that would be more than 2,000 times as large as its file: no
/// compression that keeps every bit does that, and memory is taken by what the header says.
void check_image_bytes(std::uint64_t bytes, const std::string& path);

/// Walks an EXR header without allocating by what it says; throws for everything that is no small
/// single-part scanline image or whose sizes contradict the file's.
void check_exr_header(const std::string& path);

/// Sets info.attributes and info.dropped.
void read_attributes(const Imf::Header& header, DumpInfo& info);
/// The inverse; throws for an attribute that is not well formed.
void set_attributes(Imf::Header& header, const Attributes& attributes, const std::string& path);

[[nodiscard]] Dump read_exr(const std::string& path, const Hints& hints, bool texels);
/// DDS, KTX2 and raw.
[[nodiscard]] Dump read_texture_file(const std::string& path, ImageKind kind, const Hints& hints,
                                     bool texels);
void write_texture_file(const std::string& path, ImageKind kind, const DumpInfo& info,
                        std::span<const std::byte> texels, Existing existing);
/// Throws unless the texture is valid and has as many texels.
void check_texels(const DumpInfo& info, std::span<const std::byte> texels, const std::string& path);
[[nodiscard]] Dump read_image(const std::string& path, ImageKind kind, const Hints& hints,
                              bool texels);

}  // namespace gicodec::tools
