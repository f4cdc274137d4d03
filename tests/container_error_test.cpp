// Containers made to do harm: damaged, forged, and read through failing sources.
#include "container_support.h"

#include "base/bytes.h"
#include "bitstream/container_format.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

Bytes part_entry(const IndexPart& part, std::uint64_t offset) {
  Bytes body;
  write_index_part(part, offset, body);
  return entry(3, body);
}
Bytes part_entry(std::span<const SeekEntry> packets, std::uint64_t offset) {
  return part_entry(IndexPart{{packets.begin(), packets.end()}, {}, 0, {}}, offset);
}

/// A sample of one index part: what stands before it.
Bytes before_index(const Sample& sample) {
  return {sample.bytes.begin(),
          sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.parts.front())};
}

/// A file of what stands before the index, one part with these packets, and the end.
Bytes with_index(const Sample& sample, std::span<const SeekEntry> packets) {
  const std::uint64_t at = sample.parts.front();
  return before_index(sample) + part_entry(packets, at) + end_entry(at);
}

/// Seeks to every frame: what is decoded is right, or it is refused.
void expect_right_or_refused(ContainerReader& reader, const Sample& sample) {
  for (const auto& [frame, states] : sample.frames) {
    if (reader.seek(frame) != Status::ok) continue;
    Player player;
    const Status status = player.play(reader, frame);
    ASSERT_TRUE(status != Status::ok || player.states == states) << frame;
  }
}

TEST(HostileContainer, EverySingleBitFlipIsNoticed) {
  const auto sample = make_sample(1, 5, 4, 2);
  ASSERT_EQ(sample.parts.size(), 3U);
  for (std::size_t bit = 0; bit < sample.bytes.size() * 8; ++bit) {
    const std::size_t at = bit / 8;
    const Exact bytes{flip_bit(sample.bytes, bit)};
    const bool minor_version = at == 9;
    bool in_index = false;
    for (const std::uint64_t part : sample.parts) {
      const auto next = std::upper_bound(sample.ends.begin(), sample.ends.end(), part);
      const std::uint64_t last = sample.end_offset;
      const std::uint64_t end =
          next == sample.ends.end()
              ? last
              : *next -
                    packet_of(sample, static_cast<std::size_t>(next - sample.ends.begin())).size();
      in_index |= at >= part && at < end;
    }
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    if (!reader) {
      ASSERT_LT(at, sample.ends[0]);
      continue;
    }
    if (!in_index) {
      ASSERT_TRUE(reader->seekable()) << bit;
    }
    ASSERT_EQ(reader->finished(), at < sample.end_offset) << bit;
    std::vector<ContainerPacket> packets;
    const Status status = read_all(*reader, packets);
    const bool harmless = minor_version || (in_index && status == Status::ok);
    ASSERT_EQ(status == Status::ok, harmless) << bit;
    // Everything before the damage was delivered, and nothing else.
    const auto sound = std::upper_bound(sample.ends.begin(), sample.ends.end(), at);
    const auto expected =
        harmless ? sample.packets.size() : static_cast<std::size_t>(sound - sample.ends.begin());
    ASSERT_TRUE(same_packets(packets, std::span(sample.packets).first(expected))) << bit;
    expect_right_or_refused(*reader, sample);
    // A part is read by those who seek, and then the index is none.
    ASSERT_EQ(reader->seekable(), !in_index) << bit;
    PipeSource pipe(bytes.span());
    std::vector<ContainerPacket> piped;
    auto in_order = *ContainerReader::open(pipe);
    ASSERT_EQ(read_all(in_order, piped) == Status::ok, harmless) << bit;
    ASSERT_TRUE(same_packets(piped, packets));
  }
}

