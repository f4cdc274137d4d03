// Shared by the readers in this folder.
#pragma once

#include "dump/dump.h"
#include "dump/exr_header.h"

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

/// Formats of 1 to 4 channels of a type that keep every value.
[[nodiscard]] std::array<Format, 4> floats_of(SampleType type) noexcept;

/// Determines format, grid, block, tiling and channels of an image: info.desc and info.channels.
/// Returns the channels that are not the texture's.
std::vector<FoundChannel> resolve(DumpInfo& info, const FoundImage& found, const Hints& hints,
                                  const std::string& path);

[[nodiscard]] std::string to_hex(std::string_view bytes);
/// False unless the text is pairs of hexadecimal digits.
[[nodiscard]] bool from_hex(std::string_view text, std::string& bytes);

/// Throws Error for a sample that is no code.
[[noreturn]] void fail_sample(const DumpInfo& info, const Component& component, SampleType type,
                              std::uint32_t sample, std::uint32_t x, std::uint32_t y,
                              const std::string& path);

/// No compression that keeps bits makes an image smaller by more, but for zstd.
inline constexpr std::uint64_t kMaxRatio = 2000;
/// Throws for an image beyond 64 MiB that is more than `ratio` times as large as its file, which no
/// compression reaches: the header's sizes determine allocations.
void check_image_bytes(std::uint64_t bytes, std::uint64_t ratio, const std::string& path);

// Attributes of these names are facts of an EXR part that are no attributes there.
inline constexpr const char* kExrOrigin = "exr:origin";      ///< of the data window, unless (0, 0)
inline constexpr const char* kExrLinear = "exr:pLinear";     ///< channels with that flag, by lines
inline constexpr const char* kExrSampling = "exr:sampling";  ///< of an image's channels, if not 1
/// A name that the container can hold: itself, or 0x and its bytes where it is no UTF-8.
[[nodiscard]] std::string text_of_name(std::string_view name);
/// The inverse.
[[nodiscard]] std::string name_of_text(const std::string& text);

/// Sets the attributes of a part's first image, and what of them is lost. `several`: the file has
/// more parts.
void read_attributes(const ExrPart& part, bool several, DumpInfo& info);
/// The inverse; throws for a malformed attribute.
void set_attributes(Imf::Header& header, const Attributes& attributes, const std::string& path);

// Readers of all images of a file, or of the one that `hints` name; with or without texels.
[[nodiscard]] std::vector<Dump> read_exr(const std::string& path, const Hints& hints, bool texels);
/// Reads DDS, KTX2 and raw files.
[[nodiscard]] std::vector<Dump> read_texture_file(const std::string& path, ImageKind kind,
                                                  const Hints& hints, bool texels);
[[nodiscard]] std::vector<Dump> read_image(const std::string& path, ImageKind kind,
                                           const Hints& hints, bool texels);
void write_texture_file(const std::string& path, ImageKind kind, std::span<const Dump> images,
                        Existing existing);
/// Throws unless the texture is valid and `texels` has its size.
void check_texels(const DumpInfo& info, std::span<const std::byte> texels, const std::string& path);
}  // namespace gicodec::tools
