#include "feed_container.h"

#include "common/backend_flags.h"
#include "common/stored_texture.h"
#include "common/world.h"
#include "dump/error.h"

#include <fmt/core.h>

#include <limits>
#include <memory>
#include <vector>

namespace gicodec::kinds {
namespace {

ContainerDescription describe(const Feed& feed, const FrameTimes& times, const std::string& path) {
  ContainerDescription description;
  description.scene = feed.scene;
  for (const FeedVolume& volume : feed.volumes) {
    tools::check(add_volume(description, volume.name, volume.desc), path);
    VolumeEntry& entry = description.volumes.back();
    entry.geometry = volume.geometry;
    tools::add_place(entry.metadata, {.layout = volume.layout,
                                      .axes = "right up back",
                                      .metres = 1.0,
                                      .bounds = volume.bounds});  // axes of glTF's scenes
    for (std::size_t i = 0; i < volume.quantisers.size(); ++i) {
      if (volume.quantisers[i] < 0) continue;
      TextureEntry& texture = description.textures[entry.first_texture + i];
      texture.largest_error = std::numeric_limits<float>::infinity();
      texture.metadata.emplace_back("lossy", fmt::format("qp={}", volume.quantisers[i]));
    }
    for (std::size_t i = 0; i < volume.files.size(); ++i) {
      TextureEntry& texture = description.textures[entry.first_texture + i];
      tools::StoredTexture stored;
      stored.info = volume.files[i];
      set_attribute(stored.info.attributes, {tools::kSceneAttribute, "string", feed.scene.name});
      set_attribute(stored.info.attributes, tools::time_attribute(times.start));
      texture.metadata = to_entry(stored).metadata;
    }
  }
  description.metadata = {{"creator", "gi-trace"}};
  add_times(description.metadata, times);
  return description;
}

}  // namespace

FeedContainer::FeedContainer(const std::string& path, const Feed& feed, const FrameTimes& times,
                             const std::string& backend, tools::Existing existing)
    : output_(path, describe(feed, times, path), existing) {
  for (const FeedVolume& volume : feed.volumes) {
    VolumeEncoderOptions options;
    options.backend = backend;
    options.gop = 0;  // keyframes would need blocks that did not change
    options.first_texture = static_cast<std::uint8_t>(sums_.size());
    std::vector<std::unique_ptr<const Backend>> lossy;
    for (const int quantiser : volume.quantisers) {
      lossy.push_back(quantiser < 0 ? nullptr : tools::lossy_hevc(quantiser));
      options.texture_backends.push_back(lossy.back().get());
    }
    encoders_.push_back(tools::take(VolumeEncoder::create(volume.desc, options), path));
    for (const NamedTexture* texture : textures_of(volume.desc))
      sums_.push_back({texture->name, 0});
  }
}

void FeedContainer::add(std::uint64_t frame, const FeedFrame& contents) {
  std::size_t texture = 0;
  for (std::size_t v = 0; v < encoders_.size(); ++v) {
    const auto& textures = contents.volumes[v].textures;
    const std::vector<ConstTextureView> views(textures.begin(), textures.end());
    const auto packets = tools::take(encoders_[v].encode(views), sums_[texture].texture);
    for (const Packet& packet : packets) {
      sums_[texture++].bytes += packet.size();
      output_.add(frame, packet);
    }
  }
}

void FeedContainer::finish() { output_.finish(); }

}  // namespace gicodec::kinds
