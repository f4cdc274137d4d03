#include "texture_roles.h"

#include "common/error_flags.h"
#include "common/named_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace gicodec::tools {
namespace {

bool is_state(const TextureDesc& desc) {
  return desc.block.x == 1 && desc.block.y == 1 && desc.block.z == 1;
}

bool counts_or_names(const Record& record) {
  return std::ranges::any_of(record.used(), [](const Component& component) {
    return component.type == ComponentType::uint || component.type == ComponentType::opaque;
  });
}

}  // namespace

std::vector<bool> are_states(std::span<const TextureDesc> textures) {
  std::vector<bool> states(textures.size());
  if (std::ranges::all_of(textures, is_state)) return states;
  std::transform(textures.begin(), textures.end(), states.begin(), is_state);
  return states;
}

std::vector<bool> shown_textures(const VolumeDesc& volume, std::size_t textures) {
  const auto is_seen = [](const TextureGroup& group) {
    return std::ranges::any_of(group.textures, [](const NamedTexture& texture) {
      return texture.preview != Preview::none;
    });
  };
  const bool any = std::ranges::any_of(volume.groups, is_seen);
  std::vector<bool> shown;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      shown.push_back(texture.threshold != Threshold::exact && (!any || is_seen(group)));
    }
  }
  shown.resize(textures, true);
  return shown;
}

std::vector<bool> are_light(std::span<const TextureDesc> textures, const std::vector<bool>& shown) {
  std::vector<bool> light = are_states(textures);
  light.flip();
  for (std::size_t i = 0; i < textures.size(); ++i) {
    light[i] = light[i] && shown[i] && !counts_or_names(textures[i].record);
  }
  const bool any = std::ranges::find(light, true) != light.end();
  return any ? light : std::vector<bool>(textures.size(), true);
}

std::vector<float> max_errors(const std::vector<std::string>& values,
                              std::span<const std::string> names,
                              std::span<const TextureDesc> textures,
                              const std::vector<bool>& light) {
  std::vector<std::string> named;
  std::ranges::copy_if(values, std::back_inserter(named),
                       [](const std::string& value) { return is_named(value, false); });
  std::vector<float> errors;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    errors.push_back(max_error_for(light[i] ? values : named, names[i], textures[i].record));
  }
  return errors;
}

std::string left_exact(const std::vector<std::string>& values, std::span<const std::string> names,
                       const std::vector<bool>& light) {
  std::string error;
  for (const std::string& value : values) {
    if (!is_named(value, false)) error = value;
  }
  if (error.empty() || error == "0") return "";
  std::vector<std::string> left;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool own = std::ranges::any_of(
        values, [&](const std::string& value) { return value.starts_with(names[i] + "="); });
    if (!light[i] && !own) left.push_back(names[i]);
  }
  if (left.empty()) return "";
  return fmt::format("--max-error {} is for light: {} {} exact; --max-error {}={} is for that one",
                     error, fmt::join(left, ", "), left.size() == 1 ? "stays" : "stay",
                     left.front(), error);
}

}  // namespace gicodec::tools