TEST(HostileContainer, Headers) {
  const auto sample = make_sample(2, 2);
  const auto with = [&](std::size_t at, int value) {
    auto bytes = sample.bytes;
    bytes[at] = static_cast<std::byte>(value);
    return read_through(bytes);
  };
  EXPECT_EQ(read_through({}), Status::truncated);
  EXPECT_EQ(read_through(std::as_bytes(std::span("EXR"))), Status::not_gicodec);
  EXPECT_EQ(read_through(std::as_bytes(std::span("a longer text file"))), Status::not_gicodec);
  EXPECT_EQ(with(0, 'x'), Status::not_gicodec);
  EXPECT_EQ(with(8, 2), Status::unsupported_version);
  EXPECT_EQ(with(9, 77), Status::ok);
  EXPECT_EQ(with(10, 1), Status::unsupported_feature);
  EXPECT_EQ(with(11, 0x80), Status::unsupported_feature);
}

TEST(HostileContainer, UnknownEntries) {
  const auto sample = make_sample(3, 2);
  const auto head = head_of(sample.description);
  const auto first = packet_entry(sample.packets[0]);
  const auto second = packet_entry(sample.packets[1]);
  const Bytes some(50, std::byte{9});
  const auto end = end_entry(0);
  EXPECT_EQ(read_through(head + first + second + end), Status::ok);
  for (const int type : {0x80, 0xFF}) {
    const auto skippable = entry(static_cast<std::uint8_t>(type), some);
    EXPECT_EQ(read_through(head + skippable + first + skippable + second + end), Status::ok);
    EXPECT_EQ(read_through(head + skippable + first + skippable, true), Status::truncated);
  }
  for (const int type : {0, 1, 6, 0x7F}) {
    const auto mandatory = entry(static_cast<std::uint8_t>(type), some);
    EXPECT_EQ(read_through(head + first + mandatory + end), Status::unsupported_feature) << type;
  }
  // Whatever follows the end entry is not looked at.
  EXPECT_EQ(read_through(head + end + some), Status::ok);
  EXPECT_EQ(read_through(head + first + second + end + some, true), Status::ok);
  // The description must come first.
  const Bytes magic(head.begin(), head.begin() + kFileHeader);
  EXPECT_EQ(read_through(magic + first), Status::corrupt);
  EXPECT_EQ(read_through(magic + entry(0x80, some)), Status::corrupt);
}

TEST(HostileContainer, EndsAndIndicesOutOfForm) {
  const auto sample = make_sample(11, 2);
  const auto head = head_of(sample.description);
  const auto first = packet_entry(sample.packets[0]);
  const auto end = end_entry(0);
  const std::uint64_t at = head.size() + first.size();
  const std::vector<SeekEntry> none;
  const auto index = part_entry(none, at);
  IndexPart astray;
  astray.directory = kEnd;
  for (const bool pipe : {false, true}) {
    EXPECT_EQ(read_through(head + first + index + end, pipe), Status::ok);
    EXPECT_EQ(read_through(head + first + index + part_entry(none, at + index.size()) + end, pipe),
              Status::ok);
    // What it says matters to nobody who reads in order; that it is one does.
    EXPECT_EQ(read_through(head + first + part_entry(astray, at) + end, pipe), Status::ok);
    EXPECT_EQ(read_through(head + first + part_entry(none, at + 1) + end, pipe), Status::corrupt);
    for (const std::size_t size : {0U, 15U, 16U, 30U}) {
      EXPECT_EQ(read_through(head + first + entry(3, Bytes(size)) + end, pipe), Status::corrupt);
    }
    for (const std::size_t size : {0U, 7U, 9U}) {
      EXPECT_EQ(read_through(head + first + entry(4, Bytes(size)), pipe), Status::corrupt) << size;
    }
  }
}

