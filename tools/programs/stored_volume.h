// A volume of a traced kind from a container or from dumps, as a client would hold it.
#pragma once

#include "kind_table.h"

#include "common/container_input.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::kinds {

/// What files say of a frame, as far as they do.
struct FrameFacts {
  std::optional<std::string> scene;
  std::optional<double> time;
  std::optional<Position> origin, spacing;

  /// Takes what the attributes of a dump say.
  void read(const tools::Attributes& attributes);
};

class StoredVolume {
 public:
  /// The first volume of a traced kind in a container; "-" is standard input. Throws tools::Error,
  /// here and below.
  StoredVolume(const std::string& path, bool allow_incomplete, const tools::DecoderFlags& decoding);
  /// Irradiance and visibility of one frame of probes, from the dumps of a folder.
  StoredVolume(const std::string& folder, std::uint64_t frame);

  [[nodiscard]] const std::string& source() const noexcept { return source_; }  ///< for messages
  [[nodiscard]] const TracedKind& kind() const noexcept { return *kind_; }
  [[nodiscard]] const VolumeDesc& desc() const noexcept { return desc_; }
  /// A hash of the scene's triangles; 0 if it is not told.
  [[nodiscard]] std::uint64_t triangles() const;
  /// What an incomplete container lacks; empty if it is whole. Of a pipe after show().
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  /// Which texture lost bits to coding; empty if none did.
  [[nodiscard]] std::string loss() const;
  [[nodiscard]] FrameFacts facts_at(std::uint64_t frame) const;
  /// Instead of where it says that it stands.
  void place(const VolumeGeometry& geometry) { geometry_ = geometry; }
  /// Tells a light this frame; every frame up to it where the kind remembers them. Throws
  /// tools::Error of Exit::bad_input where there is no such frame, or maybe not all of it.
  void show(std::uint64_t frame, VolumeLight& light);

 private:
  void follow();
  void update(std::uint64_t frame, VolumeLight& light) const;

  std::string source_, missing_;
  std::optional<tools::ContainerInput> input_;
  bool allow_incomplete_ = false;
  std::vector<tools::DumpInfo> files_;  ///< heads of dumps
  const TracedKind* kind_ = nullptr;
  VolumeDesc desc_;
  std::optional<VolumeGeometry> geometry_;
  std::size_t first_ = 0;  ///< of its textures in the container
  bool cut_ = false;       ///< into regions, any of which may be missing
  std::vector<std::vector<std::byte>> texels_;
};

}  // namespace gicodec::kinds
