// Habits of a tracer: formats, resolutions, spherical harmonics, blending, rays, clamp.
#include "ddgi/octahedral.h"
#include "rooms.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

namespace gicodec::ddgi {
namespace {

using test::busy_room;
using test::for_core_texels;
using test::room;
using test::Traced;

/// Linear light of what is stored.
float light(const ProbeTextures& textures, float stored) {
  const ColorTexels format(textures.color_desc.record.format, textures.encoding);
  const float v = stored / format.unit();
  return format.linear() ? v : v * v * v * v * v;
}

// The closed form of the white furnace, in each format: Le / (1 - albedo).
TEST(Forms, FurnaceInEveryFormat) {
  for (const Format format : color_formats()) {
    for (const Encoding encoding : {Encoding::gamma5, Encoding::linear}) {
      // Linear codes are too coarse in the dark, roots in 6 bits of a mantissa for RTXGI's steps.
      if (encoding == Encoding::linear && usual_encoding(format) == Encoding::gamma5) continue;
      if (encoding == Encoding::gamma5 && format == Format::B10G11R11_UFLOAT_PACK32) continue;
      for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
        Traced traced(room({4, 3, 5}, 0.5F, 0.1F),
                      {.mode = mode,
                       .rays = 64,
                       .hysteresis = 0.5F,
                       .forms = {.color = format, .encoding = encoding, .color_core = 6}});
        for (int i = 0; i < (mode == TraceMode::noisy ? 40 : 1); ++i) traced.volume.update(0);
        const ProbeTextures& t = traced.volume.textures();
        float least = 1, most = 0;
        std::size_t texels = 0;
        for_core_texels(t, traced.volume.active_probes(),
                        [&](auto, auto, auto, float r, float, float) {
                          least = std::min(least, light(t, r));
                          most = std::max(most, light(t, r));
                          ++texels;
                        });
        EXPECT_EQ(texels, 60U * 36);
        // Codes of 8 bits and mantissas of 6 are the coarsest; rounding down adds up over bounces.
        EXPECT_GT(least, 0.2F * 0.94F) << names_of({&format, 1}) << " " << to_string(encoding);
        EXPECT_LT(most, 0.2F * 1.04F) << names_of({&format, 1}) << " " << to_string(encoding);
      }
    }
  }
}

TEST(Forms, ValuesAreThoseOfTheUsualFormatButForRounding) {
  const auto traced_in = [](const TextureForms& forms) {
    Traced traced(busy_room(), {.rays = 128, .forms = forms});
    traced.volume.update(1);
    std::vector<float> values;
    const ProbeTextures& t = traced.volume.textures();
    for_core_texels(t, traced.volume.active_probes(),
                    [&](auto, auto, auto, float r, float, float b) {
                      values.push_back(light(t, r));
                      values.push_back(light(t, b));
                    });
    return values;
  };
  const auto exact = traced_in({.color = Format::R32G32B32A32_SFLOAT});
  for (const Format format : color_formats()) {
    const auto values = traced_in({.color = format});
    ASSERT_EQ(values.size(), exact.size());
    const float allowed = format == Format::R8G8B8A8_UNORM ? 0.15F : 0.06F;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (exact[i] < 1e-3F || exact[i] >= 1) continue;
      EXPECT_NEAR(values[i], exact[i], allowed * exact[i] + 1e-3F) << names_of({&format, 1});
    }
  }
}

TEST(Forms, FixedRaysRepeatInNoisyModeAndTurningOnesDifferInConverged) {
  const auto last_two = [](TraceMode mode, Rotation rotation) {
    Traced traced(busy_room(), {.mode = mode, .rays = 32, .hysteresis = 0, .rotation = rotation});
    for (int i = 0; i < 24; ++i) traced.volume.update(0);
    const ProbeTextures before = traced.volume.textures();
    traced.volume.update(0);
    return traced.volume.textures().visibility == before.visibility;
  };
  EXPECT_TRUE(last_two(TraceMode::noisy, Rotation::fixed));
  EXPECT_FALSE(last_two(TraceMode::noisy, Rotation::by_mode));
  EXPECT_TRUE(last_two(TraceMode::converged, Rotation::by_mode));
  EXPECT_FALSE(last_two(TraceMode::converged, Rotation::turning));
}

