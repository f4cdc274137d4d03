// Containers far away: how often and how much a reader asks, to the first frame of files of any
// length, to one frame of many, and of those that grow.
#include "container_support.h"

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

constexpr std::uint64_t kEdge = std::uint64_t{64} << 10;

/// Memory that is far away: its head and its end are here; all else comes with a round trip.
class DistantSource final : public Source {
 public:
  explicit DistantSource(std::span<const std::byte> bytes)
      : bytes_(bytes), here_(bytes.size() / kPiece + 1) {
    bring({0, std::min<std::uint64_t>(kEdge, bytes.size())});
    bring({bytes.size() - std::min<std::uint64_t>(kEdge, bytes.size()), kEdge});
    round_trips = 1;
  }
  Result<std::size_t> read(std::span<std::byte> into) override {
    const std::size_t size = std::min(into.size(), bytes_.size() - at_);
    if (bring({at_, size})) ++round_trips;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), size, into.begin());
    at_ += size;
    return size;
  }
  std::optional<std::uint64_t> size() const override { return bytes_.size(); }
  Status seek(std::uint64_t offset) override {
    at_ = static_cast<std::size_t>(offset);
    return Status::ok;
  }
  bool prefetch(std::span<const ByteRange> ranges) override {
    bool any = false;
    for (const ByteRange& range : ranges) any |= bring(range);
    round_trips += any ? 1 : 0;
    return true;
  }

  std::size_t round_trips = 0;
  std::uint64_t brought = 0;  ///< bytes

 private:
  static constexpr std::uint64_t kPiece = 64;

  /// True if something was not here.
  bool bring(const ByteRange& range) {
    bool any = false;
    const std::uint64_t end = std::min<std::uint64_t>(range.offset + range.size, bytes_.size());
    for (std::uint64_t at = range.offset / kPiece; at * kPiece < end; ++at) {
      if (here_[at]) continue;
      here_[at] = any = true;
      brought += kPiece;
    }
    return any;
  }

  std::span<const std::byte> bytes_;
  std::vector<bool> here_;
  std::size_t at_ = 0;
};

/// Frames of all regions of the second volume, whose index somebody reads as it grows unless it is
/// finished; the first texture of the first volume has a keyframe
/// in frame 0, and nothing else.
struct Recording {
  ContainerDescription description = sample_description();
  MemorySink sink;
  std::uint64_t frames = 0;
  std::map<std::uint64_t, States> states;  ///< after some frames

  Recording(std::uint64_t frames_in, std::size_t payload, std::uint64_t gop, bool finished = true)
      : frames(frames_in) {
    auto writer = *ContainerWriter::create(sink, description);
    PacketMaker maker(description);
    Random random(frames);
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      if (frame == 0) add(writer, maker.make(0, kWhole, true, random, payload), frame, kWhole);
      for (std::uint32_t region = 0; region < 4; ++region) {
        const bool keyframe = (frame + region) % gop == 0 || frame == 0;
        add(writer, maker.make(2, region, keyframe, random, payload), frame, region);
      }
      if (frame % 97 == 0 || frame + 1 == frames) states[frame] = maker.states();
      if (!finished && frame % 10 == 9) {
        EXPECT_EQ(writer.flush(), Status::ok);
      }
    }
    if (finished) {
      EXPECT_EQ(writer.finish(), Status::ok);
    }
  }
  static void add(ContainerWriter& writer, const Bytes& packet, std::uint64_t frame,
                  std::uint32_t region) {
    ASSERT_EQ(writer.add(frame, packet, region), Status::ok);
  }
  [[nodiscard]] std::uint64_t bytes() const { return sink.bytes.size(); }
};

/// Reads packets as long as the next one may belong to the frame.
States play_frame(ContainerReader& reader, std::uint64_t frame) {
  Player player;
  while (reader.next_frame().value_or(frame) <= frame) {
    ContainerPacket packet;
    if (reader.next(packet) != Status::ok) break;
    if (player.take(packet) != Status::ok) break;
  }
  return player.states;
}

/// Three round trips: head and end, parts of the index, packets.
TEST(DistantContainer, AnyFrameIsThreeRoundTripsAway) {
  for (const std::uint64_t frames : {1U, 40U, 3000U, 40000U}) {
    const Recording recording(frames, 300, 25);
    for (const auto& [frame, states] : recording.states) {
      if (frame % 1000 > 96 && frame + 1 != frames) continue;
      DistantSource source(recording.sink.bytes);
      auto reader = *ContainerReader::open(source);
      EXPECT_EQ(source.round_trips, 1U) << "to open it";
      ASSERT_EQ(reader.seek(frame), Status::ok);
      EXPECT_EQ(play_frame(reader, frame), states);
      EXPECT_LE(source.round_trips, 3U) << frame << " of " << frames;
      // The packets since the last keyframes, the keyframe of frame 0, and what a plan has beside.
      EXPECT_LE(source.brought, 2 * kEdge + 26 * 4 * 400 + 4 * 1024 * 8 + 2 * kEdge) << frame;
    }
  }
}

