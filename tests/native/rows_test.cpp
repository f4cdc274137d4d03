// Blocks of one row by the record model: points that change like similar ones, matrices that
// turn.
#include "native/content.h"
#include "native/reference_decoder.h"
#include "quantise/component_code.h"

#include <gicodec/ao_points.h>

#include <gtest/gtest.h>

#include <cmath>

namespace gicodec {
namespace {

using test::Bytes;

/// An update of all blocks from `mirror` to `records`.
test::UpdateCase update_of(const TextureDesc& desc, Bytes mirror, Bytes records) {
  test::UpdateCase u{desc, {}, std::move(records), std::move(mirror), {}, false, {}};
  u.received.assign(block_count(desc), 1);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) u.blocks.push_back(block);
  return u;
}

/// Bytes of the payload, which both decoders read.
std::size_t size_of(const test::UpdateCase& u) {
  const Bytes payload = test::encode(u, {}, best_isa());
  Bytes out(u.records.size());
  native::PayloadMemory memory;
  EXPECT_EQ(native::decode_payload(u.decode_job(payload, out), best_isa(), memory), Status::ok);
  EXPECT_EQ(out, u.records);
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload);
  EXPECT_TRUE(expected && *expected == u.records);
  return payload.size();
}

/// Each point has one of eight normals; points of a normal change in the same way, or at random.
test::UpdateCase points(bool by_normal, bool move) {
  constexpr std::uint32_t kCells = 400;
  const auto volume = *ao_point_volume(kCells, 1, 1);
  const TextureDesc& desc = volume.groups[0].textures[0].desc;
  const Record& record = desc.record;
  Bytes mirror(texture_bytes(desc)), records;
  test::Random random(1);
  const auto set = [&](Bytes& bytes, std::size_t at, unsigned component, std::uint32_t code) {
    set_code(&bytes[at], record.components[component], record.bytes, code);
  };
  for (std::size_t at = 0; at < mirror.size(); at += record.bytes) {
    if (test::chance(random, 3)) continue;
    set(mirror, at, 0, 1);
    for (unsigned c = 1; c <= 3; ++c) set(mirror, at, c, random() & 31);
    set(mirror, at, 4, random() & 7);
    set(mirror, at, 6, 64 + (random() & 127));
  }
  records = mirror;
  for (std::size_t at = 0; at < mirror.size(); at += record.bytes) {
    const Component& normal = record.components[4];
    const Component& visible = record.components[6];
    if (code_of(&mirror[at], record.components[0], record.bytes) == 0) continue;
    const std::uint32_t normal_code = code_of(&mirror[at], normal, record.bytes);
    const auto which = by_normal ? normal_code : static_cast<std::uint32_t>(random() & 7);
    if (which % 3 == 2) continue;
    const std::uint32_t by = which % 2 == 0 ? 8 * which : 0U - 8 * which;
    set(records, at, 6, (code_of(&mirror[at], visible, record.bytes) + by + 4) & 255);
    if (move) set(records, at, test::pick(random, 1, 3), random() & 31);
  }
  return update_of(desc, std::move(mirror), std::move(records));
}

TEST(NativeRows, PointsChangeLikeTheirKin) {
  const std::size_t by_normal = size_of(points(true, false));
  EXPECT_LT(3 * by_normal, size_of(points(false, false)));
  EXPECT_LT(by_normal, size_of(points(true, true)));
}

/// Turning around y: two numbers, each of which is in a matrix twice, in several matrices.
test::UpdateCase matrices(std::uint32_t objects, std::uint32_t of_object) {
  const auto volume = *ao_point_volume(1, 1, objects * of_object);
  const TextureDesc& desc = volume.groups[2].textures[1].desc;
  const auto turned = [&](float by) {
    Bytes bytes;
    for (std::uint32_t object = 0; object < objects; ++object) {
      const float angle = static_cast<float>(object) + by;
      const float c = std::cos(angle), s = std::sin(angle);
      const std::array<float, 12> matrix{c, 0, s, 0, 0, 1, 0, 2, -s, 0, c, 3};
      for (std::uint32_t i = 0; i < of_object; ++i) {
        const auto part = std::as_bytes(std::span(matrix));
        bytes.insert(bytes.end(), part.begin(), part.end());
      }
    }
    return bytes;
  };
  return update_of(desc, turned(1), turned(1.1F));
}

TEST(NativeRows, MatricesThatTurnCostTwoNumbers) {
  constexpr std::size_t kNumber = 4, kSlack = 8;
  EXPECT_LE(size_of(matrices(10, 1)), 10 * 2 * kNumber + kSlack);
  EXPECT_LE(size_of(matrices(10, 4)), 10 * 2 * kNumber + 2 * kSlack);
}

}  // namespace
}  // namespace gicodec
