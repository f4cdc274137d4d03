// Metadata entries of containers: what is long, packed beside the description, and read on demand.
#include "container_support.h"

#include "base/compressor.h"
#include "bitstream/container_metadata.h"

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

std::vector<Metadata> sample_metadata() {
  Metadata frames;
  for (int i = 0; i < 1000; ++i) frames.emplace_back("frame " + std::to_string(i), "value");
  return {frames, {}, {{"manifest", std::string(std::size_t{3} << 20, 'm')}, {"", ""}}};
}

Sample sample_with_metadata() {
  static const auto metadata = sample_metadata();
  return make_sample(21, 6, 4, 3, metadata);
}

/// A container of these entries behind the sample's description.
Bytes file_of(const Bytes& entries) { return head_of(sample_description()) + entries; }

/// A metadata entry of any fields.
Bytes metadata_entry(std::uint8_t texture, std::uint64_t said, std::span<const std::byte> plain) {
  Bytes body;
  ByteWriter writer(body);
  writer.fixed(texture);
  writer.varint(said);
  auto compressor = *Compressor::create(Compression::zstd, 1);
  EXPECT_EQ(compressor.compress(plain, body), Status::ok);
  return entry(5, body);
}

Bytes metadata_entry(std::uint8_t texture, const Metadata& metadata) {
  Bytes plain;
  ByteWriter writer(plain);
  write_metadata(metadata, writer);
  return metadata_entry(texture, plain.size(), plain);
}

/// What a reader says of a texture's metadata, from memory and as a pipe.
Status status_of(const Bytes& file, std::uint8_t texture, const DecodeLimits& limits = {}) {
  MemorySource memory(file);
  PipeSource pipe(file);
  auto reader = ContainerReader::open(memory, limits);
  auto piped = ContainerReader::open(pipe, limits);
  if (!reader || !piped) return reader.status();
  const Status status = reader->metadata(texture).status();
  EXPECT_EQ(piped->metadata(texture).status(), status);
  return status;
}

TEST(ContainerMetadata, RoundTripFromMemoryAndPipe) {
  const auto sample = sample_with_metadata();
  const auto expected = sample_metadata();
  ASSERT_FALSE(sample.bytes.empty());
  EXPECT_LT(sample.bytes.size(), 20'000U);
  for (const bool first : {false, true}) {
    MemorySource memory(sample.bytes);
    PipeSource pipe(sample.bytes);
    for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
      auto reader = ContainerReader::open(*source);
      ASSERT_TRUE(reader.ok()) << reader.status();
      const auto check = [&] {
        for (std::uint8_t i = 0; i < 3; ++i) EXPECT_EQ(*reader->metadata(i), expected[i]);
        EXPECT_EQ(reader->metadata(3).status(), Status::unknown_texture);
      };
      if (first) check();
      std::vector<ContainerPacket> packets;
      EXPECT_EQ(read_all(*reader, packets), Status::ok);
      EXPECT_TRUE(same_packets(packets, sample.packets));
      check();
    }
  }
}

TEST(ContainerMetadata, IsReadOnDemand) {
  const auto sample = sample_with_metadata();
  GrowingSource source(sample.bytes, sample.bytes.size());
  auto reader = *ContainerReader::open(source);
  EXPECT_TRUE(reader.seekable());
  std::vector<ContainerPacket> packets;
  EXPECT_EQ(read_all(reader, packets), Status::ok);
  const std::size_t without = source.read_bytes;
  ASSERT_TRUE(reader.metadata(0).ok());
  EXPECT_GT(source.read_bytes, without + 500);
}

