// An EXR file's header as its bytes say it, before OpenEXR allocates by its sizes.
#pragma once

#include "dump/sample.h"

#include <gicodec/volume.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

struct ExrAttribute {
  std::string name, type, bytes;
};

struct ExrChannel {
  std::string name;
  SampleType type{};
  bool linear = false;  ///< pLinear
  std::uint32_t x_sampling = 1, y_sampling = 1;
};

struct ExrPart {
  std::string name;  ///< empty in files of one part that do not name it
  std::vector<ExrAttribute> attributes;
  std::vector<ExrChannel> channels;
  std::int32_t x = 0, y = 0;  ///< where the data window begins
  std::uint32_t width = 0, height = 0;
  bool tiled = false;
  std::uint32_t levels = 1;  ///< mip levels
  bool round_up = false;     ///< sizes of levels
  Grid tile;                 ///< texels of one; z = 1
  std::uint8_t compression = 0;
  std::uint64_t places = 0;  ///< where the places of its chunks stand in the file, 8 bytes each
  bool in_several = false;   ///< of a file whose chunks say to which part they belong

  /// Width and height of a level; z = 1.
  [[nodiscard]] Grid level_size(std::uint32_t level) const noexcept;
  /// Lines of a chunk, where it is no tile.
  [[nodiscard]] std::uint32_t chunk_lines() const noexcept;
  [[nodiscard]] std::uint64_t chunk_count() const noexcept;
};

/// Farthest that a data window may begin from 0: attribute exr:origin holds these exactly.
inline constexpr std::int32_t kMaxExrOrigin = 1 << 24;
inline constexpr std::uint32_t kMaxExrSampling = 1024;

/// How many of the texels first..last have a sample if every `step`th has one, 0 among them.
[[nodiscard]] std::int64_t exr_samples(std::int64_t first, std::int64_t last,
                                       std::int64_t step) noexcept;

/// False where the bytes are no value of a type that OpenEXR knows: it would read another header
/// than the one that they stand in, or allocate by a size in them.
[[nodiscard]] bool is_sound_exr_value(std::string_view type, std::string_view bytes) noexcept;

/// Throws Error for a file that is no EXR, is damaged, deep or ripmapped, or claims more than its
/// bytes can hold.
[[nodiscard]] std::vector<ExrPart> read_exr_header(const std::string& path);

}  // namespace gicodec::tools
