// HEVC backend (Stengel et al. §3.3): lossless H.265 by x265 and libde265, or by FFmpeg. It is in
// the target gicodec::hevc, because x265 is GPL and FFmpeg and libde265 are LGPL.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace GICODEC_API gicodec {

/// How texels become HEVC planes (FORMAT.md, "HEVC payload").
enum class HevcPacking : std::uint8_t {
  paper,   ///< colour as 10-bit 4:4:4 planes R,G,B; others as bytes in 8-bit 4:4:4 (YUVY UVYU VYUV)
  planes,  ///< colour as 12-bit 4:4:4 planes G, R−G, B−G; others as 8-bit 4:0:0 byte planes
  luma,    ///< lossy colour alone, as 10-bit 4:4:4 luma and chroma: half the bytes of `paper`
};

/// Which blocks an HEVC frame holds.
enum class HevcLayout : std::uint8_t {
  atlas,   ///< all blocks in place; unchanged ones have their mirror value
  packed,  ///< only the update's blocks, side by side (the paper's update textures)
};

struct HevcSettings {
  HevcPacking packing = HevcPacking::paper;
  HevcLayout layout = HevcLayout::atlas;
  /// "x265", or names of FFmpeg encoders in order of preference, separated by commas, e.g.
  /// "hevc_nvenc,hevc_vaapi,libx265". x265 is always the last resort.
  std::string encoder = "x265";
  /// "libde265" or "ffmpeg".
  std::string decoder = "libde265";
  unsigned decoder_threads = 1;  ///< of the third-party decoder, 1..64
  /// Quantiser 0..51 for lossy colour; negative for lossless, and invalid_settings with `luma`.
  /// invalid_settings for any other format and with an encoder other than "x265". Alpha stays
  /// exact.
  int lossy_qp = -1;
};

/// Immutable; several threads may share it.
class HevcBackend final : public Backend {
 public:
  HevcBackend() = default;
  explicit HevcBackend(HevcSettings settings) : settings_(std::move(settings)) {}

  std::uint8_t id() const override { return kBackendHevc; }
  std::string_view name() const override { return "hevc"; }
  /// Reads settings.preset (x265's names; default "medium") and settings.threads, 1..64; refuses a
  /// level. limit_exceeded if the grid's picture is wider or higher than HEVC coders take. Skips an
  /// FFmpeg encoder that cannot be opened, or later delays, loses or garbles pictures.
  Result<std::unique_ptr<BackendEncoder>> make_encoder(
      const TextureDesc& desc, const BackendSettings& settings) const override;
  Result<std::unique_ptr<BackendDecoder>> make_decoder(const TextureDesc& desc) const override;

  /// The encoder that make_encoder() would open: a name from HevcSettings::encoder, or "x265".
  /// Errors: those of make_encoder().
  [[nodiscard]] Result<std::string> encoder_in_use(const TextureDesc& desc,
                                                   const BackendSettings& settings) const;

 private:
  HevcSettings settings_;
};

}  // namespace gicodec
