// Containers: round trips, cuts, seeking, and failing sinks.
#include "container_support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdio>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

constexpr auto kEnd = std::numeric_limits<std::uint64_t>::max();

void expect_same_description(const ContainerDescription& a, const ContainerDescription& b) {
  EXPECT_EQ(a.metadata, b.metadata);
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i].name, b.textures[i].name);
    EXPECT_EQ(a.textures[i].desc, b.textures[i].desc);
    EXPECT_EQ(a.textures[i].metadata, b.textures[i].metadata);
  }
}

/// Reads packets until the end or an error, which is returned.
Status read_all(ContainerReader& reader, std::vector<ContainerPacket>& packets) {
  for (;;) {
    ContainerPacket packet;
    const Status status = reader.next(packet);
    if (status == Status::end) return Status::ok;
    if (status != Status::ok) {
      EXPECT_EQ(reader.next(packet), Status::end);  // Nothing follows an error.
      return status;
    }
    packets.push_back(std::move(packet));
  }
}

bool same_packets(std::span<const ContainerPacket> a, std::span<const ContainerPacket> b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
    return x.frame == y.frame && x.texture_id == y.texture_id && x.keyframe == y.keyframe &&
           x.bytes == y.bytes;
  });
}

TEST(Container, RoundTripFromMemoryAndPipe) {
  const auto sample = make_sample(1);
  ASSERT_FALSE(sample.bytes.empty());
  const Exact bytes{std::span(sample.bytes)};
  MemorySource memory(bytes.span());
  PipeSource pipe(bytes.span());
  for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
    auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader.ok()) << reader.status();
    expect_same_description(reader->description(), sample.description);
    EXPECT_EQ(reader->seekable(), source == &memory);
    std::vector<ContainerPacket> packets;
    EXPECT_EQ(read_all(*reader, packets), Status::ok);
    EXPECT_TRUE(same_packets(packets, sample.packets));
    ContainerPacket more;
    EXPECT_EQ(reader->next(more), Status::end);
  }
  EXPECT_EQ(*find_metadata(sample.description.metadata, "writer"), "test");
  EXPECT_EQ(find_metadata(sample.description.metadata, "reader"), nullptr);
}

RC_GTEST_PROP(Container, AnyDescription, (std::uint64_t seed)) {
  Random random(seed);
  const auto text = [&](std::uint32_t max) {
    constexpr std::string_view kPieces[] = {
        "a", " ", "\n", "\x7F", "\u00E9", "\u20AC", "\U0001F4A1", std::string_view("\0", 1)};
    std::string all;
    for (std::uint32_t i = pick(random, 0, max / 4); i > 0; --i) {
      all += kPieces[random() % std::size(kPieces)];
    }
    return all;
  };
  const auto metadata = [&] {
    Metadata all(random() % 4);
    for (auto& [name, value] : all) {
      name = text(20);
      value = text(300);
    }
    return all;
  };
  ContainerDescription description;
  description.metadata = metadata();
  for (std::uint32_t i = pick(random, 1, 5); i > 0; --i) {
    description.textures.push_back(
        {std::to_string(i) + text(200), random_desc(random), metadata()});
  }
  MemorySink sink;
  auto writer = ContainerWriter::create(sink, description);
  RC_ASSERT(writer.ok());
  RC_ASSERT(writer->finish() == Status::ok);
  const Exact bytes{std::span(sink.bytes)};
  MemorySource source(bytes.span());
  const auto reader = ContainerReader::open(source);
  RC_ASSERT(reader.ok());
  expect_same_description(reader->description(), description);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(Container, StdioFiles) {
  const auto sample = make_sample(2);
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  FileSink sink(file);
  ASSERT_EQ(sink.write(sample.bytes), Status::ok);
  {
    FileSource middle(file);  // Not at the start: read on from there, like a pipe.
    EXPECT_FALSE(middle.size().has_value());
    EXPECT_EQ(middle.seek(0), Status::io_failed);
  }
  std::rewind(file);
  FileSource source(file);
  ASSERT_EQ(source.size(), std::optional<std::uint64_t>(sample.bytes.size()));
  EXPECT_EQ(source.seek(sample.bytes.size() + 1), Status::io_failed);
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->seekable());
  std::vector<ContainerPacket> packets;
  EXPECT_EQ(read_all(*reader, packets), Status::ok);
  EXPECT_TRUE(same_packets(packets, sample.packets));
  std::fclose(file);

  std::FILE* full = std::fopen("/dev/full", "wb");
  if (full == nullptr) GTEST_SKIP() << "no /dev/full";
  std::setvbuf(full, nullptr, _IONBF, 0);
  FileSink full_sink(full);
  EXPECT_EQ(ContainerWriter::create(full_sink, sample.description).status(), Status::io_failed);
  FileSource unreadable(full);
  EXPECT_EQ(ContainerReader::open(unreadable).status(), Status::io_failed);
  std::fclose(full);
}

