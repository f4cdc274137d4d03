// Bytes written once and kept: what a decoder made of them then it must make of them for ever.
#include "golden/golden.h"
#include "container_support.h"
#include "golden/hashes.h"
#include "golden/map_golden.h"
#include "golden/native_golden.h"
#include "same_description.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
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
    EXPECT_TRUE(reader->finished());
    const ContainerDescription& description = reader->description();
    EXPECT_EQ(description.metadata, (Metadata{{"golden", backend}}));
    ASSERT_EQ(description.volumes.size(), 1U);
    EXPECT_EQ(description.volumes[0].kind, kKindProbes);
    const auto textures = golden::sequence_textures();
    ASSERT_EQ(description.textures.size(), textures.size());
    std::vector<Decoder> decoders;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      EXPECT_EQ(description.textures[i].name, textures[i].name);
      EXPECT_EQ(description.textures[i].desc, textures[i].desc);
      EXPECT_EQ(description.textures[i].metadata, textures[i].metadata);
      EXPECT_EQ(description.textures[i].largest_error, 0);
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

TEST(Golden, VolumesOfEveryKind) {
  const auto bytes = load("volumes.gic");
  MemorySource source(bytes.span());
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto expected = golden::volumes_description();
  const ContainerDescription& found = reader->description();
  ASSERT_NO_FATAL_FAILURE(expect_same(found, expected));
  for (std::size_t i = 0; i < found.textures.size(); ++i) {
    EXPECT_EQ(is_known(found.textures[i]), is_known(expected.textures[i]));
  }
  std::map<std::uint64_t, Decoder> decoders;
  ContainerPacket packet;
  std::size_t packets = 0;
  for (; reader->next(packet) == Status::ok; ++packets) {
    const auto desc = golden::volumes_texture(found, packet.texture_id, packet.region);
    auto& decoder =
        decoders.try_emplace(region_key(packet.texture_id, packet.region), *Decoder::create(desc))
            .first->second;
    ASSERT_EQ(decoder.decode(packet.bytes), Status::ok) << packets;
    Texture painted(desc);
    golden::paint(painted, golden::volumes_step(packet.frame, packet.region));
    EXPECT_TRUE(contents(decoder) == painted.blocks()) << packets;
  }
  std::size_t each = 0;
  for (std::uint8_t id = 0; id < found.textures.size(); ++id) {
    each += std::max(1U, golden::volumes_regions(found, id));
  }
  EXPECT_EQ(packets, golden::kVolumesFrames * each);
  // Of one region from its keyframe on.
  const TextureRegion one{1, 3};
  ASSERT_EQ(reader->select({&one, 1}), Status::ok);
  ASSERT_EQ(reader->seek(2), Status::ok);
  for (const std::uint64_t frame : {0, 1, 2, 3}) {
    ASSERT_EQ(reader->next(packet), Status::ok);
    EXPECT_EQ(packet.frame, frame);
    EXPECT_EQ(packet.texture_id, 1);
    EXPECT_EQ(packet.region, 3U);
  }
  EXPECT_EQ(reader->next(packet), Status::end);
}

TEST(Golden, BlocksOfEveryShape) {
  for (const auto& [name, desc] : golden::block_textures()) {
    auto decoder = *Decoder::create(desc);
    const Bytes presence = golden::block_presence(desc);
    if (!presence.empty()) {
      ASSERT_EQ(decoder.set_presence(presence), Status::ok);
    }
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
      const auto file =
          load("blocks_" + std::string(name) + "_" + std::to_string(frame + 1) + ".packet");
      ASSERT_EQ(decoder.decode(file.span()), Status::ok) << name << frame;
      Texture painted(desc);
      golden::paint(painted, frame);
      Bytes expected = painted.blocks();
      const std::size_t bytes = desc.record.bytes;
      for (std::uint32_t i = 0; i < expected.size() / bytes; ++i) {
        const std::uint32_t records = record_count(desc.block);
        if (golden::exists(desc, presence, i / records, i % records)) continue;
        std::fill_n(expected.begin() + static_cast<std::ptrdiff_t>(i * bytes), bytes, std::byte{0});
      }
      EXPECT_TRUE(contents(decoder) == expected) << name << frame;
    }
  }
}

