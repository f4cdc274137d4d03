// Containers when memory or the disk runs out: a failed call changes nothing and can be made again.
#include "container_support.h"
#include "faults.h"

#include <gicodec/encoder.h>
#include <gicodec/irradiance_vectors.h>
#include <gicodec/player.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

namespace gicodec {
namespace {

using namespace test;

/// Calls again and again, with one allocation more each time, until there is enough; expects
/// out_of_memory and `unchanged` until then. Gives the last answer.
template <typename Call, typename Check>
auto until_enough(const Call& call, const Check& unchanged) {
  for (std::size_t nth = 1;; ++nth) {
    Fault fault(0, nth, false);
    auto answer = fault(call);
    if (!fault.failed()) return answer;
    if constexpr (std::is_same_v<decltype(answer), Status>) {
      EXPECT_EQ(answer, Status::out_of_memory) << nth;
    } else {
      EXPECT_EQ(answer.status(), Status::out_of_memory) << nth;
    }
    unchanged();
    if (testing::Test::HasFailure()) return answer;
  }
}

TEST(FailingContainer, AWriterGoesOnAfterEveryAllocation) {
  const auto sample = make_sample(7, 9, 4, 0);
  MemorySink sink;
  sink.bytes.reserve(2 * sample.bytes.size());
  std::size_t size = 0;
  const auto unchanged = [&] { EXPECT_EQ(sink.bytes.size(), size); };
  auto writer =
      until_enough([&] { return ContainerWriter::create(sink, sample.description); }, unchanged);
  ASSERT_TRUE(writer.ok());
  for (const ContainerPacket& packet : sample.packets) {
    size = sink.bytes.size();
    const auto add = [&] { return writer->add(packet.frame, packet.bytes, packet.region); };
    ASSERT_EQ(until_enough(add, unchanged), Status::ok);
    ASSERT_GT(sink.bytes.size(), size);
  }
  size = sink.bytes.size();
  ASSERT_EQ(until_enough([&] { return writer->finish(); }, unchanged), Status::ok);
  EXPECT_EQ(sink.bytes, sample.bytes);
}

/// Kinds are asked by applications, too.
TEST(FailingContainer, KindsThatAreBuiltInThrowNothing) {
  const auto check = [](const VolumeDesc& volume) {
    const Kind& kind = *find_kind(volume.kind);
    std::vector<std::byte> description;
    const auto write = [&] {
      description = {};
      return kind.write(volume, description);
    };
    ASSERT_EQ(until_enough(write, [] {}), Status::ok);
    const auto volume_again = until_enough([&] { return kind.read(description); }, [] {});
    ASSERT_TRUE(volume_again.ok());
    EXPECT_TRUE(same_but_layout(*volume_again, volume));
  };
  check(sample_description().volumes[0].desc);
  check(*irradiance_vector_volume({3, 2, 1}));
}

/// The packet with which an index part is written, and parts written on demand.
TEST(FailingContainer, AnIndexPartIsWrittenAfterEveryAllocation) {
  const auto description = sample_description();
  PacketMaker maker(description);
  Random random(9);
  MemorySink sink, expected;
  auto writer = *ContainerWriter::create(sink, description);
  auto other = *ContainerWriter::create(expected, description);
  std::size_t size = 0;
  const auto unchanged = [&] { EXPECT_EQ(sink.bytes.size(), size); };
  for (std::size_t i = 0; i < kPartPackets + 2; ++i) {
    const auto packet = maker.make(0, kWhole, i % 50 == 0, random, 3);
    ASSERT_EQ(other.add(i, packet), Status::ok);
    sink.bytes.reserve(expected.bytes.size());
    size = sink.bytes.size();
    if (i + 3 < kPartPackets) {
      ASSERT_EQ(writer.add(i, packet), Status::ok);
    } else {
      ASSERT_EQ(until_enough([&] { return writer.add(i, packet); }, unchanged), Status::ok);
    }
  }
  ASSERT_EQ(other.flush(), Status::ok);
  sink.bytes.reserve(expected.bytes.size());
  size = sink.bytes.size();
  ASSERT_EQ(until_enough([&] { return writer.flush(); }, unchanged), Status::ok);
  EXPECT_EQ(sink.bytes, expected.bytes);
}

TEST(FailingContainer, AReaderOpensAfterEveryAllocation) {
  const auto sample = make_sample(7);
  const auto open = [&] {
    MemorySource source(sample.bytes);
    return ContainerReader::open(source).status();
  };
  EXPECT_EQ(until_enough(open, [] {}), Status::ok);
}

/// A reader that can go back loses nothing.
TEST(FailingContainer, AReaderGoesOnAfterEveryAllocation) {
  const auto sample = make_sample(7);
  // Without the last part, so that seeking reads what it would have listed.
  const auto cut = std::span(sample.bytes).first(static_cast<std::size_t>(sample.parts.back()));
  MemorySource source(cut);
  auto reader = *ContainerReader::open(source);
  const std::uint64_t frame = sample.frames.rbegin()->first;
  ASSERT_EQ(until_enough([&] { return reader.seek(frame); }, [] {}), Status::ok);
  const TextureRegion wanted[] = {{0}, {1}, {2, 0}, {2, 1}, {2, 2}, {2, 3}};
  ASSERT_EQ(until_enough([&] { return reader.select(wanted); }, [] {}), Status::ok);
  ASSERT_EQ(reader.seek(0), Status::ok);
  for (const ContainerPacket& expected : sample.packets) {
    ContainerPacket packet;
    ASSERT_EQ(until_enough([&] { return reader.next(packet); }, [] {}), Status::ok);
    ASSERT_TRUE(same_packet(packet, expected));
  }
}

TEST(FailingContainer, MetadataIsWrittenAndReadAfterEveryAllocation) {
  const Metadata metadata{{"manifest", std::string(100'000, 'm')}, {"frame", "1"}};
  MemorySink sink;
  sink.bytes.reserve(std::size_t{1} << 20);
  auto writer = *ContainerWriter::create(sink, sample_description());
  const std::size_t size = sink.bytes.size();
  ASSERT_EQ(until_enough([&] { return writer.add_metadata(1, metadata); },
                         [&] { EXPECT_EQ(sink.bytes.size(), size); }),
            Status::ok);
  ASSERT_EQ(writer.finish(), Status::ok);
  MemorySource source(sink.bytes);
  auto reader = *ContainerReader::open(source);
  EXPECT_EQ(*until_enough([&] { return reader.metadata(1); }, [] {}), metadata);
  EXPECT_TRUE(until_enough([&] { return reader.metadata(0); }, [] {})->empty());
}

/// A player goes on with the packet for which there was no memory.
TEST(FailingContainer, APlayerGoesOnAfterEveryAllocation) {
  const TextureDesc desc = probe_texture(Format::R8G8B8A8_UNORM, {4, 3, 2}, 4, 1);
  ContainerDescription description =
      probe_description(std::vector<ProbeTexture>{{"a", desc}, {"b", desc}});
  description.volumes[0].region = {2, 3, 1};
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  std::vector<Encoder> encoders;
  for (std::uint32_t part = 0; part < 8; ++part) {
    EncoderOptions options;
    options.texture_id = static_cast<std::uint8_t>(part / 4);
    encoders.push_back(*Encoder::create(region_texture(desc, {2, 3, 1}, part % 4), options));
  }
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    for (std::uint32_t part = 0; part < 8; ++part) {
      const Bytes texels(static_cast<std::size_t>(texture_bytes(encoders[part].desc())),
                         static_cast<std::byte>(8 * frame + part));
      ASSERT_EQ(writer.add(frame, *encoders[part].encode(ConstTextureView(texels)), part % 4),
                Status::ok);
    }
  }
  ASSERT_EQ(writer.finish(), Status::ok);
  const auto played = [&](bool short_of_memory, std::optional<std::uint64_t> sought) {
    MemorySource source(sink.bytes);
    auto player = *ContainerPlayer::open(source);
    const auto call = [&](const auto& step) {
      return short_of_memory ? until_enough(step, [] {}) : step();
    };
    if (sought) {
      EXPECT_EQ(call([&] { return player.seek(*sought); }), Status::ok);
    }
    std::vector<Bytes> all;
    for (std::uint64_t frame = sought.value_or(0); frame < 3; ++frame) {
      EXPECT_EQ(call([&] { return player.next(); }), Status::ok);
      EXPECT_EQ(player.frame(), frame);
      EXPECT_EQ(player.packets().size(), 8U);
      for (std::uint8_t texture = 0; texture < 2; ++texture) {
        EXPECT_EQ(player.changed(texture).size(), block_count(desc));
        Bytes& texels = all.emplace_back(static_cast<std::size_t>(texture_bytes(desc)));
        EXPECT_EQ(call([&] { return player.read_changed(texture, TextureView{texels}); }),
                  Status::ok);
      }
    }
    EXPECT_EQ(player.next(), Status::end);
    return all;
  };
  EXPECT_EQ(played(true, std::nullopt), played(false, std::nullopt));
  EXPECT_EQ(played(true, 2), played(false, 2));
}

/// A file that may not grow beyond a size, as on a full disk.
class Narrow {
 public:
  Narrow() : handler_(std::signal(SIGXFSZ, SIG_IGN)) { getrlimit(RLIMIT_FSIZE, &before_); }
  Narrow(const Narrow&) = delete;
  Narrow& operator=(const Narrow&) = delete;
  ~Narrow() {
    widen();
    std::signal(SIGXFSZ, handler_);
  }
  void to(std::size_t bytes) const {
    const rlimit narrow{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &narrow);
  }
  void widen() const { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(FailingContainer, AFileGoesOnWhenThereIsRoomAgain) {
  const auto sample = make_sample(7, 9, 4, 0);
  const Narrow narrow;
  for (std::size_t room = 1; room < sample.bytes.size(); room += 29) {
    std::FILE* file = std::tmpfile();
    ASSERT_NE(file, nullptr);
    FileSink sink(file);
    narrow.to(room);
    const auto repeated = [&](auto&& call) {
      Status status = call();
      if (status == Status::ok) return status;
      EXPECT_EQ(status, Status::io_failed);
      narrow.widen();
      return call();
    };
    Result<ContainerWriter> writer = Status::io_failed;
    (void)repeated([&] {
      writer = ContainerWriter::create(sink, sample.description);
      return writer.status();
    });
    ASSERT_TRUE(writer.ok());
    for (const ContainerPacket& packet : sample.packets) {
      ASSERT_EQ(repeated([&] { return writer->add(packet.frame, packet.bytes, packet.region); }),
                Status::ok);
    }
    ASSERT_EQ(repeated([&] { return writer->finish(); }), Status::ok);
    Bytes written(sample.bytes.size() + 1);
    std::rewind(file);
    written.resize(std::fread(written.data(), 1, written.size(), file));
    EXPECT_EQ(written, sample.bytes) << room;
    std::fclose(file);
  }
}

TEST(FailingContainer, APipeThatBrokeStaysBroken) {
  std::signal(SIGPIPE, SIG_IGN);
  std::FILE* pipe = popen("true", "w");
  ASSERT_NE(pipe, nullptr);
  FileSink sink(pipe);
  const Bytes bytes(std::size_t{1} << 17);
  // Its reader ends at some time.
  while (sink.write(bytes) == Status::ok) continue;
  EXPECT_EQ(sink.write(std::span(bytes).first(1)), Status::io_failed);
  pclose(pipe);
}

}  // namespace
}  // namespace gicodec
