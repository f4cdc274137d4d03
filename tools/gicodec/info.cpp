// gicodec info: what is in a container and where its bytes go.
#include "cli.h"
#include "container_input.h"
#include "container_sums.h"
#include "payload_report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace gicodec::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFooter =
    "Ratios are against the full textures with guard bands, as many bytes as their format has per\n"
    "texel, and against the core texels of the probes in the packets. Packet bytes count "
    "everything:\n"
    "header, probe indices, guard bands that do not follow the rule, payload. --verbose decodes\n"
    "native packets, as far as their size warrants it, and says how many bytes their heads,\n"
    "tables, modes and planes take, and in percent how often each mode, the way in which a block\n"
    "is predicted (docs/native.md), was chosen.\n"
    "\n"
    "Examples:\n"
    "  gicodec info villa.gic\n"
    "  gicodec info villa.gic --fps 10\n"
    "  gicodec info villa.gic --packets\n"
    "  gicodec info villa.gic --format json | jq .textures[0].updates\n";

struct InfoOptions {
  std::string input;
  std::string format = "text";
  bool packets = false;
  bool metadata = false;
  bool verbose = false;
  std::optional<double> fps;
  bool allow_incomplete = false;
};

struct PacketLine {
  std::uint64_t frame = 0;
  PacketInfo info;
  std::uint64_t bytes = 0, probes = 0;
};

struct TextureReport {
  Sums keyframes, updates, all;
  std::optional<std::uint64_t> first_frame, last_frame;
  std::set<std::uint8_t> backends;
  bool lossy = false;
  std::vector<PacketLine> packets;  ///< with --packets only
  PayloadReport payload;
};

void add_packet(TextureReport& report, const ContainerPacket& packet, const TextureDesc& desc,
                const InfoOptions& options, const std::string& where, LookBudget& budget) {
  check(verify_checksum(packet.bytes), where);
  const PacketInfo info = take(peek(packet.bytes), where);
  if (!info.all_probes && info.probes > probe_count(desc)) check(Status::corrupt, where);
  for (Sums* sums : {info.keyframe ? &report.keyframes : &report.updates, &report.all}) {
    sums->add(info, packet.bytes.size(), desc);
  }
  if (!report.first_frame) report.first_frame = packet.frame;
  report.last_frame = packet.frame;
  report.backends.insert(info.backend);
  report.lossy |= info.lossy;
  if (options.verbose) report.payload.add(packet, info, desc, where, budget);
  if (options.packets) {
    const std::uint64_t probes = info.all_probes ? probe_count(desc) : info.probes;
    report.packets.push_back({packet.frame, info, packet.bytes.size(), probes});
  }
}

std::string backend_text(std::uint8_t id) {
  const auto name = backend_name(id);
  return name.empty() ? fmt::format("backend {}", id) : std::string(name);
}

std::string backends_text(const StoredTexture& texture, const TextureReport& report) {
  std::string text;
  for (const std::uint8_t id : report.backends) {
    text += (text.empty() ? "" : ", ") + backend_text(id);
    if (id == kBackendHevc && !texture.encoder.empty()) text += " (" + texture.encoder + ")";
  }
  return text.empty() ? "no packets" : text;
}

/// ", R is irr.R" for channels of other names than their components.
std::string names_text(const StoredTexture& texture) {
  const Format format = texture.info.desc.format;
  std::string text;
  for (std::size_t i = 0; i < find_format(format)->component_count; ++i) {
    if (texture.info.channels.names[i].empty()) continue;
    text += fmt::format(", {} is {}", find_format(format)->components[i].name,
                        texture.info.channels.names[i]);
  }
  return text;
}

std::string ratio_text(std::optional<double> value) {
  return value ? fmt::format("{:.2f}:1", *value) : std::string("-");
}

/// "1.23 Mbit/s".
std::string rate_text(double bits_per_second) {
  if (bits_per_second >= 1e6) return fmt::format("{:.2f} Mbit/s", bits_per_second * 1e-6);
  return fmt::format("{:.2f} kbit/s", bits_per_second * 1e-3);
}