/// All blocks, those of native_selection(), and all, as `paint` has them.
void expect_native(const std::string& name, const ContainerDescription& description,
                   void (*paint)(Texture&, std::uint32_t)) {
  const auto bytes = load(name);
  MemorySource source(bytes.span());
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok()) << name << reader.status();
  const auto& textures = description.textures;
  ASSERT_EQ(reader->description().textures.size(), textures.size());
  std::vector<Decoder> decoders;
  for (const TextureEntry& texture : textures) decoders.push_back(*Decoder::create(texture.desc));
  for (std::uint32_t frame = 0; frame < golden::kNativeFrames; ++frame) {
    for (std::size_t i = 0; i < textures.size(); ++i) {
      const TextureDesc& desc = textures[i].desc;
      const std::string what = name + " frame " + std::to_string(frame) + " " + textures[i].name;
      EXPECT_EQ(reader->description().textures[i].desc, desc) << what;
      ContainerPacket packet;
      ASSERT_EQ(reader->next(packet), Status::ok) << what;
      ASSERT_EQ(decoders[i].decode(packet.bytes), Status::ok) << what;
      EXPECT_EQ(decoders[i].changed().size(),
                frame == 1 ? golden::native_selection(desc).size() : block_count(desc));
      Texture expected(desc), decoded(desc);
      paint(expected, frame);
      ASSERT_EQ(decoders[i].read(decoded.view()), Status::ok);
      for (const auto block : decoders[i].changed()) {
        EXPECT_TRUE(decoded.block(block) == expected.block(block)) << what << " " << block;
      }
    }
  }
}

TEST(Golden, NativePresets) {
  for (const std::string preset : {"fast", "strong", "turbo"}) {
    expect_native("native_" + preset + ".gic", probe_description(golden::native_textures()),
                  golden::paint_native);
  }
}

TEST(Golden, Maps) {
  for (const std::string preset : {"fast", "strong"})
    expect_native("maps_" + preset + ".gic", golden::maps_description(), golden::paint_map);
}

TEST(Golden, IndexModes) {
  for (const auto mode : golden::kIndexModes) {
    const auto packet = load("index_" + std::string(mode) + ".packet");
    auto decoder = *Decoder::create(golden::index_desc());
    ASSERT_EQ(decoder.decode(packet.span()), Status::ok) << mode;
    const auto blocks = golden::index_blocks(mode);
    EXPECT_EQ(listed_blocks(decoder, packet.span()), blocks) << mode;
    const auto records = contents(decoder);
    for (std::uint32_t block = 0; block < golden::kIndexBlocks; ++block) {
      const bool listed = std::binary_search(blocks.begin(), blocks.end(), block);
      const auto byte = static_cast<std::byte>(listed ? block + 1 : 0);
      EXPECT_EQ(records[2 * block], byte) << mode << " " << block;
      EXPECT_EQ(records[2 * block + 1], byte) << mode << " " << block;
    }
  }
}

