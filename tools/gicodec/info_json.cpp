// The report of gicodec info as JSON.
#include "common/volume_words.h"
#include "container_report.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <string_view>
#include <utility>

namespace gicodec::tools {
namespace {

using Json = nlohmann::ordered_json;

/// Metadata by name, the first of each name. Bypasses ordered_json's linear search.
Json metadata_json(const Metadata& metadata, const Metadata& beside = {}) {
  Json json = Json::object();
  using Entries = std::vector<std::pair<const std::string, Json>>;
  Entries& entries = json.get_ref<Json::object_t&>();
  std::set<std::string_view> seen;
  for (const Metadata* const part : {&metadata, &beside}) {
    for (const auto& [key, value] : *part) {
      if (seen.insert(key).second) entries.emplace_back(key, value);
    }
  }
  return json;
}

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}
Json grid_json(const Grid& grid) { return {grid.x, grid.y, grid.z}; }

Json sums_json(const Sums& sums, bool by_index) {
  const auto read = [&](std::uint64_t value) { return by_index ? Json(nullptr) : Json(value); };
  return {{"packets", sums.packets},
          {"blocks", or_null(sums.blocks)},
          {"bytes", sums.bytes},
          {"header_bytes", read(sums.header)},
          {"index_bytes", read(sums.index)},
          {"guard_band_bytes", read(sums.guard_bands)},
          {"payload_bytes", read(sums.payload)},
          {"full_texture_bytes", or_null(sums.full_bytes)},
          {"record_bytes", or_null(sums.record_bytes)},
          {"ratio_full", or_null(sums.full_ratio())},
          {"ratio_records", or_null(sums.record_ratio())},
          {"bits_per_record", or_null(sums.bits_per_record())}};
}

Json volume_json(const VolumeEntry& volume) {
  const Kind* kind = find_kind(volume.kind);
  Json json = {{"name", volume.name},
               {"kind", kind == nullptr ? Json(nullptr) : Json(kind->name)},
               {"kind_number", volume.kind},
               {"region", volume.region.x == 0 ? Json(nullptr) : grid_json(volume.region)},
               {"geometry", nullptr},
               {"first_texture", volume.first_texture},
               {"textures", volume.textures},
               {"groups", Json::array()}};
  if (volume.geometry) {
    json["geometry"] = {{"origin", volume.geometry->origin},
                        {"spacing", volume.geometry->spacing},
                        {"scroll", volume.geometry->scroll}};
  }
  for (const TextureGroup& group : volume.desc.groups) {
    const TextureDesc& desc = group.textures.front().desc;
    json["groups"].push_back({{"space", desc.space == Space::grid ? "grid" : "pool"},
                              {"grid", grid_json(desc.grid)},
                              {"textures", group.textures.size()}});
  }
  if (!volume.metadata.empty()) json["metadata"] = metadata_json(volume.metadata);
  return json;
}

/// Adds fields of textures of known kinds.
void add_shape(const TextureDesc& desc, Json& json) {
  const Extent size = extent(desc);
  const FormatInfo* format = find_format(desc.record.format);
  json["format"] = format == nullptr ? Json(nullptr) : Json(format->name);
  json["components"] = Json::array();
  for (const Component& component : desc.record.used()) {
    json["components"].push_back(
        {{"name", component.name()}, {"bits", component.bits}, {"offset", component.offset}});
  }
  json["space"] = desc.space == Space::grid ? "grid" : "pool";
  json["grid"] = grid_json(desc.grid);
  json["block"] = {desc.block.x, desc.block.y, desc.block.z};
  json["guard_band"] = desc.guard_band;
  json["tiling"] = gicodec::to_string(desc.layout.tiling);
  json["width"] = size.width;
  json["height"] = size.height;
  json["slices"] = size.slices;
}

/// Adds what the container stores about dumps.
void add_files(const StoredTexture& texture, Json& json) {
  const Record& record = texture.info.desc.record;
  json["channels"] = to_string(texture.info.channels, record.format);
  json["channel_names"] = Json::object();
  for (std::size_t i = 0; i < record.count; ++i) {
    json["channel_names"][std::string(record.components[i].name())] =
        channel_name(texture.info.channels, record.format, i);
  }
  json["not_kept"] = texture.dropped;
  json["file_bytes"] = texture.file_bytes > 0 ? Json(texture.file_bytes) : Json(nullptr);
  json["encoder"] = texture.encoder.empty() ? Json(nullptr) : Json(texture.encoder);
  json["inactive_probes"] = texture.inactive.size();
}

Json texture_json(const ContainerReport& report, std::size_t place) {
  const StoredTexture& texture = report.input.textures()[place];
  const TextureEntry& entry = report.input.description().textures[place];
  const TextureReport& own = report.textures[place];
  const bool known = std::isfinite(entry.largest_error);
  Json json = {{"name", texture.name},
               {"volume", entry.volume},
               {"lossy", !texture.lossy.empty()},
               {"largest_error", known ? Json(entry.largest_error) : Json(nullptr)},
               {"backends", Json::array()}};
  for (const std::uint8_t id : own.backends) json["backends"].push_back(backend_text(id));
  if (is_known(entry)) add_shape(entry.desc, json);
  if (texture.no_dump.empty()) add_files(texture, json);
  if (own.first_frame) {
    json["first_frame"] = *own.first_frame;
    json["last_frame"] = *own.last_frame;
  }
  json["keyframes"] = sums_json(own.keyframes, report.by_index);
  json["updates"] = sums_json(own.updates, report.by_index);
  json["all"] = sums_json(own.all, report.by_index);
  if (const Json native = own.payload.json(entry.desc.record); !native.is_null())
    json["native"] = native;
  const Metadata beside = report.metadata ? report.input.beside(place) : Metadata{};
  if (!entry.metadata.empty() || !beside.empty()) {
    json["metadata"] = metadata_json(entry.metadata, beside);
  }
  for (const PacketLine& packet : own.packets) {
    json["packets"].push_back(
        {{"frame", packet.frame},
         {"region", packet.region == StreamId::kWholeVolume ? Json(nullptr) : Json(packet.region)},
         {"keyframe", is_keyframe(packet.info.type)},
         {"lossy", packet.info.lossy},
         {"backend", backend_text(packet.info.backend)},
         {"sequence", packet.info.sequence},
         {"reference", packet.info.reference},
         {"blocks", or_null(packet.blocks)},
         {"bytes", packet.bytes},
         {"index_bytes", packet.info.index_size},
         {"guard_band_bytes", packet.info.guard_band_size},
         {"payload_bytes", packet.info.payload_size}});
  }
  return json;
}

}  // namespace

