// Containers: round trips, cuts, seeking, and failing sinks.
#include "container_support.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

constexpr auto kEnd = std::numeric_limits<std::uint64_t>::max();

TEST(Container, RoundTripFromMemoryAndPipe) {
  const auto sample = make_sample(1);
  ASSERT_FALSE(sample.bytes.empty());
  const Exact bytes{std::span(sample.bytes)};
  MemorySource memory(bytes.span());
  PipeSource pipe(bytes.span());
  for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
    auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader.ok()) << reader.status();
    EXPECT_EQ(reader->description().textures.size(), 3U);
    EXPECT_EQ(reader->description().metadata, sample.description.metadata);
    EXPECT_EQ(reader->seekable(), source == &memory);
    EXPECT_EQ(reader->finished(), source == &memory);
    std::vector<ContainerPacket> packets;
    EXPECT_EQ(read_all(*reader, packets), Status::ok);
    EXPECT_TRUE(same_packets(packets, sample.packets));
    EXPECT_TRUE(reader->finished());
    ContainerPacket more;
    EXPECT_EQ(reader->next(more), Status::end);
  }
  EXPECT_EQ(*find_metadata(sample.description.metadata, "writer"), "test");
  EXPECT_EQ(find_metadata(sample.description.metadata, "reader"), nullptr);
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

#if defined(__linux__)
  std::FILE* full = std::fopen("/dev/full", "wb");
  ASSERT_NE(full, nullptr);
  std::setvbuf(full, nullptr, _IONBF, 0);
  FileSink full_sink(full);
  EXPECT_EQ(ContainerWriter::create(full_sink, sample.description).status(), Status::io_failed);
  FileSource unreadable(full);
  EXPECT_EQ(ContainerReader::open(unreadable).status(), Status::io_failed);
  std::fclose(full);
#endif
}

TEST(Container, EveryPrefixGivesThePacketsBeforeTheCut) {
  const auto sample = make_sample(3);
  for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
    const Exact cut{std::span(sample.bytes).first(size)};
    const auto whole = sample.packets_before(size);
    MemorySource memory(cut.span());
    PipeSource pipe(cut.span());
    for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
      auto reader = ContainerReader::open(*source);
      if (!reader) {
        ASSERT_EQ(reader.status(), Status::truncated) << size;
        ASSERT_TRUE(whole.empty());
        continue;
      }
      ASSERT_FALSE(reader->finished());
      std::vector<ContainerPacket> packets;
      ASSERT_EQ(read_all(*reader, packets), Status::truncated) << size;
      ASSERT_TRUE(same_packets(packets, whole)) << size;
      // Whoever can go back looks again; of a pipe nothing follows.
      ContainerPacket more;
      ASSERT_EQ(reader->next(more), source == &memory ? Status::truncated : Status::end);
    }
  }
}

TEST(Container, SeekingIsDecodingFromTheStart) {
  const auto sample = make_sample(4, 20, 5, 4);
  const Exact bytes{std::span(sample.bytes)};
  Random random(5);
  MemorySource source(bytes.span());
  auto reader = *ContainerReader::open(source);
  ASSERT_TRUE(reader.seekable());
  std::vector<std::uint64_t> frames;
  for (const auto& [frame, states] : sample.frames) frames.push_back(frame);
  for (int round = 0; round < 3; ++round) {
    std::shuffle(frames.begin(), frames.end(), random);
    for (const auto frame : frames) {
      Player seeking, sequential;
      ASSERT_EQ(reader.seek(frame), Status::ok);
      // No packet comes before what it builds on.
      ASSERT_EQ(seeking.play(reader, frame), Status::ok);
      EXPECT_EQ(seeking.states, sample.frames.at(frame)) << frame;
      MemorySource again(bytes.span());
      auto from_start = *ContainerReader::open(again);
      ASSERT_EQ(sequential.play(from_start, frame), Status::ok);
      EXPECT_EQ(sequential.states, sample.frames.at(frame)) << frame;
      EXPECT_LE(seeking.packets, sequential.packets);
    }
  }
  // A late frame is reached without reading everything before it.
  const auto last = sample.frames.rbegin()->first;
  Player late;
  ASSERT_EQ(reader.seek(last), Status::ok);
  ASSERT_EQ(late.play(reader, kEnd), Status::ok);
  EXPECT_LT(late.packets, sample.packets.size() / 2);
  for (std::uint64_t frame = 0; frame < last + 3; ++frame) {
    if (sample.frames.count(frame) == 0) {
      EXPECT_EQ(reader.seek(frame), Status::unknown_frame);
    }
  }
}

