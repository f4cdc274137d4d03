#include "dump_folder.h"

#include "engine_textures.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"

#include <nlohmann/json.hpp>

#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace gicodec::ddgi {
namespace {

namespace fs = std::filesystem;
using tools::Exit;
using tools::fail;

std::string text(Vec3 v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

/// Names that a trace writes: the fixed ones, and TEXTURE.FFFF.exr, or of another kind of dumps.
bool is_result(std::string_view name) {
  for (const char* fixed : {"positions.csv", "inactive.txt", "camera.json", "views.jsonl",
                            kProbesFile, kSettingsFile}) {
    if (name == fixed) return true;
  }
  for (const EngineLayout& layout : engine_layouts()) {
    if (name == container_name(layout)) return true;
  }
  std::vector<std::string> textures = sh_names();
  textures.insert(textures.end(), {kColorName, kVisibilityName});
  textures.insert(textures.end(), engine_texture_names().begin(), engine_texture_names().end());
  const std::size_t dot = name.rfind('.');
  constexpr std::array<std::string_view, 5> kEndings = {".exr", ".dds", ".ktx2", ".raw", ".json"};
  if (dot == std::string_view::npos ||
      std::find(kEndings.begin(), kEndings.end(), name.substr(dot)) == kEndings.end())
    return false;
  name = name.substr(0, dot);
  return std::any_of(textures.begin(), textures.end(), [&](const std::string& texture) {
    if (!name.starts_with(texture)) return false;
    const auto number = name.substr(texture.size());
    return number.size() > 1 && number.front() == '.' &&
           number.find_first_not_of("0123456789", 1) == std::string_view::npos;
  });
}

bool contains(const std::vector<std::string>& sorted, const std::string& name) {
  return std::binary_search(sorted.begin(), sorted.end(), name);
}

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::vector<FrameTexture> frame_textures(const ProbeTextures& textures) {
  std::vector<FrameTexture> all{
      {kColorName, textures.color_desc, textures.color, textures.encoding},
      {kVisibilityName, textures.visibility_desc, textures.visibility}};
  for (const ShTexture& texture : textures.sh)
    all.push_back({texture.name, texture.desc, texture.texels});
  return all;
}

tools::DumpInfo info_of(const FrameTexture& texture, const std::string& scene,
                        const VolumeShape& shape) {
  const Record& record = texture.desc.record;
  tools::DumpInfo info = tools::make_info(texture.desc);
  // Alpha of unorm is 0 everywhere.
  if (texture.encoding && record.components[0].kind == ComponentKind::unorm)
    info.channels.alpha = false;
  set_attribute(info.attributes, {kSceneAttribute, "string", scene});
  set_attribute(info.attributes, {tools::kOriginAttribute, "v3f", text(shape.origin)});
  set_attribute(info.attributes, {tools::kSpacingAttribute, "v3f", text(shape.spacing)});
  if (texture.encoding && *texture.encoding != usual_encoding(record.format)) {
    set_attribute(info.attributes,
                  {kEncodingAttribute, "string", std::string(to_string(*texture.encoding))});
  }
  return info;
}

tools::Attribute time_attribute(double time) {
  return {kTimeAttribute, "float", fmt::format("{}", static_cast<float>(time))};
}

DumpFolder::DumpFolder(std::string path, std::string scene, const VolumeShape& shape,
                       const std::string& settings, Former former, const tools::InputFiles& inputs,
                       FrameFiles files)
    : path_(std::move(path)),
      directory_(path_),
      work_(path_),
      scene_(std::move(scene)),
      shape_(shape),
      files_(std::move(files)),
      resumes_(former == Former::resume) {
  std::error_code error;
  for (fs::directory_iterator at(path_, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    std::error_code unknown;
    if (!is_result(name) || at->is_directory(unknown)) continue;
    former_.push_back(name);
    if (former == Former::replace && inputs.contains(at->path()))
      fail(Exit::usage,
           "{}: is a part of the scene and would be overwritten; name another folder by -o",
           at->path().string());
  }
  if (error) fail(Exit::io, "{}: cannot be listed: {}", path_, error.message());
  std::sort(former_.begin(), former_.end());
  if (!former_.empty() && former == Former::refuse) {
    fail(Exit::io,
         "{}: already holds {}; --overwrite replaces what an earlier trace wrote, --resume goes on "
         "with it",
         path_, former_.front());
  }
  if (!former_.empty() && former == Former::resume) {
    const std::string file = path_ + "/" + kSettingsFile, found = read_text(file);
    if (found.empty())
      fail(Exit::bad_input,
           "{}: cannot be read, so nothing says how the frames there were traced; "
           "name another folder by -o",
           file);
    if (found != settings)
      fail(
          Exit::bad_input,
          "{}: the frames there were traced with other options; give the same ones again (they are "
          "in this file), or --overwrite",
          file);
    keep_ = true;
  }
  if (!former_.empty() && former == Former::replace) {
    if (!contains(former_, kSettingsFile))
      fail(
          Exit::io,
          "{}: holds {} but no {}, so no trace wrote that; name another folder by -o, or remove it",
          path_, former_.front(), kSettingsFile);
    work_ = path_ + "/.gi-trace.XXXXXX";
    if (mkdtemp(work_.data()) == nullptr) {
      const std::string reason = std::strerror(errno);
      work_ = path_;
      fail(Exit::io, "{}: cannot be written: {}", path_, reason);
    }
  }
  if (keep_) return;
  try {
    write_text(kSettingsFile, settings);
  } catch (...) {
    if (replaces()) fs::remove(work_, error);
    throw;
  }
}

DumpFolder::~DumpFolder() {
  if (keep_) return;
  for (const std::string& name : written_) remove_own(name);
  std::error_code ignored;
  if (replaces()) fs::remove(work_, ignored);
}

void DumpFolder::note_written(const std::string& name) {
  written_.push_back(name);
  own_.add(work_ + "/" + name);
}

void DumpFolder::remove_own(const std::string& name) const {
  std::error_code ignored;
  const std::string path = work_ + "/" + name;
  if (own_.contains(path)) fs::remove(path, ignored);
}

tools::Existing DumpFolder::existing(const std::string& name) const {
  return tools::overwrite_if(resumes_ && contains(former_, name));
}

void DumpFolder::write_text(const std::string& name, const std::string& content) {
  tools::write_file(work_ + "/" + name, std::as_bytes(std::span(content)), existing(name));
  note_written(name);
}

void DumpFolder::write_positions(std::span<const std::uint32_t> active, bool probes) {
  std::vector<std::uint8_t> is_active(shape_.probes());
  for (const std::uint32_t probe : active) is_active[probe] = 1;
  std::string csv = "probe,x,y,z,active\n", inactive;
  for (std::uint32_t probe = 0; probe < shape_.probes(); ++probe) {
    const Vec3 p = shape_.position(probe);
    csv += fmt::format("{},{},{},{},{}\n", probe, p.x, p.y, p.z, is_active[probe]);
    if (!is_active[probe]) inactive += fmt::format("{}\n", probe);
  }
  write_text("positions.csv", csv);
  if (probes) write_text("inactive.txt", inactive);
}

void DumpFolder::write_frame(std::uint32_t frame, double time,
                             std::span<const FrameTexture> textures) {
  std::vector<std::string> own;
  const auto write = [&](const FrameTexture& texture) {
    tools::DumpInfo info = info_of(texture, scene_, shape_);
    set_attribute(info.attributes, time_attribute(time));
    const auto names = names_of(texture.name, frame);
    tools::write_dump(work_ + "/" + names.front(), info, texture.texels, existing(names.front()));
    for (const std::string& name : names) {
      note_written(name);
      own.push_back(name);
    }
  };
  try {
    for (const FrameTexture& texture : textures) write(texture);
  } catch (...) {
    for (const std::string& file : own) remove_own(file);  // no frame of some textures
    throw;
  }
  if (!replaces()) keep_ = true;
}

std::vector<std::string> DumpFolder::names_of(const std::string& texture,
                                              std::uint32_t frame) const {
  std::vector<std::string> names{tools::frame_file_name(texture, 4, frame, files_.ending)};
  if (files_.ending == "raw") names.push_back(tools::frame_file_name(texture, 4, frame, "json"));
  return names;
}

bool DumpFolder::holds(std::uint32_t frame) const {
  const auto is_former = [&](const std::string& name) { return contains(former_, name); };
  return !replaces() && !files_.textures.empty() &&
         std::all_of(files_.textures.begin(), files_.textures.end(),
                     [&](const std::string& texture) {
                       const auto names = names_of(texture, frame);
                       return std::all_of(names.begin(), names.end(), is_former);
                     });
}

void DumpFolder::write_cameras(std::span<const CameraFrame> cameras) {
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

void DumpFolder::write_views(const std::string& lines) { write_text("views.jsonl", lines); }

void DumpFolder::write_container(const std::string& name, std::span<const std::byte> container) {
  tools::write_file(work_ + "/" + name, container, existing(name));
  note_written(name);
}

void DumpFolder::finish() {
  keep_ = true;
  if (!replaces()) return;
  // Former results step aside and come back where a step fails.
  const std::string aside = work_ + "/former";
  std::vector<std::pair<std::string, std::string>> moved;
  const auto move = [&](const std::string& from, const std::string& to, const std::string& name) {
    std::error_code error;
    fs::create_directory(to, error);
    if (!error && fs::exists(fs::symlink_status(to + "/" + name)))
      error = std::make_error_code(std::errc::file_exists);
    if (!error) fs::rename(from + "/" + name, to + "/" + name, error);
    if (!error) {
      moved.emplace_back(from + "/" + name, to + "/" + name);
      return;
    }
    for (auto last = moved.rbegin(); last != moved.rend(); ++last) {
      std::error_code ignored;
      fs::rename(last->second, last->first, ignored);
    }
    fail(Exit::io, "{}/{}: cannot be replaced: {}; the new results are in {}", path_, name,
         error.message(), work_);
  };
  for (const std::string& name : former_) move(path_, aside, name);
  for (const std::string& name : written_) move(work_, path_, name);
  std::error_code ignored;
  fs::remove_all(work_, ignored);
  work_ = path_;
}

}  // namespace gicodec::ddgi