TEST(ContainerMetadata, EveryPrefixGivesWhatIsBeforeTheCut) {
  const auto sample = sample_with_metadata();
  const auto expected = sample_metadata();
  for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
    const Exact cut{std::span(sample.bytes).first(size)};
    const auto whole = sample.packets_before(size);
    MemorySource memory(cut.span());
    PipeSource pipe(cut.span());
    for (Source* source : {static_cast<Source*>(&memory), static_cast<Source*>(&pipe)}) {
      auto reader = ContainerReader::open(*source);
      if (!reader) continue;
      const auto metadata = reader->metadata(0);
      if (metadata) {
        ASSERT_TRUE(metadata->empty() || *metadata == expected[0]) << size;
      } else {
        ASSERT_EQ(metadata.status(), Status::truncated);
      }
      ASSERT_TRUE(metadata || whole.empty()) << size;
      std::vector<ContainerPacket> packets;
      const Status status = read_all(*reader, packets);
      ASSERT_TRUE(status == Status::truncated || (!metadata && source == &pipe)) << status;
      ASSERT_TRUE(same_packets(packets, whole)) << size;
    }
  }
}

TEST(ContainerMetadata, AFileThatGrows) {
  const auto sample = sample_with_metadata();
  const auto expected = sample_metadata();
  GrowingSource source(sample.bytes, head_of(sample.description).size());
  auto reader = *ContainerReader::open(source);
  EXPECT_TRUE(reader.metadata(0)->empty());
  std::vector<ContainerPacket> packets;
  while (source.visible < sample.bytes.size()) {
    EXPECT_EQ(read_all(reader, packets), Status::truncated);
    source.visible = std::min(source.visible + 97, sample.bytes.size());
  }
  EXPECT_EQ(read_all(reader, packets), Status::ok);
  EXPECT_TRUE(same_packets(packets, sample.packets));
  EXPECT_EQ(*reader.metadata(0), expected[0]);
  EXPECT_EQ(*reader.metadata(2), expected[2]);
  ASSERT_TRUE(reader.seekable());
  EXPECT_EQ(reader.seek(sample.packets.back().frame), Status::ok);
}

TEST(ContainerMetadata, WriterRefusesWhatItsReaderWould) {
  const auto description = sample_description();
  const Metadata some{{"a", "b"}};
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  const std::size_t size = sink.bytes.size();
  EXPECT_EQ(writer.add_metadata(3, some), Status::unknown_texture);
  EXPECT_EQ(writer.add_metadata(0, {{"\xFF", ""}}), Status::invalid_description);
  EXPECT_EQ(writer.add_metadata(0, {{"", "\xFF"}}), Status::invalid_description);
  const std::string half(std::size_t{32} << 20, 'h');
  EXPECT_EQ(writer.add_metadata(0, {{half, half}}), Status::limit_exceeded);
  EXPECT_EQ(writer.add_metadata(0, Metadata(kMaxPackedEntries + 1)), Status::limit_exceeded);
  EXPECT_EQ(writer.add_metadata(0, {}), Status::ok);
  EXPECT_EQ(sink.bytes.size(), size);
  EXPECT_EQ(writer.add_metadata(0, {{"half", half}}), Status::ok);
  EXPECT_EQ(writer.add_metadata(0, some), Status::out_of_order);
  EXPECT_EQ(writer.add_metadata(1, {{"half", half}}), Status::limit_exceeded);
  EXPECT_EQ(writer.add_metadata(1, some), Status::ok);
  PacketMaker maker(description);
  Random random(3);
  ASSERT_EQ(writer.add(0, maker.make(0, kWhole, true, random)), Status::ok);
  EXPECT_EQ(writer.add_metadata(2, some), Status::out_of_order);
  ASSERT_EQ(writer.finish(), Status::ok);
  MemorySource source(sink.bytes);
  auto reader = *ContainerReader::open(source);
  EXPECT_EQ(reader.metadata(0)->front().second, half);
  EXPECT_EQ(*reader.metadata(1), some);
  EXPECT_TRUE(reader.metadata(2)->empty());
}

