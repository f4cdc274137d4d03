// Containers in part: regions, unknown kinds, files that grow, indexes of many parts.
#include "container_support.h"

#include "base/bytes.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

std::vector<ContainerPacket> only(const Sample& sample, std::span<const TextureRegion> regions) {
  std::vector<ContainerPacket> packets;
  for (const ContainerPacket& packet : sample.packets) {
    const TextureRegion region{packet.texture_id, packet.region};
    if (std::find(regions.begin(), regions.end(), region) != regions.end()) {
      packets.push_back(packet);
    }
  }
  return packets;
}

TEST(ContainerAccess, ASelectionGivesItsPacketsOnly) {
  const auto sample = make_sample(1, 12);
  MemorySource memory(sample.bytes);
  PipeSource pipe(sample.bytes);
  const TextureRegion regions[] = {{2, 2}, {0}};
  for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
    auto reader = *ContainerReader::open(*source);
    for (const TextureRegion wrong :
         {TextureRegion{3}, TextureRegion{0, 0}, TextureRegion{2}, TextureRegion{2, 4}}) {
      EXPECT_EQ(reader.select(std::span(&wrong, 1)),
                wrong.texture_id == 3 ? Status::unknown_texture : Status::unknown_region);
    }
    ASSERT_EQ(reader.select(regions), Status::ok);
    std::vector<ContainerPacket> packets;
    ASSERT_EQ(read_all(reader, packets), Status::ok);
    EXPECT_TRUE(same_packets(packets, only(sample, regions)));
  }
  // Every one of them, every frame that has it, and everything again.
  ASSERT_EQ(memory.seek(0), Status::ok);
  auto reader = *ContainerReader::open(memory);
  for (const auto& [frame, states] : sample.frames) {
    for (const TextureRegion region :
         {TextureRegion{0}, TextureRegion{1}, TextureRegion{2, 1}, TextureRegion{2, 3}}) {
      ASSERT_EQ(reader.select(std::span(&region, 1)), Status::ok);
      ASSERT_EQ(reader.seek(frame), Status::ok);
      Player player;
      ASSERT_EQ(player.play(reader, frame), Status::ok);
      const std::uint64_t key = region_key(region.texture_id, region.region);
      ASSERT_EQ(player.states.size(), states.count(key));
      if (states.count(key) != 0) {
        EXPECT_EQ(player.states.at(key), states.at(key));
      }
    }
  }
  ASSERT_EQ(reader.select({}), Status::ok);
  ASSERT_EQ(reader.seek(0), Status::ok);
  std::vector<ContainerPacket> packets;
  ASSERT_EQ(read_all(reader, packets), Status::ok);
  EXPECT_TRUE(same_packets(packets, sample.packets));
}

TEST(ContainerAccess, ACornerCostsItsOwnBytes) {
  const auto description = sample_description();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  PacketMaker maker(description);
  Random random(2);
  const std::uint64_t head = writer.bytes_written();
  std::size_t own = 0;
  for (std::uint64_t frame = 0; frame < 40; ++frame) {
    for (std::uint32_t region = 0; region < 4; ++region) {
      const auto packet = maker.make(2, region, frame % 10 == 0, random, 5000);
      const std::uint64_t before = writer.bytes_written();
      ASSERT_EQ(writer.add(frame, packet, region), Status::ok);
      if (region == 2) own += writer.bytes_written() - before;
    }
  }
  const std::uint64_t packets_end = writer.bytes_written();
  ASSERT_EQ(writer.finish(), Status::ok);
  GrowingSource source(sink.bytes, sink.bytes.size());
  auto reader = *ContainerReader::open(source);
  const std::size_t opened = source.read_bytes;
  EXPECT_LE(opened, head + 2 * (sink.bytes.size() - packets_end));
  const TextureRegion corner{2, 2};
  ASSERT_EQ(reader.select(std::span(&corner, 1)), Status::ok);
  Player player;
  ASSERT_EQ(player.play(reader, kEnd), Status::ok);
  EXPECT_EQ(player.packets, 40U);
  // Behind them stand the end of the index part and the end entry.
  EXPECT_LE(source.read_bytes - opened, own + 64);
  // A late frame costs the packets since the corner's own keyframe.
  source.read_bytes = 0;
  ASSERT_EQ(reader.seek(35), Status::ok);
  Player late;
  ASSERT_EQ(late.play(reader, 35), Status::ok);
  EXPECT_EQ(late.packets, 6U);
  EXPECT_LE(source.read_bytes, own * 7 / 40 + 64);
}

