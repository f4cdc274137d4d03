#include "dump_folder.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace gicodec::ddgi {
namespace {

namespace fs = std::filesystem;

std::string text(Vec3 v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

bool is_dump(const std::string& name) {
  const auto starts = [&](const char* texture) {
    return name.starts_with(fmt::format("{}.", texture));
  };
  return name.ends_with(".exr") && (starts(kColorName) || starts(kVisibilityName));
}

bool is_written(const std::string& name) {
  return is_dump(name) || name == "positions.csv" || name == "inactive.txt" ||
         name == "camera.json" || name == "views.jsonl";
}

std::vector<fs::path> files_in(const std::string& folder, bool (*wanted)(const std::string&)) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (wanted(at->path().filename().string())) files.push_back(at->path());
  }
  if (error) tools::fail(tools::Exit::io, "{}: cannot be listed: {}", folder, error.message());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

DumpFolder::DumpFolder(std::string path, std::string scene, const VolumeShape& shape,
                       bool overwrite)
    : path_(std::move(path)),
      directory_(path_),
      staging_(path_),
      scene_(std::move(scene)),
      shape_(shape) {
  const std::vector<fs::path> old = files_in(path_, is_written);
  if (old.empty()) return;
  if (!overwrite) {
    tools::fail(tools::Exit::io,
                "{}: already holds dumps or what belongs to them, e.g. {}; --overwrite "
                "replaces it",
                path_, old.front().filename().string());
  }
  std::error_code error;
  fs::remove_all(path_ + "/.new", error);  // Of a program that was killed.
  tools::make_directory(path_ + "/.new");
  staging_ = path_ + "/.new";
}

DumpFolder::~DumpFolder() {
  std::error_code error;
  if (staging_ != path_) fs::remove_all(staging_, error);
}

void DumpFolder::write_text(const std::string& name, const std::string& content) const {
  tools::write_file(staging_ + "/" + name, std::as_bytes(std::span(content)));
}

void DumpFolder::finish() {
  if (staging_ == path_) return;
  std::error_code error;
  const auto require = [&](const fs::path& file) {
    if (error) {
      tools::fail(tools::Exit::io, "{}: cannot be replaced: {}", file.string(), error.message());
    }
  };
  for (const fs::path& file : files_in(path_, is_dump)) {
    if (fs::exists(fs::path(staging_) / file.filename(), error)) continue;
    fs::remove(file, error);
    require(file);
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(staging_, error)) files.push_back(entry.path());
  require(staging_);
  for (const fs::path& file : files) {
    fs::rename(file, fs::path(path_) / file.filename(), error);
    require(file);
  }
}

void DumpFolder::write_positions(std::span<const std::uint32_t> active) const {
  std::vector<std::uint8_t> is_active(shape_.probes());
  for (const std::uint32_t probe : active) is_active[probe] = 1;
  std::string csv = "probe,x,y,z,active\n", inactive;
  for (std::uint32_t probe = 0; probe < shape_.probes(); ++probe) {
    const Vec3 p = shape_.position(probe);
    csv += fmt::format("{},{},{},{},{}\n", probe, p.x, p.y, p.z, is_active[probe]);
    if (!is_active[probe]) inactive += fmt::format("{}\n", probe);
  }
  write_text("positions.csv", csv);
  write_text("inactive.txt", inactive);
}

void DumpFolder::write_frame(std::uint32_t frame, double time,
                             const ProbeTextures& textures) const {
  const auto write = [&](const char* name, const TextureDesc& desc,
                         std::span<const std::uint32_t> texels) {
    tools::DumpInfo info = tools::make_info(desc);
    if (desc == textures.color_desc) info.channels.alpha = false;
    set_attribute(info.attributes, {kSceneAttribute, "string", scene_});
    set_attribute(info.attributes,
                  {kTimeAttribute, "float", fmt::format("{}", static_cast<float>(time))});
    set_attribute(info.attributes, {kOriginAttribute, "v3f", text(shape_.origin)});
    set_attribute(info.attributes, {kSpacingAttribute, "v3f", text(shape_.spacing)});
    const std::string path =
        fmt::format("{}/{}", staging_, tools::frame_file_name(name, 4, frame, "exr"));
    tools::write_dump(path, info, std::as_bytes(texels));
  };
  write(kColorName, textures.color_desc, textures.color);
  write(kVisibilityName, textures.visibility_desc, textures.visibility);
}

void DumpFolder::write_cameras(std::span<const CameraFrame> cameras) const {
  using nlohmann::ordered_json;
  const auto array = [](Vec3 v) { return ordered_json::array({v.x, v.y, v.z}); };
  ordered_json frames = ordered_json::array();
  for (const auto& [frame, time, camera] : cameras) {
    frames.push_back({{"frame", frame},
                      {"time", time},
                      {"eye", array(camera.eye)},
                      {"target", array(camera.target)},
                      {"up", array(camera.up)},
                      {"fov_y", camera.fov_y},
                      {"exposure", camera.exposure}});
  }
  const ordered_json root{{"scene", scene_}, {"frames", frames}};
  write_text("camera.json", root.dump(1) + "\n");
}

}  // namespace gicodec::ddgi
