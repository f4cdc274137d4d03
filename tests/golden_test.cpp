// Bytes written once and kept: what a decoder made of them then it must make of them for ever.
#include "golden/golden.h"
#include "container_support.h"
#include "golden/native_golden.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace gicodec {
namespace {

using namespace test;

std::filesystem::path folder() { return GICODEC_GOLDEN_DIR; }

Exact load(const std::string& name) {
  std::ifstream file(folder() / name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(bytes.empty()) << name;
  return Exact(std::as_bytes(std::span(bytes)));
}

TEST(Golden, Sequences) {
  for (const std::string backend : {"raw", "lz4", "zstd", "native"}) {
    const auto bytes = load("sequence_" + backend + ".gic");
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok()) << backend << reader.status();
    EXPECT_TRUE(reader->seekable());
    EXPECT_EQ(reader->description().metadata, (Metadata{{"golden", backend}}));
    const auto textures = golden::sequence_textures();
    ASSERT_EQ(reader->description().textures.size(), textures.size());
    std::vector<Decoder> decoders;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      EXPECT_EQ(reader->description().textures[i].name, textures[i].name);
      EXPECT_EQ(reader->description().textures[i].desc, textures[i].desc);
      EXPECT_EQ(reader->description().textures[i].metadata, textures[i].metadata);
      decoders.push_back(*Decoder::create(textures[i].desc));
    }
    for (std::uint32_t frame = 0; frame < golden::kFrames; ++frame) {
      for (std::size_t i = 0; i < textures.size(); ++i) {
        ContainerPacket packet;
        ASSERT_EQ(reader->next(packet), Status::ok)
            << backend << " " << frame << " " << textures[i].name;
        EXPECT_EQ(packet.frame, frame * 10);
        EXPECT_EQ(packet.texture_id, i);
        EXPECT_EQ(packet.keyframe, frame % 3 == 0);
        ASSERT_EQ(decoders[i].decode(packet.bytes), Status::ok) << textures[i].name;
        Texture expected(textures[i].desc);
        golden::paint(expected, frame);
        EXPECT_TRUE(contents(decoders[i]) == expected.blocks())
            << backend << " frame " << frame << " " << textures[i].name;
      }
    }
    ContainerPacket packet;
    EXPECT_EQ(reader->next(packet), Status::end);
  }
}

TEST(Golden, NativePresets) {
  for (const std::string preset : {"fast", "strong"}) {
    const auto bytes = load("native_" + preset + ".gic");
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok()) << preset << reader.status();
    const auto textures = golden::native_textures();
    ASSERT_EQ(reader->description().textures.size(), textures.size());
    std::vector<Decoder> decoders;
    for (const auto& texture : textures) decoders.push_back(*Decoder::create(texture.desc));
    for (std::uint32_t frame = 0; frame < golden::kNativeFrames; ++frame) {
      for (std::size_t i = 0; i < textures.size(); ++i) {
        ContainerPacket packet;
        ASSERT_EQ(reader->next(packet), Status::ok)
            << preset << " " << frame << " " << textures[i].name;
        ASSERT_EQ(decoders[i].decode(packet.bytes), Status::ok) << textures[i].name;
        EXPECT_EQ(decoders[i].updated().size(),
                  frame == 1 ? golden::native_selection(textures[i].desc).size()
                             : probe_count(textures[i].desc));
        Texture expected(textures[i].desc);
        golden::paint_native(expected, frame);
        Texture decoded(textures[i].desc);
        ASSERT_EQ(decoders[i].read(decoded.view()), Status::ok);
        for (const auto probe : decoders[i].updated()) {
          EXPECT_TRUE(decoded.block(probe) == expected.block(probe))
              << preset << " frame " << frame << " " << textures[i].name << " " << probe;
        }
      }
    }
  }
}