Status write_kind(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.groups.size() != 2) return Status::invalid_description;
  ByteWriter(out).varint(volume.groups[0].textures[0].desc.grid.x);
  return Status::ok;
}

Result<VolumeDesc> read_kind(std::span<const std::byte> description) {
  ByteReader reader(description);
  const auto slots = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  if (!reader.ok() || !reader.rest().empty()) return Status::corrupt;
  TextureDesc pool;
  pool.record = Format::R32_UINT;
  pool.grid = {slots, 1, 1};
  pool.space = Space::pool;
  pool.model = Model::none;
  VolumeDesc volume{200, {{}, {}}};
  volume.groups[0].textures = {{"ids", pool, Threshold::exact, {}}};
  pool.grid.x = 2 * slots;
  pool.block = {4, 1, 1};
  volume.groups[1].textures = {{"values", pool, {}, {}}};
  return volume;
}

const Kind kPools{200, "pools", write_kind, read_kind, nullptr};
const Kind* const kOwnKinds[] = {&kPools};

VolumeDesc pools() { return *read_kind(Bytes{std::byte{10}}); }

/// A volume of a kind that only some know, between two of known ones.
ContainerDescription with_pools() {
  ContainerDescription description = sample_description();
  EXPECT_EQ(add_volume(description, "pools", pools(), kOwnKinds), Status::ok);
  VolumeEntry& volume = description.volumes.back();
  volume.geometry = VolumeGeometry{{10, 1, 1}, {1, 2, 3}, {1, 1, 2}, {0, -4, 5}};
  volume.region = {4, 1, 1};
  volume.metadata = {{"of", "pools"}};
  description.textures[4].largest_error = 3;
  description.textures[4].desc.layout.slots = {5, 4, 1};
  EXPECT_EQ(add_volume(description, "", sample_description().volumes[0].desc), Status::ok);
  return description;
}

TEST(ContainerAccess, UnknownKindsAreListedCopiedAndChecked) {
  const auto description = with_pools();
  EXPECT_EQ(find_kind(std::uint8_t{200}), nullptr);
  auto again = description;
  EXPECT_EQ(add_volume(again, "pools", pools()), Status::unknown_kind);
  EXPECT_EQ(again.volumes.size(), description.volumes.size());

  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description, kOwnKinds);
  PacketMaker maker(description);
  Random random(3);
  const TextureRegion regions[] = {{0}, {3, 0}, {3, 2}, {4, 4}, {5}};
  for (std::uint64_t frame = 0; frame < 6; ++frame) {
    for (const auto& [id, region] : regions) {
      ASSERT_EQ(
          writer.add(frame, maker.make(id, region, frame % 3 == 0, random, 9, id == 4), region),
          Status::ok);
    }
  }
  EXPECT_EQ(writer.add(9, maker.make(3, 2, false, random), 3), Status::unknown_region);
  ASSERT_EQ(writer.finish(), Status::ok);

  // Listed: by those who know the kind and by those who do not.
  for (const bool known : {false, true}) {
    MemorySource source(sink.bytes);
    const auto kinds =
        known ? std::span<const Kind* const>(kOwnKinds) : std::span<const Kind* const>();
    auto reader = *ContainerReader::open(source, {}, kinds);
    const ContainerDescription& read = reader.description();
    ASSERT_EQ(read.volumes.size(), 4U);
    ASSERT_EQ(read.textures.size(), 7U);
    const VolumeEntry& volume = read.volumes[2];
    EXPECT_EQ(volume.name, "pools");
    EXPECT_EQ(volume.kind, 200);
    EXPECT_EQ(volume.description, Bytes{std::byte{10}});
    EXPECT_EQ(volume.region, (Grid{4, 1, 1}));
    EXPECT_EQ(volume.first_texture, 3U);
    EXPECT_EQ(volume.textures, 2U);
    EXPECT_EQ(volume.metadata, description.volumes[2].metadata);
    ASSERT_TRUE(volume.geometry.has_value());
    EXPECT_EQ(volume.geometry->scroll, (Scroll{0, -4, 5}));
    EXPECT_EQ(volume.geometry->grid, known ? (Grid{10, 1, 1}) : Grid{});
    EXPECT_EQ(volume.desc.groups.size(), known ? 2U : 0U);
    EXPECT_EQ(read.textures[3].name, "ids");
    for (std::size_t id = 0; id < 7; ++id) {
      const bool own = id == 3 || id == 4;
      EXPECT_EQ(is_known(read.textures[id]), known || !own) << id;
      EXPECT_EQ(validate(read.textures[id].desc) == Status::ok, known || !own) << id;
      EXPECT_EQ(read.textures[id].desc.layout, description.textures[id].desc.layout);
    }

    // Checked and copied: the same file again.
    MemorySink copy;
    auto copying = ContainerWriter::create(copy, read, kinds);
    ASSERT_TRUE(copying.ok()) << copying.status();
    for (ContainerPacket packet;;) {
      const Status status = reader.next(packet);
      if (status == Status::end) break;
      ASSERT_EQ(status, Status::ok);
      ASSERT_EQ(copying->add(packet.frame, packet.bytes, packet.region), Status::ok);
    }
    ASSERT_EQ(copying->finish(), Status::ok);
    EXPECT_EQ(copy.bytes, sink.bytes);
    Player player;
    ASSERT_EQ(reader.seek(5), Status::ok);
    EXPECT_EQ(player.play(reader, kEnd), Status::ok);
    EXPECT_EQ(player.packets, std::size(regions) * 3);
  }
}