TEST(Container, WriterRefusesWhatItsReaderWouldNotUnderstand) {
  const auto sample = make_sample(6);
  auto description = sample.description;
  description.textures[1].largest_error = 2;
  PacketMaker maker(description);
  Random random(6);
  const auto color = maker.make(0, kWhole, true, random),
             visibility = maker.make(1, kWhole, true, random);
  const auto far = maker.make(2, 0, true, random);
  const auto lossy_color = maker.make(0, kWhole, true, random, 9, true);
  const auto lossy_visibility = maker.make(1, kWhole, true, random, 9, true);

  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  EXPECT_EQ(writer.add(0, {}), Status::truncated);
  EXPECT_EQ(writer.add(0, Bytes(40)), Status::not_gicodec);
  auto fourth_texture = color;
  fourth_texture[3] = std::byte{3};
  EXPECT_EQ(writer.add(0, fourth_texture), Status::unknown_texture);
  EXPECT_EQ(writer.add(0, color, 0), Status::unknown_region);  // A volume of one region.
  EXPECT_EQ(writer.add(0, far), Status::unknown_region);       // And one that is cut into four.
  EXPECT_EQ(writer.add(0, far, 4), Status::unknown_region);
  EXPECT_EQ(writer.add(0, lossy_color), Status::description_mismatch);
  ASSERT_EQ(writer.add(7, color), Status::ok);
  EXPECT_EQ(writer.add(6, visibility), Status::wrong_frame);  // Frames must not decrease.
  ASSERT_EQ(writer.add(7, lossy_visibility), Status::ok);
  EXPECT_EQ(writer.add(7, color),
            Status::wrong_frame);  // One packet per texture, region and frame.
  ASSERT_EQ(writer.flush(), Status::ok);
  EXPECT_EQ(writer.add(7, color), Status::wrong_frame);
  ASSERT_EQ(writer.add(7, far, 0), Status::ok);
  EXPECT_EQ(writer.add(7, far, 0), Status::wrong_frame);
  ASSERT_EQ(writer.add(7, maker.make(2, 3, true, random), 3), Status::ok);
  ASSERT_EQ(writer.add(kEnd, color), Status::ok);
  ASSERT_EQ(writer.finish(), Status::ok);
  EXPECT_EQ(writer.add(kEnd, visibility), Status::out_of_order);
  EXPECT_EQ(writer.flush(), Status::out_of_order);
  EXPECT_EQ(writer.finish(), Status::out_of_order);

  const Exact bytes{std::span(sink.bytes)};
  MemorySource source(bytes.span());
  auto reader = *ContainerReader::open(source);
  std::vector<ContainerPacket> back;
  EXPECT_EQ(read_all(reader, back), Status::ok);
  ASSERT_EQ(back.size(), 5U);
  EXPECT_EQ(back[4].frame, kEnd);
  EXPECT_EQ(reader.seek(kEnd), Status::ok);
}

