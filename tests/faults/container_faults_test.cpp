// Containers when memory or the disk runs out: a failed call changes nothing and can be made again.
#include "container_support.h"
#include "faults.h"

#include <gicodec/irradiance_vectors.h>

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
    const auto packet = maker.make(0, 0, i % 50 == 0, random, 3);
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
  const TextureRegion wanted[] = {{0, 0}, {1, 0}, {2, 1}, {2, 2}, {2, 3}, {2, 4}};
  ASSERT_EQ(until_enough([&] { return reader.select(wanted); }, [] {}), Status::ok);
  ASSERT_EQ(reader.seek(0), Status::ok);
  for (const ContainerPacket& expected : sample.packets) {
    ContainerPacket packet;
    ASSERT_EQ(until_enough([&] { return reader.next(packet); }, [] {}), Status::ok);
    ASSERT_TRUE(same_packet(packet, expected));
  }
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