TEST(Forms, ClampBoundsWhatARayBrings) {
  for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
    Traced traced(room({4, 3, 5}, 0.5F, 2.0F), {.mode = mode,
                                                .rays = 64,
                                                .clamp = 0.75F,
                                                .forms = {.color = Format::R32G32B32A32_SFLOAT}});
    traced.volume.update(0);
    for_core_texels(traced.volume.textures(), traced.volume.active_probes(),
                    [](auto, auto, auto, float r, float, float) { EXPECT_NEAR(r, 0.75F, 1e-4F); });
  }
}

/// A room with a lamp that goes out at time 0.
Scene fading_room() {
  Scene scene = room({4, 3, 5}, 0.1F, 0);
  scene.lights.push_back({.type = LightType::point, .colour = {50, 50, 50}, .position = {0, 1, 0}});
  scene.animate = [](double time, FrameState& state) {
    if (time > 0) state.lights[0].colour = {0, 0, 0};
  };
  return scene;
}

// Where half a unit of the last place is more than a step, the texel stays what it is; codes of a
// root always move.
TEST(Forms, NoisyBlendsInThePrecisionOfTheTexture) {
  const auto moves = [](Format format) {
    Traced traced(fading_room(),
                  {.mode = TraceMode::noisy,
                   .rays = 8,
                   .hysteresis = 0.9999F,
                   .rotation = Rotation::fixed,
                   .forms = {.color = format, .color_core = 2, .visibility_core = 2}});
    for (int i = 0; i < 400; ++i) traced.volume.update(0);
    const auto before = traced.volume.textures().color;
    traced.volume.update(1);
    return before != traced.volume.textures().color;
  };
  EXPECT_FALSE(moves(Format::B10G11R11_UFLOAT_PACK32));
  EXPECT_TRUE(moves(Format::R32G32B32A32_SFLOAT));
  EXPECT_TRUE(moves(Format::A2R10G10B10_UNORM_PACK32));
  EXPECT_TRUE(moves(Format::R8G8B8A8_UNORM));
}

/// What an update leaves of the light once the lamp is out.
float left_of_light(const TraceOptions& options) {
  Traced traced(fading_room(), options);
  for (int i = 0; i < 9; ++i) traced.volume.update(0);
  const auto red = [&] {
    float sum = 0;
    for_core_texels(traced.volume.textures(), traced.volume.active_probes(),
                    [&](auto, auto, auto, float r, float, float) { sum += r; });
    return sum;
  };
  const float before = red();
  traced.volume.update(1);
  return red() / before;
}

TEST(Forms, ThresholdsChangeWhatThePastCounts) {
  TraceOptions options{.mode = TraceMode::noisy,
                       .rays = 64,
                       .hysteresis = 0.8F,
                       .rotation = Rotation::fixed,
                       .forms = {.color = Format::R32G32B32A32_SFLOAT}};
  // A tenth of the light comes back from the walls.
  EXPECT_NEAR(left_of_light(options), 0.81F, 0.02F);
  options.irradiance_threshold = 1e-4F;
  EXPECT_NEAR(left_of_light(options), 0.1F, 0.06F) << "a fall should be forgotten sooner";
  options.irradiance_threshold = TraceOptions::kNoLimit;
  options.brightness_threshold = 1e-4F;
  EXPECT_NEAR(left_of_light(options), 0.95F, 0.02F) << "a quarter of a change should be taken";
}