TEST(HostileContainer, PacketEntries) {
  const auto sample = make_sample(4, 3);
  const auto head = head_of(sample.description);
  const auto with = [&](auto change) {
    auto packet = sample.packets[0];
    change(packet);
    return read_through(head + packet_entry(packet) + end_entry(0));
  };
  EXPECT_EQ(with([](auto&) {}), Status::ok);
  EXPECT_EQ(read_through(head + entry(2, {})), Status::corrupt);
  EXPECT_EQ(with([](auto& p) { p.bytes = {}; }), Status::corrupt);
  EXPECT_EQ(with([](auto& p) { p.bytes = Bytes(30); }), Status::not_gicodec);
  EXPECT_EQ(with([](auto& p) { p.bytes[3] = std::byte{3}; }), Status::corrupt);  // No such texture.
  EXPECT_EQ(with([](auto& p) { p.region = 0; }), Status::corrupt);
  EXPECT_EQ(with([](auto& p) { p.region = kMaxBlocks; }), Status::corrupt);
  EXPECT_EQ(with([](auto& p) { p.bytes[1] |= std::byte{8}; }), Status::corrupt);  // Lossy.
  const auto in_region = [&](std::uint32_t region) {
    return with([&](auto& p) {
      p.bytes[3] = std::byte{2};
      p.region = region;
    });
  };
  EXPECT_EQ(in_region(StreamId::kWholeVolume), Status::corrupt);
  EXPECT_EQ(in_region(0), Status::ok);
  EXPECT_EQ(in_region(3), Status::ok);
  EXPECT_EQ(in_region(4), Status::corrupt);
  auto late = sample.packets[0], early = sample.packets[1];
  late.frame = 5;
  early.frame = 4;
  EXPECT_EQ(read_through(head + packet_entry(late) + packet_entry(early)), Status::corrupt);
}

TEST(HostileContainer, FalseLengthsCostNothing) {
  const auto head = head_of(sample_description());
  for (const std::uint64_t length :
       {std::uint64_t{1} << 29, std::uint64_t{1} << 30, (std::uint64_t{1} << 30) + 1,
        std::uint64_t{1} << 40, kEnd - 16, kEnd - 4, kEnd - 3, kEnd - 1, kEnd}) {
    for (const int type : {1, 2, 3, 5, 0x80}) {
      Bytes lying;
      ByteWriter writer(lying);
      writer.fixed(static_cast<std::uint8_t>(type));
      writer.varint(length);
      lying.resize(lying.size() + 100);
      const auto file = head + lying;
      for (const bool unlimited : {false, true}) {
        DecodeLimits limits;
        if (unlimited) {
          limits.max_packet_bytes = limits.max_index_bytes = limits.max_description_bytes =
              limits.max_metadata_bytes = kEnd;
        }
        PipeSource pipe(file);
        GrowingSource memory(file, file.size());
        for (Source* source : {static_cast<Source*>(&pipe), static_cast<Source*>(&memory)}) {
          auto reader = ContainerReader::open(*source, limits);
          ASSERT_TRUE(reader.ok());
          ContainerPacket packet;
          const auto status = reader->next(packet);
          EXPECT_TRUE(status == Status::truncated ||
                      (!unlimited && status == Status::limit_exceeded))
              << length;
        }
        EXPECT_LE(pipe.largest, std::size_t{64} << 10);  // Read in steps, and one was enough.
        EXPECT_LE(memory.read_bytes, 3 * file.size());
      }
    }
  }
  Bytes endless(head);
  endless.resize(endless.size() + 30, std::byte{0xFF});
  EXPECT_EQ(read_through(endless), Status::corrupt);
}

TEST(HostileContainer, Limits) {
  const auto sample = make_sample(6, 3);
  const auto with = [&](auto change) {
    DecodeLimits limits;
    change(limits);
    return read_through(sample.bytes, false, limits);
  };
  EXPECT_EQ(with([](auto&) {}), Status::ok);
  EXPECT_EQ(with([](auto& l) { l.max_textures = 2; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_texture_bytes = 100; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_description_bytes = 20; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_packet_bytes = 20; }), Status::limit_exceeded);
  DecodeLimits no_index;
  no_index.max_index_bytes = 30;
  MemorySource source(sample.bytes);
  auto reader = ContainerReader::open(source, no_index);
  ASSERT_TRUE(reader.ok());
  EXPECT_FALSE(reader->seekable());
  std::vector<ContainerPacket> packets;
  EXPECT_EQ(read_all(*reader, packets), Status::ok);
  // What is listed for want of parts keeps to it, too: 30 bytes would be six packets.
  GrowingSource growing(sample.bytes, static_cast<std::size_t>(sample.parts[0]));
  auto listing = *ContainerReader::open(growing, no_index);
  ASSERT_TRUE(listing.seekable());
  EXPECT_EQ(listing.seek(sample.packets[5].frame), Status::ok);
  EXPECT_EQ(listing.seek(sample.packets.back().frame), Status::unknown_frame);
}

