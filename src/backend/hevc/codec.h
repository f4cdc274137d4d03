// HEVC encoders and decoders without delay: one picture in, one out. Each hides a library.
#pragma once

#include "backend/hevc/access_unit.h"
#include "backend/hevc/picture.h"

#include <gicodec/status.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::hevc {

struct CoderSettings {
  std::string preset;  ///< x265's; empty: the default
  unsigned threads = 1;
  int lossy_qp = -1;    ///< negative: lossless
  bool weights = true;  ///< weighted prediction; x265 sometimes writes weights out of range
};

/// Side of the coding tree units, in samples; larger ones code a little better.
[[nodiscard]] constexpr std::uint32_t coding_tree_side(const PictureFormat& format) noexcept {
  return format.width > kMaxCodingTree && format.height >= kMaxCodingTree ? kMaxCodingTree
                                                                          : kMinCodingTree;
}

class PictureEncoder {
 public:
  virtual ~PictureEncoder() = default;
  /// Replaces `out` by the picture's access unit. The first picture must be an IDR picture.
  virtual Status encode(const Picture& picture, bool idr, std::vector<std::byte>& out) = 0;
};

class PictureDecoder {
 public:
  virtual ~PictureDecoder() = default;
  /// Decodes an access unit that parse_access_unit() accepted for picture.format. If the status is
  /// ok, all samples are set, but of damaged bytes they may be wrong.
  virtual Status decode(const AccessUnit& unit, Picture& picture) = 0;
};

/// invalid_argument for an unknown preset.
[[nodiscard]] Result<std::unique_ptr<PictureEncoder>> open_x265(const PictureFormat& format,
                                                                const CoderSettings& settings);
/// An FFmpeg encoder by name. backend_unavailable if FFmpeg has no HEVC encoder of that name, or it
/// cannot code the format or be opened on this machine. Its output may be lossy.
[[nodiscard]] Result<std::unique_ptr<PictureEncoder>> open_ffmpeg_encoder(
    const std::string& name, const PictureFormat& format, const CoderSettings& settings);

enum class DecoderKind : std::uint8_t { libde265, ffmpeg };

[[nodiscard]] Result<std::unique_ptr<PictureDecoder>> open_libde265(unsigned threads);
[[nodiscard]] Result<std::unique_ptr<PictureDecoder>> open_ffmpeg_decoder(
    const PictureFormat& format, unsigned threads);

[[nodiscard]] inline Result<std::unique_ptr<PictureDecoder>> open_decoder(
    DecoderKind kind, const PictureFormat& format, unsigned threads) {
  return kind == DecoderKind::ffmpeg ? open_ffmpeg_decoder(format, threads)
                                     : open_libde265(threads);
}

}  // namespace gicodec::hevc
