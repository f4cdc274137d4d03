// What the measurements of all kinds share: coders that are their peers, packets, and pictures as a
// client draws them.
#pragma once

#include "common/command_line.h"
#include "ddgi/client_renderer.h"
#include "ddgi/picture.h"
#include "dump/error.h"
#include "kinds/volume_light.h"

#include <gicodec/encoder.h>
#include <gicodec/kind.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gicodec::bench {

using Bytes = std::vector<std::byte>;
/// What was chosen on the command line.
using Measurement = std::function<tools::Exit()>;

/// A row of the table of kinds: adds its flags, and says what is run.
struct KindBench {
  const char* name;
  const char* summary;
  void (*add)(tools::Command& command, Measurement& chosen);
};
void add_ao_points(tools::Command& command, Measurement& chosen);
void add_irradiance_maps(tools::Command& command, Measurement& chosen);
void add_irradiance_vectors(tools::Command& command, Measurement& chosen);
void add_photons(tools::Command& command, Measurement& chosen);
void add_voxels(tools::Command& command, Measurement& chosen);

/// Runs a kind's measurement if its command is given; the options outlive the command line.
template <typename Options>
void choose(tools::Command& command, Measurement& chosen, const std::shared_ptr<Options>& options,
            tools::Exit (*run)(const Options&)) {
  command.callback([&chosen, options, run] { chosen = [options, run] { return run(*options); }; });
}

/// Bytes by zstd; `strategy` 0 is that of the level.
[[nodiscard]] std::size_t zstd_size(std::span<const std::byte> bytes, int level = 19,
                                    int strategy = 0);
/// Byte i of all records, then byte i + 1 of all.
[[nodiscard]] Bytes planes(std::span<const std::byte> records, std::size_t record_bytes);
/// Differences of components, each in its own bits, of as many records; of bytes; and exclusive or.
[[nodiscard]] Bytes differences(std::span<const std::byte> now, std::span<const std::byte> before,
                                const Record& record);
[[nodiscard]] Bytes byte_differences(std::span<const std::byte> now,
                                     std::span<const std::byte> before);
[[nodiscard]] Bytes exclusive_or(std::span<const std::byte> now, std::span<const std::byte> before);
/// Pieces of a texture, one after the other, that begin at multiples of their size.
[[nodiscard]] Bytes gather(std::span<const std::byte> texture, std::size_t piece_bytes,
                           std::span<const std::uint32_t> places);

/// Of updates only: no keyframes but the first packet. Throws tools::Error.
[[nodiscard]] Encoder make_encoder(const TextureDesc& desc, const std::string& preset = "");

/// Options of a picture for a comparison: one ray per pixel.
[[nodiscard]] ddgi::RenderOptions picture_options(std::uint32_t width = 480,
                                                  std::uint32_t height = 270);
/// Writes FOLDER/NAME.png if there is a folder.
void keep_picture(const std::string& folder, const std::string& name, const ddgi::Picture& picture,
                  float exposure);

[[nodiscard]] inline double ratio(std::size_t a, std::size_t b) {
  return static_cast<double>(a) / static_cast<double>(b);
}
/// Prints a line of a table at once.
void print_line(const std::string& line);

}  // namespace gicodec::bench
