// Guard band sections on their own: round trips, and sections an encoder never writes.
#include "support.h"

#include "base/bytes.h"
#include "bitstream/index_buffer.h"
#include "stream/border_section.h"
#include "texture/guard_band.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;
using Probes = std::vector<std::uint32_t>;

RC_GTEST_PROP(BorderSection, WriteAndReadAreInverse, (std::uint64_t seed)) {
  Random random(seed);
  auto desc = random_desc(random, 6000);
  desc.border = 1;
  const auto total = probe_count(desc);
  Mirror mirror(desc);
  // A mirror that already holds some stale rings.
  Probes all(total);
  std::iota(all.begin(), all.end(), 0U);
  StaleRings held;
  for (const auto probe : random_selection(random, total)) {
    held.add(probe, noise(random, ring_bytes(desc)));
  }
  mirror.make_room(held);
  mirror.commit(true, all, noise(random, total * core_bytes(desc)), held);

  Probes update = random_selection(random, total);
  if (update.empty()) update = {pick(random, 0, total - 1)};
  const auto cores = noise(random, update.size() * core_bytes(desc));
  const bool keyframe = chance(random, 2);
  const BorderContext context{mirror, keyframe, update, cores};
  StaleRings stale;
  for (const auto probe : update) {
    if (chance(random, 3)) continue;
    Bytes ring = noise(random, ring_bytes(desc));
    if (chance(random, 2)) mirror.ring(probe, ring);  // As before: no difference.
    stale.add(probe, ring);
  }
  if (stale.empty()) stale.add(update[0], noise(random, ring_bytes(desc)));

  Bytes section;
  RC_ASSERT(write_border_section(context, stale, section) == Status::ok);
  RC_ASSERT(section.size() <= border_section_bound(desc, update.size(), stale.size()));
  const Exact exact{std::span(section)};
  StaleRings back;
  RC_ASSERT(read_border_section(desc, update, exact.span(), back) == Status::ok);
  resolve_borders(context, back);
  RC_ASSERT(back == stale);

  for (std::size_t size = 0; size < section.size(); ++size) {
    const Exact cut{std::span(section).first(size)};
    StaleRings none;
    RC_ASSERT(read_border_section(desc, update, cut.span(), none) != Status::ok);
    if (size > 40 && size + 40 < section.size()) size += 30;
  }
}

TEST(BorderSection, SectionsThatBreakTheFormat) {
  const TextureDesc desc{Format::R16_SFLOAT, {4, 1, 1}, 1, 1, Tiling::atlas_xy_z};
  const std::size_t ring = ring_bytes(desc);
  ASSERT_EQ(ring, 16U);
  const auto read = [&](std::initializer_list<int> head, std::size_t texels,
                        const TextureDesc& texture, const Probes& update) {
    Bytes section;
    for (const int byte : head) section.push_back(static_cast<std::byte>(byte));
    section.resize(section.size() + texels);
    const Exact exact{std::span(section)};
    StaleRings rings;
    return read_border_section(texture, update, exact.span(), rings);
  };
  const auto sound = [&](std::initializer_list<int> head, std::size_t texels) {
    return read(head, texels, desc, {0, 1, 3});
  };
  constexpr int kAll = 0, kBitmap = 1, kGaps = 2, kNone = 0, kLz4 = 1, kZstd = 2;
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * ring), Status::ok);
  EXPECT_EQ(sound({kBitmap, 1, 1, 4, kNone}, ring), Status::ok);
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * ring + 1), Status::corrupt);
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * ring - 1), Status::corrupt);
  EXPECT_EQ(sound({kAll, 2, 0, kNone}, 2 * ring), Status::corrupt);
  EXPECT_EQ(sound({kAll, 4, 0, kNone}, 4 * ring), Status::corrupt);
  EXPECT_EQ(sound({kBitmap, 1, 1, 8, kNone}, ring), Status::corrupt);  // Place 3 of 3.
  EXPECT_EQ(sound({kGaps, 0, 0, kNone}, 0), Status::corrupt);          // No ring at all.
  EXPECT_EQ(sound({4, 3, 0, kNone}, 3 * ring), Status::corrupt);
  EXPECT_EQ(sound({kAll, 3, 0, kLz4}, 3 * ring), Status::unsupported_feature);
  EXPECT_EQ(sound({kAll, 3, 0, 255}, 3 * ring), Status::unsupported_feature);
  EXPECT_EQ(sound({kAll, 3, 0, kZstd}, 3 * ring), Status::corrupt);
  EXPECT_EQ(sound({}, 0), Status::truncated);
  EXPECT_EQ(read({kAll, 1, 0, kNone}, ring, desc, {}), Status::corrupt);
  TextureDesc bare = desc;
  bare.border = 0;
  EXPECT_EQ(read({kAll, 3, 0, kNone}, 3 * ring, bare, {0, 1, 3}), Status::corrupt);
}

TEST(ByteCursors, VarintsAndEnds) {
  for (unsigned shift = 0; shift < 64; ++shift) {
    for (const int around : {-1, 0, 1}) {
      const std::uint64_t value = (std::uint64_t{1} << shift) + static_cast<std::uint64_t>(around);
      Bytes bytes;
      ByteWriter(bytes).varint(value);
      EXPECT_LE(bytes.size(), kMaxVarint);
      const Exact exact{std::span(bytes)};
      ByteReader reader(exact.span());
      EXPECT_EQ(reader.varint(), value);
      EXPECT_TRUE(reader.ok() && reader.rest().empty());
      ByteReader limited(exact.span());
      if (value > 0) {
        EXPECT_EQ(limited.varint(value - 1), 0U);
        EXPECT_EQ(limited.status(), Status::corrupt);
      }
      const Exact cut{std::span(bytes).first(bytes.size() - 1)};
      ByteReader short_reader(cut.span());
      EXPECT_EQ(short_reader.varint(), 0U);
      EXPECT_EQ(short_reader.status(), Status::truncated);
    }
  }
  const auto refused = [](std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
    ByteReader reader(bytes);
    (void)reader.varint();
    return reader.status();
  };
  EXPECT_EQ(refused({0x80, 0x00}), Status::corrupt);
  EXPECT_EQ(refused({255, 255, 255, 255, 255, 255, 255, 255, 255, 2}), Status::corrupt);
  EXPECT_EQ(refused({255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1}), Status::corrupt);
  EXPECT_EQ(refused({255, 255, 255, 255, 255, 255, 255, 255, 255, 1}), Status::ok);
}

}  // namespace
}  // namespace gicodec
