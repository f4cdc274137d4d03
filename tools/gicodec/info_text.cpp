// The report of gicodec info as text.
#include "common/volume_words.h"
#include "common/world.h"
#include "container_report.h"

#include <gicodec/voxels.h>

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace gicodec::tools {
namespace {

const char* plural(std::uint64_t n) { return n == 1 ? "" : "s"; }

std::string backends_text(const StoredTexture& texture, const TextureReport& report) {
  std::string text;
  for (const std::uint8_t id : report.backends) {
    text += (text.empty() ? "" : ", ") + backend_text(id);
    if (id == kBackendHevc && !texture.encoder.empty()) text += " (" + texture.encoder + ")";
  }
  return text.empty() ? "no packets" : text;
}

/// ", R is irr.R" for channels whose names are not their components'.
std::string names_text(const StoredTexture& texture) {
  const Record& record = texture.info.desc.record;
  std::string text;
  for (std::size_t i = 0; i < record.count; ++i) {
    if (texture.info.channels.names[i].empty()) continue;
    text += fmt::format(", {} is {}", record.components[i].name(), texture.info.channels.names[i]);
  }
  return text;
}

/// ", channels R:HALF G:HALF" for images; empty for texture files, which have no channels.
std::string channels_text(const StoredTexture& texture) {
  if (image_kind(texture.file_name(0)).value_or(ImageKind::exr) != ImageKind::exr) return "";
  const Format format = texture.info.desc.record.format;
  return fmt::format(", channels {}{}", to_string(texture.info.channels, format),
                     names_text(texture));
}

std::string ratio_text(std::optional<double> value) {
  return value ? fmt::format("{:.2f}:1", *value) : std::string("-");
}

/// "1.23 Mbit/s".
std::string rate_text(double bits_per_second) {
  if (bits_per_second >= 1e6) return fmt::format("{:.2f} Mbit/s", bits_per_second * 1e-6);
  return fmt::format("{:.2f} kbit/s", bits_per_second * 1e-3);
}

/// A line for each state, as far as a screen takes them.
void print_states(const ContainerDescription& description) {
  constexpr std::size_t kShown = 32;
  const auto states = states_of(description.metadata);
  for (const FrameState& state : std::span(states).first(std::min(states.size(), kShown))) {
    print("  frame {}{}{}\n", state.frame, state.time ? fmt::format(" at {}", *state.time) : "",
          state.name.empty() ? "" : ": " + state.name);
  }
  if (states.size() > kShown) print("  and {} more states\n", states.size() - kShown);
}

void print_totals(const ContainerReport& report) {
  const ContainerInput& input = report.input;
  const Totals& totals = report.totals;
  const auto volumes = input.description().volumes.size(), textures = input.textures().size();
  print("{}: {} volume{}, {} texture{}, {} frame{}{}{}{}\n", input.path(), volumes, plural(volumes),
        textures, plural(textures), totals.frames, plural(totals.frames),
        totals.first_frame ? fmt::format(" ({}-{})", *totals.first_frame, *totals.last_frame) : "",
        totals.bytes ? fmt::format(", {} bytes", *totals.bytes) : "",
        input.cut_off() ? ", WITHOUT ITS END" : "");
  const SceneId& scene = input.description().scene;
  if (!scene.name.empty()) print("  scene {}\n", scene.name);
  if (scene.geometry != 0) print("  geometry of the scene {:016x}\n", scene.geometry);
  if (input.description().epoch != 0) print("  epoch {}\n", input.description().epoch);
  print_states(input.description());
  if (totals.frames == 0) return;
  print("  ");
  if (totals.texture_bytes) {
    print("{} of {} bytes of textures", ratio_text(totals.times_smaller(totals.texture_bytes)),
          *totals.texture_bytes);
    if (totals.file_bytes) {
      print(", {} of {} bytes of files", ratio_text(totals.times_smaller(totals.file_bytes)),
            *totals.file_bytes);
    }
    print("; ");
  }
  print("{:.0f} bytes per frame", *totals.bytes_per_frame());
  if (report.fps) {
    print(", {} at {} fps", rate_text(8 * *totals.bytes_per_frame() * *report.fps), *report.fps);
  }
  print("\n");
}

void print_sums(const char* label, const Sums& sums) {
  if (sums.packets == 0) return;
  print("  {:<9} {:>6} packet{:<1} ", label, sums.packets, plural(sums.packets));
  if (sums.blocks) print("{:>9} block{:<1} ", *sums.blocks, plural(*sums.blocks));
  print("{:>11} bytes", sums.bytes);
  if (const auto full = sums.full_ratio()) print("  {} full", ratio_text(full));
  if (const auto bits = sums.bits_per_record()) {
    print(", {} blocks, {:.2f} bit/record", ratio_text(sums.record_ratio()), *bits);
  }
  print("\n");
}

/// What the bytes of packets are.
void print_parts(const Sums& sums) {
  print("  bytes: {} headers, {} indices, {} guard bands, {} payload\n", sums.header, sums.index,
        sums.guard_bands, sums.payload);
}

void print_packet(const PacketLine& packet) {
  const PacketInfo& info = packet.info;
  print(
      "  frame {:>6} {}{:<8} {:>9} bytes: {} header, {} indices, {} guard bands, {} payload; "
      "{} blocks, {}{}\n",
      packet.frame,
      packet.region == StreamId::kWholeVolume ? "" : fmt::format("region {:>4} ", packet.region),
      is_keyframe(info.type) ? "keyframe" : "update", packet.bytes,
      packet.bytes - info.index_size - info.guard_band_size - info.payload_size, info.index_size,
      info.guard_band_size, info.payload_size,
      packet.blocks ? fmt::format("{}", *packet.blocks) : "all", backend_text(info.backend),
      info.lossy ? ", LOSSY" : "");
}

/// "grid 4x2x3", or the slots of a pool.
std::string place_text(const TextureDesc& desc) {
  if (desc.space == Space::pool) return fmt::format("a pool of {} slots", block_count(desc));
  return fmt::format("grid {}", to_string(desc.grid));
}

/// "layout three, axes right up back (right-handed), a unit is 0.01 m, lights -4 0 -4 to 4 3 4".
std::string world_text(const Place& place) {
  std::vector<std::string> parts;
  if (!place.layout.empty()) parts.push_back("layout " + place.layout);
  if (!place.axes.empty()) {
    parts.push_back(fmt::format("axes {} ({}-handed)", place.axes,
                                is_right_handed(place.axes) ? "right" : "left"));
  }
  if (place.metres) parts.push_back(fmt::format("a unit is {} m", *place.metres));
  if (place.bounds) {
    const auto& box = *place.bounds;
    parts.push_back(fmt::format("lights {} to {}", fmt::join(std::span(box).first(3), " "),
                                fmt::join(std::span(box).last(3), " ")));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

void print_volume(const ContainerReport& report, std::size_t place) {
  const ContainerDescription& description = report.input.description();
  const VolumeEntry& volume = description.volumes[place];
  const std::string name = volume_name(description, place),
                    choice = volume_choice(description, place);
  print("volume {}{}: {}", name, choice == name ? "" : fmt::format(" (--volume {})", choice),
        kind_text(volume.kind));
  std::size_t first = volume.first_texture;
  for (const TextureGroup& group : volume.desc.groups) {
    print("{} {}", first == volume.first_texture ? "," : " and",
          place_text(group.textures.front().desc));
    first += group.textures.size();
  }
  if (volume.region.x != 0) print(", cut into regions of {}", to_string(volume.region));
  print("\n");
  const auto is_pool = [](const TextureGroup& group) {
    return group.textures.front().desc.space == Space::pool;
  };
  // Pools have no geometry, except pools of bricks.
  const bool placed =
      volume.kind == kKindVoxels || !std::ranges::all_of(volume.desc.groups, is_pool);
  if (volume.geometry && placed) {
    const VolumeGeometry& at = *volume.geometry;
    print("  origin {}, spacing {}, scroll {}\n", fmt::format("{}", fmt::join(at.origin, " ")),
          fmt::format("{}", fmt::join(at.spacing, " ")),
          fmt::format("{}", fmt::join(at.scroll, " ")));
  }
  const std::string world = world_text(place_of(volume.metadata));
  if (!world.empty()) print("  {}\n", world);
  if (const std::string unknown = unknown_kind(description, place); !unknown.empty()) {
    print("  {}: its packets were checked, not decoded\n", unknown);
  }
  if (!report.metadata) return;
  for (const auto& [key, value] : volume.metadata) print("  {} = {}\n", key, value);
}

void print_texture(const ContainerReport& report, std::size_t place) {
  const StoredTexture& texture = report.input.textures()[place];
  const TextureEntry& entry = report.input.description().textures[place];
  const TextureReport& own = report.textures[place];
  const TextureDesc& desc = entry.desc;
  print("texture {}", texture.name);
  if (is_known(entry)) {
    const Extent size = extent(desc);
    print(": {}, {} blocks of {}, guard band {}, {}, {}x{}{}", record_text(desc.record),
          block_count(desc), block_text(desc.block), desc.guard_band,
          gicodec::to_string(desc.layout.tiling), size.width, size.height,
          size.slices > 1 ? fmt::format("x{}", size.slices) : "");
  }
  print("\n");
  if (texture.no_dump.empty()) {
    print("  files {}{}\n", texture.file_name(own.first_frame.value_or(0)), channels_text(texture));
  }
  if (!texture.dropped.empty()) print("  not kept: {}\n", texture.dropped);
  print("  {}{}\n", report.by_index ? "" : backends_text(texture, own) + ", ",
        texture.lossy.empty() ? "lossless" : fmt::format("LOSSY ({})", texture.lossy));
  if (is_known(entry) && desc.presence != Presence::all) {
    print("  room for {} records a block, of which {} exist\n", record_count(desc.block),
          desc.presence == Presence::count ? "the first so many" : "those that a mask selects");
  }
  if (!texture.inactive.empty()) {
    print("  {} inactive probes not stored\n", texture.inactive.size());
  }
  print_sums("keyframes", own.keyframes);
  print_sums("updates", own.updates);
  print_sums("all", own.all);
  if (report.by_index) {
    if (own.all.packets == 0) print("  no packets\n");
  } else {
    print_parts(own.all);
  }
  own.payload.print(desc.record);
  for (const PacketLine& packet : own.packets) print_packet(packet);
  if (!report.metadata) return;
  const Metadata beside = report.input.beside(place);
  for (const auto* const metadata : {&entry.metadata, &beside}) {
    for (const auto& [key, value] : *metadata) print("  {} = {}\n", key, value);
  }
}

}  // namespace

std::string backend_text(std::uint8_t id) {
  const auto name = backend_name(id);
  return name.empty() ? fmt::format("backend {}", id) : std::string(name);
}

void print_text(const ContainerReport& report) {
  print_totals(report);
  const auto& volumes = report.input.description().volumes;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    print_volume(report, i);
    for (std::uint32_t t = 0; t < volumes[i].textures; ++t) {
      print_texture(report, volumes[i].first_texture + t);
    }
  }
}

}  // namespace gicodec::tools