constexpr std::pair<const char*, Status> kBadPackets[] = {
    {"bad_signature", Status::not_gicodec},
    {"bad_version", Status::unsupported_version},
    {"bad_flag", Status::unsupported_feature},
    {"bad_type", Status::unsupported_feature},
    {"bad_backend", Status::backend_missing},
    {"bad_sequence", Status::corrupt},
    {"bad_description", Status::description_mismatch},
    {"bad_checksum", Status::checksum_mismatch},
    {"bad_cut", Status::checksum_mismatch},
    {"bad_payload_head", Status::unsupported_feature},
    {"bad_difference", Status::corrupt},
    {"bad_payload_size", Status::corrupt},
    {"bad_block_count", Status::corrupt},
    {"bad_index_padding", Status::corrupt},
    {"bad_trailing_byte", Status::corrupt},
    {"bad_native_version", Status::unsupported_version},
    {"bad_native_box", Status::corrupt},
    {"bad_native_size", Status::corrupt},
    {"bad_native_kind", Status::corrupt},
    {"bad_native_lanes", Status::corrupt},
    {"bad_native_planes", Status::corrupt},
    {"bad_native_state", Status::corrupt},
    {"bad_native_end", Status::corrupt},
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

/// Status of opening or at the end, the number of packets before it, and whether it can seek.
struct Other {
  const char* name;
  Status status;
  std::size_t packets;
  bool seekable = false;
};
constexpr Other kContainers[] = {
    {"least", Status::ok, 0, true},
    {"regions", Status::ok, 2, true},
    {"lossy", Status::ok, 2, true},
    {"index", Status::ok, 2, true},
    {"index_order", Status::ok, 2},
    {"index_directory", Status::ok, 2},
    {"bad_index_place", Status::corrupt, 2},
    {"index_texture", Status::ok, 2},
    {"index_flags", Status::ok, 2},
    {"index_frame", Status::ok, 2, true},
    {"index_keyframe", Status::ok, 2, true},
    {"cut", Status::truncated, 3, true},
    {"skippable_entry", Status::ok, 4, true},
    {"newer_minor", Status::ok, 4, true},
    {"bad_mandatory_entry", Status::unsupported_feature, 0, true},
    {"bad_magic", Status::not_gicodec, 0},
    {"bad_major", Status::unsupported_version, 0},
    {"bad_features", Status::unsupported_feature, 0},
    {"bad_description", Status::checksum_mismatch, 0},
    {"bad_packet", Status::checksum_mismatch, 0, true},
    {"bad_no_volumes", Status::corrupt, 0},
    {"bad_no_textures", Status::corrupt, 0},
    {"bad_more_textures", Status::corrupt, 0},
    {"bad_texture_name", Status::corrupt, 0},
    {"bad_kind", Status::corrupt, 0},
    {"bad_format", Status::unsupported_format, 0},
    {"bad_record_gap", Status::corrupt, 0},
    {"bad_record_overlap", Status::corrupt, 0},
    {"bad_record_crossing", Status::corrupt, 0},
    {"bad_kind_rest", Status::corrupt, 0},
    {"bad_placed", Status::corrupt, 0},
    {"bad_spacing", Status::corrupt, 0},
    {"bad_region_size", Status::corrupt, 0},
    {"bad_tiling", Status::corrupt, 0},
    {"bad_padding", Status::corrupt, 0},
    {"bad_slots", Status::corrupt, 0},
    {"bad_error", Status::corrupt, 0},
    {"bad_error_sign", Status::corrupt, 0},
    {"bad_description_rest", Status::corrupt, 0},
    {"bad_region", Status::corrupt, 1, true},
    {"bad_region_zero", Status::corrupt, 1, true},
    {"bad_region_beyond", Status::corrupt, 1, true},
    {"bad_texture_id", Status::corrupt, 1, true},
    {"bad_frame_order", Status::corrupt, 1, true},
    {"bad_lossy", Status::corrupt, 1, true},
};

TEST(Golden, OtherContainers) {
  for (const auto& [name, status, packets, seekable] : kContainers) {
    const auto bytes = load(std::string(name) + ".gic");
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    if (!reader) {
      EXPECT_EQ(reader.status(), status) << name;
      EXPECT_EQ(packets, 0U) << name;
      continue;
    }
    EXPECT_EQ(reader->seekable(), seekable) << name;
    std::vector<ContainerPacket> found;
    EXPECT_EQ(read_all(*reader, found), status) << name;
    EXPECT_EQ(found.size(), packets) << name;
  }
}

// Whoever follows an index that lists other packets is told.
TEST(Golden, IndicesOfOtherPackets) {
  for (const char* name : {"index_frame", "index_keyframe"}) {
    const auto bytes = load(std::string(name) + ".gic");
    MemorySource source(bytes.span());
    auto reader = *ContainerReader::open(source);
    const TextureRegion only{0};
    ASSERT_EQ(reader.select({&only, 1}), Status::ok);
    ContainerPacket packet;
    ASSERT_EQ(reader.next(packet), Status::ok) << name;
    EXPECT_EQ(reader.next(packet), Status::corrupt) << name;
  }
}

// As C, Python and JavaScript do, each in its own tests.
TEST(Golden, ContainersHaveTheirHashes) {
  std::map<std::string, std::string> expected;
  std::ifstream list(folder() / "hashes.txt");
  for (std::string line; std::getline(list, line);) {
    expected[line.substr(0, line.find(' '))] += line + '\n';
  }
  std::size_t containers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    if (entry.path().extension() != ".gic") continue;
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(golden::lines_of(name, load(name).span()), expected[name]);
    ++containers;
  }
  EXPECT_EQ(containers, expected.size());
}

TEST(Golden, EveryFileIsTested) {
  std::set<std::string> known{"README.md",
                              "golden.h",
                              "native_golden.h",
                              "map_golden.h",
                              "make_golden.h",
                              "make_golden.cpp",
                              "damaged_packets.cpp",
                              "damaged_containers.cpp",
                              "native_fast.gic",
                              "native_strong.gic",
                              "native_turbo.gic",
                              "maps_fast.gic",
                              "maps_strong.gic",
                              "volumes.gic",
                              "hashes.h",
                              "hashes.txt"};
  for (const auto& [name, desc] : golden::block_textures()) {
    for (const char* number : {"_1", "_2"}) {
      known.insert("blocks_" + std::string(name) + number + ".packet");
    }
  }
  for (const char* backend : {"raw", "lz4", "zstd", "native"}) {
    known.insert(std::string("sequence_") + backend + ".gic");
  }
  for (const auto mode : golden::kIndexModes)
    known.insert("index_" + std::string(mode) + ".packet");
  for (const auto& bad : kBadPackets) known.insert(std::string(bad.first) + ".packet");
  for (const auto& container : kContainers) known.insert(std::string(container.name) + ".gic");
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    EXPECT_TRUE(known.contains(entry.path().filename().string())) << entry.path();
  }
}

}  // namespace
}  // namespace gicodec
