// Wrote the golden files, once: make_golden FOLDER. Kept to show how; not part of any test.
#include "golden/golden.h"
#include "golden/native_golden.h"

#include "bitstream/packet.h"
#include "container_support.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace gicodec::golden {
namespace {

using test::Bytes;
using test::MemorySink;
using test::reseal;

std::filesystem::path folder;

void save(const std::string& name, std::span<const std::byte> bytes) {
  std::ofstream(folder / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

Bytes sequence(std::string_view backend, std::uint32_t frames, std::size_t textures) {
  auto entries = sequence_textures();
  entries.resize(std::min(textures, entries.size()));
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, {entries, {{"golden", std::string(backend)}}});
  std::vector<Encoder> encoders;
  std::vector<std::unique_ptr<test::Texture>> painted;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EncoderOptions options;
    options.backend = backend;
    options.gop = 3;
    options.texture_id = static_cast<std::uint8_t>(i);
    encoders.push_back(*Encoder::create(entries[i].desc, options));
    painted.push_back(std::make_unique<test::Texture>(entries[i].desc));
  }
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      paint(*painted[i], frame);
      const auto packet = *encoders[i].encode(std::as_const(*painted[i]).view());
      if (writer.add(frame * 10, packet) != Status::ok) std::abort();
    }
  }
  if (writer.finish() != Status::ok) std::abort();
  return sink.bytes;
}

Packet index_packet(std::string_view mode, std::string_view backend = "raw") {
  const auto desc = index_desc();
  test::Texture texture(desc);
  const auto probes = index_probes(mode);
  for (const auto probe : probes) {
    for (auto& byte : texture.texel(probe, 0, 0)) byte = static_cast<std::byte>(probe + 1);
  }
  auto encoder = *Encoder::create(desc, {.backend = backend});
  return *encoder.encode(std::as_const(texture).view(), probes);
}

Packet changed(Packet packet, std::size_t at, int value, bool sealed = true) {
  packet[at] = static_cast<std::byte>(value);
  if (sealed) reseal(packet);
  return packet;
}

void bad_packets() {
  const auto all = index_packet("all");
  const auto bitmap = index_packet("bitmap");
  const auto gaps = index_packet("gaps", "zstd");
  const auto head = peek(all)->header_size - kPacketChecksum;
  save("bad_signature.packet", changed(all, 0, 0xD1));
  save("bad_version.packet", changed(all, 0, 0xC2));
  save("bad_flag.packet", changed(all, 1, 0x21));
  save("bad_backend.packet", changed(all, 2, 0x7F));
  save("bad_sequence.packet", changed(all, 4, 0));
  save("bad_description.packet", changed(all, 5, std::to_integer<int>(all[5]) ^ 1));
  save("bad_checksum.packet",
       changed(all, all.size() - 1, std::to_integer<int>(all.back()) ^ 1, false));
  save("bad_payload_head.packet", changed(all, head, 0x04));
  save("bad_difference.packet", changed(all, head, 0x03));
  auto cut = all;
  cut.resize(cut.size() - 10);
  save("bad_cut.packet", cut);
  reseal(cut);
  save("bad_payload_size.packet", cut);
  save("bad_probe_count.packet", changed(bitmap, 9, std::to_integer<int>(bitmap[9]) + 1));
  save("bad_index_padding.packet", changed(gaps, 11 + peek(gaps)->index_size - 1, 0xFF));
  auto extra = gaps;
  extra.insert(extra.end() - 4, std::byte{0});
  reseal(extra);
  save("bad_trailing_byte.packet", extra);
}

Bytes native_sequence(const std::string& preset) {
  const auto entries = native_textures();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, {entries, {{"golden", "native " + preset}}});
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EncoderOptions options;
    options.backend = "native";
    options.settings.preset = preset;
    options.texture_id = static_cast<std::uint8_t>(i);
    encoders.push_back(*Encoder::create(entries[i].desc, options));
  }
  for (std::uint32_t frame = 0; frame < kNativeFrames; ++frame) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      test::Texture texture(entries[i].desc);
      paint_native(texture, frame);
      const auto some = native_selection(entries[i].desc);
      const auto packet = *encoders[i].encode(std::as_const(texture).view(),
                                              frame == 1 ? Selection(some) : Selection::all());
      if (writer.add(frame, packet) != Status::ok) std::abort();
    }
  }
  if (writer.finish() != Status::ok) std::abort();
  return sink.bytes;
}

void bad_native_packets() {
  const test::Texture zero(index_desc());
  auto encoder = *Encoder::create(index_desc(), {.backend = "native"});
  const auto good = *encoder.encode(zero.view(), Selection::all());
  const auto payload = peek(good)->header_size - kPacketChecksum;
  const auto chunk = payload + 5;                             // version, box, one size
  const auto states = good.size() - kPacketChecksum - 8 * 4;  // of 8 lanes, no words
  save("bad_native_version.packet", changed(good, payload, 2));
  save("bad_native_box.packet", changed(good, payload + 1, 9));
  save("bad_native_size.packet",
       changed(good, payload + 4, std::to_integer<int>(good[payload + 4]) - 1));
  save("bad_native_kind.packet", changed(good, chunk, 2));
  save("bad_native_lanes.packet", changed(good, chunk, 1 | 6 << 2));
  save("bad_native_planes.packet", changed(good, chunk + 1, 2));
  save("bad_native_state.packet", changed(good, states + 3, 0xFF));
  save("bad_native_end.packet", changed(good, states, 1));
}

void other_containers() {
  const auto good = sequence("zstd", 2, 2);
  MemorySink description;
  auto entries = sequence_textures();
  entries.resize(2);
  (void)ContainerWriter::create(description, {entries, {{"golden", "zstd"}}});
  const auto with_record = [&](std::uint8_t type) {
    auto bytes = good;
    const auto record = test::record(type, Bytes(5, std::byte{1}));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(description.bytes.size()),
                 record.begin(), record.end());
    return bytes;
  };
  const auto with = [&](std::size_t at, int flip) {
    auto bytes = good;
    bytes[at] ^= static_cast<std::byte>(flip);
    return bytes;
  };
  save("cut.gic", std::span(good).first(good.size() - 60));
  save("skippable_record.gic", with_record(0x80));
  save("newer_minor.gic", with(9, 7));
  save("bad_mandatory_record.gic", with_record(0x7F));
  save("bad_magic.gic", with(3, 1));
  save("bad_major.gic", with(8, 2));
  save("bad_features.gic", with(10, 1));
  save("bad_description.gic", with(20, 1));
  save("bad_packet.gic", with(description.bytes.size() + 20, 1));
}

}  // namespace
}  // namespace gicodec::golden

int main(int argc, char** argv) {
  using namespace gicodec::golden;
  if (argc != 2) return 2;
  folder = argv[1];
  for (const char* backend : {"raw", "lz4", "zstd", "native"}) {
    save(std::string("sequence_") + backend + ".gic", sequence(backend, kFrames, SIZE_MAX));
  }
  for (const auto mode : kIndexModes)
    save("index_" + std::string(mode) + ".packet", index_packet(mode));
  for (const std::string preset : {"fast", "strong"}) {
    save("native_" + preset + ".gic", native_sequence(preset));
  }
  bad_packets();
  bad_native_packets();
  other_containers();
  return 0;
}
