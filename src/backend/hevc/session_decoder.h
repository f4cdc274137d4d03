// Decoding session of the HEVC backend.
#pragma once

#include "backend/hevc/codec.h"
#include "backend/hevc/picture.h"

#include <gicodec/backend.h>

#include <vector>

namespace gicodec::hevc {

class SessionDecoder final : public BackendDecoder {
 public:
  SessionDecoder(const TextureDesc& desc, DecoderKind kind, unsigned threads)
      : desc_(desc), kind_(kind), threads_(threads) {}

  Status decode(const DecodeJob& job) override;

 private:
  Status decode_update(const DecodeJob& job);

  TextureDesc desc_;
  DecoderKind kind_;
  unsigned threads_;
  bool ready_ = false;  // a keyframe and all updates since were decoded
  FrameShape shape_{};  // of the open stream
  ParameterSets sets_;
  std::unique_ptr<PictureDecoder> decoder_;  // null: the next picture must be an IDR picture
  Picture picture_;
  std::vector<std::byte> raster_;
};

}  // namespace gicodec::hevc
