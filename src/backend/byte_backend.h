// The backends "raw", "lz4" and "zstd": records as bytes or byte planes, with or without
// differences to the mirror, through a general compressor (FORMAT.md, "Byte payloads").
#pragma once

#include <gicodec/backend.h>

#include "base/compressor.h"

namespace gicodec {

class ByteBackend final : public Backend {
 public:
  constexpr ByteBackend(std::uint8_t id, Compression method) noexcept : id_(id), method_(method) {}
  std::uint8_t id() const override { return id_; }
  std::string_view name() const override { return backend_name(id_); }
  Result<std::unique_ptr<BackendEncoder>> make_encoder(
      const TextureDesc& desc, const BackendSettings& settings) const override;
  Result<std::unique_ptr<BackendDecoder>> make_decoder(const TextureDesc& desc) const override;

 private:
  std::uint8_t id_;
  Compression method_;
};

}  // namespace gicodec