TEST(ContainerAccess, KindsThatCannotBeReadOrWrittenAreUnknown) {
  const Kind readless{200, "pools", write_kind, nullptr, nullptr};
  const Kind writeless{200, "pools", nullptr, read_kind, nullptr};
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, with_pools(), kOwnKinds);
  ASSERT_EQ(writer.finish(), Status::ok);
  for (const Kind* half : {&readless, &writeless}) {
    const Kind* const kinds[] = {nullptr, half};
    EXPECT_EQ(find_kind(std::uint8_t{200}, kinds), nullptr);
    EXPECT_EQ(find_kind("pools", kinds), nullptr);
    ContainerDescription description;
    EXPECT_EQ(add_volume(description, "pools", pools(), kinds), Status::unknown_kind);
    MemorySource source(sink.bytes);
    const auto reader = ContainerReader::open(source, {}, kinds);
    ASSERT_TRUE(reader.ok());
    EXPECT_FALSE(is_known(reader->description().textures[3]));
    // One that can do both stands behind it.
    const Kind* const both[] = {half, &kPools};
    EXPECT_EQ(find_kind(std::uint8_t{200}, both), &kPools);
  }
}

TEST(ContainerAccess, VolumesThatDifferInLayoutsOnly) {
  const VolumeDesc volume = pools();
  const auto same = [&](const auto& change) {
    VolumeDesc other = volume;
    change(other);
    EXPECT_EQ(same_but_layout(other, volume), same_but_layout(volume, other));
    return same_but_layout(volume, other);
  };
  EXPECT_TRUE(same([](VolumeDesc&) {}));
  EXPECT_TRUE(same([](VolumeDesc& v) { v.groups[1].textures[0].desc.layout.slots = {5, 4, 1}; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.kind = 201; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups.pop_back(); }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].bundled = true; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].presence = 0; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[1].depends_on = 0; }));
  EXPECT_FALSE(same([](VolumeDesc& v) {
    v.groups[1].dependencies = [](std::span<const std::byte>,
                                  std::span<std::uint32_t>) -> std::size_t { return 0; };
  }));
  EXPECT_FALSE(same(
      [](VolumeDesc& v) { v.groups[1].rank = [](std::span<const std::byte>) { return 1.0F; }; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].textures.clear(); }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].textures[0].name = "numbers"; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].textures[0].desc.grid.x = 11; }));
  EXPECT_FALSE(
      same([](VolumeDesc& v) { v.groups[0].textures[0].threshold = Threshold::components; }));
  EXPECT_FALSE(same([](VolumeDesc& v) { v.groups[0].textures[0].preview = Preview::color; }));
}

