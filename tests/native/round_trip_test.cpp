// Payloads: exact for everything, the same bytes on every instruction set and number of threads,
// and what the reference decoder reads.
#include "native/content.h"
#include "native/reference_decoder.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec {
namespace {

using test::Bytes;

Bytes decode(const test::UpdateCase& u, std::span<const std::byte> payload, unsigned threads,
             Isa isa) {
  const test::Exact exact(payload), mirror(u.mirror);
  test::Exact out(u.texels.size());
  std::vector<native::Workspace> workspaces;
  auto job = u.decode_job(exact.span(), out.span());
  job.mirror = mirror.span();
  job.threads = threads;
  EXPECT_EQ(native::decode_payload(job, isa, workspaces), Status::ok);
  return {out.span().begin(), out.span().end()};
}

void check_everything(test::UpdateCase u, native::PayloadSettings settings) {
  SCOPED_TRACE(rc::toString(u.desc) + (u.keyframe ? " keyframe" : " update"));
  const Bytes payload = test::encode(u, settings, Isa::scalar);
  EXPECT_LE(payload.size(), native::payload_bound(u.desc, u.probes.size()));
  static unsigned turn = 0;
  const bool all = test::everything();
  const auto isas = supported_isas();
  for (const Isa isa : all ? isas : isas.subspan(turn++ % isas.size(), 1)) {
    SCOPED_TRACE(to_string(isa));
    for (const unsigned threads : {1U, 2U, 7U}) {
      if (threads > 1 && (isa != best_isa() || (!all && threads != (turn % 8 < 4 ? 2 : 7))))
        continue;
      settings.threads = threads;
      EXPECT_EQ(test::encode(u, settings, isa), payload);
      EXPECT_EQ(decode(u, payload, threads, isa), u.texels);
    }
  }
  const auto expected = reference::decode(u.desc, u.probes, u.mirror, payload);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(*expected, u.texels);
}

RC_GTEST_PROP(NativeRoundTrip, AnyTexture, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto desc = test::any_desc(random);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  settings.chunk.strong = test::chance(random, 4);
  if (test::chance(random, 2)) {
    settings.box = {test::pick(random, 1, desc.grid.x), test::pick(random, 1, desc.grid.y),
                    test::pick(random, 1, desc.grid.z)};
  }
  if (test::chance(random, 3)) settings.chunk.lanes = 1U << test::pick(random, 0, 5);
  check_everything(
      test::make_update(desc, content, test::chance(random, 2), test::pick(random, 1, 4), seed),
      settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(NativeRoundTrip, EveryFormatAndContent) {
  for (const auto& format : formats()) {
    for (const auto content : test::kContents) {
      for (const bool keyframe : {true, false}) {
        const TextureDesc desc{format.format, {6, 4, 5}, 6, 1};
        check_everything(test::make_update(desc, content, keyframe, 1, 5), {});
      }
    }
  }
}

TEST(NativeRoundTrip, SidesOfEveryKind) {
  constexpr std::uint16_t kSides[] = {1, 2, 3, 5, 7, 14, 16, 33, 64};
  for (const std::uint16_t core : kSides) {
    check_everything(test::make_update({Format::R16G16_SFLOAT, {2, 2, 1}, core, 1},
                                       test::Content::noisy, false, 1, core),
                     {});
    check_everything(test::make_update({Format::A2B10G10R10_UNORM_PACK32, {2, 2, 1}, core, 1},
                                       test::Content::noisy, true, 1, core),
                     {});
  }
}

TEST(NativeRoundTrip, FullLanes) {
  for (const bool keyframe : {true, false}) {
    for (const auto content : {test::Content::smooth, test::Content::noisy}) {
      check_everything(test::make_update(ddgi_irradiance({9, 8, 10}), content, keyframe, 1, 3), {});
      check_everything(test::make_update(ddgi_visibility({8, 6, 7}), content, keyframe, 1, 3), {});
    }
  }
}

TEST(NativeRoundTrip, NoProbes) {
  auto u = test::make_update(ddgi_irradiance({4, 4, 4}), test::Content::smooth, false, 1, 1);
  u.probes.clear();
  u.texels.clear();
  check_everything(u, {});
}

/// Expansion never exceeds what docs/native.md states.
TEST(NativeRoundTrip, ExpansionIsBounded) {
  for (const auto& format : formats()) {
    for (const auto content : test::kContents) {
      for (const std::uint32_t one_in : {1U, 3U, 40U}) {
        auto u = test::make_update({format.format, {7, 5, 6}, 8, 1}, content, false, one_in, 9);
        const std::size_t size = test::encode(u, {}, best_isa()).size();
        EXPECT_LE(size, 10 + 6 * u.probes.size() + u.texels.size());
      }
    }
  }
}

/// A few probes cost little more than their share of a full update.
TEST(NativeRoundTrip, SmallUpdates) {
  const auto desc = ddgi_irradiance({16, 8, 8});
  auto all = test::make_update(desc, test::Content::noisy, false, 1, 7);
  const double share = static_cast<double>(test::encode(all, {}, best_isa()).size()) /
                       static_cast<double>(all.probes.size());
  for (const std::size_t n : {1U, 8U, 32U, 100U}) {
    auto some = all;
    some.probes.assign(all.probes.begin() + 200, all.probes.begin() + 200 + n);
    some.texels.assign(all.texels.begin() + 200 * 256, all.texels.begin() + (200 + n) * 256);
    const double size = static_cast<double>(test::encode(some, {}, best_isa()).size());
    EXPECT_LE(size, 24 + static_cast<double>(n) * share * 1.35) << n << " probes";
  }
}

}  // namespace
}  // namespace gicodec
