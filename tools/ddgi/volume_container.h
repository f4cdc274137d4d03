// Successive frames of a volume as a container.
#pragma once

#include "gicodec/stored_texture.h"
#include "volume.h"
#include "volume_encoders.h"

#include <gicodec/container.h>
#include <gicodec/kind.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// Throws tools::Error.
class VolumeContainer {
 public:
  /// A file in memory with one volume, coded by zstd. `file`: its name, for messages. `dumps`: what
  /// its textures come back as; if there are none, no attributes.
  VolumeContainer(const VolumeDesc& volume, const std::string& name, const VolumeShape& shape,
                  const std::string& scene, std::string file,
                  std::span<const tools::StoredTexture> dumps = {});
  VolumeContainer(const VolumeContainer&) = delete;
  VolumeContainer& operator=(const VolumeContainer&) = delete;

  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  /// All textures in order. What changed of a set that travels together travels in all of it.
  void add(std::uint64_t frame, std::span<const Texels> textures);
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
  std::string file_;
  VolumeEncoders encoders_;
  std::optional<ContainerWriter> writer_;
};

}  // namespace gicodec::ddgi
