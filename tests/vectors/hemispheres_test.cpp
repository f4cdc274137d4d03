// Compression of vectors (Pacanowski et al. §3.3) and their records.
#include "fields.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace gicodec::vectors {
namespace {

/// Light of some directions of a hemisphere.
Vectors random_light(std::size_t hemisphere, ddgi::Random& random) {
  Vectors out;
  const float scale = std::pow(10.0F, random.in(-6, 6));
  for (int count = 1 + static_cast<int>(random.in(0, 8)); count > 0; --count) {
    Vec3 d = test::random_direction(random);
    if (dot(d, axis_of(hemisphere)) < 0) d = -d;
    const auto radiance = [&] { return random.next() < 0.2F ? 0 : scale * random.next(); };
    out.red += d * radiance();
    out.green += d * radiance();
    out.blue += d * radiance();
  }
  return out;
}

void expect_share(Vec3 value, Vec3 expected, float share) {
  EXPECT_NEAR(value.x, expected.x, share * std::abs(expected.x));
  EXPECT_NEAR(value.y, expected.y, share * std::abs(expected.y));
  EXPECT_NEAR(value.z, expected.z, share * std::abs(expected.z));
}

TEST(Hemispheres, AreAroundTheAxes) {
  Vec3 sum;
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    EXPECT_EQ(length(axis_of(h)), 1);
    sum += axis_of(h);
    EXPECT_EQ(axis_of(h ^ 1), -axis_of(h));
  }
  EXPECT_EQ(sum, Vec3{});
  EXPECT_EQ(axis_of(0), (Vec3{1, 0, 0}));
  EXPECT_EQ(axis_of(3), (Vec3{0, -1, 0}));
  EXPECT_EQ(axis_of(4), (Vec3{0, 0, 1}));
}

/// M·n = c (d·n) where the normal is the hemisphere's axis.
TEST(Compression, LosesNothingAlongTheAxis) {
  ddgi::Random random(1);
  for (std::uint32_t i = 0; i < 6000; ++i) {
    const std::size_t h = i % kHemispheres;
    const Vec3 axis = axis_of(h);
    const Vectors vectors = random_light(h, random);
    const DirectedColor compressed = compress(vectors, h);
    EXPECT_NEAR(length(compressed.direction), 1, 1e-6);
    expect_share(compressed.color * dot(compressed.direction, axis), vectors.along(axis), 1e-5F);
    expect_share(compressed.vectors().along(axis), vectors.along(axis), 1e-5F);
    EXPECT_GE(std::min({compressed.color.x, compressed.color.y, compressed.color.z}), 0);
  }
}

/// Where all colours come from one direction nothing is lost at all.
TEST(Compression, LosesNothingOfOneDirection) {
  ddgi::Random random(2);
  for (std::uint32_t i = 0; i < 600; ++i) {
    const std::size_t h = i % kHemispheres;
    Vec3 d = test::random_direction(random);
    if (dot(d, axis_of(h)) < 0) d = -d;
    if (dot(d, axis_of(h)) < 0.01F) continue;
    const Vec3 color{random.next(), random.next(), random.next()};
    const DirectedColor compressed = compress(DirectedColor{d, color}.vectors(), h);
    EXPECT_LT(length(compressed.direction - d), 1e-5F);
    EXPECT_LT(length(compressed.color - color), 1e-3F * length(color));
  }
}

TEST(Compression, OfNoLightIsBlackAlongTheAxis) {
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    const Vec3 axis = axis_of(h);
    for (const Vectors& dark : {Vectors{}, Vectors{-axis, {}, -axis}, Vectors{axis, -axis, {}}}) {
      const DirectedColor compressed = compress(dark, h);
      EXPECT_EQ(compressed.direction, axis);
      EXPECT_EQ(compressed.color, Vec3{});
    }
  }
}

TEST(VectorCodes, HaveTheSizesOfTheKindsRecords) {
  EXPECT_EQ(VectorCode(false).bytes(), 7U);
  EXPECT_EQ(VectorCode(true).bytes(), 24U);
  for (const bool floats : {false, true}) {
    EXPECT_EQ(VectorCode(floats).bytes(), colored_direction(floats).bytes);
  }
}

std::array<std::byte, 24> stored(const VectorCode& code, const DirectedColor& value) {
  std::array<std::byte, 24> record;
  record.fill(std::byte{0xA5});
  code.store(record.data(), value);
  for (std::size_t i = code.bytes(); i < record.size(); ++i) EXPECT_EQ(record[i], std::byte{0xA5});
  return record;
}

/// What is made of it is finite, too.
bool is_sound(const DirectedColor& value) {
  const Vectors vectors = value.vectors();
  bool sound = true;
  for (const Vec3 v : {value.color, value.direction, vectors.red, vectors.green, vectors.blue}) {
    sound = sound && std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  }
  return sound && std::min({value.color.x, value.color.y, value.color.z}) >= 0;
}

/// Of any bits: what is loaded is finite, and comes back; what was stored has the same bits again.
RC_GTEST_PROP(VectorCodes, TakeAnyBytes, (std::array<std::uint8_t, 24> bytes, bool high)) {
  if (high) {  // Of floats: no numbers, and those beyond all.
    for (const std::size_t i : {3, 7, 15, 23}) bytes[i] |= 0x7F, bytes[i - 1] |= 0x80;
  }
  for (const bool floats : {false, true}) {
    const VectorCode code(floats);
    std::array<std::byte, 24> record{};
    std::memcpy(record.data(), bytes.data(), bytes.size());
    const DirectedColor loaded = code.load(record.data());
    RC_ASSERT(is_sound(loaded));
    const auto canonical = stored(code, loaded);
    const DirectedColor again = code.load(canonical.data());
    RC_ASSERT(again.color == loaded.color);
    RC_ASSERT(again.direction == loaded.direction);
    RC_ASSERT(stored(code, again) == canonical);
  }
}

TEST(VectorCodes, AllDirectionsOfTheQuantisedFormComeBack) {
  const VectorCode code(false);
  for (int x = -127; x <= 127; ++x) {
    std::array<std::byte, 24> record;
    record.fill(std::byte{0xA5});
    for (std::size_t i = 0; i < 4; ++i) record[i] = std::byte{0};
    record[4] = record[6] = static_cast<std::byte>(x);
    record[5] = static_cast<std::byte>(-x);
    EXPECT_EQ(stored(code, code.load(record.data())), record);
  }
}

TEST(VectorCodes, AreAsNearAsTheirFormsAllow) {
  ddgi::Random random(3);
  for (std::uint32_t i = 0; i < 600; ++i) {
    const DirectedColor value = compress(random_light(i % kHemispheres, random), i % kHemispheres);
    const DirectedColor exact = VectorCode(true).load(stored(VectorCode(true), value).data());
    EXPECT_EQ(exact.color, value.color);
    EXPECT_EQ(exact.direction, value.direction);
    const float brightest = std::max({value.color.x, value.color.y, value.color.z});
    if (brightest > 60000) continue;  // E5B9G9R9 ends there.
    const DirectedColor near = VectorCode(false).load(stored(VectorCode(false), value).data());
    EXPECT_LT(length(near.direction - value.direction), 0.008F);
    EXPECT_LT(length(near.color - value.color), 0.004F * brightest + 1e-7F);
  }
}

}  // namespace
}  // namespace gicodec::vectors