TEST(DistantContainer, ReadingInOrderAsksSeldom) {
  const Recording recording(3000, 300, 25);
  DistantSource source(recording.sink.bytes);
  auto reader = *ContainerReader::open(source);
  EXPECT_EQ(play_frame(reader, 0), recording.states.at(0));
  EXPECT_LE(source.round_trips, 3U);
  Player rest;
  ASSERT_EQ(reader.seek(0), Status::ok);
  ASSERT_EQ(rest.play(reader, kEnd), Status::ok);
  EXPECT_EQ(rest.states, recording.states.rbegin()->second);
  // 4 MB: windows grow to 2 MiB, and each part of the index is one more.
  EXPECT_LE(source.round_trips, 26U);
}

TEST(DistantContainer, ACornerCostsItsOwnBytes) {
  const Recording recording(2000, 3000, 50);
  DistantSource source(recording.sink.bytes);
  auto reader = *ContainerReader::open(source);
  const TextureRegion corner{2, 1};
  ASSERT_EQ(reader.select(std::span(&corner, 1)), Status::ok);
  ASSERT_EQ(reader.seek(970), Status::ok);
  Player player;
  ASSERT_EQ(player.play(reader, 970), Status::ok);
  EXPECT_LE(source.round_trips, 3U);
  EXPECT_LE(source.brought, 2 * kEdge + 51 * 3200 + kEdge + 4 * 1024 * 8);
  // To the end: a quarter of the file.
  Player rest;
  ASSERT_EQ(reader.seek(0), Status::ok);
  ASSERT_EQ(rest.play(reader, kEnd), Status::ok);
  EXPECT_LE(source.brought, recording.bytes() * 3 / 10 + 4 * kEdge);
}

/// Of a file that grows the parts at its end are listed in few places.
TEST(DistantContainer, AFileThatGrowsIsFourRoundTripsAway) {
  const Recording recording(40000, 8, 25, false);
  for (std::uint64_t part = 5; part <= 10; ++part) {
    const auto size = static_cast<std::size_t>(recording.bytes() * part / 10);
    DistantSource source(std::span(recording.sink.bytes).first(size));
    auto reader = *ContainerReader::open(source);
    EXPECT_LE(source.round_trips, 2U);
    EXPECT_FALSE(reader.finished());
    ASSERT_EQ(reader.seek(97 * 97), Status::ok);
    EXPECT_EQ(play_frame(reader, 97 * 97), recording.states.at(97 * 97));
    EXPECT_LE(source.round_trips, 4U);
  }
}

TEST(DistantContainer, TheIndexSaysWhatThereIs) {
  const Recording recording(3000, 300, 25);
  DistantSource source(recording.sink.bytes);
  auto reader = *ContainerReader::open(source);
  const auto listed = reader.listed();
  ASSERT_TRUE(listed.ok());
  ASSERT_EQ(listed->size(), 5U);
  std::uint64_t packets = 0, bytes = 0;
  for (const ListedPart& part : *listed) {
    packets += part.packets;
    bytes += part.bytes;
  }
  EXPECT_EQ(packets, 4 * recording.frames + 1);
  EXPECT_EQ((*listed)[0].part, (TextureRegion{0}));
  EXPECT_EQ((*listed)[0].last_frame, 0U);
  EXPECT_EQ((*listed)[1].part, (TextureRegion{2, 0}));
  EXPECT_EQ((*listed)[1].keyframes, 120U);
  EXPECT_EQ((*listed)[1].last_frame, recording.frames - 1);
  EXPECT_LE(bytes, recording.bytes());
  EXPECT_GE(bytes, recording.bytes() * 9 / 10);
  EXPECT_LE(source.brought, recording.bytes() / 20 + 4 * kEdge);
  EXPECT_LE(source.round_trips, 3U);
}

/// Whatever parts there are, a seek gives what reading in order gives.
TEST(DistantContainer, EveryFrameOfEveryCutOfTheIndex) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto sample = make_sample(seed, 30, 2 + static_cast<std::uint32_t>(seed % 7),
                                    1 + static_cast<std::uint32_t>(seed % 3));
    MemorySource source(sample.bytes);
    auto reader = *ContainerReader::open(source);
    for (const auto& [frame, states] : sample.frames) {
      ASSERT_EQ(reader.seek(frame), Status::ok);
      Player player;
      ASSERT_EQ(player.play(reader, frame), Status::ok);
      ASSERT_EQ(player.states, states) << seed << ", " << frame;
    }
  }
}

}  // namespace
}  // namespace gicodec