TEST(Golden, IndexModes) {
  for (const auto mode : golden::kIndexModes) {
    const auto packet = load("index_" + std::string(mode) + ".packet");
    auto decoder = *Decoder::create(golden::index_desc());
    ASSERT_EQ(decoder.decode(packet.span()), Status::ok) << mode;
    const auto probes = golden::index_probes(mode);
    EXPECT_TRUE(std::ranges::equal(decoder.updated(), probes)) << mode;
    const auto texels = contents(decoder);
    for (std::uint32_t probe = 0; probe < golden::kIndexProbes; ++probe) {
      const bool listed = std::ranges::binary_search(probes, probe);
      const auto byte = static_cast<std::byte>(listed ? probe + 1 : 0);
      EXPECT_EQ(texels[2 * probe], byte) << mode << " " << probe;
      EXPECT_EQ(texels[2 * probe + 1], byte) << mode << " " << probe;
    }
  }
}

constexpr std::pair<const char*, Status> kBadPackets[] = {
    {"bad_signature", Status::not_gicodec},
    {"bad_version", Status::unsupported_version},
    {"bad_flag", Status::unsupported_feature},
    {"bad_backend", Status::backend_missing},
    {"bad_sequence", Status::corrupt},
    {"bad_description", Status::description_mismatch},
    {"bad_checksum", Status::checksum_mismatch},
    {"bad_cut", Status::checksum_mismatch},
    {"bad_payload_head", Status::unsupported_feature},
    {"bad_difference", Status::corrupt},
    {"bad_payload_size", Status::corrupt},
    {"bad_probe_count", Status::corrupt},
    {"bad_index_padding", Status::corrupt},
    {"bad_trailing_byte", Status::corrupt},
    {"bad_native_version", Status::unsupported_version},
    {"bad_native_box", Status::corrupt},
    {"bad_native_size", Status::corrupt},
    {"bad_native_kind", Status::corrupt},
    {"bad_native_lanes", Status::corrupt},
    {"bad_native_planes", Status::corrupt},
    {"bad_native_state", Status::corrupt},
    {"bad_native_end", Status::truncated},
};

TEST(Golden, BadPacketsAreRefused) {
  for (const auto& [name, status] : kBadPackets) {
    const auto packet = load(std::string(name) + ".packet");
    auto decoder = *Decoder::create(golden::index_desc());
    EXPECT_EQ(decoder.decode(packet.span()), status) << name;
    EXPECT_EQ(decoder.sequence(), 0U);
    EXPECT_EQ(decoder.decode(load("index_all.packet").span()), Status::ok);
  }
}

/// Status at the end and the number of packets before it.
constexpr std::tuple<const char*, Status, std::size_t> kContainers[] = {
    {"cut", Status::truncated, 3},
    {"skippable_record", Status::ok, 4},
    {"newer_minor", Status::ok, 4},
    {"bad_mandatory_record", Status::unsupported_feature, 0},
    {"bad_magic", Status::not_gicodec, 0},
    {"bad_major", Status::unsupported_version, 0},
    {"bad_features", Status::unsupported_feature, 0},
    {"bad_description", Status::checksum_mismatch, 0},
    {"bad_packet", Status::checksum_mismatch, 0},
};

TEST(Golden, OtherContainers) {
  for (const auto& [name, status, packets] : kContainers) {
    const auto bytes = load(std::string(name) + ".gic");
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    if (!reader) {
      EXPECT_EQ(reader.status(), status) << name;
      EXPECT_EQ(packets, 0U) << name;
      continue;
    }
    Player player(reader->description());
    EXPECT_EQ(player.play(*reader, UINT64_MAX), status) << name;
    EXPECT_EQ(player.packets, packets) << name;
  }
}

TEST(Golden, EveryFileIsTested) {
  std::set<std::string> known{"README.md",       "golden.h",        "make_golden.cpp",
                              "native_golden.h", "native_fast.gic", "native_strong.gic"};
  for (const char* backend : {"raw", "lz4", "zstd", "native"}) {
    known.insert(std::string("sequence_") + backend + ".gic");
  }
  for (const auto mode : golden::kIndexModes)
    known.insert("index_" + std::string(mode) + ".packet");
  for (const auto& bad : kBadPackets) known.insert(std::string(bad.first) + ".packet");
  for (const auto& container : kContainers)
    known.insert(std::string(std::get<0>(container)) + ".gic");
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    EXPECT_TRUE(known.contains(entry.path().filename().string())) << entry.path();
  }
}

}  // namespace
}  // namespace gicodec
