// What containers add to packets: bytes in the file, memory of readers and writers; never more than
// docs/guarantees.md says ("Size of a packet", "Memory").
#include "allocation_counter.h"
#include "container_support.h"
#include "memory_sink.h"

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

ContainerDescription one_texture(const TextureDesc& desc) {
  ContainerDescription description;
  const NamedTexture texture{"texture", desc};
  EXPECT_EQ(add_volume(description, "volume", *probe_volume(std::span(&texture, 1))), Status::ok);
  return description;
}

TEST(Memory, ContainersTakeLittle) {
  class Counting final : public Sink {
   public:
    explicit Counting(Bytes& file) : file_(file) {}
    Status write(std::span<const std::byte> bytes) override {
      std::ranges::copy(bytes, file_.begin() + static_cast<std::ptrdiff_t>(size));
      size += bytes.size();
      return Status::ok;
    }
    std::size_t size = 0;

   private:
    Bytes& file_;
  };
  Random random(83);
  const TextureDesc desc = probe_texture(Format::R32_SFLOAT, {16, 16, 2}, 16, 0);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = 4});
  std::vector<Packet> packets;
  std::size_t largest = 0;
  for (int i = 0; i < 500; ++i) {
    if (i % 100 == 7) texture.fill(Fill::noise, random);
    packets.push_back(*encoder.encode(std::as_const(texture).view()));
    largest = std::max(largest, packets.back().size());
  }
  Bytes file(packets.size() * (largest + 100));
  Counting sink(file);
  const std::size_t writing = heap_peak_of([&] {
    auto writer = *ContainerWriter::create(sink, one_texture(desc));
    for (std::size_t i = 0; i < packets.size(); ++i) {
      if (writer.add(i, packets[i]) != Status::ok) std::abort();
    }
    if (writer.finish() != Status::ok) std::abort();
  });
  EXPECT_LE(writing, 2 * largest + 64 + 256 * kKiB);
  std::size_t count = 0;
  const std::size_t reading = heap_peak_of([&] {
    const auto written = std::span(file).first(sink.size);
    MemorySource source(written);
    auto reader = *ContainerReader::open(source);
    for (ContainerPacket packet; reader.next(packet) == Status::ok;) ++count;
  });
  EXPECT_EQ(count, packets.size());
  EXPECT_LE(reading, 5 * (largest + 29) + 24 * packets.size() + 2 * kKiB);
}

TEST(Expansion, ContainersAddLittle) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {2, 1, 1}, 1, 0, Tiling::atlas_xy_z);
  const Texture texture(desc);
  auto encoder = *Encoder::create(desc, {.backend = "raw"});
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, one_texture(desc));
  constexpr std::uint64_t kPackets = 200;
  for (std::uint64_t i = 0; i < kPackets; ++i) {
    const auto packet = *encoder.encode(texture.view());
    const std::uint64_t before = writer.bytes_written();
    ASSERT_EQ(writer.add(i * (UINT64_MAX / kPackets), packet), Status::ok);
    EXPECT_LE(writer.bytes_written() - before, packet.size() + 29);
  }
  const std::uint64_t before = writer.bytes_written();
  ASSERT_EQ(writer.finish(), Status::ok);
  EXPECT_LE(writer.bytes_written() - before, 26 * kPackets + 35 + 49);
}

/// However far the last part of the index is from the end of a file that was cut off.
TEST(Expansion, LargeContainersThatWereCutOffCanBeSought) {
  const TextureDesc desc = probe_texture(Format::R32_SFLOAT, {16, 16, 8}, 16, 0);
  Texture texture(desc);
  auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = 1});
  Random random(84);
  texture.fill(Fill::noise, random);
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, one_texture(desc));
  const auto packet = *encoder.encode(std::as_const(texture).view(), Selection::all());
  std::uint64_t frames = 0;
  while (sink.bytes.size() < (std::size_t{18} << 20)) {
    ASSERT_EQ(writer.add(frames++, packet), Status::ok);
  }
  MemorySource source(std::span(sink.bytes).first(sink.bytes.size() - 1));
  auto reader = *ContainerReader::open(source);
  EXPECT_FALSE(reader.finished());
  const auto found = reader.frames();
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->size(), frames - 1);
  ASSERT_EQ(reader.seek(frames - 2), Status::ok);
  ContainerPacket last;
  ASSERT_EQ(reader.next(last), Status::ok);
  EXPECT_EQ(last.frame, frames - 2);
}

}  // namespace
}  // namespace gicodec
