// Match chunks (docs/native/matches.md), and what strong is never larger than.
#include "distinct_formats.h"
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

std::size_t zstd_size(const Bytes& bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  return ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 19);
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

std::size_t best_of_zstd(const test::UpdateCase& u) {
  std::size_t best = SIZE_MAX;
  for (unsigned d = 0; d < native::kDifferences; ++d) {
    const auto difference = static_cast<native::Difference>(d);
    if (difference == native::Difference::past && u.keyframe) continue;
    for (const bool planes : {false, true}) {
      best = std::min(best, zstd_size(ordered(u, difference, planes)));
    }
  }
  return best;
}

/// Bytes that are poor in information, each in a way of its own, and nothing that light is.
struct Poor {
  const char* name;
  std::byte (*byte)(std::size_t record, std::size_t byte, std::size_t size, const Bytes& noise);
};
std::byte at(const Bytes& noise, std::size_t i) { return noise[i % noise.size()]; }
std::size_t number(const Bytes& noise, std::size_t i) {
  return std::to_integer<std::size_t>(at(noise, i));
}
constexpr Poor kPoor[] = {
    {"constant", [](auto, auto, auto, const Bytes&) { return std::byte{7}; }},
    {"noise", [](auto r, auto k, auto size, const Bytes& n) { return at(n, r * size + k); }},
    {"64 records in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return at(n, r % 64 * size + k); }},
    {"1000 records in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return at(n, r % 1000 * size + k); }},
    {"331 bytes in turn",
     [](auto r, auto k, auto size, const Bytes& n) { return at(n, (r * size + k) % 331); }},
    {"one of 300 records",
     [](auto r, auto k, auto size, const Bytes& n) {
       return at(n, 2 * number(n, 7919 * r) % 300 * size + k);
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
       return at(n, number(n, 7919 * (i / 64)) * 64 + i % 64);
     }},
    {"two records",
     [](auto r, auto, auto, const Bytes& n) {
       return number(n, 7919 * r) % 2 == 0 ? std::byte{3} : std::byte{255};
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

TEST(NativeMatches, StrongIsNotLargerThanZstd) {
  native::PayloadSettings strong;
  strong.chunk.preset = native::Preset::strong;
  for (const TextureDesc& desc : shapes()) {
    for (const Poor& poor : kPoor) {
      for (const bool keyframe : {true, false}) {
        const auto u = poor_update(desc, poor, keyframe);
        const Bytes payload = test::encode(u, strong, best_isa());
        EXPECT_LE(payload.size(), best_of_zstd(u) + kMayBeLarger)
            << poor.name << ", blocks of " << int{desc.block.x} << ", records of "
            << int{desc.record.bytes};
      }
    }
  }
}

TEST(NativeMatches, AreExact) {
  native::PayloadSettings settings;
  settings.chunk.matches_within = 1 << 20;
  std::size_t matches = 0;
  for (const TextureDesc& desc : shapes()) {
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
  EXPECT_GT(matches, 40U);
}

}  // namespace
}  // namespace gicodec