TEST(HostileContainer, AWrongIndexIsNoIndex) {
  const auto sample = make_sample(8, 6, 4, 0);
  const auto index = index_of(sample);
  ASSERT_TRUE(with_index(sample, index) == sample.bytes);
  const std::uint64_t at = sample.parts.front();
  const auto seekable = [&](const Bytes& file) {
    const Exact bytes{std::span(file)};
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    EXPECT_TRUE(reader.ok());
    std::vector<ContainerPacket> packets;
    EXPECT_EQ(read_all(*reader, packets), Status::ok);
    EXPECT_TRUE(same_packets(packets, sample.packets));
    return reader->seekable();
  };
  const Bytes before = before_index(sample), part = part_entry(index, at);
  for (const std::uint64_t wrong :
       {std::uint64_t{1}, std::uint64_t{20}, at - 1, at + 1, kEnd, kEnd - 8}) {
    EXPECT_FALSE(seekable(before + part + end_entry(wrong))) << wrong;
  }
  // None is told: all packets are found one by one.
  EXPECT_TRUE(seekable(before + part + end_entry(0)));
  // A directory that is none, or the part itself, or one behind it, or not listed first.
  for (const std::uint64_t wrong : {std::uint64_t{1}, index[2].offset, at - 1, at, at + 1, kEnd}) {
    IndexPart told{index, {}, wrong, {}};
    EXPECT_FALSE(seekable(before + part_entry(told, at) + end_entry(at))) << wrong;
    told.parts = {{wrong, 40, 0, {}}};
    EXPECT_FALSE(seekable(before + part_entry(told, at) + end_entry(at))) << wrong;
  }
  // It needs a part, and there is none.
  const IndexPart needy{index, {{1, 1}}, 0, {}};
  EXPECT_FALSE(seekable(before + part_entry(needy, at) + end_entry(at)));
  const auto with = [&](auto change) {
    auto wrong = index;
    change(wrong);
    return seekable(with_index(sample, wrong));
  };
  EXPECT_TRUE(with([](auto&) {}));
  EXPECT_FALSE(with([](auto& i) { i[1].texture_id = 3; }));
  EXPECT_FALSE(with([](auto& i) { i[0].region = 0; }));
  EXPECT_FALSE(with([](auto& i) { i[2].region = 4; }));
  EXPECT_FALSE(with([](auto& i) { i[0].offset = 5; }));            // The header.
  EXPECT_FALSE(with([](auto& i) { i[1].offset = i[0].offset; }));  // Twice.
  EXPECT_FALSE(with([&](auto& i) { i.back().offset = at; }));      // The index.
  EXPECT_FALSE(with([](auto& i) { i.back().offset = kEnd; }));
  Bytes body;
  write_index_part({index, {}, 0, {}}, at, body);
  for (std::size_t size = 0; size + kIndexTail < body.size(); ++size) {
    Bytes cut(body.begin(), body.begin() + static_cast<std::ptrdiff_t>(size));
    cut.insert(cut.end(), body.end() - kIndexTail, body.end());
    EXPECT_FALSE(seekable(before + entry(3, cut) + end_entry(at))) << size;
  }
  // Offsets into the middle of an entry: seeking or reading says so, and nothing worse.
  for (std::size_t bit = 0; bit < (body.size() - kIndexTail) * 8; ++bit) {
    const Exact file{before + entry(3, flip_bit(body, bit)) + end_entry(at)};
    MemorySource source(file.span());
    auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok());
    for (std::uint64_t frame = 0; frame < 8 && reader->seekable(); ++frame) {
      if (reader->seek(frame) != Status::ok) continue;
      Player player;
      (void)player.play(*reader, kEnd);
    }
  }
}