TEST(Container, EveryPrefixGivesThePacketsBeforeTheCut) {
  const auto sample = make_sample(3);
  for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
    const Exact cut{std::span(sample.bytes).first(size)};
    const auto whole =
        static_cast<std::size_t>(std::ranges::upper_bound(sample.ends, size) - sample.ends.begin());
    MemorySource memory(cut.span());
    PipeSource pipe(cut.span());
    for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
      auto reader = ContainerReader::open(*source);
      if (!reader) {
        ASSERT_EQ(reader.status(), Status::truncated) << size;
        ASSERT_EQ(whole, 0U);
        continue;
      }
      ASSERT_FALSE(reader->seekable());
      std::vector<ContainerPacket> packets;
      ASSERT_EQ(read_all(*reader, packets), Status::truncated) << size;
      ASSERT_TRUE(same_packets(packets, std::span(sample.packets).first(whole))) << size;
    }
  }
}

TEST(Container, SeekingIsDecodingFromTheStart) {
  const auto sample = make_sample(4, 20, 5);
  const Exact bytes{std::span(sample.bytes)};
  Random random(5);
  MemorySource source(bytes.span());
  auto reader = *ContainerReader::open(source);
  ASSERT_TRUE(reader.seekable());
  std::vector<std::uint64_t> frames;
  for (const auto& [frame, contents] : sample.frames) frames.push_back(frame);
  for (int round = 0; round < 3; ++round) {
    std::ranges::shuffle(frames, random);
    for (const auto frame : frames) {
      Player seeking(sample.description), sequential(sample.description);
      ASSERT_EQ(reader.seek(frame), Status::ok);
      ASSERT_EQ(seeking.play(reader, frame, true), Status::ok);
      EXPECT_TRUE(seeking.contents() == sample.frames.at(frame)) << frame;
      MemorySource again(bytes.span());
      auto from_start = *ContainerReader::open(again);
      ASSERT_EQ(sequential.play(from_start, frame), Status::ok);
      EXPECT_TRUE(sequential.contents() == sample.frames.at(frame)) << frame;
      EXPECT_LE(seeking.packets, sequential.packets);
    }
  }
  // A late frame is reached without reading everything before it.
  const auto last = sample.frames.rbegin()->first;
  Player late(sample.description);
  ASSERT_EQ(reader.seek(last), Status::ok);
  ASSERT_EQ(late.play(reader, kEnd, true), Status::ok);
  EXPECT_LT(late.packets, sample.packets.size() / 2);
  for (std::uint64_t frame = 0; frame < last + 3; ++frame) {
    if (!sample.frames.contains(frame)) {
      EXPECT_EQ(reader.seek(frame), Status::invalid_argument);
    }
  }
}

