// Guard band sections on their own: round trips, and sections an encoder never writes.
#include "shapes.h"
#include "support.h"

#include "base/bytes.h"
#include "bitstream/index_buffer.h"
#include "stream/guard_band_section.h"
#include "stream/mirror.h"
#include "texture/guard_band.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;
using Blocks = std::vector<std::uint32_t>;

RC_GTEST_PROP(GuardBandSection, WriteAndReadAreInverse, (std::uint64_t seed)) {
  Random random(seed);
  auto desc = probe_desc(random, 6000);
  desc.guard_band = 1;
  desc.record = any_record(random);
  const auto total = block_count(desc);
  Mirror mirror(desc);
  // A mirror that already holds some stale bands.
  Blocks all(total);
  std::iota(all.begin(), all.end(), 0U);
  StaleBands held;
  for (const auto block : random_selection(random, total)) {
    held.add(block, noise(random, band_bytes(desc)));
  }
  mirror.make_room(held);
  const auto bytes = noise(random, total * block_bytes(desc));
  Vector<std::byte> held_records(bytes.begin(), bytes.end());
  mirror.commit(true, all, held_records, {}, held);

  Blocks update = random_selection(random, total);
  if (update.empty()) update = {pick(random, 0, total - 1)};
  const auto records = noise(random, update.size() * block_bytes(desc));
  const bool keyframe = chance(random, 2);
  StaleBands before;
  for (const auto block : update) {
    const auto band = mirror.stale_band(block);
    if (!band.empty()) before.add(block, band);
  }
  const GuardBandContext context{
      desc, keyframe, update, {records.data(), block_bytes(desc)}, mirror.blocks(), before};
  StaleBands stale;
  for (const auto block : update) {
    if (chance(random, 3)) continue;
    Bytes band = noise(random, band_bytes(desc));
    const auto now = mirror.stale_band(block);
    if (!now.empty() && chance(random, 2)) band.assign(now.begin(), now.end());  // As before.
    stale.add(block, band);
  }
  if (stale.empty()) stale.add(update[0], noise(random, band_bytes(desc)));

  Bytes section;
  GuardBandMemory memory;
  RC_ASSERT(write_guard_band_section(context, stale, memory, section) == Status::ok);
  RC_ASSERT(section.size() <= guard_band_section_bound(desc, update.size(), stale.size()));
  const Exact exact{std::span(section)};
  StaleBands back;
  RC_ASSERT(read_guard_band_section(desc, update, exact.span(), memory, back) == Status::ok);
  resolve_guard_bands(context, back);
  RC_ASSERT(back == stale);

  for (std::size_t size = 0; size < section.size(); ++size) {
    const Exact cut{std::span(section).first(size)};
    // The binary coder takes any bytes, the same bands from no others.
    StaleBands other;
    if (read_guard_band_section(desc, update, cut.span(), memory, other) == Status::ok) {
      resolve_guard_bands(context, other);
      RC_ASSERT(!(other == stale));
    }
    if (size > 40 && size + 40 < section.size()) size += 30;
  }
}

TEST(GuardBandSection, SectionsThatBreakTheFormat) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {4, 1, 1}, 1, 1, Tiling::atlas_xy_z);
  const std::size_t band = band_bytes(desc);
  ASSERT_EQ(band, 16U);
  const auto read = [&](std::initializer_list<int> head, std::size_t bytes,
                        const TextureDesc& texture, const Blocks& update) {
    Bytes section;
    for (const int byte : head) section.push_back(static_cast<std::byte>(byte));
    section.resize(section.size() + bytes);
    const Exact exact{std::span(section)};
    StaleBands bands;
    GuardBandMemory memory;
    return read_guard_band_section(texture, update, exact.span(), memory, bands);
  };
  const auto sound = [&](std::initializer_list<int> head, std::size_t bytes) {
    return read(head, bytes, desc, {0, 1, 3});
  };
  constexpr int kAll = 0, kBitmap = 1, kGaps = 2, kNone = 0, kCoded = 1;
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * band), Status::ok);
  EXPECT_EQ(sound({kBitmap, 1, 1, 4, kNone}, band), Status::ok);
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * band + 1), Status::corrupt);
  EXPECT_EQ(sound({kAll, 3, 0, kNone}, 3 * band - 1), Status::corrupt);
  EXPECT_EQ(sound({kAll, 2, 0, kNone}, 2 * band), Status::corrupt);
  EXPECT_EQ(sound({kAll, 4, 0, kNone}, 4 * band), Status::corrupt);
  EXPECT_EQ(sound({kBitmap, 1, 1, 8, kNone}, band), Status::corrupt);  // Place 3 of 3.
  EXPECT_EQ(sound({kGaps, 0, 0, kNone}, 0), Status::corrupt);          // No band at all.
  EXPECT_EQ(sound({4, 3, 0, kNone}, 3 * band), Status::corrupt);
  EXPECT_EQ(sound({kAll, 3, 0, kCoded + 1}, 3 * band), Status::unsupported_feature);
  EXPECT_EQ(sound({kAll, 3, 0, 255}, 3 * band), Status::unsupported_feature);
  EXPECT_EQ(sound({kAll, 3, 0, kCoded}, 3 * band), Status::corrupt);
  EXPECT_EQ(sound({}, 0), Status::truncated);
  EXPECT_EQ(read({kAll, 1, 0, kNone}, band, desc, {}), Status::corrupt);
  TextureDesc bare = desc;
  bare.guard_band = 0;
  EXPECT_EQ(read({kAll, 3, 0, kNone}, 3 * band, bare, {0, 1, 3}), Status::corrupt);
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
