// Damaged and hostile payloads: an error or other texels, never anything else, on every instruction
// set, and the same verdict everywhere.
#include "native/content.h"
#include "native/frame/chunk_head.h"
#include "native/matches/match_chunk.h"
#include "native/reference_decoder.h"
#include "native/vector_content.h"
#include "native/voxel_content.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec {
namespace {

using test::Bytes;

/// Verdict of one decoder; records only if it accepts.
struct Outcome {
  Status status;
  Bytes records;
};
Outcome attempt(const test::UpdateCase& u, std::span<const std::byte> payload, Isa isa) {
  const test::Exact exact(payload), mirror(u.mirror);
  test::Exact out(u.records.size());
  static native::PayloadMemory memory;  // as in a session: whatever was decoded before
  auto job = u.decode_job(exact.span(), out.span());
  job.mirror.blocks.records = mirror.span().data();
  Outcome o{native::decode_payload(job, isa, memory), {}};
  if (o.status == Status::ok) o.records.assign(out.span().begin(), out.span().end());
  return o;
}

void compare_all(const test::UpdateCase& u, std::span<const std::byte> payload) {
  const Outcome first = attempt(u, payload, Isa::scalar);
  static std::size_t turn = 0;
  const auto others = supported_isas().subspan(1);
  const std::size_t one = others.empty() ? 0 : turn++ % others.size();
  for (const Isa isa : test::everything() || others.empty() ? others : others.subspan(one, 1)) {
    const Outcome o = attempt(u, payload, isa);
    EXPECT_EQ(o.status, first.status) << to_string(isa);
    EXPECT_EQ(o.records, first.records) << to_string(isa);
  }
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload,
                                          u.presence, u.intra, u.mirror_presence);
  EXPECT_EQ(expected.has_value(), first.status == Status::ok);
  if (expected && first.status == Status::ok) {
    EXPECT_EQ(*expected, first.records);
  }
}

std::vector<test::UpdateCase> cases() {
  test::Random random(6);
  std::vector<test::UpdateCase> all;
  for (const bool keyframe : {true, false}) {
    all.push_back(
        test::make_update(probe_texture(Format::A2R10G10B10_UNORM_PACK32, {4, 3, 3}, 3, 1),
                          test::Content::noisy, keyframe, 1, 2));
    all.push_back(test::make_update(probe_texture(Format::R16G16_SFLOAT, {3, 3, 2}, 4, 1),
                                    test::Content::noisy, keyframe, 1, 2));
    all.push_back(test::make_update(probe_texture(Format::R32G32_SFLOAT, {2, 2, 2}, 2, 1),
                                    test::Content::smooth, keyframe, 1, 2));
    for (const Presence presence : {Presence::count, Presence::mask}) {
      TextureDesc desc = pool_texture(Format::R8G8B8A8_UNORM, 40, {3, 3, 2});
      desc.presence = presence;
      all.push_back(test::make_update(desc, test::Content::smooth, keyframe, 1, 2));
    }
    all.push_back(test::make_update(pool_texture(test::custom_record(random, 64), 5, {2, 1, 1}),
                                    test::Content::smooth, keyframe, 1, 2));
    all.push_back(test::make_update(pool_texture(Format::E5B9G9R9_UFLOAT_PACK32, 9, {4, 4, 1}),
                                    test::Content::smooth, keyframe, 1, 2));
    TextureDesc sets = pool_texture(Format::R16G16B16A16_UNORM, 4, {20, 1, 1});
    sets.model = Model::unordered;
    sets.presence = Presence::count;
    all.push_back(test::make_update(sets, test::Content::noisy, keyframe, 1, 2));
    test::sort_sets(all.back());
    if (!keyframe) test::make_previous(all.back(), random, true);
    for (const bool halves : {false, true}) {
      all.push_back(
          test::make_update(test::voxels(3, 2, halves), test::Content::noisy, keyframe, 1, 2));
    }
    TextureDesc map = probe_texture(Format::R16G16B16A16_SFLOAT, {3, 2, 2}, 4, 0);
    map.model = Model::continuous;
    all.push_back(test::make_update(map, test::Content::noisy, keyframe, 2, 2));
    map.record = Format::E5B9G9R9_UFLOAT_PACK32;
    map.presence = Presence::mask;
    all.push_back(test::make_update(map, test::Content::smooth, keyframe, 1, 2));
    for (const bool floats : {false, true}) {
      all.push_back(test::make_vertex_update(
          test::vertices({2, 2, floats ? 1U : 2U}, floats), test::VertexContent::smooth,
          keyframe ? test::UpdateMode::keyframe : test::UpdateMode::update, 1, 2));
    }
  }
  return all;
}

/// By the presets that make other chunks.
std::vector<Bytes> payloads_of(const test::UpdateCase& u) {
  native::PayloadSettings turbo;
  turbo.chunk.preset = native::Preset::turbo;
  std::vector<Bytes> all{test::encode(u, {}, best_isa()), test::encode(u, turbo, best_isa())};
  native::PayloadSettings strong;
  strong.chunk.preset = native::Preset::strong;
  native::PayloadSettings rows, matches;
  rows.chunk.others = false;
  matches.chunk.matches_within = 1 << 20;
  all.push_back(test::encode(u, matches, best_isa()));
  if (native::takes_raster(u.desc)) {
    all.push_back(test::encode(u, strong, best_isa()));
    all.push_back(test::encode(u, rows, best_isa()));
  }
  return all;
}