float half_at(const ShTexture& texture, std::uint32_t probe, std::size_t channel) {
  std::vector<std::byte> block(bytes_of_block(texture.desc));
  read_block(texture.desc, texture.texels, probe, block);
  std::uint16_t bits = 0;
  std::memcpy(&bits, &block[2 * channel], 2);
  return from_half(bits);
}

// A smooth light is what its harmonics say: octahedral texels against the sum of L2.
TEST(SphericalHarmonics, AgreeWithOctahedralTexels) {
  Scene scene = room({6, 4, 6}, 0.6F, 0.1F);
  scene.lights.push_back({.type = LightType::point, .colour = {9, 6, 3}, .position = {0, 0, 0}});
  scene.grid = {3, 2, 3};
  Traced traced(std::move(scene),
                {.rays = 4096, .forms = {.color = Format::R32G32B32A32_SFLOAT, .sh = ShForm::l2}});
  traced.volume.update(0);
  const ProbeTextures& t = traced.volume.textures();
  ASSERT_EQ(t.sh.size(), 7U);
  std::size_t texels = 0;
  for_core_texels(
      t, traced.volume.active_probes(),
      [&](std::uint32_t probe, std::uint32_t x, std::uint32_t y, float r, float g, float) {
        const Vec3 n = texel_direction(x, y, 8);
        const auto sum = [&](std::size_t colour) {
          const auto a = [&](std::size_t i) { return half_at(t.sh[colour], probe, i); };
          const auto b = [&](std::size_t i) { return half_at(t.sh[3 + colour], probe, i); };
          return a(0) * n.x + a(1) * n.y + a(2) * n.z + a(3) + b(0) * n.x * n.y + b(1) * n.y * n.z +
                 b(2) * n.z * n.z + b(3) * n.z * n.x +
                 half_at(t.sh[6], probe, colour) * (n.x * n.x - n.y * n.y);
        };
        EXPECT_NEAR(sum(0), r, 0.04F * r) << probe << " " << x << " " << y;
        EXPECT_NEAR(sum(1), g, 0.04F * g) << probe << " " << x << " " << y;
        ++texels;
      });
  EXPECT_GT(texels, 500U);
}

TEST(SphericalHarmonics, EvenLightHasNoDirection) {
  for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
    Traced traced(room({4, 3, 5}, 0, 0.25F),
                  {.mode = mode, .rays = 256, .forms = {.sh = ShForm::l1_over_l0}});
    for (int i = 0; i < 3; ++i) traced.volume.update(0);
    const ProbeTextures& t = traced.volume.textures();
    ASSERT_EQ(t.sh.size(), 3U);
    for (const std::uint32_t probe : traced.volume.active_probes()) {
      EXPECT_NEAR(half_at(t.sh[0], probe, 0), 0.25F, 1e-3F);
      EXPECT_NEAR(half_at(t.sh[0], probe, 3), 0.5F, 0.01F);
      std::array<std::byte, 4> block{};
      read_block(t.sh[1].desc, t.sh[1].texels, probe, block);
      for (const std::byte code : block) EXPECT_NEAR(static_cast<int>(code), 128, 2);
    }
  }
}

TEST(SphericalHarmonics, L1IsPartOfL2) {
  const auto traced_in = [](ShForm form) {
    Traced traced(busy_room(), {.rays = 64, .forms = {.sh = form}});
    traced.volume.update(0);
    return traced.volume.textures().sh;
  };
  const auto l1 = traced_in(ShForm::l1), l2 = traced_in(ShForm::l2);
  ASSERT_EQ(l1.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(l1[i].name, l2[i].name);
    for (std::uint32_t probe = 0; probe < 60; ++probe) {
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(half_at(l1[i], probe, c), half_at(l2[i], probe, c));
      EXPECT_NEAR(half_at(l1[i], probe, 3),
                  half_at(l2[i], probe, 3) + half_at(l2[3 + i], probe, 2) / 3, 2e-3F);
    }
  }
}

}  // namespace
}  // namespace gicodec::ddgi
