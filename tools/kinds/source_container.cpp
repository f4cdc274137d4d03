#include "source_container.h"

#include "dump/error.h"

#include <fmt/core.h>

#include <charconv>

namespace gicodec::kinds {
namespace {

constexpr const char* kStart = "start";  // seconds of the scene
constexpr const char* kFps = "fps";

ContainerDescription describe(const Source& source, const FrameTimes& times,
                              const std::string& path) {
  ContainerDescription description;
  description.scene = source.scene;
  for (const SourceVolume& volume : source.volumes) {
    tools::check(add_volume(description, volume.name, volume.desc), path);
    description.volumes.back().geometry = volume.geometry;
  }
  description.metadata = {{"creator", "gi-trace"},
                          {kStart, fmt::format("{}", times.start)},
                          {kFps, fmt::format("{}", times.fps)}};
  return description;
}

std::optional<double> number(const Metadata& metadata, const char* name, double least) {
  const std::string* text = find_metadata(metadata, name);
  if (text == nullptr) return std::nullopt;
  double value = 0;
  const char* const end = text->data() + text->size();
  const auto parsed = std::from_chars(text->data(), end, value);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == end;
  return whole && value >= least && value <= 1e9 ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<FrameTimes> times_of(const ContainerDescription& description) {
  const auto start = number(description.metadata, kStart, 0);
  const auto fps = number(description.metadata, kFps, 1e-3);
  if (!start || !fps) return std::nullopt;
  return FrameTimes{*start, *fps};
}

SourceContainer::SourceContainer(const std::string& path, const Source& source,
                                 const FrameTimes& times, const std::string& backend)
    : output_(path, describe(source, times, path)) {
  for (const SourceVolume& volume : source.volumes) {
    encoders_.emplace_back(volume.desc, backend, path, static_cast<std::uint8_t>(sums_.size()));
    for (const NamedTexture& texture : volume.textures()) sums_.push_back({texture.name, 0});
  }
}

void SourceContainer::add(std::uint64_t frame, const SourceFrame& contents) {
  std::size_t texture = 0;
  for (std::size_t v = 0; v < encoders_.size(); ++v) {
    const auto& textures = contents.volumes[v].textures;
    const std::vector<ddgi::Texels> texels(textures.begin(), textures.end());
    for (const Packet& packet : encoders_[v].encode(texels)) {
      sums_[texture++].bytes += packet.size();
      output_.add(frame, packet);
    }
  }
}

void SourceContainer::finish() { output_.finish(); }

}  // namespace gicodec::kinds
