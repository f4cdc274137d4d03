// A volume of a traced kind in a container, frame by frame, as a client would hold it.
#pragma once

#include "traced_kind.h"

#include "common/container_input.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::kinds {

class StoredVolume {
 public:
  /// The first volume of a traced kind. Throws tools::Error.
  StoredVolume(const std::string& path, bool allow_incomplete, const tools::DecoderFlags& decoding);
  /// Whether a container, "-" excepted, holds one, and no probes. Throws tools::Error.
  [[nodiscard]] static bool is_in(const std::string& path);

  [[nodiscard]] const TracedKind& kind() const noexcept { return *kind_; }
  [[nodiscard]] const VolumeDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] const SceneId& scene() const noexcept { return input_.description().scene; }
  /// What an incomplete container lacks; empty if it is whole.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  /// Nothing if the container does not say, such as a client's recording.
  [[nodiscard]] std::optional<double> time_of(std::uint64_t frame) const;
  /// Tells a light every frame up to this one. Throws tools::Error of Exit::bad_input where the
  /// container has no such frame, or maybe not all of it.
  void show(std::uint64_t frame, VolumeLight& light);

 private:
  void update(VolumeLight& light);

  tools::ContainerInput input_;
  std::string missing_;
  const TracedKind* kind_ = nullptr;
  VolumeDesc desc_;
  VolumeGeometry geometry_;
  std::size_t first_ = 0;  ///< of its textures in the container
  bool cut_ = false;       ///< into regions, any of which may be missing
  std::vector<std::vector<std::byte>> texels_;
};

}  // namespace gicodec::kinds