Json to_json(const ContainerReport& report) {
  const ContainerInput& input = report.input;
  const ContainerDescription& description = input.description();
  const Totals& totals = report.totals;
  Json json = {{"file", input.path()},
               {"bytes", or_null(totals.bytes)},
               {"frames", totals.frames},
               {"first_frame", or_null(totals.first_frame)},
               {"last_frame", or_null(totals.last_frame)},
               {"by_index", report.by_index},
               {"finished", !input.cut_off()},
               {"missing", input.cut_off() ? Json(input.missing()) : Json(nullptr)},
               {"epoch", description.epoch == 0 ? Json(nullptr) : Json(description.epoch)},
               {"scene", description.scene.name},
               {"scene_geometry",
                description.scene.geometry == 0 ? Json(nullptr) : Json(description.scene.geometry)},
               {"packet_bytes", totals.packet_bytes},
               {"texture_bytes", or_null(totals.texture_bytes)},
               {"ratio", or_null(totals.times_smaller(totals.texture_bytes))},
               {"file_bytes", or_null(totals.file_bytes)},
               {"ratio_files", or_null(totals.times_smaller(totals.file_bytes))},
               {"bytes_per_frame", or_null(totals.bytes_per_frame())}};
  if (report.fps) {
    json["fps"] = *report.fps;
    json["bits_per_second"] = 8 * totals.bytes_per_frame().value_or(0) * *report.fps;
  }
  json["metadata"] = metadata_json(description.metadata);
  json["volumes"] = Json::array();
  for (const VolumeEntry& volume : description.volumes) {
    json["volumes"].push_back(volume_json(volume));
  }
  json["textures"] = Json::array();
  for (std::size_t i = 0; i < report.textures.size(); ++i) {
    json["textures"].push_back(texture_json(report, i));
  }
  json["damage"] = report.damage.empty() ? Json(nullptr) : Json(report.damage);
  return json;
}

}  // namespace gicodec::tools