bool ends_adaptive(const test::UpdateCase& u, std::span<const std::byte> payload) {
  native::PayloadMemory memory;
  EXPECT_EQ(native::check_payload(u.desc, u.blocks.size(), payload, memory), Status::ok);
  const auto first = memory.head.chunks.back().front();
  return first == std::byte{native::kAdaptiveChunk} || first == std::byte{native::kMatchChunk};
}

/// With sanitizers one case in so many of those that are tried without.
std::size_t rarer() { return std::max<std::size_t>(1, test::one_case_in() / 3); }

/// But for what the binary coder reads: it takes any bytes, the same records from no others.
TEST(NativeHostile, NoPrefixPassesForTheWhole) {
  const auto check = [](const test::UpdateCase& u, const Bytes& payload) {
    const bool adaptive = ends_adaptive(u, payload);
    for (std::size_t n = 0; n < payload.size(); ++n) {
      // Models take their time, whatever is left of the bytes.
      const bool near_an_end = n < 16 || n + 16 >= payload.size();
      if (!near_an_end && n % rarer() != 0) continue;
      if (adaptive && !near_an_end && n % 16 != 0 && !test::everything()) continue;
      const auto cut = std::span(payload).first(n);
      const auto isas = supported_isas();
      for (const Isa isa : test::everything() ? isas : isas.subspan(n % isas.size(), 1)) {
        const Outcome o = attempt(u, cut, isa);
        EXPECT_TRUE(o.status != Status::ok || (adaptive && o.records != u.records));
      }
      if (n % 4 != 0 && !test::everything()) continue;
      if (adaptive) compare_all(u, cut);
      EXPECT_TRUE(adaptive || !reference::decode(u.desc, u.blocks, u.mirror, u.received, cut,
                                                 u.presence, u.intra, u.mirror_presence)
                                   .has_value());
    }
  };
  for (auto& u : cases()) {
    for (const Bytes& payload : payloads_of(u)) check(u, payload);
  }
}

/// Every bit of the heads, some of what follows; fewer where models take their time.
TEST(NativeHostile, BitFlipsGetOneVerdict) {
  const auto check = [](const test::UpdateCase& u, Bytes payload) {
    const bool few = ends_adaptive(u, payload) && !test::everything();
    const std::size_t heads = few ? 64 : 256, step = few ? 331 : 29;
    for (std::size_t bit = 0; bit < payload.size() * 8; bit += bit < heads ? 1 : step * rarer()) {
      payload[bit / 8] ^= std::byte(1U << bit % 8);
      compare_all(u, payload);
      payload[bit / 8] ^= std::byte(1U << bit % 8);
    }
  };
  for (auto& u : cases()) {
    for (const Bytes& payload : payloads_of(u)) check(u, payload);
  }
}

TEST(NativeHostile, TrailingBytesAreRefused) {
  for (auto& u : cases()) {
    for (Bytes payload : payloads_of(u)) {
      payload.push_back(std::byte{0});
      compare_all(u, payload);
      EXPECT_NE(attempt(u, payload, best_isa()).status, Status::ok);
    }
  }
}

TEST(NativeHostile, NoiseBehindASoundHead) {
  test::Random random(4);
  const int rounds = test::everything() ? 300 : 180 / static_cast<int>(test::one_case_in());
  for (auto& u : cases()) {
    for (int round = 0; round < rounds; ++round) {
      Bytes payload = {std::byte{native::kVersion}};
      Bytes chunk = test::noise(random, test::pick(random, 3, 120));
      chunk[0] = std::byte(1 | test::pick(random, 0, 5) << 2 | test::pick(random, 0, 7) << 5);
      chunk[1] = chunk[2] = std::byte{0};
      if (round % 4 == 0) chunk[0] = std::byte{2};
      if (round % 4 == 1) chunk[0] = std::byte(3 | test::pick(random, 0, 15) << 2);
      payload.insert(payload.end(), chunk.begin(), chunk.end());
      compare_all(u, payload);
    }
  }
}

TEST(NativeHostile, BoxesOutOfRange) {
  auto u = test::make_update(ddgi_irradiance({4, 4, 4}), test::Content::smooth, true, 1, 1);
  for (const Grid box : {Grid{0, 1, 1}, Grid{5, 4, 4}, Grid{4, 4, 0}}) {
    Bytes payload = {std::byte{native::kVersion | 1 << 4}};
    for (const auto side : {box.x, box.y, box.z, 0U}) {
      payload.insert(payload.end(), {std::byte(side), std::byte{0}});
    }
    EXPECT_EQ(attempt(u, payload, best_isa()).status, Status::corrupt);
  }
  EXPECT_EQ(attempt(u, Bytes{std::byte{native::kVersion + 1}}, best_isa()).status,
            Status::unsupported_version);
}

}  // namespace
}  // namespace gicodec
