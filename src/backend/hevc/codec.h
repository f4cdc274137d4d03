// HEVC encoders and decoders of one picture after another without delay, each hiding one
// third-party library.
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
  std::string preset;  ///< of x265; empty for the default
  unsigned threads = 1;
  int lossy_qp = -1;    ///< negative: lossless
  bool weights = true;  ///< of inter prediction; x265 sometimes writes them out of range
};

/// Side of the coding tree units: the larger ones code a little better.
[[nodiscard]] constexpr std::uint32_t coding_tree_side(const PictureFormat& format) noexcept {
  return format.width > kMaxCodingTree && format.height >= kMaxCodingTree ? kMaxCodingTree
                                                                          : kMinCodingTree;
}

class PictureEncoder {
 public:
  virtual ~PictureEncoder() = default;
  /// Replaces `out` by the encoder's access unit. The first picture has to be an IDR picture.
  virtual Status encode(const Picture& picture, bool idr, std::vector<std::byte>& out) = 0;
};

class PictureDecoder {
 public:
  virtual ~PictureDecoder() = default;
  /// Decodes one access unit that parse_access_unit() accepted for picture.format. The samples are
  /// complete if the status is ok, but they are only as good as the bytes were.
  virtual Status decode(const AccessUnit& unit, Picture& picture) = 0;
};

/// invalid_argument for an unknown preset.
[[nodiscard]] Result<std::unique_ptr<PictureEncoder>> open_x265(const PictureFormat& format,
                                                                const CoderSettings& settings);
/// An FFmpeg encoder by name. backend_unavailable if there is none of that name for HEVC, it cannot
/// code the format or cannot be opened on this machine. Whether it codes without loss is to be
/// seen from what it gives.
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
