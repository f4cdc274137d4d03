// Containers made to do harm: damaged, forged, and read through failing sources.
#include "container_support.h"

#include "base/bytes.h"
#include "bitstream/container_format.h"

#include <gtest/gtest.h>

#include <limits>

namespace gicodec {
namespace {

using namespace test;

constexpr auto kEnd = std::numeric_limits<std::uint64_t>::max();

/// The file header and description record of a sample.
Bytes head_of(const Sample& sample) {
  MemorySink sink;
  (void)ContainerWriter::create(sink, sample.description);
  return sink.bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes packet_record(const ContainerPacket& packet) {
  Bytes body;
  ByteWriter writer(body);
  writer.varint(packet.frame);
  writer.bytes(packet.bytes);
  return record(2, body);
}

Bytes end_record(std::uint64_t index_offset) {
  Bytes body;
  ByteWriter(body).fixed(index_offset);
  return record(4, body);
}

Bytes before_index(const Sample& sample) {
  return {sample.bytes.begin(),
          sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.index_offset)};
}

/// The right one.
std::vector<SeekEntry> index_of(const Sample& sample) {
  std::vector<SeekEntry> index;
  std::uint64_t offset = head_of(sample).size();
  for (std::size_t i = 0; i < sample.packets.size(); ++i) {
    const auto& packet = sample.packets[i];
    index.push_back({packet.frame, offset, packet.texture_id, packet.keyframe});
    offset = sample.ends[i];
  }
  return index;
}

/// Opens and reads to the end; the first status that is not ok.
Status read_through(std::span<const std::byte> file, bool pipe = false,
                    const DecodeLimits& limits = {}) {
  const Exact bytes(file);
  MemorySource memory(bytes.span());
  PipeSource piped(bytes.span());
  Source& source = pipe ? static_cast<Source&>(piped) : memory;
  auto reader = ContainerReader::open(source, limits);
  if (!reader) return reader.status();
  ContainerPacket packet;
  for (;;) {
    const Status status = reader->next(packet);
    if (status != Status::ok) return status == Status::end ? Status::ok : status;
  }
}

TEST(HostileContainer, EverySingleBitFlipIsNoticed) {
  const auto sample = make_sample(1, 4);
  for (std::size_t bit = 0; bit < sample.bytes.size() * 8; ++bit) {
    const Exact bytes{flip_bit(sample.bytes, bit)};
    const bool minor_version = bit / 8 == 9;
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    if (!reader) {
      ASSERT_LT(bit / 8, sample.ends[0]);
      continue;
    }
    const bool in_index = bit / 8 >= sample.index_offset;
    ASSERT_EQ(reader->seekable(), !in_index) << bit;
    Player player(sample.description);
    const Status status = player.play(*reader, kEnd);
    ASSERT_EQ(status == Status::ok, minor_version) << bit;
    // Everything before the damage was delivered.
    if (!minor_version) {
      const auto sound = std::ranges::upper_bound(sample.ends, bit / 8) - sample.ends.begin();
      ASSERT_EQ(player.packets, static_cast<std::size_t>(sound)) << bit;
    }
    ASSERT_NE(read_through(bytes.span(), true), minor_version ? Status::corrupt : Status::ok);
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

TEST(HostileContainer, UnknownRecords) {
  const auto sample = make_sample(3, 2);
  const auto head = head_of(sample);
  const auto first = packet_record(sample.packets[0]);
  const auto second = packet_record(sample.packets[1]);
  const Bytes some(50, std::byte{9});
  const auto end = end_record(0);
  EXPECT_EQ(read_through(head + first + second + end), Status::ok);
  for (const int type : {0x80, 0xFF}) {
    const auto skippable = record(static_cast<std::uint8_t>(type), some);
    EXPECT_EQ(read_through(head + skippable + first + skippable + second + end), Status::ok);
    EXPECT_EQ(read_through(head + skippable + first + skippable, true), Status::truncated);
  }
  for (const int type : {0, 1, 5, 0x7F}) {
    const auto mandatory = record(static_cast<std::uint8_t>(type), some);
    EXPECT_EQ(read_through(head + first + mandatory + end), Status::unsupported_feature) << type;
  }
  // Whatever follows the end record is not looked at.
  EXPECT_EQ(read_through(head + end + some), Status::ok);
  // The description must come first.
  const Bytes magic(head.begin(), head.begin() + kFileHeader);
  EXPECT_EQ(read_through(magic + first), Status::corrupt);
  EXPECT_EQ(read_through(magic + record(0x80, some)), Status::corrupt);
}

TEST(HostileContainer, EndsAndIndicesOutOfForm) {
  const auto sample = make_sample(11, 2);
  const auto head = head_of(sample);
  const auto first = packet_record(sample.packets[0]);
  const auto end = end_record(0);
  Bytes none;
  write_index({}, none);
  const auto index = record(3, none);
  EXPECT_EQ(read_through(head + first + index + end), Status::ok);
  EXPECT_EQ(read_through(head + index + first + index + end), Status::corrupt);  // Two of them.
  EXPECT_EQ(read_through(head + first + index + index + end, true), Status::corrupt);
  for (const std::size_t size : {0U, 7U, 9U}) {
    EXPECT_EQ(read_through(head + first + record(4, Bytes(size))), Status::corrupt) << size;
  }
}

TEST(HostileContainer, TextsThatAreNotUtf8) {
  const auto sample = make_sample(12, 1);
  const auto head = head_of(sample);
  const Bytes magic(head.begin(), head.begin() + kFileHeader);
  const auto with = [&](const std::string& text) {
    std::vector<Status> read;
    for (int place = 0; place < 4; ++place) {
      // Four bytes of plain text in one place, replaced in the bytes.
      auto description = sample.description;
      description.textures[1].metadata = description.metadata = {{"name", "value"}};
      const std::string plain(text.size(), 'p');
      auto& texture = description.textures[1];
      std::string& field = place == 0   ? texture.name
                           : place == 1 ? texture.metadata[0].first
                           : place == 2 ? texture.metadata[0].second
                                        : description.metadata[0].second;
      field = plain;
      Bytes body;
      EXPECT_EQ(write_description(description, body), Status::ok);
      const auto bytes = std::as_bytes(std::span(plain));
      const auto at = std::search(body.begin(), body.end(), bytes.begin(), bytes.end());
      EXPECT_NE(at, body.end());
      std::ranges::copy(std::as_bytes(std::span(text)), at);
      read.push_back(read_through(magic + record(1, body) + end_record(0)));
      // Writers do not write it either.
      field = text;
      Bytes written;
      const bool good = write_description(description, written) == Status::ok;
      EXPECT_EQ(good, read.back() == Status::ok) << place;
    }
    EXPECT_EQ(std::ranges::count(read, read[0]), 4);
    return read[0];
  };
  for (const char* good : {"ppppp", "\xC3\xA9p", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xEE\x80\x80",
                           "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "\xC2\x80\xDF\xBF"}) {
    EXPECT_EQ(with(good), Status::ok) << good;
  }
  for (const char* bad :
       {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC3", "\xC3p", "\xE0\x9F\xBF", "\xE2\x82",
        "\xE2\x82p", "\xED\xA0\x80", "\xED\xBF\xBF", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80",
        "\xF0\x90\x80", "\xF5\x80\x80\x80", "\xFF", "\xFE\x80"}) {
    EXPECT_EQ(with(bad), Status::corrupt) << bad;
  }
}

TEST(HostileContainer, PacketRecords) {
  const auto sample = make_sample(4, 3);
  const auto head = head_of(sample);
  auto packet = sample.packets[0];
  EXPECT_EQ(read_through(head + record(2, {})), Status::corrupt);
  packet.bytes = {};
  EXPECT_EQ(read_through(head + packet_record(packet)), Status::corrupt);
  packet.bytes = Bytes(30);
  EXPECT_EQ(read_through(head + packet_record(packet)), Status::not_gicodec);
  packet = sample.packets[0];
  packet.bytes[3] = std::byte{2};  // A texture that is not described.
  EXPECT_EQ(read_through(head + packet_record(packet)), Status::corrupt);
  auto late = sample.packets[0], early = sample.packets[1];
  late.frame = 5;
  early.frame = 4;
  EXPECT_EQ(read_through(head + packet_record(late) + packet_record(early)), Status::corrupt);
}

TEST(HostileContainer, FalseLengthsCostNothing) {
  const auto sample = make_sample(5, 2);
  const auto head = head_of(sample);
  for (const std::uint64_t length :
       {std::uint64_t{1} << 29, std::uint64_t{1} << 30, (std::uint64_t{1} << 30) + 1,
        std::uint64_t{1} << 40, kEnd - 16, kEnd - 4, kEnd - 3, kEnd - 1, kEnd}) {
    for (const int type : {1, 2, 3, 0x80}) {
      Bytes lying;
      ByteWriter writer(lying);
      writer.fixed(static_cast<std::uint8_t>(type));
      writer.varint(length);
      lying.resize(lying.size() + 100);
      const auto file = head + lying;
      for (const bool unlimited : {false, true}) {
        DecodeLimits limits;
        if (unlimited) {
          limits.max_packet_bytes = limits.max_index_bytes = limits.max_description_bytes = kEnd;
        }
        PipeSource source(file);
        auto reader = ContainerReader::open(source, limits);
        ASSERT_TRUE(reader.ok());
        ContainerPacket packet;
        const auto status = reader->next(packet);
        EXPECT_TRUE(status == Status::truncated || (!unlimited && status == Status::limit_exceeded))
            << length;
        EXPECT_LE(source.largest, std::size_t{64} << 10);  // Read in steps, and one was enough.
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
  EXPECT_EQ(with([](auto& l) { l.max_textures = 1; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_texture_bytes = 100; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_description_bytes = 20; }), Status::limit_exceeded);
  EXPECT_EQ(with([](auto& l) { l.max_packet_bytes = 20; }), Status::limit_exceeded);
  DecodeLimits no_index;
  no_index.max_index_bytes = 3;
  MemorySource source(sample.bytes);
  auto reader = ContainerReader::open(source, no_index);
  ASSERT_TRUE(reader.ok());
  EXPECT_FALSE(reader->seekable());
}

TEST(HostileContainer, Descriptions) {
  const auto sample = make_sample(7, 1);
  const auto head = head_of(sample);
  Bytes body;
  ASSERT_EQ(write_description(sample.description, body), Status::ok);
  const Bytes magic(head.begin(), head.begin() + kFileHeader);
  EXPECT_EQ(read_through(magic + record(1, body)), Status::truncated);
  // Cut or damaged, but with a checksum that fits.
  for (std::size_t size = 0; size < body.size(); ++size) {
    ASSERT_EQ(read_through(magic + record(1, std::span(body).first(size))), Status::corrupt);
  }
  for (std::size_t bit = 0; bit < body.size() * 8; ++bit) {
    (void)read_through(magic + record(1, flip_bit(body, bit)));
  }
  body.push_back(std::byte{0});
  EXPECT_EQ(read_through(magic + record(1, body)), Status::corrupt);
  EXPECT_EQ(read_through(magic + record(1, Bytes{std::byte{0}, std::byte{0}})), Status::corrupt);
  // Two textures of one name.
  auto twice = sample.description;
  twice.textures[1].name = "colox";
  Bytes same;
  ASSERT_EQ(write_description(twice, same), Status::ok);
  const auto name = std::as_bytes(std::span(std::string_view("colox")));
  const auto at = std::search(same.begin(), same.end(), name.begin(), name.end());
  ASSERT_NE(at, same.end());
  at[4] = std::byte{'r'};
  EXPECT_EQ(read_through(magic + record(1, same)), Status::corrupt);
}

TEST(HostileContainer, AWrongIndexIsNoIndex) {
  const auto sample = make_sample(8, 6);
  const Bytes before = before_index(sample);
  const auto index = index_of(sample);
  const auto file_with = [&](const Bytes& body, std::uint64_t at) {
    return before + record(3, body) + end_record(at);
  };
  Bytes good;
  write_index(index, good);
  ASSERT_TRUE(file_with(good, sample.index_offset) == sample.bytes);
  const auto seekable = [&](const Bytes& file) {
    const Exact bytes{std::span(file)};
    MemorySource source(bytes.span());
    auto reader = ContainerReader::open(source);
    EXPECT_TRUE(reader.ok());
    Player player(sample.description);
    EXPECT_EQ(player.play(*reader, kEnd), Status::ok);
    EXPECT_EQ(player.packets, sample.packets.size());
    return reader->seekable();
  };
  EXPECT_TRUE(seekable(file_with(good, sample.index_offset)));
  for (const std::uint64_t at : {std::uint64_t{0}, std::uint64_t{20}, sample.index_offset - 1,
                                 sample.index_offset + 1, kEnd, kEnd - 8}) {
    EXPECT_FALSE(seekable(file_with(good, at))) << at;
  }
  const auto with = [&](auto change) {
    auto wrong = index;
    change(wrong);
    Bytes body;
    write_index(wrong, body);
    return seekable(file_with(body, sample.index_offset));
  };
  EXPECT_TRUE(with([](auto&) {}));
  EXPECT_FALSE(with([](auto& i) { i[1].texture_id = 2; }));
  EXPECT_FALSE(with([](auto& i) { i[0].offset = 5; }));                         // The header.
  EXPECT_FALSE(with([](auto& i) { i[1].offset = i[0].offset; }));               // Twice.
  EXPECT_FALSE(with([&](auto& i) { i.back().offset = sample.index_offset; }));  // The index.
  EXPECT_FALSE(with([](auto& i) { i.back().offset = kEnd; }));
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(
        seekable(file_with(Bytes(good.begin(), good.begin() + size), sample.index_offset)));
  }
  // Offsets into the middle of a record: seeking or reading says so, and nothing worse.
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    const auto file = file_with(flip_bit(good, bit), sample.index_offset);
    MemorySource source(file);
    auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok());
    for (std::uint64_t frame = 0; frame < 8 && reader->seekable(); ++frame) {
      if (reader->seek(frame) != Status::ok) continue;
      Player player(sample.description);
      (void)player.play(*reader, kEnd, true);
    }
  }
}

/// An index may lie about what stands where: found out by whoever goes there.
TEST(HostileContainer, AnIndexOfOtherPackets) {
  const auto sample = make_sample(8, 6);
  const Bytes before = before_index(sample);
  const auto index = index_of(sample);
  const auto after_seek = [&](auto change) {
    auto wrong = index;
    change(wrong);
    Bytes body;
    write_index(wrong, body);
    const auto file = before + record(3, body) + end_record(sample.index_offset);
    MemorySource source(file);
    auto reader = *ContainerReader::open(source);
    EXPECT_TRUE(reader.seekable());
    EXPECT_EQ(reader.seek(wrong.front().frame), Status::ok);
    ContainerPacket packet;
    return reader.next(packet);
  };
  EXPECT_EQ(after_seek([](auto&) {}), Status::ok);
  EXPECT_EQ(after_seek([](auto& i) {
              for (auto& entry : i) ++entry.frame;
            }),
            Status::corrupt);
  EXPECT_EQ(after_seek([](auto& i) { std::swap(i[0].texture_id, i[1].texture_id); }),
            Status::corrupt);
  // Said to be keyframes: the second packet of the texture, at the end of the first frame's.
  EXPECT_EQ(after_seek([&](auto& i) {
              const auto update = std::ranges::find(i, false, &SeekEntry::keyframe);
              ASSERT_NE(update, i.end());
              SeekEntry entry = *update;
              entry.keyframe = true;
              i = {entry};
            }),
            Status::corrupt);
  // No packet at all: the index record's neighbour is not looked at, a record of another type is.
  const auto skipped = record(0x80, Bytes(10));
  Bytes body;
  write_index(std::vector<SeekEntry>{{0, head_of(sample).size(), 0, true}}, body);
  const Bytes rest(before.begin() + static_cast<std::ptrdiff_t>(head_of(sample).size()),
                   before.end());
  const auto file = head_of(sample) + skipped + rest + record(3, body) +
                    end_record(sample.index_offset + skipped.size());
  MemorySource source(file);
  auto reader = *ContainerReader::open(source);
  ASSERT_TRUE(reader.seekable());
  ASSERT_EQ(reader.seek(0), Status::ok);
  ContainerPacket packet;
  EXPECT_EQ(reader.next(packet), Status::corrupt);
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
      Player player(sample.description);
      const Status status = player.play(*reader, kEnd);
      complete = status == Status::ok;
      ASSERT_TRUE(complete || status == Status::io_failed) << calls;
    }
    EXPECT_GT(calls, 10);
  }
}

}  // namespace
}  // namespace gicodec
