#include "stored_volume.h"

#include "feed_container.h"

#include "common/program.h"
#include "common/volume_words.h"
#include "ddgi/volume.h"
#include "dump/error.h"
#include "dump/sequence.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <numeric>

namespace gicodec::kinds {
namespace {

using tools::Exit;
using tools::fail;

/// The reason why a volume cannot be drawn.
std::string why_not(const ContainerDescription& description, std::size_t volume) {
  std::string unknown = tools::unknown_kind(description, volume);
  if (!unknown.empty()) return unknown;
  return fmt::format(
      "volume {} is of kind {}, which is not drawn; \"gicodec preview\" shows it, \"gicodec "
      "decode\" makes dumps of it",
      tools::volume_name(description, volume), tools::kind_text(description.volumes[volume].kind));
}

std::string_view encoding_in(const tools::Attributes& attributes) {
  const auto* const found = find_attribute(attributes, tools::kEncodingAttribute);
  return found == nullptr ? std::string_view{} : found->value;
}

}  // namespace

void FrameFacts::read(const tools::Attributes& attributes) {
  const auto position = [&](const char* name, std::optional<Position>& to) {
    if (const auto v = find_floats(attributes, name, 3)) to = Position{(*v)[0], (*v)[1], (*v)[2]};
  };
  if (const auto* name = find_attribute(attributes, tools::kSceneAttribute)) scene = name->value;
  if (const auto seconds = find_floats(attributes, tools::kTimeAttribute, 1))
    time = seconds->front();
  position(tools::kOriginAttribute, origin);
  position(tools::kSpacingAttribute, spacing);
}

StoredVolume::StoredVolume(const std::string& path, bool allow_incomplete,
                           const tools::DecoderFlags& decoding)
    : input_(std::in_place, path, decoding), allow_incomplete_(allow_incomplete) {
  path_ = input_->path();
  missing_ = require_complete(*input_, allow_incomplete);
  const auto& volumes = input_->description().volumes;
  const auto found = std::ranges::find_if(volumes, tools::is_drawn);
  if (found == volumes.end()) {
    fail(Exit::bad_input, "{}: nothing can be drawn: {}", path_,
         volumes.empty() ? "it holds no volume" : why_not(input_->description(), 0));
  }
  kind_ = find_traced_kind(found->kind);
  desc_ = found->desc;
  geometry_ = found->geometry;
  first_ = found->first_texture;
  cut_ = found->region != Grid{};
  std::vector<std::size_t> textures(found->textures);
  std::iota(textures.begin(), textures.end(), first_);
  input_->select(textures);
  texels_.resize(textures.size());
}

StoredVolume::StoredVolume(const std::string& folder, std::uint64_t frame)
    : path_(folder), kind_(find_traced_kind("probes")) {
  std::vector<NamedTexture> named;
  std::string others;
  for (const auto& sequence : tools::group_sequences({folder}, {.allow_gaps = true})) {
    const auto* const file = sequence.find(frame);
    if (file == nullptr) {
      fail(Exit::bad_input, "{}: has no frame {} of texture {}; it holds {} to {}", folder, frame,
           sequence.name, sequence.frames.front().frame, sequence.frames.back().frame);
    }
    if (tools::image_kind(file->path) == tools::ImageKind::dds) {
      others =
          "; its DDS files do not say what they hold; draw a container of them by --stream, or "
          "decode it to another kind of files";
      continue;
    }
    tools::Dump dump = tools::read_dump(file->path);
    if (!ddgi::is_color(dump.info.desc) && !ddgi::is_visibility(dump.info.desc)) continue;
    named.push_back({sequence.name, dump.info.desc});
    files_.push_back(std::move(dump.info));
    texels_.push_back(std::move(dump.texels));
  }
  if (named.empty()) fail(Exit::bad_input, "{}: has no textures of probes{}", folder, others);
  for (const NamedTexture& texture : named) {
    if (texture.desc.grid != named.front().desc.grid)
      fail(Exit::bad_input, "{}: its textures have different grids, {} and {}", folder,
           tools::to_string(named.front().desc.grid), tools::to_string(texture.desc.grid));
  }
  desc_ = tools::take(probe_volume(named), folder);
}

std::uint64_t StoredVolume::triangles() const {
  return input_ ? input_->description().scene.geometry : 0;
}

std::string StoredVolume::loss() const {
  for (std::size_t i = 0; input_ && i < texels_.size(); ++i) {
    std::string loss = input_->textures()[first_ + i].loss();
    if (!loss.empty()) return loss;
  }
  return "";
}

FrameFacts StoredVolume::facts_at(std::uint64_t frame) const {
  FrameFacts facts;
  if (input_) {
    const ContainerDescription& description = input_->description();
    if (!description.scene.name.empty()) facts.scene = description.scene.name;
    if (const auto times = times_of(description)) facts.time = times->at(frame);
  }
  for (std::size_t i = texels_.size(); i-- > 0;) {  // The first one's word is the last.
    facts.read(input_ ? input_->textures()[first_ + i].info_at(frame).attributes
                      : files_[i].attributes);
  }
  return facts;
}

void StoredVolume::show(std::uint64_t frame, VolumeLight& light) {
  if (!input_) return update(frame, light);
  if (!kind_->remembers) input_->seek(frame);
  while (!input_->last_frame() || *input_->last_frame() < frame) {
    tools::check_interrupt();
    if (!input_->next_frame() || input_->frame() > frame) {
      fail(Exit::bad_input, "{}: has no frame {}; {}", path_, frame, input_->frames_there());
    }
    follow();
    if (kind_->remembers || input_->frame() == frame) update(input_->frame(), light);
  }
  if (missing_.empty()) missing_ = require_complete(*input_, allow_incomplete_);
  if (cut_ || input_->arrived().size() < texels_.size()) tools::require_whole(*input_);
}

/// Reads the blocks that the next frame changed.
void StoredVolume::follow() {
  for (std::size_t i = 0; i < texels_.size(); ++i) {
    if (texels_[i].empty()) {
      texels_[i] = input_->texels(first_ + i);
    } else {
      input_->follow(first_ + i, texels_[i]);
    }
  }
}

void StoredVolume::update(std::uint64_t frame, VolumeLight& light) const {
  std::vector<HeldTexture> held = held_of(desc_, texels_);
  std::vector<tools::DumpInfo> infos = files_;
  for (std::size_t i = 0; input_ && i < texels_.size(); ++i) {
    infos.push_back(input_->textures()[first_ + i].info_at(frame));
  }
  for (std::size_t i = 0; i < held.size(); ++i) {
    held[i].desc = infos[i].desc;
    held[i].encoding = encoding_in(infos[i].attributes);
  }
  const VolumeGeometry geometry = geometry_.value_or(VolumeGeometry{});
  try {
    light.update({desc_, geometry, held}, facts_at(frame).time.value_or(FrameTimes{}.at(frame)));
  } catch (const tools::Error& error) {
    throw tools::Error(error.code(), path_ + ": " + error.what());
  }
}

}  // namespace gicodec::kinds
