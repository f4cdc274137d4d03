// Match chunks (docs/native/matches.md), and what fast and strong are never larger than.
#include "native/content.h"
#include "native/matches/byte_order.h"
#include "native/matches/match_chunk.h"
#include "native/round_trip.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <string_view>

namespace gicodec {
namespace {

using test::Bytes;

constexpr std::size_t kMayBeLarger = 64;

std::size_t zstd_size(const Bytes& bytes, int level) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  return ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
}

/// The records of an update in an order of a match chunk.
Bytes ordered(const test::UpdateCase& u, native::Difference difference, bool planes) {
  const std::size_t block = block_bytes(u.desc), b = u.desc.record.bytes;
  const std::size_t n = u.records.size() / b, w = u.desc.block.x;
  Bytes out(u.records.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < b; ++k) {
      const std::size_t at = i * b + k, back = difference == native::Difference::before ? 1 : w;
      unsigned reference = 0;
      if (difference == native::Difference::past) {
        reference = std::to_integer<unsigned>(u.mirror[u.blocks[at / block] * block + at % block]);
      } else if (difference != native::Difference::none && i >= back) {
        reference = std::to_integer<unsigned>(u.records[at - back * b]);
      }
      const unsigned byte = std::to_integer<unsigned>(u.records[at]) - reference;
      out[planes ? k * n + i : at] = static_cast<std::byte>(byte & 255);
    }
  }
  return out;
}

std::size_t best_of_zstd(const test::UpdateCase& u, int level) {
  std::size_t best = SIZE_MAX;
  for (unsigned d = 0; d < native::kDifferences; ++d) {
    const auto difference = static_cast<native::Difference>(d);
    if (difference == native::Difference::past && u.keyframe) continue;
    for (const bool planes : {false, true}) {
      best = std::min(best, zstd_size(ordered(u, difference, planes), level));
    }
  }
  return best;
}