TEST(ContainerAccess, AFileThatGrows) {
  const auto sample = make_sample(4, 10);
  const std::size_t head = head_of(sample.description).size();
  GrowingSource source(sample.bytes, head - 1);
  EXPECT_EQ(ContainerReader::open(source).status(), Status::truncated);
  ASSERT_EQ(source.seek(0), Status::ok);
  source.visible = head;
  auto reader = *ContainerReader::open(source);
  EXPECT_TRUE(reader.seekable());
  EXPECT_EQ(reader.seek(0), Status::unknown_frame);  // No frame yet.
  std::vector<ContainerPacket> packets;
  while (source.visible < sample.bytes.size()) {
    ++source.visible;
    const Status status = read_all(reader, packets);
    ASSERT_EQ(status, source.visible < sample.bytes.size() ? Status::truncated : Status::ok);
    const auto whole = std::upper_bound(sample.ends.begin(), sample.ends.end(), source.visible) -
                       sample.ends.begin();
    ASSERT_EQ(packets.size(), static_cast<std::size_t>(whole)) << source.visible;
    ASSERT_EQ(reader.finished(), status == Status::ok);
  }
  EXPECT_TRUE(same_packets(packets, sample.packets));
}

/// Whoever opens it while it grows can seek, whatever has been listed of it.
TEST(ContainerAccess, SeekingInAFileThatGrows) {
  for (const std::uint32_t flush : {0U, 1U, 4U}) {
    const auto sample = make_sample(5, 12, 3, flush);
    for (std::size_t cut = 0; cut < sample.ends.size(); ++cut) {
      for (const std::size_t torn : {0, 1, 30}) {
        const auto visible = std::min<std::size_t>(
            static_cast<std::size_t>(sample.ends[cut]) + torn, sample.bytes.size() - 1);
        GrowingSource source(sample.bytes, visible);
        auto reader = *ContainerReader::open(source);
        ASSERT_TRUE(reader.seekable());
        ASSERT_FALSE(reader.finished());
        const std::uint64_t last = sample.packets[cut].frame;
        // Frames before the one that is cut are whole.
        for (const auto& [frame, states] : sample.frames) {
          if (frame >= last) break;
          ASSERT_EQ(reader.seek(frame), Status::ok);
          Player player;
          ASSERT_EQ(player.play(reader, frame), Status::ok);
          ASSERT_EQ(player.states, states) << frame;
        }
        // The rest comes later; a selection finds it, too.
        source.visible = sample.bytes.size();
        const TextureRegion wanted{2, 2};
        ASSERT_EQ(reader.select(std::span(&wanted, 1)), Status::ok);
        const auto& [frame, states] = *sample.frames.rbegin();
        ASSERT_EQ(reader.seek(frame), Status::ok);
        Player player;
        ASSERT_EQ(player.play(reader, frame), Status::ok);
        ASSERT_EQ(player.states.at(region_key(2, 2)), states.at(region_key(2, 2)));
        ASSERT_TRUE(reader.finished());
      }
    }
  }
}

/// A part that was listed once is not read again, nor is what stands before it.
TEST(ContainerAccess, AGrownFileCostsWhatIsNew) {
  const auto description = sample_description();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  PacketMaker maker(description);
  Random random(6);
  std::vector<std::size_t> sizes;
  for (std::uint64_t frame = 0; frame < 60; ++frame) {
    ASSERT_EQ(writer.add(frame, maker.make(0, kWhole, frame % 5 == 0, random, 4000)), Status::ok);
    if (frame == 39) {
      ASSERT_EQ(writer.flush(), Status::ok);
    }
    sizes.push_back(sink.bytes.size());
  }
  GrowingSource source(sink.bytes, sizes[49]);
  auto reader = *ContainerReader::open(source);
  EXPECT_LE(source.read_bytes, sizes[49] - sizes[39] + (std::size_t{100} << 10));
  source.read_bytes = 0;
  ASSERT_EQ(reader.seek(45), Status::ok);
  EXPECT_LE(source.read_bytes, sizes[49] - sizes[39] + 100);
  source.visible = sizes[54];
  source.read_bytes = 0;
  ASSERT_EQ(reader.seek(54), Status::ok);
  EXPECT_LE(source.read_bytes, sizes[54] - sizes[49] + 100);
  // What was read in order need not be read again.
  source.visible = sizes[59];
  Player player;
  ASSERT_EQ(player.play(reader, kEnd), Status::truncated);
  source.read_bytes = 0;
  ASSERT_EQ(reader.seek(59), Status::ok);
  EXPECT_LE(source.read_bytes, 100U);
}

