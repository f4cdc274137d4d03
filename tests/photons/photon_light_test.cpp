#include "rooms.h"

#include "ddgi/noise.h"
#include "dump/error.h"
#include "photons/reference.h"
#include "photons/splatting.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::photons {
namespace {

using namespace test;

constexpr std::uint32_t kCapacity = 64;

kinds::FeedVolume small_volume(std::uint32_t batches, PhotonForm form = PhotonForm::halves) {
  return {"photons", {{batches, 1, 1}}, *photon_volume(batches, kCapacity, form)};
}

void set_batch(Held& held, std::uint32_t slot, const PhotonBatch& batch,
               std::span<const Photon> photons, std::uint16_t count) {
  std::memcpy(&held.texels[0][slot * sizeof count], &count, sizeof count);
  pack_photon_batch(batch, std::span<std::byte, kPhotonBatchBytes>(
                               &held.texels[1][slot * kPhotonBatchBytes], kPhotonBatchBytes));
  for (std::size_t i = 0; i < photons.size(); ++i) {
    std::byte* const at = &held.texels[2][(slot * kCapacity + i) * kPhotonBytes];
    pack_photon(photons[i], batch, PhotonForm::halves, PhotonBytes(at, kPhotonBytes));
  }
}

PhotonBatch box(std::uint16_t light, std::uint16_t generation) {
  return {{-4, -2, -3}, {8, 4, 6}, 10, light, generation, 100};
}

ddgi::PictureView view_of_room(std::uint32_t width = 64, std::uint32_t height = 48) {
  return {{.eye = {0, 0, 2.5F}, .target = {0, -0.5F, -3}, .fov_y = 70}, width, height};
}

ddgi::Picture draw(const ddgi::RayScene& scene, ddgi::ClientLight& light, unsigned threads = 2) {
  ddgi::ThreadPool pool(threads);
  ddgi::RenderOptions options;
  options.width = 64;
  options.height = 48;
  options.samples = 1;
  options.mode = ddgi::RenderMode::gi;
  return ddgi::render(scene, &light, view_of_room().camera, options, pool);
}

Vec3 mean_of(const ddgi::Picture& picture) {
  Vec3 sum;
  for (const Vec3 pixel : picture.pixels) sum += pixel;
  return sum / static_cast<float>(picture.pixels.size());
}

bool same(const ddgi::Picture& a, const ddgi::Picture& b) {
  return std::equal(a.pixels.begin(), a.pixels.end(), b.pixels.begin(), b.pixels.end());
}

/// A room's photons as they come from the feed, of so many updates.
Held traced(const Scene& scene, double time, unsigned updates,
            const std::vector<std::string>& given) {
  kinds::TraceRequest request;
  request.scene = scene;
  request.settings = settings(given);
  kinds::Feed feed = trace(std::move(request));
  Held held(feed.volumes[0]);
  for (unsigned i = 0; i < updates; ++i) held.texels = feed.next({time, {}}).volumes[0].textures;
  return held;
}

TEST(PhotonLight, IsWhatIsGathered) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  GatheredLight gathered(scene, 64);
  const Vec3 expected = mean_of(draw(scene, gathered));
  for (const char* form : {"form=Q", "form=R"}) {
    const Held held = traced(s, 0, 5, {"photons=16384", "per-watt=5000", form});
    auto light = photons::light(scene, held.volume.desc);
    held.give(*light);
    const Vec3 found = mean_of(draw(scene, *light));
    EXPECT_NEAR(found.x, expected.x, 0.03F * expected.x);
    EXPECT_NEAR(found.y, expected.y, 0.03F * expected.y);
    EXPECT_NEAR(found.z, expected.z, 0.03F * expected.z);
  }
}

TEST(PhotonLight, IsRightHoweverManyBatchesCame) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  const auto of = [&](unsigned updates) {
    const Held held =
        traced(s, 0, updates, {"photons=4096", "per-watt=2600", "per-update=1"});  // 8 batches
    auto light = photons::light(scene, held.volume.desc);
    held.give(*light);
    return mean_of(draw(scene, *light)).y;
  };
  const float whole = of(8);
  EXPECT_NEAR(of(1), whole, 0.1F * whole);
  EXPECT_NEAR(of(3), whole, 0.05F * whole);
}

TEST(PhotonLight, TheNumberOfThreadsChangesNoBit) {
  const Scene s = two_lights();
  ddgi::RayScene scene(s);
  scene.set_state(s.state_at(4));
  const Held held = traced(s, 4, 3, {"photons=2000", "per-watt=500"});
  auto light = photons::light(scene, held.volume.desc);
  held.give(*light);
  const ddgi::Picture one = draw(scene, *light, 1);
  EXPECT_GT(mean_of(one).x, 0);
  EXPECT_TRUE(same(draw(scene, *light, 2), one));
  EXPECT_TRUE(same(draw(scene, *light, 5), one));
}