TEST(HostileMetadata, OrderAndTextures) {
  const Metadata some{{"a", "b"}};
  const Bytes end = end_entry(0);
  EXPECT_EQ(status_of(file_of(metadata_entry(0, some) + metadata_entry(2, some) + end), 2),
            Status::ok);
  EXPECT_EQ(status_of(file_of(metadata_entry(1, some) + metadata_entry(0, some) + end), 0),
            Status::corrupt);
  EXPECT_EQ(status_of(file_of(metadata_entry(1, some) + metadata_entry(1, some) + end), 1),
            Status::corrupt);
  EXPECT_EQ(status_of(file_of(metadata_entry(3, some) + end), 0), Status::corrupt);
  // Behind a packet, and where a packet is after damage.
  const auto sample = sample_with_metadata();
  Bytes late(sample.bytes.begin(),
             sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[0]));
  late = late + metadata_entry(2, some);
  EXPECT_EQ(read_through(late), Status::corrupt);
  EXPECT_EQ(read_through(late, true), Status::corrupt);
  Bytes damaged = sample.bytes;
  damaged[head_of(sample.description).size() + 3] = std::byte{9};  // texture 9
  MemorySource source(damaged);
  auto reader = *ContainerReader::open(source);
  ContainerPacket packet;
  EXPECT_EQ(reader.next(packet), Status::corrupt);
  EXPECT_EQ(reader.metadata(0).status(), Status::corrupt);
}

TEST(HostileMetadata, Contents) {
  const auto text = [](std::string_view plain, std::uint64_t said) {
    return status_of(
        file_of(metadata_entry(0, said, std::as_bytes(std::span(plain))) + end_entry(0)), 0);
  };
  using namespace std::string_view_literals;
  EXPECT_EQ(text("\1\1a\1b"sv, 5), Status::ok);
  EXPECT_EQ(text("\1\1a\1b"sv, 4), Status::corrupt);
  EXPECT_EQ(text("\1\1a\1b"sv, 6), Status::corrupt);
  EXPECT_EQ(text("\1\1a\1b"sv, kMaxPackedMetadata + 1), Status::corrupt);
  EXPECT_EQ(text("\1\1a\1bc"sv, 6), Status::corrupt);
  EXPECT_EQ(text("\2\1a\1b"sv, 5), Status::corrupt);
  EXPECT_EQ(text("\1\1a\2b"sv, 5), Status::corrupt);
  EXPECT_EQ(text("\1\1a\1\xFF"sv, 5), Status::corrupt);
  EXPECT_EQ(text(""sv, 0), Status::corrupt);
  Bytes flipped = metadata_entry(0, {{"a", "b"}});
  flipped[flipped.size() - 6] ^= std::byte{1};
  EXPECT_EQ(status_of(file_of(flipped + end_entry(0)), 0), Status::checksum_mismatch);
  EXPECT_EQ(status_of(file_of(entry(5, {}) + end_entry(0)), 0), Status::corrupt);
}

/// What unpacks to much is refused by what it says, and many empty names by their count.
TEST(HostileMetadata, Limits) {
  const Bytes zeros(std::size_t{1} << 20);
  const Bytes file = file_of(metadata_entry(0, zeros.size(), zeros) +
                             metadata_entry(1, zeros.size(), zeros) + end_entry(0));
  const auto with = [&](std::uint64_t bytes) {
    DecodeLimits limits;
    limits.max_metadata_bytes = bytes;
    return status_of(file, 1, limits);
  };
  EXPECT_EQ(with(2 * zeros.size()), Status::corrupt);  // zeros are no metadata
  EXPECT_EQ(with(2 * zeros.size() - 1), Status::limit_exceeded);
  EXPECT_EQ(with(zeros.size() - 1), Status::limit_exceeded);
  EXPECT_EQ(with(10), Status::limit_exceeded);
  Bytes endless;
  ByteWriter head(endless);
  head.fixed(std::uint8_t{5});
  head.varint(std::uint64_t{1} << 40);
  EXPECT_EQ(status_of(file_of(endless), 0), Status::limit_exceeded);
  Bytes many;
  ByteWriter writer(many);
  writer.varint(kMaxPackedEntries + 1);
  many.resize(many.size() + 2 * (kMaxPackedEntries + 1));
  EXPECT_EQ(status_of(file_of(metadata_entry(0, many.size(), many) + end_entry(0)), 0),
            Status::corrupt);
}

}  // namespace
}  // namespace gicodec
