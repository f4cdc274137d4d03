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

/// Facts about a frame from files; each may be missing.
struct FrameFacts {
  std::optional<std::string> scene;
  std::optional<double> time;
  std::optional<Position> origin, spacing;

  /// Reads the facts in the attributes of a dump.
  void read(const tools::Attributes& attributes);
};

class StoredVolume {
 public:
  /// Opens the first volume of a traced kind in a container; "-" is standard input. All calls throw
  /// tools::Error.
  StoredVolume(const std::string& path, bool allow_incomplete, const tools::DecoderFlags& decoding);
  /// Opens the dumps of a folder: irradiance and visibility of one frame of probes.
  StoredVolume(const std::string& folder, std::uint64_t frame);
  /// Of a container on a server: what reading took.
  void remark_cost() const {
    if (input_) tools::remark_cost(*input_);
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }  ///< for messages
  [[nodiscard]] const TracedKind& kind() const noexcept { return *kind_; }
  [[nodiscard]] const VolumeDesc& desc() const noexcept { return desc_; }
  /// A hash of the scene's triangles; 0 if unknown.
  [[nodiscard]] std::uint64_t triangles() const;
  /// What an incomplete container lacks; empty if it is complete. For a pipe, call it after show().
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  /// Names the first texture that was coded with loss; empty if none was.
  [[nodiscard]] std::string loss() const;
  [[nodiscard]] FrameFacts facts_at(std::uint64_t frame) const;
  /// Overrides the stored geometry.
  void place(const VolumeGeometry& geometry) { geometry_ = geometry; }
  /// Updates a light to this frame, through all earlier frames if the kind `remembers`. Throws
  /// tools::Error of Exit::bad_input if the frame does not exist or may be incomplete.
  void show(std::uint64_t frame, VolumeLight& light);

 private:
  void follow();
  void update(std::uint64_t frame, VolumeLight& light) const;

  std::string path_, missing_;
  std::optional<tools::ContainerInput> input_;
  bool allow_incomplete_ = false;
  std::vector<tools::DumpInfo> files_;  ///< headers of dumps
  const TracedKind* kind_ = nullptr;
  VolumeDesc desc_;
  std::optional<VolumeGeometry> geometry_;
  std::size_t first_ = 0;  ///< first of its textures in the container
  bool cut_ = false;       ///< the volume is cut into regions, which may be missing
  std::vector<std::vector<std::byte>> texels_;
};

}  // namespace gicodec::kinds
