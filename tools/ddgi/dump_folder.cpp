#include "dump_folder.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace gicodec::ddgi {
namespace {

std::string text(Vec3 v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

bool is_dump(const std::string& name) {
  const auto starts = [&](const char* texture) {
    return name.starts_with(fmt::format("{}.", texture));
  };
  return name.ends_with(".exr") && (starts(kColorName) || starts(kVisibilityName));
}

void write_text(const std::string& path, const std::string& content) {
  tools::write_file(path, std::as_bytes(std::span(content)));
}

}  // namespace

DumpFolder::DumpFolder(std::string path, std::string scene, const VolumeShape& shape,
                       bool overwrite)
    : path_(std::move(path)), directory_(path_), scene_(std::move(scene)), shape_(shape) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator at(path_, error), end; !error && at != end; at.increment(error)) {
    if (is_dump(at->path().filename().string())) old.push_back(at->path());
  }
  if (error) tools::fail(tools::Exit::io, "{}: cannot be listed: {}", path_, error.message());
  if (!old.empty() && !overwrite) {
    tools::fail(tools::Exit::io, "{}: already holds dumps, e.g. {}; --overwrite replaces them",
                path_, old.front().filename().string());
  }
  for (const fs::path& file : old) {
    if (!fs::remove(file, error)) {
      tools::fail(tools::Exit::io, "{}: cannot be removed: {}", file.string(), error.message());
    }
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
  write_text(path_ + "/positions.csv", csv);
  write_text(path_ + "/inactive.txt", inactive);
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
        fmt::format("{}/{}", path_, tools::frame_file_name(name, 4, frame, "exr"));
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
  write_text(path_ + "/camera.json", root.dump(1) + "\n");
}

}  // namespace gicodec::ddgi