void print_totals(const Totals& totals, const ContainerInput& input, const InfoOptions& options) {
  const auto plural = [](std::size_t n) { return n == 1 ? "" : "s"; };
  const auto textures = input.textures().size();
  print("{}: {} texture{}, {} frame{}{}{}{}\n", input.path(), textures, plural(textures),
        totals.frames, plural(totals.frames),
        totals.first_frame ? fmt::format(" ({}-{})", *totals.first_frame, *totals.last_frame) : "",
        totals.bytes ? fmt::format(", {} bytes", *totals.bytes) : "",
        input.cut_off() ? ", CUT OFF" : "");
  if (totals.frames == 0) return;
  print("  {} of {} bytes of texels", ratio_text(totals.times_smaller(totals.texel_bytes)),
        totals.texel_bytes);
  if (totals.file_bytes) {
    print(", {} of {} bytes of files", ratio_text(totals.times_smaller(totals.file_bytes)),
          *totals.file_bytes);
  }
  print("; {:.0f} bytes per frame", *totals.bytes_per_frame());
  if (options.fps) {
    print(", {} at {} fps", rate_text(8 * *totals.bytes_per_frame() * *options.fps), *options.fps);
  }
  print("\n");
}

void print_sums(const char* label, const Sums& sums) {
  if (sums.packets == 0) return;
  print("  {:<9} {:>6} packets {:>9} probes {:>11} bytes  {} full, {} core, {:.2f} bit/texel\n",
        label, sums.packets, sums.probes, sums.bytes, ratio_text(sums.full_ratio()),
        ratio_text(sums.core_ratio()), sums.bits_per_texel().value_or(0));
}

void print_texture(const StoredTexture& texture, const TextureReport& report) {
  const TextureDesc& desc = texture.info.desc;
  const Extent size = extent(desc);
  print("texture {}: {}, grid {} ({} probes), {}x{} core texels, border {}, {}, {}x{}{}\n",
        texture.name, find_format(desc.format)->name, to_string(desc.grid), probe_count(desc),
        desc.core, desc.core, desc.border, gicodec::to_string(desc.tiling), size.width, size.height,
        size.slices > 1 ? fmt::format("x{}", size.slices) : "");
  print("  files {}, channels {}{}\n", texture.file_name(report.first_frame.value_or(0)),
        to_string(texture.info.channels, desc.format), names_text(texture));
  if (!texture.dropped.empty()) print("  not kept: {}\n", texture.dropped);
  const bool lossy = report.lossy || !texture.lossy.empty();
  print("  {}, {}{}\n", backends_text(texture, report), lossy ? "LOSSY" : "lossless",
        texture.lossy.empty() ? "" : fmt::format(" ({})", texture.lossy));
  if (!texture.inactive.empty()) {
    print("  {} inactive probes not stored\n", texture.inactive.size());
  }
  print_sums("keyframes", report.keyframes);
  print_sums("updates", report.updates);
  print_sums("all", report.all);
  const Sums& all = report.all;
  print("  bytes: {} headers, {} indices, {} guard bands, {} payload\n", all.header, all.index,
        all.border, all.payload);
  report.payload.print(desc.format);
  for (const PacketLine& packet : report.packets) {
    print(
        "  frame {:>6} {:<8} {:>9} bytes: {} header, {} indices, {} guard bands, {} payload; "
        "{} probes, {}{}\n",
        packet.frame, packet.info.keyframe ? "keyframe" : "update", packet.bytes,
        packet.bytes - packet.info.index_size - packet.info.border_size - packet.info.payload_size,
        packet.info.index_size, packet.info.border_size, packet.info.payload_size, packet.probes,
        backend_text(packet.info.backend), packet.info.lossy ? ", LOSSY" : "");
  }
}

/// The first of each name. Written past the object's own search for a name, which is linear.
Json metadata_json(const Metadata& metadata) {
  Json json = Json::object();
  using Entries = std::vector<std::pair<const std::string, Json>>;
  Entries& entries = json.get_ref<Json::object_t&>();
  std::set<std::string_view> seen;
  for (const auto& [key, value] : metadata) {
    if (seen.insert(key).second) entries.emplace_back(key, value);
  }
  return json;
}

