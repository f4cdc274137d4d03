#include "trace_output.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "scene_source.h"

#include <gicodec/probes.h>

namespace gicodec::ddgi {
namespace {

using tools::Exit;
using tools::fail;

std::vector<FrameTexture> textures_of(const ProbeTextures& traced, const EngineTextures* engine) {
  if (engine == nullptr) return frame_textures(traced);
  std::vector<FrameTexture> textures;
  for (const EngineTexture& texture : engine->textures())
    textures.push_back({texture.name, texture.desc, texture.texels});
  // The first of a layout of probes is their colour.
  if (engine->volume().kind == kKindProbes) textures.front().encoding = traced.encoding;
  return textures;
}

tools::ImageKind kind_of(const std::string& ending) { return *tools::image_kind("x." + ending); }

/// "exr, ktx2, raw and gic": those that hold it.
std::string kinds_for(Format format) {
  std::string kinds;
  for (const char* ending : {"exr", "dds", "ktx2", "raw"}) {
    if (has_format(kind_of(ending), format))
      kinds += (kinds.empty() ? "" : ", ") + std::string(ending);
  }
  return kinds + " and gic";
}

VolumeDesc own_volume(std::span<const FrameTexture> textures) {
  std::vector<NamedTexture> named;
  for (const FrameTexture& texture : textures)
    named.push_back({texture.name, texture.desc, {}, {}});
  return tools::take(probe_volume(named), kProbesFile);
}

/// What decode makes of the textures: what --files exr writes. Times are told of probes alone,
/// whose textures are drawn and few: a description holds no more.
std::vector<tools::StoredTexture> stored(const TraceFlags& flags, const VolumeShape& shape,
                                         std::span<const FrameTexture> textures) {
  const std::string scene = scene_label(flags.scene);
  std::vector<tools::StoredTexture> all;
  for (const FrameTexture& texture : textures) {
    tools::StoredTexture& one = all.emplace_back();
    one.name = texture.name;
    one.info = info_of(texture, scene, shape);
    if (!tools::is_probes(texture.desc)) continue;
    const tools::Attribute first = time_attribute(flags.start);
    set_attribute(one.info.attributes, first);
    for (std::uint32_t frame = 1; frame < flags.frames; ++frame) {
      const tools::Attribute time = time_attribute(flags.start + frame / flags.fps);
      if (time != first) one.changes.push_back({frame, time});
    }
  }
  return all;
}

}  // namespace

FrameFiles files_of(const TraceFlags& o, const EngineTextures* engine) {
  FrameFiles files;
  if (o.files == "gic") return files;
  files.ending = o.files;
  // Descriptions need no more probes than one; those of engines are there already.
  const ProbeTextures own({1, 1, 1}, o.trace.forms);
  for (const FrameTexture& texture : textures_of(own, engine)) {
    const Format format = texture.desc.record.format;
    if (!has_format(kind_of(o.files), format)) {
      fail(Exit::usage,
           "--files {}: texture {} is of format {}, which such files cannot have; {} hold it{}",
           o.files, texture.name, find_format(format)->name, kinds_for(format),
           engine == nullptr ? "; --vk-format chooses another" : "");
    }
    files.textures.push_back(texture.name);
  }
  return files;
}

TraceOutput::TraceOutput(const TraceFlags& o, const DdgiVolume& volume, EngineTextures* engine,
                         DumpFolder& folder)
    : volume_(volume), engine_(engine), folder_(folder) {
  if (o.files != "gic") return;
  const VolumeShape& shape = volume.shape();
  const std::string scene = scene_label(o.scene);
  const auto textures = current();
  const auto dumps = stored(o, shape, textures);
  if (engine == nullptr) {
    container_.emplace(own_volume(textures), "probes", shape, scene, kProbesFile, dumps);
  } else {
    container_.emplace(engine->volume(), o.layout, shape, scene, container_name(*o.engine), dumps);
  }
}

std::vector<FrameTexture> TraceOutput::current() const {
  return textures_of(volume_.textures(), engine_);
}

void TraceOutput::write(std::uint32_t frame, double time) {
  if (engine_ != nullptr) engine_->fill(volume_.textures(), volume_.active_probes());
  const auto textures = current();
  if (container_) {
    std::vector<Texels> texels;
    for (const FrameTexture& texture : textures) texels.push_back(texture.texels);
    container_->add(frame, texels);
  } else {
    folder_.write_frame(frame, time, textures);
  }
}

void TraceOutput::finish() {
  if (container_) folder_.write_container(container_->file(), container_->finish());
}

}  // namespace gicodec::ddgi