/// A directory says where parts are, in order, and what a reader needs of them.
TEST(HostileContainer, PartsThatLie) {
  const auto sample = make_sample(12, 6, 4, 2);
  const auto index = index_of(sample);
  const Bytes before(sample.bytes.begin(),
                     sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.parts[1]));
  const std::uint64_t first = sample.parts[0], second = sample.parts[1];
  IndexPart honest;
  std::uint64_t size = 0;
  for (const SeekEntry& packet : index) {
    if (packet.offset < first || packet.offset > second) continue;
    if (size == 0) size = packet.offset - first;
    honest.packets.push_back(packet);
  }
  honest.needs = {{1, 1}};
  honest.parts = {{first, size, index.front().frame, {}}};
  // Found when it is opened, or by those who seek to the first part.
  const auto sought = [&](auto change) {
    IndexPart part = honest;
    change(part);
    const Bytes file = before + part_entry(part, second) + end_entry(second);
    MemorySource source(file);
    auto reader = *ContainerReader::open(source);
    const bool found = reader.seek(index.front().frame) == Status::ok;
    EXPECT_EQ(found, reader.seekable());
    std::vector<ContainerPacket> packets;
    EXPECT_EQ(read_all(reader, packets), Status::ok);
    EXPECT_FALSE(packets.empty());
    return found;
  };
  EXPECT_TRUE(sought([](auto&) {}));
  for (const std::uint64_t wrong : {first - 1, first + 1, second, second + 1, kEnd}) {
    EXPECT_FALSE(sought([&](auto& part) { part.parts[0].offset = wrong; })) << wrong;
  }
  for (const std::uint64_t wrong : {std::uint64_t{0}, size - 1, size + 1, second, kEnd}) {
    EXPECT_FALSE(sought([&](auto& part) { part.parts[0].size = wrong; })) << wrong;
  }
  EXPECT_FALSE(sought([](auto& part) { ++part.parts[0].frame; }));
  EXPECT_FALSE(sought([](auto& part) { part.parts[0].frame = kEnd; }));
  EXPECT_FALSE(sought([](auto& part) { part.parts[0].needs = {{1, 1}}; }));
  for (const PartRun run : {PartRun{2, 1}, {1, 2}, {kEnd, 1}, {1, kEnd}, {0, 1}, {1, 0}}) {
    EXPECT_FALSE(sought([&](auto& part) { part.needs = {run}; })) << run.gap;
  }
  EXPECT_FALSE(sought([&](auto& part) { part.needs.assign(kMaxPartRuns + 1, {1, 1}); }));
  EXPECT_FALSE(sought([&](auto& part) { part.parts.push_back(part.parts[0]); }));
  // A part lists what stands behind the one before it, in frames that do not decrease.
  EXPECT_FALSE(sought([&](auto& part) { part.packets = index; }));
  EXPECT_FALSE(sought([](auto& part) {
    for (SeekEntry& packet : part.packets) packet.frame = 0;
    part.parts[0].frame = 1;
  }));
  // It may list as many parts as the limit of bytes allows.
  std::vector<std::byte> body;
  write_index_part(honest, second, body);
  const auto rules = packet_rules(sample.description);
  EXPECT_TRUE(read_index_part(body, rules, 0, second, 1).ok());
  EXPECT_EQ(read_index_part(body, rules, 0, second, 0).status(), Status::corrupt);
  // The directory is another part, which may be none.
  EXPECT_TRUE(sought([&](auto& part) { part.directory = first; }));
  EXPECT_FALSE(sought([&](auto& part) { part.directory = index.front().offset; }));
  // Many places that look like the end of a part cost no more than a few looks.
  Bytes marks;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    ByteWriter writer(marks);
    writer.fixed(head_of(sample.description).size() + i);
    writer.bytes(std::as_bytes(std::span(kIndexMark)));
  }
  const Bytes file = before + entry(0x80, marks);
  GrowingSource source(file, file.size());
  auto reader = *ContainerReader::open(source);
  EXPECT_LE(source.read_bytes, 2 * file.size());
  EXPECT_FALSE(reader.finished());
  const auto frames = reader.frames();  // found front to back
  ASSERT_TRUE(frames.ok());
  EXPECT_FALSE(frames->empty());
  EXPECT_LE(source.read_bytes, 4 * file.size());
  std::vector<ContainerPacket> packets;
  EXPECT_EQ(read_all(reader, packets), Status::truncated);
  EXPECT_FALSE(packets.empty());
}