TEST(Container, KeyframesOfOtherTexturesAreRefused) {
  const auto description = sample_description();
  const TextureDesc& far = description.textures[2].desc;
  const Grid& size = description.volumes[1].region;
  Random random(11);
  const auto keyframe = [&](const TextureDesc& desc, std::uint8_t texture_id) {
    EncoderOptions options;
    options.texture_id = texture_id;
    Texture texture(desc);
    texture.fill(Fill::noise, random);
    return *Encoder::create(desc, options)->encode(std::as_const(texture).view());
  };
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  const auto before = sink.bytes.size();
  const auto mismatch = Status::description_mismatch;
  EXPECT_EQ(writer.add(0, keyframe(far, 2), 0), mismatch);  // The whole for a part of it,
  EXPECT_EQ(writer.add(0, keyframe(region_texture(far, size, 0), 2), 1),
            mismatch);  // another part,
  EXPECT_EQ(writer.add(0, keyframe(region_texture(far, size, 0), 0)),
            mismatch);  // another texture.
  EXPECT_EQ(writer.add(0, keyframe(description.textures[1].desc, 0)), mismatch);
  EXPECT_EQ(sink.bytes.size(), before);
  for (std::uint32_t region = 0; region < 4; ++region) {
    EXPECT_EQ(writer.add(0, keyframe(region_texture(far, size, region), 2), region), Status::ok);
  }
  EXPECT_EQ(writer.add(0, keyframe(description.textures[0].desc, 0)), Status::ok);
  EXPECT_EQ(writer.finish(), Status::ok);
}

TEST(Container, AFullSinkChangesNothing) {
  const auto sample = make_sample(7, 9, 4, 0);
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
      ASSERT_EQ(repeated([&] { return writer->add(packet.frame, packet.bytes, packet.region); }),
                Status::ok);
    }
    ASSERT_EQ(repeated([&] { return writer->finish(); }), Status::ok);
    ASSERT_EQ(sink.bytes, sample.bytes);
    EXPECT_EQ(writer->finish(), Status::out_of_order);
    EXPECT_EQ(writer->add(1000, sample.packets[0].bytes), Status::out_of_order);
  }
}

/// Fails the n-th call, whatever it is.
class FailingSink final : public Sink {
 public:
  explicit FailingSink(int calls) : calls_(calls) {}
  Status write(std::span<const std::byte> more) override {
    if (calls_-- == 0) return Status::io_failed;
    bytes.insert(bytes.end(), more.begin(), more.end());
    return Status::ok;
  }
  Bytes bytes;

 private:
  int calls_;
};

/// Over a whole index part, so that the packet with which it is written is among them.
TEST(Container, EveryFailingWriteCanBeRepeated) {
  const auto description = sample_description();
  PacketMaker maker(description);
  Random random(8);
  std::vector<Bytes> packets;
  for (std::size_t i = 0; i < kPartPackets + 5; ++i) {
    packets.push_back(maker.make(0, kWhole, i % 64 == 0, random, 1));
  }
  Bytes expected;
  for (const int failing : {-1, 0, 1, 1000, 1023, 1024, 1025, 1028, 1029, 1030, 1031}) {
    FailingSink sink(failing);
    int failures = 0;
    const auto repeated = [&](auto&& call) {
      const Status status = call();
      if (status == Status::ok) return;
      EXPECT_EQ(status, Status::io_failed);
      ++failures;
      EXPECT_EQ(call(), Status::ok);
    };
    Result<ContainerWriter> writer = Status::io_failed;
    repeated([&] {
      writer = ContainerWriter::create(sink, description);
      return writer.status();
    });
    ASSERT_TRUE(writer.ok());
    for (std::size_t i = 0; i < packets.size(); ++i) {
      repeated([&] { return writer->add(i, packets[i]); });
    }
    repeated([&] { return writer->flush(); });
    repeated([&] { return writer->finish(); });
    EXPECT_EQ(failures, failing < 0 ? 0 : 1) << failing;
    if (failing < 0) expected = sink.bytes;
    EXPECT_EQ(sink.bytes, expected) << failing;
  }
  EXPECT_EQ(read_through(expected), Status::ok);
}

}  // namespace
}  // namespace gicodec
