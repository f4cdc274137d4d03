// The folder that ddgi-trace writes: dumps of both textures, probe positions, camera path.
#pragma once

#include "scene.h"
#include "volume.h"

#include "dump/file.h"

#include <string>

namespace gicodec::ddgi {

inline constexpr const char* kColorName = "color";
inline constexpr const char* kVisibilityName = "vis";
inline constexpr const char* kSceneAttribute = "gicodec:scene";
inline constexpr const char* kTimeAttribute = "gicodec:time";
inline constexpr const char* kOriginAttribute = "gicodec:origin";
inline constexpr const char* kSpacingAttribute = "gicodec:spacing";

class DumpFolder {
 public:
  /// Creates the folder. Throws tools::Error of Exit::io if it already holds dumps, unless
  /// `overwrite`: then the new files are kept in a folder .new inside it until finish().
  DumpFolder(std::string path, std::string scene, const VolumeShape& shape, bool overwrite);
  DumpFolder(const DumpFolder&) = delete;
  DumpFolder& operator=(const DumpFolder&) = delete;
  ~DumpFolder();

  /// A file of any name in it.
  void write_text(const std::string& name, const std::string& content) const;
  /// New files take the places of old ones; old dumps that have no successor go.
  void finish();

  /// positions.csv: index, position and state of each probe; inactive.txt: for gicodec encode.
  void write_positions(std::span<const std::uint32_t> active) const;
  /// color.FFFF.exr and vis.FFFF.exr.
  void write_frame(std::uint32_t frame, double time, const ProbeTextures& textures) const;
  /// camera.json: the camera at each frame.
  struct CameraFrame {
    std::uint32_t frame;
    double time;
    Camera camera;
  };
  void write_cameras(std::span<const CameraFrame> cameras) const;

 private:
  std::string path_;
  tools::OutputDirectory directory_;
  std::string staging_;  ///< where files are written; path_ if there is nothing to replace
  std::string scene_;
  VolumeShape shape_;
};

}  // namespace gicodec::ddgi
