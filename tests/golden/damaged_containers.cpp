// Containers with one fault each, and sound ones beside these.
#include "golden/make_golden.h"

#include "bitstream/description.h"
#include "bitstream/packet.h"
#include "bitstream/region_field.h"

#include <cstring>
#include <limits>

namespace gicodec::golden {
namespace {

using test::Bytes;
using test::operator+;

void other_containers() {
  const auto good = sequence("zstd", 2, 2);
  auto textures = sequence_textures();
  textures.resize(2);
  const Bytes head = test::head_of(probe_description(textures, {{"golden", "zstd"}}));
  // Without the index, whose offsets would be others.
  std::uint64_t packets_end = 0;
  std::memcpy(&packets_end, &good[good.size() - kEndEntry + 2], sizeof packets_end);
  const Bytes packets(good.begin() + static_cast<std::ptrdiff_t>(head.size()),
                      good.begin() + static_cast<std::ptrdiff_t>(packets_end));
  const auto with_entry = [&](std::uint8_t type) {
    return head + test::entry(type, Bytes(5, std::byte{1})) + packets + test::end_entry(0);
  };
  const auto with = [&](std::size_t at, int flip) {
    auto bytes = good;
    bytes[at] ^= static_cast<std::byte>(flip);
    return bytes;
  };
  save("cut.gic", std::span(good).first(good.size() - 100));
  save("skippable_entry.gic", with_entry(0x80));
  save("newer_minor.gic", with(9, 7));
  save("bad_mandatory_entry.gic", with_entry(0x7F));
  save("bad_magic.gic", with(3, 1));
  save("bad_major.gic", with(8, 2));
  save("bad_features.gic", with(10, 1));
  save("bad_description.gic", with(20, 1));
  save("bad_packet.gic", with(head.size() + 20, 1));
}

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

/// What a description of one volume says, field by field, so that each can be wrong.
struct Said {
  std::uint64_t volumes = 1;
  std::uint8_t kind = kKindProbes;
  Bytes told = {};  ///< by the kind
  std::uint8_t placed = 0;
  float spacing = 1;
  Grid region = {};
  std::uint64_t textures = 1;
  std::string name = "vis";
  std::uint8_t tiling = 0, padding = 0;
  Grid slots = {};
  float error = 0;
  Bytes rest = {};  ///< behind the last field
};

/// What the kind probes tells: one texture of single halves on a grid of 3×1×1.
Bytes told(const Bytes& record = bytes({76}), const Bytes& rest = {}) {
  return bytes({3, 1, 1, 1, 3, 'v', 'i', 's'}) + record + bytes({1, 0}) + rest;
}

Bytes file_of(Said said, const Bytes& entries = {}) {
  if (said.told.empty()) said.told = told();
  Bytes body;
  ByteWriter writer(body);
  const auto real = [&](float value) { writer.bytes(std::as_bytes(std::span(&value, 1))); };
  writer.fixed(std::uint64_t{0});
  writer.text("");
  writer.fixed(std::uint64_t{0});
  writer.varint(said.volumes);
  if (said.volumes != 0) {
    writer.text("");
    writer.fixed(said.kind);
    writer.varint(said.told.size());
    writer.bytes(said.told);
    writer.fixed(said.placed);
    for (int i = 0; i < 6 && said.placed != 0; ++i) real(i < 3 ? 0 : said.spacing);
    for (int i = 0; i < 3 && said.placed != 0; ++i) writer.varint(0);
    write_grid(said.region, writer);
    writer.varint(said.textures);
    for (std::uint64_t i = 0; i < said.textures; ++i) {
      writer.text(said.name + std::string(i, 'x'));
      writer.fixed(said.tiling);
      writer.fixed(said.padding);
      writer.fixed(std::uint8_t{0});
      write_grid(said.slots, writer);
      real(said.error);
      writer.varint(0);
    }
    writer.varint(0);
  }
  writer.varint(0);
  writer.bytes(said.rest);
  const Bytes head = test::head_of(volumes_description());
  return Bytes(head.begin(), head.begin() + kFileHeader) + test::entry(1, body) + entries +
         test::end_entry(0);
}

void bad_descriptions() {
  const auto save_said = [](const std::string& name, const Said& said) {
    save("bad_" + name + ".gic", file_of(said));
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  save("least.gic", file_of({}));
  save_said("no_volumes", {.volumes = 0});
  save_said("no_textures", {.textures = 0});
  save_said("more_textures", {.textures = 2});
  save_said("texture_name", {.name = "viz"});
  save_said("kind", {.kind = 0});
  save_said("format", {.told = told(bytes({86}))});
  // Two components of a bit less than the record, of one bit twice, and one across 32 bits.
  const auto component = [](int at, int bits) { return bytes({1, 'a', at, bits, 0}); };
  save_said("record_gap", {.told = told(bytes({0, 2, 2}) + component(0, 8) + component(9, 7))});
  save_said("record_overlap", {.told = told(bytes({0, 2, 2}) + component(0, 9) + component(8, 8))});
  save_said("record_crossing", {.told = told(bytes({0, 8, 3}) + component(0, 16) +
                                             component(16, 32) + component(48, 16))});
  save_said("kind_rest", {.told = told(bytes({76}), bytes({0}))});
  save_said("placed", {.placed = 2});
  save_said("spacing", {.placed = 1, .spacing = 0});
  save_said("region_size", {.region = {1, 0, 1}});
  save_said("tiling", {.tiling = kTilingCount});
  save_said("padding", {.padding = 9});
  save_said("slots", {.slots = {3, 1, 1}});
  save_said("error", {.error = nan});
  save_said("error_sign", {.error = -1});
  save_said("description_rest", {.rest = bytes({0})});
}

/// Packets that are sound, where the description or the entry is against them.
void bad_entries() {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 1, 1}, 1, 0);
  const auto packet = [&](const TextureDesc& of, std::uint8_t id) {
    auto encoder = *Encoder::create(of, {.backend = "raw", .texture_id = id});
    const test::Texture texture(of);
    return *encoder.encode(texture.view(), Selection::all());
  };
  const auto entry = [](std::uint64_t frame, std::uint32_t region, const Packet& bytes) {
    return test::packet_entry({frame, from_region_field(region), 0, true, bytes});
  };
  const Packet whole = packet(desc, 0);
  const Said cut{.region = {2, 1, 1}};
  const Packet part = packet(region_texture(desc, cut.region, 0), 0);
  const Packet last = packet(region_texture(desc, cut.region, 1), 0);
  save("regions.gic", file_of(cut, entry(0, 1, part) + entry(0, 2, last)));
  save("bad_region.gic", file_of({}, entry(0, 0, whole) + entry(1, 1, whole)));
  save("bad_region_zero.gic", file_of(cut, entry(0, 1, part) + entry(1, 0, whole)));
  save("bad_region_beyond.gic", file_of(cut, entry(0, 1, part) + entry(1, 3, part)));
  save("bad_texture_id.gic", file_of({}, entry(0, 0, whole) + entry(1, 0, packet(desc, 1))));
  save("bad_frame_order.gic", file_of({}, entry(7, 0, whole) + entry(6, 0, whole)));
  const Packet lossy = changed(whole, 1, std::to_integer<int>(whole[1]) | 8);
  save("lossy.gic", file_of({.error = 2}, entry(0, 0, whole) + entry(1, 0, lossy)));
  save("bad_lossy.gic", file_of({}, entry(0, 0, whole) + entry(1, 0, lossy)));
}

/// Two packets, and an index that is not what it should be.
void bad_indices() {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 1, 1}, 1, 0);
  auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = 1});
  const test::Texture texture(desc);
  const Bytes start = file_of({});
  const Bytes head(start.begin(), start.end() - kEndEntry);
  const Bytes first =
      test::packet_entry({0, StreamId::kWholeVolume, 0, true, *encoder.encode(texture.view())});
  const Bytes second =
      test::packet_entry({1, StreamId::kWholeVolume, 0, true, *encoder.encode(texture.view())});
  const std::uint64_t at = head.size(), then = at + first.size(), part = then + second.size();
  struct Line {
    std::uint64_t frame, distance;
    std::uint8_t id = 0, flags = 1;
  };
  const auto file = [&](std::uint64_t directory, const std::vector<Line>& lines,
                        std::uint64_t here) {
    Bytes body;
    ByteWriter writer(body);
    writer.varint(lines.size());
    for (const Line& line : lines) {
      writer.varint(line.frame);
      writer.varint(line.distance);
      writer.fixed(line.id);
      writer.varint(0);
      writer.fixed(line.flags);
    }
    writer.varint(0);
    writer.fixed(directory);
    writer.varint(directory == 0 ? 0 : 1);
    if (directory != 0) writer.bytes(bytes({0, 40, 0, 0}));
    writer.fixed(here);
    writer.bytes(std::as_bytes(std::span(kIndexMark)));
    return head + first + second + test::entry(3, body) + test::end_entry(part);
  };
  const std::uint64_t step = then - at;
  save("index.gic", file(0, {{0, at}, {1, step}}, part));
  save("index_order.gic", file(0, {{0, then}, {1, 0}}, part));
  save("index_directory.gic", file(part, {{0, at}, {1, step}}, part));
  save("bad_index_place.gic", file(0, {{0, at}, {1, step}}, part - 1));
  save("index_texture.gic", file(0, {{0, at, 1}, {1, step}}, part));
  save("index_flags.gic", file(0, {{0, at, 0, 3}, {1, step}}, part));
  // Sound, but of other packets: the next packet finds it.
  save("index_frame.gic", file(0, {{0, at}, {2, step}}, part));
  save("index_keyframe.gic", file(0, {{0, at}, {1, step, 0, 0}}, part));
}

}  // namespace

void save_damaged_containers() {
  other_containers();
  bad_descriptions();
  bad_entries();
  bad_indices();
}

}  // namespace gicodec::golden
