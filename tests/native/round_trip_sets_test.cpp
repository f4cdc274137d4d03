// Payloads of blocks that are sets (round_trip.h).
#include "native/round_trip.h"
#include "quantise/set_order.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec {
namespace {

using test::any_update;
using test::Bytes;
using test::check_everything;

TextureDesc any_sets(test::Random& random, const Record& record) {
  TextureDesc desc = pool_texture(record, test::pick(random, 1, 12), {1, 1, 1});
  desc.model = Model::unordered;
  desc.presence = test::chance(random, 2) ? Presence::count : Presence::all;
  desc.block = {static_cast<std::uint8_t>(test::pick(random, 1, 40)),
                static_cast<std::uint8_t>(test::pick(random, 1, 4)), 1};
  return desc;
}

/// Blocks that are sets, in the canonical order or in any.
RC_GTEST_PROP(NativeRoundTrip, AnySet, (std::uint64_t seed)) {
  test::Random random(seed);
  const TextureDesc desc = any_sets(random, test::any_record(random));
  ASSERT_EQ(validate(desc), Status::ok);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  auto u = any_update(desc, content, test::pick(random, 1, 3), seed);
  if (!test::chance(random, 4)) test::sort_sets(u);
  check_everything(u, {});
  RC_ASSERT(!testing::Test::HasFailure());
}

/// Blocks that are sets, of which the mirror has a part.
RC_GTEST_PROP(NativeRoundTrip, AnyUpdateOfSets, (std::uint64_t seed)) {
  test::Random random(seed);
  const TextureDesc desc = any_sets(random, test::any_record(random));
  const auto content = test::kContents[random() % std::size(test::kContents)];
  auto u = test::make_update(desc, content, false, test::pick(random, 1, 3), seed);
  if (!test::chance(random, 6)) test::sort_sets(u);
  test::make_previous(u, random, !test::chance(random, 6));
  check_everything(u, {});
  RC_ASSERT(!testing::Test::HasFailure());
}

/// Photons, as it were: many on walls.
test::UpdateCase points_on_walls(std::uint32_t count, bool sorted) {
  Record record;
  record.bytes = 12;
  for (const auto& [name, bits] :
       {std::pair("x", 16), {"y", 16}, {"z", 16}, {"u", 16}, {"p", 32}}) {
    const unsigned at = record.count == 0 ? 0
                                          : record.components[record.count - 1U].offset +
                                                record.components[record.count - 1U].bits;
    record.components[record.count++] = {name, static_cast<std::uint16_t>(at),
                                         static_cast<std::uint8_t>(bits), ComponentType::unorm};
  }
  TextureDesc desc = pool_texture(record, 1, {64, 64, 1});
  desc.model = Model::unordered;
  desc.presence = Presence::count;
  test::UpdateCase u{desc, {0}, Bytes(block_bytes(desc)), {}, {}, true, {}, false};
  u.presence = {std::byte(count & 255), std::byte(count >> 8)};
  test::Random random(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::uint16_t, 6> p{};
    for (auto& v : p) v = static_cast<std::uint16_t>(random());
    p[random() % 3] = static_cast<std::uint16_t>(random() % 3 * 20000);
    p[4] = p[5] = 77;
    std::memcpy(u.records.data() + i * sizeof p, p.data(), sizeof p);
  }
  if (sorted) test::sort_sets(u);
  return u;
}

/// Two coordinates of 16 bits, less log2(n!)/n bits for the order, 16 bits of noise, nothing else.
TEST(NativeRoundTrip, SetsCostWhatTheirPlacesAre) {
  for (const std::uint32_t count : {0U, 1U, 2U, 3U, 100U, 4096U}) {
    check_everything(points_on_walls(count, true), {});
    check_everything(points_on_walls(count, false), {});
  }
  const double ideal = 4096 * (32 + 1.58 - 10.56 + 16 + 1.58) / 8;
  const auto size =
      static_cast<double>(test::encode(points_on_walls(4096, true), {}, best_isa()).size());
  EXPECT_LE(size, 1.15 * ideal);
}

/// A retained record costs a flag, and an empty mirror nothing.
TEST(NativeRoundTrip, UpdatesOfSetsCostWhatIsNew) {
  const auto size = [](const test::UpdateCase& u) {
    return static_cast<double>(test::encode(u, {}, best_isa()).size());
  };
  constexpr std::size_t kCount = 4096, kRecord = 12;
  const auto key = points_on_walls(kCount, true);
  auto u = key;
  u.keyframe = false;
  u.received = {1};
  u.mirror = points_on_walls(kCount - 1, true).records;
  EXPECT_LE(size(u), 1.001 * size(key) + 2);
  check_everything(u, {});

  u.mirror = u.records;
  EXPECT_LE(size(u), 16);
  test::Random random(1);
  for (std::size_t i = 0; i < kCount; i += 16) {
    u.mirror[i * kRecord + 6] ^= std::byte{1};  // behind its place
    std::generate_n(&u.mirror[(i + 8) * kRecord], 6,
                    [&] { return static_cast<std::byte>(random()); });
  }
  sort_set(u.desc.record, u.mirror);
  EXPECT_LE(size(u), size(key) / 8);
  check_everything(u, {});
}

TEST(NativeRoundTrip, SetsOfOneAndTheSame) {
  for (const bool zero : {true, false}) {
    auto u = points_on_walls(500, true);
    for (std::size_t i = 0; i < 500 * 12; ++i)
      u.records[i] = zero ? std::byte{0} : u.records[i % 12];
    check_everything(u, {});
    EXPECT_LE(test::encode(u, {}, best_isa()).size(), 200U);
    std::fill_n(u.records.begin() + 12 * 100, 12 * 400, std::byte{0});
    test::sort_sets(u);
    check_everything(u, {});
  }
}

}  // namespace
}  // namespace gicodec