TEST(Container, WriterRefusesWhatItsReaderWouldNotUnderstand) {
  const auto sample = make_sample(6);
  const auto create = [&](auto change) {
    auto description = sample.description;
    change(description);
    MemorySink sink;
    return ContainerWriter::create(sink, description).status();
  };
  const auto bad = Status::invalid_argument;
  EXPECT_EQ(create([](auto& d) { d.textures.clear(); }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].name = "color"; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].name.assign(256, 'x'); }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].name.assign(255, 'x'); }), Status::ok);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.core = 0; }), Status::invalid_description);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.format = Format{}; }),
            Status::unsupported_format);
  EXPECT_EQ(create([](auto& d) { d.metadata[0].second.assign((1U << 20) + 1, 'x'); }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[0].metadata[0].first.assign((1U << 20) + 1, 'x'); }),
            bad);
  EXPECT_EQ(create([](auto& d) {
              const auto one = d.textures[0];
              for (int i = 0; i < 255; ++i) {
                d.textures.push_back(one);
                d.textures.back().name = std::to_string(i);
              }
            }),
            bad);

  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, sample.description);
  const auto& packets = sample.packets;
  EXPECT_EQ(writer.add(0, {}), Status::truncated);
  EXPECT_EQ(writer.add(0, Bytes(40)), Status::not_gicodec);
  auto third_texture = packets[0].bytes;
  third_texture[3] = std::byte{2};
  EXPECT_EQ(writer.add(0, third_texture), bad);
  ASSERT_EQ(writer.add(7, packets[0].bytes), Status::ok);
  EXPECT_EQ(writer.add(6, packets[1].bytes), bad);  // Frames must not decrease.
  ASSERT_EQ(writer.add(7, packets[1].bytes), Status::ok);
  EXPECT_EQ(writer.add(7, packets[0].bytes), bad);  // One packet per texture and frame.
  ASSERT_EQ(writer.add(kEnd, packets[0].bytes), Status::ok);
  ASSERT_EQ(writer.finish(), Status::ok);
  EXPECT_EQ(writer.add(kEnd, packets[1].bytes), bad);
  EXPECT_EQ(writer.finish(), bad);

  const Exact bytes{std::span(sink.bytes)};
  MemorySource source(bytes.span());
  auto reader = *ContainerReader::open(source);
  std::vector<ContainerPacket> back;
  EXPECT_EQ(read_all(reader, back), Status::ok);
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back[2].frame, kEnd);
  EXPECT_EQ(reader.seek(kEnd), Status::ok);
}

TEST(Container, AFullSinkChangesNothing) {
  const auto sample = make_sample(7);
  for (std::size_t room = 0; room < sample.bytes.size(); room += 7) {
    MemorySink sink;
    sink.room = room;
    auto writer = ContainerWriter::create(sink, sample.description);
    if (!writer) {
      ASSERT_EQ(writer.status(), Status::io_failed);
      ASSERT_TRUE(sink.bytes.empty());
      continue;
    }
    const auto repeated = [&](auto&& call) {
      const std::uint64_t before = writer->bytes_written();
      Status status = call();
      if (status == Status::ok) return status;
      EXPECT_EQ(status, Status::io_failed);
      EXPECT_EQ(writer->bytes_written(), before);
      // What was written before can be read.
      MemorySource source(sink.bytes);
      auto reader = ContainerReader::open(source);
      std::vector<ContainerPacket> packets;
      EXPECT_TRUE(reader.ok() && read_all(*reader, packets) == Status::truncated);
      EXPECT_TRUE(same_packets(packets, std::span(sample.packets).first(packets.size())));
      sink.room = SIZE_MAX;
      return call();
    };
    for (const ContainerPacket& packet : sample.packets) {
      ASSERT_EQ(repeated([&] { return writer->add(packet.frame, packet.bytes); }), Status::ok);
    }
    ASSERT_EQ(repeated([&] { return writer->finish(); }), Status::ok);
    ASSERT_EQ(sink.bytes, sample.bytes);
    EXPECT_EQ(writer->finish(), Status::invalid_argument);
    EXPECT_EQ(writer->add(1000, sample.packets[0].bytes), Status::invalid_argument);
  }
}

}  // namespace
}  // namespace gicodec
