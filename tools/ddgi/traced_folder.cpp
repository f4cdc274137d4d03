#include "traced_folder.h"

#include "dump/error.h"
#include "dump/texture_file.h"
#include "dump_folder.h"

#include <gicodec/engines.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

namespace gicodec::ddgi {
namespace {

using nlohmann::json;
using tools::Exit;
using tools::fail;

constexpr std::uint64_t kMaxSettingsBytes = std::uint64_t{1} << 20;

class Settings {
 public:
  Settings(const std::string& path, const std::string& text)
      : path_(path), json_(json::parse(text, nullptr, false)) {
    if (!json_.is_object()) fail(Exit::bad_input, "{}: is no JSON object", path_);
  }

  [[nodiscard]] TracedFolder folder() const {
    TracedFolder folder;
    const auto grid = tools::grid_from_string(text("grid", true));
    if (!grid) damaged("grid");
    folder.grid = *grid;
    folder.layout = text("layout", false);
    folder.start = number(member("start"), "start");
    folder.fps = number(member("fps"), "fps");
    if (!(folder.fps > 0)) damaged("fps");
    set_attribute(folder.attributes, {kSceneAttribute, "string", text("scene", true)});
    set_attribute(folder.attributes, {tools::kOriginAttribute, "v3f", vector("origin")});
    set_attribute(folder.attributes, {tools::kSpacingAttribute, "v3f", vector("spacing")});
    if (const std::string encoding = text("encoding", false); !encoding.empty())
      set_attribute(folder.attributes, {kEncodingAttribute, "string", encoding});
    return folder;
  }

 private:
  [[noreturn]] void damaged(const char* name) const {
    fail(Exit::bad_input,
         "{}: its \"{}\" is missing or damaged, so that nothing says what the DDS files beside it "
         "hold; trace them again, or as KTX2",
         path_, name);
  }
  [[nodiscard]] const json& member(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end()) damaged(name);
    return *found;
  }
  [[nodiscard]] std::string text(const char* name, bool needed) const {
    if (!needed && !json_.contains(name)) return "";
    const json& value = member(name);
    if (!value.is_string()) damaged(name);
    return value.get<std::string>();
  }
  [[nodiscard]] double number(const json& value, const char* name) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) damaged(name);
    return value.get<double>();
  }
  [[nodiscard]] std::string vector(const char* name) const {
    const json& value = member(name);
    if (!value.is_array() || value.size() != 3) damaged(name);
    const auto at = [&](std::size_t i) { return static_cast<float>(number(value[i], name)); };
    return fmt::format("{} {} {}", at(0), at(1), at(2));
  }

  const std::string& path_;
  json json_;
};

}  // namespace

tools::Hints TracedFolder::hints(const std::string& texture) const {
  tools::Hints hints;
  if (layout.empty()) {
    if (texture == kColorName || texture == kVisibilityName) hints.grid = grid;
    return hints;
  }
  const EngineLayout* engine = find_engine_layout(layout);
  if (engine == nullptr || engine->unit != GridUnit::probe) return hints;
  const auto volume = engine->make(grid);
  if (!volume) return hints;
  for (const BlockSet& set : volume->sets) {
    for (const NamedTexture& one : set.textures) {
      if (one.name == texture) hints.desc = one.desc;
    }
  }
  return hints;
}

tools::Attributes TracedFolder::attributes_at(std::uint64_t frame) const {
  tools::Attributes all = attributes;
  const auto time = static_cast<float>(start + static_cast<double>(frame) / fps);
  set_attribute(all, {kTimeAttribute, "float", fmt::format("{}", time)});
  return all;
}

std::optional<TracedFolder> read_traced_folder(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / kSettingsFile).string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  tools::TextureFile file(path);
  if (file.size() > kMaxSettingsBytes)
    fail(Exit::bad_input, "{}: has more than {} bytes", path, kMaxSettingsBytes);
  const auto bytes = file.read(0, static_cast<std::size_t>(file.size()));
  return Settings(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}).folder();
}

}  // namespace gicodec::ddgi
