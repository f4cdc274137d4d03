// Which textures of a container a command takes.
#include "container_input.h"
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/text.h"
#include "file_forms.h"
#include "file_names.h"
#include "volume_words.h"

#include <algorithm>
#include <numeric>

namespace gicodec::tools {

void ContainerInput::prepare() {
  std::vector<std::uint8_t> selected;
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    const auto id = static_cast<std::uint8_t>(i);
    if (selected_[i]) selected.push_back(id);
    if (!textures_[i].no_dump.empty()) continue;
    check(player_->set_layout(id, textures_[i].info.desc.layout),
          fmt::format("{}: texture {}", path_, textures_[i].name));
  }
  if (decoding_.box) {
    check(player_->select(parts_in_box_of(selected)), path_);
  } else if (selected.size() < textures_.size()) {
    check(player_->select(selected), path_);
  }
}

void ContainerInput::set_files(ImageKind kind) {
  for (StoredTexture& texture : textures_) {
    if (texture.no_dump.empty()) tools::set_files(texture, kind);
  }
}

void ContainerInput::drop_attribute(std::string_view name) {
  for (StoredTexture& texture : textures_) {
    std::erase_if(texture.info.attributes, [&](const auto& one) { return one.name == name; });
    std::erase_if(texture.changes, [&](const auto& one) { return one.attribute.name == name; });
  }
}

/// Those of these textures that the box of DecoderFlags meets.
std::vector<TextureRegion> ContainerInput::parts_in_box_of(
    std::span<const std::uint8_t> textures) const {
  const auto grid = [](const auto& place) { return Grid{place[0], place[1], place[2]}; };
  const BlockBox& box = *decoding_.box;
  std::vector<TextureRegion> all;
  bool cut = false;
  for (std::uint32_t i = 0; i < description().volumes.size(); ++i) {
    cut |= description().volumes[i].region != Grid{};
    for (const TextureRegion& part :
         parts_in_box(description(), i, grid(box.first), grid(box.last))) {
      if (std::ranges::find(textures, part.texture_id) != textures.end()) all.push_back(part);
    }
  }
  if (!cut) {
    fail(Exit::usage,
         "{}: --box is for volumes that are cut into regions, by \"gicodec encode --region\"",
         path_);
  }
  if (all.empty()) fail(Exit::usage, "{}: --box is outside of its volumes", path_);
  return all;
}

void require_distinct_files(const ContainerInput& input) {
  const ContainerDescription& description = input.description();
  std::vector<std::size_t> taken;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (!input.is_selected(i) || !texture.no_dump.empty()) continue;
    const auto other = std::ranges::find_if(
        taken, [&](std::size_t before) { return names_meet(input.textures()[before], texture); });
    if (other == taken.end()) {
      taken.push_back(i);
      continue;
    }
    const std::size_t own = description.textures[i].volume;
    const bool volumes = own != description.textures[*other].volume;
    fail(Exit::bad_input, "{}: textures {} and {} have files of the same names{}", input.path(),
         input.textures()[*other].name, texture.name,
         volumes
             ? fmt::format("; {}{}",
                           to_cure(Cure::one_volume, shell_word(volume_choice(description, own))),
                           volume_choice(description, own) == volume_name(description, own)
                               ? ""
                               : ", by its number, since others have its name")
             : "");
  }
}

void select_volume(ContainerInput& input, const std::string& volume) {
  if (volume.empty()) return;
  const std::size_t one = find_volume(input.description(), volume, input.path());
  const VolumeEntry& entry = input.description().volumes[one];
  std::vector<std::size_t> own(entry.textures);
  std::iota(own.begin(), own.end(), std::size_t{entry.first_texture});
  input.select(own);
}

void select_dumps(ContainerInput& input, const std::string& volume) {
  select_volume(input, volume);
  std::string other_volume, why_not;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (!input.is_selected(i)) continue;
    if (!texture.no_dump.empty() && why_not.empty()) why_not = texture.no_dump;
    const std::size_t own = input.description().textures[i].volume;
    if (!has_dumps(input, own) || !other_volume.empty()) continue;
    other_volume = volume_choice(input.description(), own);
  }
  if (!why_not.empty()) {
    fail(Exit::bad_input, "{}: {}{}", input.path(), why_not,
         other_volume.empty() ? "" : "; " + to_cure(Cure::other_volume, shell_word(other_volume)));
  }
  require_distinct_files(input);
}

}  // namespace gicodec::tools