TEST(HeldPhotons, OldBatchesFadeAndExpire) {
  Held held(small_volume(6));
  const Photon photon{.power = {1, 1, 1}, .radius = 1, .normalisation = 1};
  const std::array<Photon, 1> one{photon};
  set_batch(held, 0, box(3, 1), one, 1);  // two states ahead of the next ones, modulo 2^16
  set_batch(held, 1, box(3, 65535), one, 1);
  set_batch(held, 2, box(3, 65530), one, 1);  // expired, 7 states ago is not
  set_batch(held, 3, box(9, 65535), one, 1);  // another light
  set_batch(held, 4, box(3, 65529), one, 1);  // expired
  HeldPhotons photons(held.volume.desc);
  struct Give : kinds::VolumeLight {
    explicit Give(HeldPhotons& to_in) : to(to_in) {}
    void update(const kinds::HeldVolume& volume, double) override { to.update(volume); }
    [[nodiscard]] Vec3 irradiance(const ddgi::SeenSurface&) const override { return {}; }
    HeldPhotons& to;
  } give(photons);
  held.give(give);
  const auto batches = photons.batches();
  // Weights 1, 1/4 and 1/128 of 100 photons each.
  const float emitted = 100 * (1 + 1 / 4.0F + 1 / 128.0F);
  EXPECT_FLOAT_EQ(batches[0].scale, 1 / emitted);
  EXPECT_FLOAT_EQ(batches[1].scale, 0.25F / emitted);
  EXPECT_FLOAT_EQ(batches[2].scale, 1 / 128.0F / emitted);
  EXPECT_FLOAT_EQ(batches[3].scale, 0.01F);
  EXPECT_EQ(batches[4].scale, 0);
  EXPECT_EQ(batches[5].scale, 0);
  EXPECT_EQ(batches[0].photons.size(), 1U);
  held.received.assign(3, {1, 0, 1, 1, 1, 1});
  held.give(give);
  EXPECT_EQ(photons.batches()[1].scale, 0);
  EXPECT_TRUE(photons.batches()[1].photons.empty());
}

TEST(HeldPhotons, WhatIsNotANumberIsPassedOver) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  std::vector<Photon> photons;
  for (int i = 0; i < 40; ++i) {
    const float at = static_cast<float>(i) / 10 - 2;
    photons.push_back({{at, at / 2, at}, {0, -1, 0}, {1, 1, 1}, i % 2 ? 65504.0F : 0.5F, 1});
  }
  Held held(small_volume(12));
  for (std::uint32_t slot = 0; slot < 12; ++slot) {
    PhotonBatch batch = box(0, 0);
    if (slot < 3) batch.minimum[slot] = slot == 0 ? kNan : kInfinity;
    if (slot == 3) batch.extent = {3e38F, 3e38F, 3e38F};
    if (slot == 4) batch.extent[1] = -1;
    if (slot == 5) batch.watts = kNan;
    if (slot == 6) batch.watts = 3e38F;
    if (slot == 7) batch.emitted = 0;
    if (slot == 8) batch.minimum = {-3e38F, -3e38F, -3e38F};
    set_batch(held, slot, batch, photons, slot == 9 ? 0xFFFF : 40);
    for (std::uint32_t i = 0; slot == 10 && i < 40; ++i) {  // halves that are not finite
      const std::array<std::uint16_t, 4> bad{0x7C00, 0xFC00, 0x7E01, 0xBC00};
      std::memcpy(&held.texels[2][(slot * kCapacity + i) * kPhotonBytes + 8 + i % 4 * 2],
                  &bad[i % bad.size()], 2);
    }
  }
  auto light = photons::light(scene, held.volume.desc);
  held.give(*light);
  for (const Vec3 pixel : draw(scene, *light).pixels) {
    ASSERT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
  }
}

RC_GTEST_PROP(PhotonLight, AnyBytesAreDrawn, ()) {
  static const Scene s = lit_room();
  static const ddgi::RayScene scene(s);
  const auto form = *rc::gen::element(PhotonForm::halves, PhotonForm::shared_exponent);
  Held held(small_volume(5, form));
  ddgi::Random random(*rc::gen::arbitrary<std::uint32_t>());
  for (auto& texture : held.texels) {
    for (std::byte& byte : texture) byte = static_cast<std::byte>(256 * random.next());
  }
  const PhotonBatch sane = box(1, 2);
  for (std::uint32_t slot = 0; slot < 3; ++slot) set_batch(held, slot, sane, {}, 64);
  auto light = photons::light(scene, held.volume.desc);
  held.give(*light);
  const ddgi::Picture once = draw(scene, *light, 1);
  RC_ASSERT(once.pixels.size() == 64U * 48);
  // NaN differs from itself: none is drawn.
  RC_ASSERT(same(once, draw(scene, *light, 3)));
}

TEST(PhotonLight, OtherVolumesAreRefused) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  Held held(small_volume(4));
  auto light = photons::light(scene, held.volume.desc);
  held.texels[1].pop_back();
  EXPECT_THROW(held.give(*light), tools::Error);
  VolumeDesc desc = held.volume.desc;
  desc.groups[0].textures[2].desc.layout = Tiling::atlas_xy_z;
  EXPECT_THROW((void)photons::light(scene, desc), tools::Error);
  desc = held.volume.desc;
  desc.kind = 200;
  EXPECT_THROW((void)photons::light(scene, desc), tools::Error);
}

TEST(SplatPicture, WideAndManyPhotonsAreBoundedWork) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  ddgi::ThreadPool pool(2);
  // A million photons that are as wide as the room: a small picture's worth of tests for each
  // would be beyond what is allowed.
  HeldPhotons::Batch batch;
  batch.scale = 1e-6F;
  batch.photons.assign(1000000, {{0, -2, -1}, {0, -1, 0}, {1, 1, 1}, 100});
  const SplatPicture picture(scene, view_of_room(1024, 768), std::span(&batch, 1), pool);
  EXPECT_LE(picture.tests(), 2 * SplatPicture::kMaxTests);
}

}  // namespace
}  // namespace gicodec::photons
