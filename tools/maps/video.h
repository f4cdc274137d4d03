// Maps as the pictures of a video, as in Crassin et al. §4.2, step 5: lossy HEVC in the pages of
// the kind.
#pragma once

#include "parameterisation.h"

#include <gicodec/backend.h>
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/irradiance_maps.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::maps {

/// Texels of a picture in 10 bits: of the fifth root of each channel, white being 1023, luma
/// (R + 2G + B) / 4 in R, (R − B) / 2 + 512 in G, (2G − R − B) / 4 + 512 in B, without chroma
/// subsampling.
[[nodiscard]] std::uint32_t to_video(Vec3 value);
[[nodiscard]] Vec3 from_video(std::uint32_t texel);

/// Such texels of a whole map, by place; those where nothing is repeat the one before.
[[nodiscard]] std::vector<std::uint32_t> video_picture(std::span<const MapTexel> texels,
                                                       std::span<const Vec3> values);

/// Pictures are packets of the library's backend "hevc", cut into pages. A keyframe and those that
/// follow it stand behind each other; where a picture does not fit behind the last one, a keyframe
/// begins at page 0.
class VideoEncoder {
 public:
  /// `qp`: 0 to 51. Throws tools::Error, also where HEVC is missing.
  VideoEncoder(const IrradianceMapDesc& desc, int qp);

  /// Codes a map's values, by place; those of `texels` matter. Throws tools::Error.
  void add(std::span<const MapTexel> texels, std::span<const Vec3> values);
  [[nodiscard]] std::size_t last_bytes() const { return last_bytes_; }

  // Textures of the volume.
  std::vector<std::byte> sizes, pages, frames;

 private:
  IrradianceMapDesc desc_;
  std::unique_ptr<Backend> backend_;
  std::optional<Encoder> encoder_;
  std::uint32_t number_ = 0, next_ = 0, start_ = 0;  ///< picture; page behind it; its keyframe's
  std::size_t last_bytes_ = 0;
};

class VideoDecoder {
 public:
  /// Throws tools::Error where HEVC is missing.
  explicit VideoDecoder(const IrradianceMapDesc& desc);

  /// Decodes the newest picture, and those before it that it needs, from a client's textures, which
  /// may hold anything; up to 50 pictures in a call. False where nothing new can be decoded; values
  /// are then as before.
  bool update(std::span<const std::byte> sizes, std::span<const std::byte> pages,
              std::span<const std::byte> frames, std::span<Vec3> values);

 private:
  void restart();

  IrradianceMapDesc desc_;
  std::unique_ptr<Backend> backend_;
  std::optional<Decoder> decoder_;
  std::uint32_t decoded_ = 0;  ///< number of the last picture; 0: none
  std::uint32_t refused_ = 0;  ///< the newest one when one was no such picture; 0: none
  std::vector<std::byte> texels_;
};

}  // namespace gicodec::maps