/// Bytes that are poor in information, each in a way of its own, and nothing that light is.
struct Poor {
  const char* name;
  std::byte (*byte)(std::size_t record, std::size_t byte, std::size_t size, const Bytes& noise);
};
std::byte byte_at(const Bytes& noise, std::size_t i) { return noise[i % noise.size()]; }
std::size_t number(const Bytes& noise, std::size_t i) {
  return std::to_integer<std::size_t>(byte_at(noise, i));
}
constexpr Poor kPoor[] = {
    {"constant", [](auto, auto, auto, const Bytes&) { return std::byte{7}; }},
    {"noise", [](auto r, auto k, auto size, const Bytes& n) { return byte_at(n, r * size + k); }},
    {"64 records in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return byte_at(n, r % 64 * size + k); }},
    {"1000 records in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return byte_at(n, r % 1000 * size + k); }},
    {"331 bytes in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return byte_at(n, (r * size + k) % 331); }},
    {"one of 300 records",
     [](auto r, auto k, auto size, const Bytes& n) {
       return byte_at(n, 2 * number(n, 7919 * r) % 300 * size + k);
     }},
    {"a text",
     [](auto r, auto k, auto size, const Bytes&) {
       constexpr std::string_view kText =
           "Light comes from where it was not long before, and goes. ";
       const std::size_t i = r * size + k;
       return static_cast<std::byte>(kText[(i + i / 700 * 13) % kText.size()]);
     }},
    {"one of 256 strings",
     [](auto r, auto k, auto size, const Bytes& n) {
       const std::size_t i = r * size + k;
       return byte_at(n, number(n, 7919 * (i / 64)) * 64 + i % 64);
     }},
    {"two records",
     [](auto r, auto, auto, const Bytes& n) {
       return number(n, 7919 * r) % 2 == 0 ? std::byte{3} : std::byte{255};
     }},
    {"bytes of 16 values",
     [](auto r, auto k, auto size, const Bytes& n) {
       return static_cast<std::byte>(number(n, r * size + k) % 16 * 17);
     }},
    {"mostly small bytes",
     [](auto r, auto k, auto size, const Bytes& n) {
       const std::size_t i = r * size + k, x = number(n, i), y = number(n, 3 * i + 1);
       return static_cast<std::byte>(x * y * y >> 16);
     }},
    {"a few records of noise",
     [](auto r, auto k, auto size, const Bytes& n) {
       return number(n, 7919 * r) < 8 ? byte_at(n, r * size + k) : std::byte{0};
     }},
    {"noise with a few records of others",
     [](auto r, auto k, auto size, const Bytes& n) {
       const std::size_t from = number(n, 7919 * r) < 64 ? r * 5 / 8 : r;
       return byte_at(n, from * size + k);
     }},
};

test::UpdateCase poor_update(const TextureDesc& desc, const Poor& poor, bool keyframe) {
  test::Random random(1);
  const Bytes noise = test::noise(random, 1 << 18);
  auto u = test::make_update(desc, test::Content::constant, keyframe, 1, 1);
  const std::size_t size = desc.record.bytes;
  for (std::size_t i = 0; i < u.records.size(); ++i) {
    u.records[i] = poor.byte(i / size, i % size, size, noise);
  }
  return u;
}

std::vector<TextureDesc> shapes() {
  TextureDesc map = probe_texture(Format::R16G16B16A16_SFLOAT, {6, 6, 1}, 16, 0);
  map.model = Model::continuous;
  TextureDesc bytes = map;
  bytes.record = Format::R8_UNORM;
  return {map, bytes, probe_texture(Format::R8G8B8A8_UNORM, {8, 8, 4}, 6, 0),
          probe_texture(Format::R16G16_SFLOAT, {6, 6, 2}, 14, 0)};
}

void expect_not_larger(native::Preset preset, int level) {
  native::PayloadSettings settings;
  settings.chunk.preset = preset;
  test::Sweep sweep;
  for (const TextureDesc& desc : shapes()) {
    for (const Poor& poor : kPoor) {
      for (const bool keyframe : {true, false}) {
        if (!sweep.takes()) continue;
        const auto u = poor_update(desc, poor, keyframe);
        const Bytes payload = test::encode(u, settings, best_isa());
        EXPECT_LE(payload.size(), best_of_zstd(u, level) + kMayBeLarger)
            << poor.name << ", blocks of " << int{desc.block.x} << ", records of "
            << int{desc.record.bytes} << (keyframe ? ", a keyframe" : "");
      }
    }
  }
}

TEST(NativeMatches, StrongIsNotLargerThanZstd) { expect_not_larger(native::Preset::strong, 19); }

TEST(NativeMatches, FastIsNotLargerThanZstd) { expect_not_larger(native::Preset::fast, 3); }

/// Also where light or noise is made up, of few blocks and many.
TEST(NativeMatches, FastIsNotLargerThanZstdOfMadeUpLight) {
  using test::Content;
  test::Sweep sweep;
  for (const Format format :
       {Format::R8_UNORM, Format::R8G8B8_UNORM, Format::A2B10G10R10_UNORM_PACK32,
        Format::R16G16_SFLOAT, Format::R16G16B16A16_SFLOAT, Format::R32G32B32A32_SFLOAT}) {
    for (const Model model : {Model::stacked, Model::none}) {
      TextureDesc desc = probe_texture(format, {6, 5, 4}, 6, 0);
      desc.model = model;
      for (const auto content : {Content::smooth, Content::noisy, Content::white, Content::constant,
                                 Content::alternating, Content::shared}) {
        for (const bool keyframe : {true, false}) {
          if (!sweep.takes()) continue;
          const auto u = test::make_update(desc, content, keyframe, keyframe ? 1 : 3, 5);
          const Bytes payload = test::encode(u, {}, best_isa());
          EXPECT_LE(payload.size(), best_of_zstd(u, 3) + kMayBeLarger)
              << desc << " content " << static_cast<int>(content)
              << (keyframe ? ", a keyframe" : "");
        }
      }
    }
  }
}

/// Noise that comes twice, the second time far behind the first.
TEST(NativeMatches, RepeatsAreFoundHoweverFar) {
  TextureDesc desc = probe_texture(Format::R8G8B8A8_UNORM, {16, 16, 4}, 16, 0);
  test::Random random(5);
  const Bytes noise = test::noise(random, block_count(desc) * block_bytes(desc) / 2);
  auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
  u.records = noise;
  u.records.insert(u.records.end(), noise.begin(), noise.end());
  for (const auto preset : {native::Preset::fast, native::Preset::strong}) {
    native::PayloadSettings settings;
    settings.chunk.preset = preset;
    EXPECT_LE(test::encode(u, settings, best_isa()).size(), noise.size() + 512);
  }
}

void expect_exact(native::Preset preset, std::span<const TextureDesc> descs) {
  native::PayloadSettings settings;
  settings.chunk.preset = preset;
  settings.chunk.matches_within = 1 << 20;
  std::size_t matches = 0;
  for (const TextureDesc& desc : descs) {
    for (const Poor& poor : kPoor) {
      for (const bool keyframe : {true, false}) {
        const auto u = poor_update(desc, poor, keyframe);
        const Bytes payload = test::encode(u, settings, best_isa());
        native::PayloadMemory memory;
        ASSERT_EQ(native::check_payload(u.desc, u.blocks.size(), payload, memory), Status::ok);
        if (memory.head.chunks[0].front() == std::byte{native::kMatchChunk}) ++matches;
        SCOPED_TRACE(poor.name);
        test::check_everything(u, settings);
      }
    }
  }
  EXPECT_GT(matches, 10 * descs.size());
}

/// The smallest: strong takes time.
TEST(NativeMatches, AreExact) { expect_exact(native::Preset::strong, std::vector{shapes()[1]}); }

TEST(NativeMatches, QuickOnesAreExact) { expect_exact(native::Preset::fast, shapes()); }

}  // namespace
}  // namespace gicodec
