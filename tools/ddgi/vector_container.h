// Irradiance vectors of successive frames as a container: no image holds blocks of 6×1×1.
#pragma once

#include "vectors.h"
#include "volume.h"

#include <gicodec/container.h>
#include <gicodec/encoder.h>

#include <optional>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// Throws tools::Error.
class VectorContainer {
 public:
  /// A file in memory with one volume, named `vectors`, coded by zstd.
  VectorContainer(const VectorTextures& textures, const VolumeShape& shape,
                  const std::string& scene);
  VectorContainer(const VectorContainer&) = delete;
  VectorContainer& operator=(const VectorContainer&) = delete;

  /// Blocks that changed in either texture travel in both.
  void add(std::uint64_t frame, const VectorTextures& textures);
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  class Bytes final : public Sink {
   public:
    Status write(std::span<const std::byte> more) override {
      all.insert(all.end(), more.begin(), more.end());
      return Status::ok;
    }
    std::vector<std::byte> all;
  };

  Bytes bytes_;
  std::vector<Encoder> encoders_;
  std::optional<ContainerWriter> writer_;
  VectorTextures before_;
};

}  // namespace gicodec::ddgi
