// Encoding session of the HEVC backend.
#pragma once

#include "backend/hevc/codec.h"
#include "backend/hevc/payload.h"
#include "backend/hevc/picture.h"

#include <gicodec/backend.h>

#include <string>
#include <vector>

namespace gicodec::hevc {

struct SessionSettings {
  HevcPacking packing{};
  HevcLayout layout{};
  std::vector<std::string> encoders;  ///< FFmpeg encoders by preference; x265 comes last
  DecoderKind decoder{};              ///< for checking and for lossy coding
  CoderSettings coder;
  Isa isa = best_isa();
};

class SessionEncoder final : public BackendEncoder {
 public:
  /// Preconditions: validate(desc) is ok; `largest` is the shape of a picture of all blocks.
  SessionEncoder(const TextureDesc& desc, SessionSettings settings, const FrameShape& largest)
      : desc_(desc), settings_(std::move(settings)), largest_(largest) {}

  /// Opens the first encoder that works for pictures of the largest shape.
  Status open_first();
  /// Name of the encoder in use: FFmpeg's, or "x265".
  [[nodiscard]] std::string_view encoder_name() const noexcept;

  [[nodiscard]] std::size_t bound(std::size_t blocks) const override;
  [[nodiscard]] bool is_stateful() const override { return true; }
  [[nodiscard]] bool lossy() const override { return settings_.coder.lossy_qp >= 0; }
  Status encode(const EncodeJob& job, std::vector<std::byte>& out) override;

 private:
  Status encode_update(const EncodeJob& job, std::vector<std::byte>& out);
  [[nodiscard]] std::uint8_t choose_class(const EncodeJob& job) const noexcept;
  [[nodiscard]] std::size_t last_candidate() const noexcept {
    return settings_.encoders.size() + 1;
  }
  Status open_encoder(const PictureFormat& format);
  Status encode_picture(bool idr);
  Status encode_once(bool idr);
  Status check_or_decode(bool idr);
  [[nodiscard]] bool must_decode() const noexcept;
  void close() noexcept;

  TextureDesc desc_;
  SessionSettings settings_;
  FrameShape largest_;
  FrameShape shape_{};                       // of the open stream
  std::size_t candidate_ = 0;                // FFmpeg's, then x265 with weights, then without
  std::unique_ptr<PictureEncoder> encoder_;  // null: the next picture is an IDR picture
  std::unique_ptr<PictureDecoder> decoder_;  // null unless the last picture was decoded
  ParameterSets sets_;
  unsigned since_idr_ = 0;          // pictures since the last IDR picture
  std::vector<std::byte> records_;  ///< of the blocks of an update
  std::vector<std::byte> raster_;
  Picture picture_, decoded_;
  std::vector<std::byte> encoded_, access_unit_;
};

}  // namespace gicodec::hevc
