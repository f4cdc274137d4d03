#include "stored_volume.h"

#include "source_container.h"

#include "ddgi/program.h"
#include "dump/error.h"

#include <gicodec/probes.h>

#include <algorithm>

namespace gicodec::kinds {
namespace {

const TracedKind* traced(const VolumeEntry& entry) {
  const Kind* const kind = find_kind(entry.kind);
  return kind == nullptr ? nullptr : find_traced_kind(kind->name);
}

}  // namespace

bool StoredVolume::is_in(const std::string& path) {
  if (path == "-") return false;  // It can be read but once.
  const tools::ContainerInput input(path);
  const auto& volumes = input.description().volumes;
  const auto probes = [](const VolumeEntry& entry) { return entry.kind == kKindProbes; };
  const auto known = [](const VolumeEntry& entry) { return traced(entry) != nullptr; };
  return std::ranges::none_of(volumes, probes) && std::ranges::any_of(volumes, known);
}

StoredVolume::StoredVolume(const std::string& path, bool allow_incomplete,
                           const tools::DecoderFlags& decoding)
    : input_(path, decoding) {
  missing_ = require_complete(input_, allow_incomplete);
  for (const VolumeEntry& entry : input_.description().volumes) {
    kind_ = traced(entry);
    if (kind_ == nullptr) continue;
    desc_ = entry.desc;
    geometry_ = entry.geometry.value_or(VolumeGeometry{});
    first_ = entry.first_texture;
    cut_ = entry.region != Grid{};
    std::vector<std::size_t> textures;
    for (std::size_t i = 0; i < entry.textures; ++i) textures.push_back(first_ + i);
    input_.select(textures);
    texels_.resize(entry.textures);
    return;
  }
  tools::fail(tools::Exit::bad_input, "{}: holds no volume that can be drawn", path);
}

std::optional<double> StoredVolume::time_of(std::uint64_t frame) const {
  const auto times = times_of(input_.description());
  return times ? std::optional(times->at(frame)) : std::nullopt;
}

void StoredVolume::show(std::uint64_t frame, VolumeLight& light) {
  while (!input_.last_frame() || *input_.last_frame() < frame) {
    ddgi::check_interrupt();
    if (!input_.next_frame() || input_.frame() > frame) {
      tools::fail(tools::Exit::bad_input, "{}: has no frame {}; {}", input_.path(), frame,
                  input_.frames_there());
    }
    update(light);
  }
  if (cut_ || input_.arrived().size() < texels_.size()) tools::require_whole(input_);
}

void StoredVolume::update(VolumeLight& light) {
  std::vector<HeldTexture> held;
  std::size_t i = 0;
  for (const TextureGroup& group : desc_.groups) {
    for (const NamedTexture& texture : group.textures) {
      const std::size_t id = first_ + i;
      if (texels_[i].empty()) {
        texels_[i] = input_.texels(id);
      } else {
        input_.follow(id, texels_[i]);
      }
      held.push_back({texture.name, input_.textures()[id].info.desc, texels_[i], {}});
      ++i;
    }
  }
  const std::uint64_t frame = input_.frame();
  light.update({desc_, geometry_, held}, time_of(frame).value_or(FrameTimes{}.at(frame)));
}

}  // namespace gicodec::kinds
