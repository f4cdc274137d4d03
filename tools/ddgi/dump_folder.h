// The folder that gi-trace writes: dumps of all textures, probe positions, camera path.
#pragma once

#include "scene.h"
#include "volume.h"

#include "dump/dump.h"
#include "dump/file.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::ddgi {

inline constexpr const char* kColorName = "color";
inline constexpr const char* kVisibilityName = "vis";
inline constexpr const char* kSceneAttribute = "gicodec:scene";
inline constexpr const char* kTimeAttribute = "gicodec:time";
/// How colour is stored, where that is not usual of its format.
inline constexpr const char* kEncodingAttribute = "gicodec:encoding";

/// The tracer's own textures, where they are no dumps.
inline constexpr const char* kProbesFile = "probes.gic";
/// All that the texels depend on, as JSON.
inline constexpr const char* kSettingsFile = "trace.json";

/// A texture as it is written.
struct FrameTexture {
  std::string name;
  TextureDesc desc;
  std::span<const std::byte> texels;
  std::optional<Encoding> encoding = {};  ///< of colour
};
/// color, vis, and spherical harmonics.
[[nodiscard]] std::vector<FrameTexture> frame_textures(const ProbeTextures& textures);
/// What a dump of it says of a texture, but for the frame's time.
[[nodiscard]] tools::DumpInfo info_of(const FrameTexture& texture, const std::string& scene,
                                      const VolumeShape& shape);
[[nodiscard]] tools::Attribute time_attribute(double time);

/// The dumps of each frame.
struct FrameFiles {
  std::vector<std::string> textures;  ///< names; none where all frames are in one container
  std::string ending = "exr";         ///< of a kind that is written: exr, dds, ktx2 or raw
};

/// What happens to the results of an earlier trace.
enum class Former : std::uint8_t {
  refuse,   ///< they are an error
  replace,  ///< they stay until all new ones are written
  resume,   ///< frames traced with the same settings are kept
};

/// Every file appears complete or not at all. Without finish(), what was written stays if it has a
/// whole frame and replaces nothing; else it goes again.
class DumpFolder {
 public:
  /// Creates the folder. `settings`: all that the texels depend on, kept as trace.json. Throws
  /// tools::Error: Exit::io for results that are in the way, Exit::bad_input for Former::resume
  /// with other settings, Exit::usage if one of `inputs` would be replaced.
  DumpFolder(std::string path, std::string scene, const VolumeShape& shape,
             const std::string& settings, Former former, const tools::InputFiles& inputs,
             FrameFiles files);
  ~DumpFolder();
  DumpFolder(const DumpFolder&) = delete;
  DumpFolder& operator=(const DumpFolder&) = delete;

  /// positions.csv: index, position and state of each probe; inactive.txt: for gicodec encode,
  /// which counts blocks, so that it is there where these are `probes`.
  void write_positions(std::span<const std::uint32_t> active, bool probes);
  /// NAME.FFFF.exr, or of another ending, for each of them.
  void write_frame(std::uint32_t frame, double time, std::span<const FrameTexture> textures);
  /// Whether all were there already (Former::resume).
  [[nodiscard]] bool holds(std::uint32_t frame) const;
  /// camera.json: the camera at each frame.
  struct CameraFrame {
    std::uint32_t frame;
    double time;
    Camera camera;
  };
  void write_cameras(std::span<const CameraFrame> cameras);
  /// views.jsonl.
  void write_views(const std::string& lines);
  /// probes.gic, or that of an engine's layout.
  void write_container(const std::string& name, std::span<const std::byte> container);
  /// All is written: it takes the place of what was there.
  void finish();

  /// Whether the results would take the place of former ones, which are untouched until finish().
  [[nodiscard]] bool replaces() const { return work_ != path_; }

 private:
  void write_text(const std::string& name, const std::string& content);
  void note_written(const std::string& name);
  /// The files of a texture's dump: a raw one has a sidecar.
  [[nodiscard]] std::vector<std::string> names_of(const std::string& texture,
                                                  std::uint32_t frame) const;
  /// Unless something else has its name now.
  void remove_own(const std::string& name) const;
  /// What that file may take the place of.
  [[nodiscard]] tools::Existing existing(const std::string& name) const;

  std::string path_;
  tools::OutputDirectory directory_;
  std::string work_;  ///< where files are written: path_, or a folder in it
  std::string scene_;
  VolumeShape shape_;
  FrameFiles files_;
  bool resumes_;                               ///< Former::resume
  tools::InputFiles own_;                      ///< files written here
  std::vector<std::string> former_, written_;  ///< names
  bool keep_ = false;                          ///< nothing is to be removed any more
};

}  // namespace gicodec::ddgi