/// An index may lie about what stands where: found out by whoever goes there.
TEST(HostileContainer, AnIndexOfOtherPackets) {
  const auto sample = make_sample(8, 6, 4, 0);
  const auto index = index_of(sample);
  const auto after_seek = [&](auto change) {
    auto wrong = index;
    change(wrong);
    const auto file = with_index(sample, wrong);
    MemorySource source(file);
    auto reader = *ContainerReader::open(source);
    EXPECT_TRUE(reader.seekable());
    EXPECT_EQ(reader.seek(wrong.front().frame), Status::ok);
    ContainerPacket packet;
    const Status status = reader.next(packet);
    if (status != Status::ok) {
      EXPECT_EQ(reader.next(packet), Status::end);  // Nothing follows an error.
    }
    return status;
  };
  EXPECT_EQ(after_seek([](auto&) {}), Status::ok);
  EXPECT_EQ(after_seek([](auto& i) {
              for (auto& entry : i) ++entry.frame;
            }),
            Status::corrupt);
  EXPECT_EQ(after_seek([](auto& i) { std::swap(i[0].texture_id, i[1].texture_id); }),
            Status::corrupt);
  // Another region: the first packet of the third texture.
  EXPECT_EQ(after_seek([&](auto& i) {
              const auto cut =
                  std::find_if(i.begin(), i.end(), [](const auto& e) { return e.texture_id == 2; });
              SeekEntry entry = *cut;
              entry.region = (entry.region + 1) % 4;
              i = {entry};
            }),
            Status::corrupt);
  // Said to be keyframes: an update.
  EXPECT_EQ(after_seek([&](auto& i) {
              const auto update =
                  std::find_if(i.begin(), i.end(), [](const auto& e) { return !e.keyframe; });
              SeekEntry entry = *update;
              entry.keyframe = true;
              i = {entry};
            }),
            Status::corrupt);
  // No packet at all.
  const auto head = head_of(sample.description);
  const auto skipped = entry(0x80, Bytes(10));
  const std::vector<SeekEntry> one{{0, head.size(), StreamId::kWholeVolume, 0, true}};
  const auto packet = packet_entry(sample.packets[0]);
  const std::uint64_t at = head.size() + skipped.size() + packet.size();
  const auto file = head + skipped + packet + part_entry(one, at) + end_entry(at);
  MemorySource source(file);
  auto reader = *ContainerReader::open(source);
  ASSERT_TRUE(reader.seekable());
  ASSERT_EQ(reader.seek(0), Status::ok);
  ContainerPacket got;
  EXPECT_EQ(reader.next(got), Status::corrupt);
}

TEST(HostileContainer, FailingSources) {
  const auto sample = make_sample(9, 3);
  for (const bool seekable : {false, true}) {
    int calls = 0;
    for (bool complete = false; !complete; ++calls) {
      ASSERT_LT(calls, 1000);
      FailingSource source(sample.bytes, calls, seekable);
      auto reader = ContainerReader::open(source);
      if (!reader) {
        ASSERT_EQ(reader.status(), Status::io_failed) << calls;
        continue;
      }
      Player player;
      const Status status = player.play(*reader, kEnd);
      complete = status == Status::ok;
      ASSERT_TRUE(complete || status == Status::io_failed) << calls;
    }
    EXPECT_GT(calls, 10);
  }
}

}  // namespace
}  // namespace gicodec
