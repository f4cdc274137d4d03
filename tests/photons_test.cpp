// Kind 5: what its volumes are, and what becomes of a photon in 20 bytes.
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/photons.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace gicodec {
namespace {

using PhotonBytes = std::array<std::byte, kPhotonBytes>;

constexpr std::array<PhotonForm, 2> kForms{PhotonForm::halves, PhotonForm::shared_exponent};
const PhotonBatch kBox{{-3, 1, 20}, {6, 4.5F, 0.25F}, 10, 0, 0, 1};

template <typename T>
T field(const PhotonBytes& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <typename T>
void set_field(PhotonBytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

PhotonBytes packed(const Photon& photon, PhotonForm form, const PhotonBatch& box = kBox) {
  PhotonBytes bytes{};
  pack_photon(photon, box, form, bytes);
  return bytes;
}
Photon unpacked(const PhotonBytes& bytes, PhotonForm form, const PhotonBatch& box = kBox) {
  return unpack_photon(bytes, box, form);
}
PhotonBytes again(const PhotonBytes& bytes, PhotonForm form) {
  return packed(unpacked(bytes, form), form);
}

PhotonBytes any_bytes() {
  PhotonBytes bytes{};
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(*rc::gen::inRange(0, 256));
  return bytes;
}

TEST(Photons, CapacitiesAreThoseThatBlocksCanHave) {
  for (const std::uint32_t capacity : {1U, 63U, 64U, 128U, 4096U, 8192U, 32768U}) {
    const auto volume = photon_volume(3, capacity);
    ASSERT_TRUE(volume) << capacity;
    EXPECT_EQ(record_count(volume->groups[0].textures[2].desc.block), capacity);
    EXPECT_EQ(volume->groups[0].textures[1].desc.record.bytes, kPhotonBatchBytes);
    EXPECT_EQ(volume->groups[0].textures[2].desc.record.bytes, kPhotonBytes);
  }
  for (const std::uint32_t capacity : {0U, 65U, 4097U, 4160U, 32769U, 36864U, 0xFFFFFFFFU}) {
    EXPECT_EQ(photon_volume(3, capacity).status(), Status::invalid_description) << capacity;
  }
  EXPECT_FALSE(photon_volume(0, 64));
  EXPECT_FALSE(photon_volume(1, 64, static_cast<PhotonForm>(2)));
  const auto form = photon_form(
      photon_volume(1, 64, PhotonForm::shared_exponent)->groups[0].textures[2].desc.record);
  ASSERT_TRUE(form);
  EXPECT_EQ(*form, PhotonForm::shared_exponent);
  EXPECT_EQ(photon_form(Format::R16_UINT).status(), Status::unsupported_format);
}

TEST(Photons, EveryPlaceComesBack) {
  for (std::uint32_t code = 0; code <= 0xFFFF; ++code) {
    PhotonBytes bytes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      set_field(bytes, 2 * axis, static_cast<std::uint16_t>(code));
    }
    ASSERT_EQ(again(bytes, PhotonForm::halves), bytes) << code;
    const Photon photon = unpacked(bytes, PhotonForm::halves);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_GE(photon.position[axis], kBox.minimum[axis]);
      ASSERT_LE(photon.position[axis], kBox.minimum[axis] + kBox.extent[axis]);
    }
  }
}

/// A direction, and that of its code, whose code it is again.
void check_direction(const PhotonBytes& bytes, PhotonForm form, double most_off) {
  const Photon photon = unpacked(bytes, form);
  const auto& d = photon.direction;
  const double length = std::sqrt(double{d[0]} * d[0] + double{d[1]} * d[1] + double{d[2]} * d[2]);
  ASSERT_NEAR(length, 1, 1e-6);
  const PhotonBytes canonical = packed(photon, form);
  const Photon same = unpacked(canonical, form);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(same.direction[i], d[i], most_off);
  ASSERT_EQ(packed(same, form), canonical);
}

TEST(Photons, EveryDirectionComesBack) {
  std::size_t aliases = 0;
  for (std::uint32_t code = 0; code <= 0xFFFF; ++code) {
    PhotonBytes bytes{};
    set_field(bytes, 6, static_cast<std::uint16_t>(code));
    check_direction(bytes, PhotonForm::halves, 1e-6);
    aliases += again(bytes, PhotonForm::halves) != bytes;
  }
  // −128 stands for −127, each half of an edge for the other one, each corner for the last.
  EXPECT_EQ(aliases, 511U + 4 * 126 + 3);
  for (std::int32_t u = -32768; u <= 32767; u += 7) {
    for (const std::int32_t v : {-32768, -32767, -20000, -1, 0, 1, 12345, 32766, 32767, u}) {
      PhotonBytes bytes{};
      set_field(bytes, 6, static_cast<std::int16_t>(u));
      set_field(bytes, 8, static_cast<std::int16_t>(v));
      check_direction(bytes, PhotonForm::shared_exponent, 1e-6);
    }
  }
}

RC_GTEST_PROP(Photons, DirectionsAreNearTheirCode, ()) {
  std::array<float, 3> d{};
  for (float& v : d) v = static_cast<float>(*rc::gen::inRange(-1000, 1001));
  RC_PRE((d != std::array<float, 3>{}));
  const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (float& v : d) v /= length;
  for (const PhotonForm form : kForms) {
    const PhotonBytes bytes = packed({.direction = d}, form);
    RC_ASSERT(again(bytes, form) == bytes);
    const Photon photon = unpacked(bytes, form);
    double cosine = 0;
    for (std::size_t i = 0; i < 3; ++i) cosine += double{d[i]} * photon.direction[i];
    RC_ASSERT(cosine > (form == PhotonForm::halves ? std::cos(0.017) : std::cos(1e-3)));
  }
}

TEST(Photons, EveryHalfComesBack) {
  for (std::uint32_t code = 0; code < 0x7C00; ++code) {
    PhotonBytes bytes{};
    for (std::size_t at = 8; at < 16; at += 2) {
      set_field(bytes, at, static_cast<std::uint16_t>(code));
    }
    ASSERT_EQ(again(bytes, PhotonForm::halves), bytes) << code;
    PhotonBytes shared{};
    set_field(shared, 10, static_cast<std::uint16_t>(code));
    ASSERT_EQ(again(shared, PhotonForm::shared_exponent), shared) << code;
  }
  // Between two halves the nearer one, of two as near the even one.
  const auto half = [](float v) {
    return field<std::uint16_t>(packed({.radius = v}, kForms[0]), 14);
  };
  EXPECT_EQ(half(1), 0x3C00);
  EXPECT_EQ(half(1 + 1 / 2048.0F), 0x3C00);
  EXPECT_EQ(half(1 + 3 / 2048.0F), 0x3C02);
  EXPECT_EQ(half(65519), 0x7BFF);
  EXPECT_EQ(half(1e30F), 0x7BFF);
  EXPECT_EQ(half(2.0F - 1 / 4096.0F), 0x4000);
  EXPECT_EQ(half(std::ldexp(1.0F, -24)), 1);
  EXPECT_EQ(half(std::ldexp(1.0F, -25)), 0);
  EXPECT_EQ(half(-1), 0);
  EXPECT_EQ(half(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Photons, EverySharedExponentComesBack) {
  for (std::uint32_t exponent = 0; exponent < 32; ++exponent) {
    for (std::uint32_t most = exponent == 0 ? 0 : 256; most < 512; ++most) {
      for (const std::uint32_t other : {0U, 1U, most / 3, most}) {
        if (other > most) continue;
        const std::uint32_t code = exponent << 27 | most << 9 | other | (most / 2) << 18;
        PhotonBytes bytes{};
        set_field(bytes, 12, code);
        ASSERT_EQ(again(bytes, PhotonForm::shared_exponent), bytes) << code;
      }
    }
  }
}

RC_GTEST_PROP(Photons, WhatPackingGivesComesBack, ()) {
  const auto form = *rc::gen::elementOf(kForms);
  const PhotonBytes any = any_bytes();
  const PhotonBytes once = packed(unpacked(any, form), form);
  RC_ASSERT(again(once, form) == once);
}

RC_GTEST_PROP(Photons, AnyPhotonIsPackedAsAFiniteOne, ()) {
  const auto number = [] {
    const auto bits = *rc::gen::arbitrary<std::uint32_t>();
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  Photon photon;
  for (auto* list : {&photon.position, &photon.direction, &photon.power}) {
    for (float& v : *list) v = number();
  }
  photon.radius = number();
  photon.normalisation = number();
  PhotonBatch box = kBox;
  for (float& v : box.extent) v = number();
  const auto form = *rc::gen::elementOf(kForms);
  const Photon back = unpacked(packed(photon, form, box), form);
  for (const auto* list : {&back.position, &back.direction, &back.power}) {
    for (const float v : *list) RC_ASSERT(std::isfinite(v));
  }
  for (const float v : back.power) RC_ASSERT(v >= 0);
  RC_ASSERT(back.radius >= 0 && back.radius <= 65504);
  RC_ASSERT(back.normalisation >= 0 && std::isfinite(back.normalisation));
}

RC_GTEST_PROP(Photons, BatchesComeBack, ()) {
  std::array<std::byte, kPhotonBatchBytes> bytes{}, back{};
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(*rc::gen::inRange(0, 256));
  pack_photon_batch(unpack_photon_batch(bytes), back);
  RC_ASSERT(back == bytes);
}

RC_GTEST_PROP(Photons, SortingForgetsTheOrderAndKeepsTheRest, ()) {
  const auto form = *rc::gen::elementOf(kForms);
  const TextureDesc desc = photon_volume(1, 64, form)->groups[0].textures[2].desc;
  std::vector<PhotonBytes> photons(*rc::gen::inRange<std::size_t>(0, 65));
  for (PhotonBytes& bytes : photons) {
    if (*rc::gen::inRange(0, 10) == 0) continue;  // one of zeros
    bytes = any_bytes();
    for (std::size_t at = 0; at < 6; ++at) bytes[at] &= std::byte{0x81};  // places often agree
  }
  const auto sorted = [&] {
    std::vector<PhotonBytes> block = photons;
    block.resize(64);
    kPhotons.sort(desc, std::as_writable_bytes(std::span(block)));
    return block;
  };
  const auto first = sorted();
  std::reverse(photons.begin(), photons.end());
  RC_ASSERT(sorted() == first);
  auto before = photons, after = first;
  before.resize(64);
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  RC_ASSERT(before == after);
  const auto zero = std::find(first.begin(), first.end(), PhotonBytes{});
  RC_ASSERT(
      std::all_of(zero, first.end(), [](const PhotonBytes& b) { return b == PhotonBytes{}; }));
  auto count = std::vector<std::byte>(2);
  kPhotons.sort(photon_volume(1, 64, form)->groups[0].textures[0].desc, count);
  RC_ASSERT(count == std::vector<std::byte>(2));
}

// A batch travels with its count and its facts, also where these alone changed.
TEST(Photons, UpdatesCostWhatChanged) {
  constexpr std::uint32_t kBatches = 3, kCapacity = 256;
  const auto volume = photon_volume(kBatches, kCapacity);
  ASSERT_TRUE(volume);
  const TextureDesc& desc = volume->groups[0].textures[2].desc;
  std::vector<std::byte> photons(static_cast<std::size_t>(texture_bytes(desc)));
  const std::vector<std::uint16_t> counts{256, 0, 100};
  std::uint32_t state = 1;
  for (std::uint32_t batch = 0; batch < kBatches; ++batch) {
    const auto block =
        std::span(photons).subspan(batch * block_bytes(desc), counts[batch] * kPhotonBytes);
    for (std::byte& byte : block) {
      state = state * 1664525 + 1013904223;
      byte = static_cast<std::byte>(state >> 24);
    }
    kPhotons.sort(desc, std::span(photons).subspan(batch * block_bytes(desc), block_bytes(desc)));
  }
  auto encoder = Encoder::create(desc);
  auto decoder = Decoder::create(desc);
  ASSERT_TRUE(encoder && decoder);
  const auto presence = std::as_bytes(std::span(counts));
  ASSERT_EQ(encoder->set_presence(presence), Status::ok);
  ASSERT_EQ(decoder->set_presence(presence), Status::ok);
  std::vector<std::size_t> sizes;
  for (int update = 0; update < 3; ++update) {
    if (update == 2) photons[kPhotonBytes - 1] ^= std::byte{1};
    const auto packet = encoder->encode(ConstTextureView(photons), Selection::all());
    ASSERT_TRUE(packet);
    std::vector<std::byte> decoded(photons.size());
    ASSERT_EQ(decoder->decode(*packet, TextureView{decoded}), Status::ok);
    EXPECT_EQ(decoded, photons) << update;
    sizes.push_back(packet->size());
  }
  // The second one is the first one again, the third one has another photon.
  EXPECT_GT(sizes[0], 356 * kPhotonBytes / 2);
  EXPECT_LT(sizes[1], sizes[2]);
  EXPECT_LT(sizes[2], 64U);
}

}  // namespace
}  // namespace gicodec