TEST(ContainerAccess, FilesOfStdioThatGrow) {
  const auto sample = make_sample(7, 6);
  const std::string name =
      testing::TempDir() + "gicodec-growing-" + std::to_string(std::random_device()());
  std::FILE* writing = std::fopen(name.c_str(), "wb");
  ASSERT_NE(writing, nullptr);
  FileSink sink(writing);
  const std::size_t head = head_of(sample.description).size();
  ASSERT_EQ(sink.write(std::span(sample.bytes).first(head + 1)), Status::ok);
  std::FILE* reading = std::fopen(name.c_str(), "rb");
  ASSERT_NE(reading, nullptr);
  FileSource source(reading);
  auto reader = *ContainerReader::open(source);
  std::vector<ContainerPacket> packets;
  for (std::size_t at = head + 1; at < sample.bytes.size();) {
    ASSERT_EQ(read_all(reader, packets), Status::truncated);
    const std::size_t size = std::min<std::size_t>(37, sample.bytes.size() - at);
    ASSERT_EQ(sink.write(std::span(sample.bytes).subspan(at, size)), Status::ok);
    at += size;
  }
  ASSERT_EQ(read_all(reader, packets), Status::ok);
  EXPECT_TRUE(same_packets(packets, sample.packets));
  EXPECT_EQ(source.size(), std::optional<std::uint64_t>(sample.bytes.size()));
  std::fclose(reading);
  std::fclose(writing);
  std::remove(name.c_str());
}

TEST(ContainerAccess, IndexesOfManyParts) {
  const auto description = sample_description();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  PacketMaker maker(description);
  Random random(8);
  std::uint64_t frame = 0;
  for (std::size_t i = 0; i < 2 * kPartPackets + 500; ++i) {
    frame += i % 3 == 0 ? 1 : 0;
    const auto region = static_cast<std::uint32_t>(i % 3);
    const bool keyframe = i % 90 < 3;
    ASSERT_EQ(writer.add(frame, maker.make(2, region, keyframe, random, 2), region), Status::ok);
  }
  const std::uint64_t before = writer.bytes_written();
  ASSERT_EQ(writer.finish(), Status::ok);
  // Only the last 500 are listed at the end.
  EXPECT_LE(writer.bytes_written() - before, 500 * 6 + 60);
  const auto count = [&](Source& source, const DecodeLimits& limits = {}) {
    auto reader = *ContainerReader::open(source, limits);
    if (!reader.seekable()) return std::size_t{0};
    EXPECT_EQ(reader.seek(frame), Status::ok);
    Player player;
    EXPECT_EQ(player.play(reader, kEnd), reader.finished() ? Status::ok : Status::truncated);
    EXPECT_EQ(player.states, maker.states());
    return player.packets;
  };
  MemorySource source(sink.bytes);
  const std::size_t few = count(source);
  EXPECT_GT(few, 0U);
  EXPECT_LE(few, 90U);
  // What is held at once keeps to the limit.
  DecodeLimits limits;
  limits.max_index_bytes = 2000;
  MemorySource again(sink.bytes);
  EXPECT_EQ(count(again, limits), 0U);
  // Cut anywhere in what is behind the first part, it is found again.
  for (std::size_t cut = static_cast<std::size_t>(before); cut < sink.bytes.size(); cut += 11) {
    GrowingSource growing(sink.bytes, cut);
    EXPECT_EQ(count(growing), few) << cut;
  }
}

}  // namespace
}  // namespace gicodec