Json number(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json sums_json(const Sums& sums) {
  return {{"packets", sums.packets},
          {"probes", sums.probes},
          {"bytes", sums.bytes},
          {"header_bytes", sums.header},
          {"index_bytes", sums.index},
          {"border_bytes", sums.border},
          {"payload_bytes", sums.payload},
          {"full_texture_bytes", sums.full_bytes},
          {"core_texel_bytes", sums.core_bytes},
          {"ratio_full", number(sums.full_ratio())},
          {"ratio_core", number(sums.core_ratio())},
          {"bits_per_core_texel", number(sums.bits_per_texel())}};
}

Json texture_json(const StoredTexture& texture, const TextureEntry& entry,
                  const TextureReport& report) {
  const TextureDesc& desc = texture.info.desc;
  const Extent size = extent(desc);
  Json json = {{"name", texture.name},
               {"format", find_format(desc.format)->name},
               {"grid", {desc.grid.x, desc.grid.y, desc.grid.z}},
               {"core", desc.core},
               {"border", desc.border},
               {"tiling", gicodec::to_string(desc.tiling)},
               {"width", size.width},
               {"height", size.height},
               {"slices", size.slices},
               {"channels", to_string(texture.info.channels, desc.format)},
               {"channel_names", Json::object()},
               {"not_kept", texture.dropped},
               {"file_bytes", texture.file_bytes > 0 ? Json(texture.file_bytes) : Json(nullptr)},
               {"encoder", texture.encoder.empty() ? Json(nullptr) : Json(texture.encoder)},
               {"lossy", report.lossy || !texture.lossy.empty()},
               {"inactive_probes", texture.inactive.size()},
               {"backends", Json::array()}};
  for (const std::uint8_t id : report.backends) json["backends"].push_back(backend_text(id));
  for (std::size_t i = 0; i < find_format(desc.format)->component_count; ++i) {
    json["channel_names"][std::string{find_format(desc.format)->components[i].name}] =
        channel_name(texture.info.channels, desc.format, i);
  }
  if (report.first_frame) {
    json["first_frame"] = *report.first_frame;
    json["last_frame"] = *report.last_frame;
  }
  json["keyframes"] = sums_json(report.keyframes);
  json["updates"] = sums_json(report.updates);
  json["all"] = sums_json(report.all);
  if (const Json native = report.payload.json(desc.format); !native.is_null())
    json["native"] = native;
  if (!entry.metadata.empty()) json["metadata"] = metadata_json(entry.metadata);
  for (const PacketLine& packet : report.packets) {
    json["packets"].push_back({{"frame", packet.frame},
                               {"keyframe", packet.info.keyframe},
                               {"lossy", packet.info.lossy},
                               {"backend", backend_text(packet.info.backend)},
                               {"sequence", packet.info.sequence},
                               {"reference", packet.info.reference},
                               {"probes", packet.probes},
                               {"bytes", packet.bytes},
                               {"index_bytes", packet.info.index_size},
                               {"border_bytes", packet.info.border_size},
                               {"payload_bytes", packet.info.payload_size}});
  }
  return json;
}

Totals totals_of(const ContainerInput& input, const std::vector<TextureReport>& reports,
                 std::size_t frames) {
  Totals totals;
  totals.frames = frames;
  totals.bytes = input.bytes();
  std::uint64_t file_bytes = 0;
  bool known = !input.cut_off();  // Else it counts files that are not in there.
  for (std::size_t i = 0; i < reports.size(); ++i) {
    totals.packet_bytes += reports[i].all.bytes;
    totals.texel_bytes += reports[i].all.full_bytes;
    file_bytes += input.textures()[i].file_bytes;
    known &= input.textures()[i].file_bytes > 0;
    if (!reports[i].first_frame) continue;
    totals.first_frame = std::min(totals.first_frame.value_or(UINT64_MAX), *reports[i].first_frame);
    totals.last_frame = std::max(totals.last_frame.value_or(0), *reports[i].last_frame);
  }
  if (known) totals.file_bytes = file_bytes;
  return totals;
}

Json totals_json(const Totals& totals, const ContainerInput& input, const InfoOptions& options) {
  const auto count = [](std::optional<std::uint64_t> value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json json = {{"file", input.path()},
               {"bytes", count(totals.bytes)},
               {"frames", totals.frames},
               {"first_frame", count(totals.first_frame)},
               {"last_frame", count(totals.last_frame)},
               {"cut_off", input.cut_off()},
               {"missing", input.cut_off() ? Json(input.missing()) : Json(nullptr)},
               {"packet_bytes", totals.packet_bytes},
               {"texel_bytes", totals.texel_bytes},
               {"ratio", number(totals.times_smaller(totals.texel_bytes))},
               {"file_bytes", count(totals.file_bytes)},
               {"ratio_files", number(totals.times_smaller(totals.file_bytes))},
               {"bytes_per_frame", number(totals.bytes_per_frame())}};
  if (options.fps) {
    json["fps"] = *options.fps;
    json["bits_per_second"] = 8 * totals.bytes_per_frame().value_or(0) * *options.fps;
  }
  json["metadata"] = nullptr;
  json["textures"] = Json::array();
  return json;
}

Exit info(const InfoOptions& options, const Cli& cli) {
  ContainerInput input(options.input);
  std::vector<TextureReport> reports(input.textures().size());
  LookBudget budget;
  std::size_t frames = 0;
  std::uint64_t frame = 0;
  std::vector<ContainerPacket> packets;
  std::string damage;
  try {
    Progress progress("reading frame", 0, cli);
    while (input.next_frame(frame, packets)) {
      progress.step();
      ++frames;
      for (const ContainerPacket& packet : packets) {
        const StoredTexture& texture = input.textures()[packet.texture_id];
        add_packet(reports[packet.texture_id], packet, texture.info.desc, options,
                   fmt::format("{}: frame {}, texture {}", input.path(), frame, texture.name),
                   budget);
      }
    }
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input || frames == 0) throw;
    damage = error.what();
  }
  const Totals totals = totals_of(input, reports, frames);
  if (options.format == "json") {
    Json json = totals_json(totals, input, options);
    json["metadata"] = metadata_json(input.description().metadata);
    for (std::size_t i = 0; i < reports.size(); ++i) {
      json["textures"].push_back(
          texture_json(input.textures()[i], input.description().textures[i], reports[i]));
    }
    json["damage"] = damage.empty() ? Json(nullptr) : Json(damage);
    print_json(json);
  } else {
    print_totals(totals, input, options);
    for (std::size_t i = 0; i < reports.size(); ++i) {
      print_texture(input.textures()[i], reports[i]);
      if (!options.metadata) continue;
      for (const auto& [key, value] : input.description().textures[i].metadata) {
        print("  {} = {}\n", key, value);
      }
    }
  }
  if (damage.empty()) return report_cut_off(input, frames, options.allow_incomplete);
  remark(damage);
  if (frames > 1) {
    remark(fmt::format("\"gicodec decode {} --frames {}-{} -o DIR\" gives back what comes before",
                       options.input, *totals.first_frame, frame - 1));
  }
  return Exit::bad_input;
}

}  // namespace

void add_info(Cli& cli) {
  auto options = std::make_shared<InfoOptions>();
  Command* command =
      cli.app.add_command("info", "Lists textures, frames, sizes and ratios of a container");
  command->footer(kFooter);
  command->add_option("container", options->input, "Container to read; - for standard input")
      ->required()
      ->type_name("FILE");
  command->add_flag("--packets", options->packets, "One line per packet as well");
  command->add_flag("--metadata", options->metadata, "What is kept about the files as well");
  command->add_flag("--verbose", options->verbose,
                    "What native packets are made of as well; decodes them");
  command->add_option("--fps", options->fps, "Frames per second, for the bit rate")
      ->allow(in_range(0.001, 1e6))
      ->type_name("N");
  add_allow_incomplete(*command, options->allow_incomplete);
  add_output_format(*command, options->format);
  command->callback([&cli, options] { cli.run = [&cli, options] { return info(*options, cli); }; });
}

}  // namespace gicodec::tools
