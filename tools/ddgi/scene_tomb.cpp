// The tomb: walls, pillars, statue and vases never move; the roof's slabs fall one after another.
#include "noise.h"
#include "patterns.h"
#include "scenes.h"
#include "shapes.h"

namespace gicodec::ddgi {
namespace {

constexpr float kHalf = 13.4F;  // of the room's sides
constexpr float kRoof = 12.6F;  // underside of the roof
constexpr float kThick = 0.9F;  // of the slabs
constexpr int kSlabs = 9;       // per side
constexpr float kFirstFall = 0.2F;
constexpr float kLastFall = 4.6F;

struct TombMaterials {
  std::uint32_t wall, floor, pillar, statue, gold, clay, slab, soil, flame, wood;
};

TombMaterials add_tomb_materials(Scene& s) {
  const auto add = [&](const char* name, Image image, Vec3 emission = {}) {
    const auto index = static_cast<std::int32_t>(s.add_image(std::move(image)));
    return s.add_material(
        {.name = name, .colour = {1, 1, 1}, .image = index, .emission = emission});
  };
  TombMaterials m{};
  m.wall = add("wall", bricks({.colour = {0.55F, 0.42F, 0.28F},
                               .mortar = {0.25F, 0.19F, 0.13F},
                               .columns = 3,
                               .rows = 5,
                               .joint = 0.012F,
                               .seed = 11}));
  m.floor = add("floor", checker({0.48F, 0.42F, 0.34F}, {0.30F, 0.22F, 0.17F}, 12));
  m.pillar = add("pillar", mottled({0.62F, 0.50F, 0.36F}, {0.42F, 0.32F, 0.22F}, 6, 1.5F, 13));
  m.statue = add("statue", mottled({0.30F, 0.45F, 0.36F}, {0.42F, 0.34F, 0.20F}, 5, 1.8F, 14));
  m.gold = add("gold", mottled({0.80F, 0.58F, 0.18F}, {0.62F, 0.40F, 0.10F}, 8, 1, 15));
  m.clay = add("clay", mottled({0.60F, 0.24F, 0.12F}, {0.42F, 0.16F, 0.09F}, 8, 1.4F, 16));
  m.slab = add("slab", mottled({0.55F, 0.47F, 0.37F}, {0.36F, 0.30F, 0.24F}, 6, 1.6F, 17));
  m.soil = add("soil", mottled({0.30F, 0.34F, 0.14F}, {0.34F, 0.25F, 0.15F}, 8, 1.6F, 18));
  m.wood = add("wood", wood({0.40F, 0.24F, 0.12F}, {0.24F, 0.13F, 0.07F}, 19));
  m.flame =
      s.add_material({.name = "flame", .colour = {0.8F, 0.6F, 0.4F}, .emission = {8, 3.4F, 0.9F}});
  return m;
}

void add_pillar(MeshBuilder& shaft, MeshBuilder& blocks, Vec3 foot, std::uint32_t seed) {
  constexpr float h = kRoof - 2.0F;
  std::vector<Vec2> profile;
  for (int i = 0; i <= 28; ++i) {
    const float t = static_cast<float>(i) / 28;
    const float swell = 0.78F + 0.10F * std::sin(kPi * t) - 0.12F * t;
    const float rings = (i == 2 || i == 26) ? 0.12F : 0.0F;
    profile.push_back({swell + rings, 1.0F + h * t});
  }
  shaft.at(foot).lathe(profile, 40, 10, 0.07F);
  blocks.at(foot)
      .stone({-1.1F, 0, -1.1F}, {1.1F, 1.0F, 1.1F}, 0.08F, 0.05F, seed, 8)
      .stone({-1.05F, kRoof - 1, -1.05F}, {1.05F, kRoof, 1.05F}, 0.08F, 0.05F, seed + 1, 8);
}

/// A seated figure on a lotus, in the place of the paper's Buddha.
void add_statue(MeshBuilder& stone, MeshBuilder& gold, Vec3 at) {
  gold.at(at);
  for (int ring = 0; ring < 2; ++ring) {
    for (int i = 0; i < 14; ++i) {
      const float a = (static_cast<float>(i) + 0.5F * static_cast<float>(ring)) * 2 * kPi / 14;
      const float r = 2.0F - 0.3F * static_cast<float>(ring);
      gold.at(translation(at + Vec3{r * std::cos(a), 0.3F + 0.3F * static_cast<float>(ring),
                                    r * std::sin(a)}) *
              rotation({0, 1, 0}, -a))
          .ellipsoid({}, {0.5F, 0.3F, 0.42F}, 16);
    }
  }
  stone.at(at)
      .ellipsoid({0, 1.0F, 0}, {2.0F, 0.55F, 1.6F}, 40, 0.06F, 3)       // crossed legs
      .ellipsoid({0, 2.4F, -0.1F}, {1.05F, 1.5F, 0.8F}, 48, 0.05F, 4)   // trunk
      .ellipsoid({0, 3.3F, -0.1F}, {1.35F, 0.5F, 0.62F}, 32, 0.04F, 5)  // shoulders
      .ellipsoid({-1.3F, 2.4F, 0.1F}, {0.36F, 1.0F, 0.4F}, 32)
      .ellipsoid({1.3F, 2.4F, 0.1F}, {0.36F, 1.0F, 0.4F}, 32)
      .ellipsoid({-0.7F, 1.55F, 0.95F}, {0.85F, 0.28F, 0.32F}, 32)
      .ellipsoid({0.7F, 1.55F, 0.95F}, {0.85F, 0.28F, 0.32F}, 32)
      .cylinder({0, 3.6F, -0.1F}, {0, 4.2F, -0.1F}, 0.34F, 24)
      .ellipsoid({0, 4.75F, -0.05F}, {0.62F, 0.78F, 0.66F}, 48, 0.03F, 6);
  gold.at(at)
      .ellipsoid({0, 5.5F, -0.1F}, {0.34F, 0.34F, 0.34F}, 32)
      .torus({0, 4.8F, -0.75F}, {0, 0, 1}, 1.35F, 0.09F, 64, 12);
}

void add_vase(MeshBuilder& clay, Vec3 at, float size) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= 24; ++i) {
    const float t = static_cast<float>(i) / 24;
    const float r = 0.22F + 0.38F * std::sin(kPi * std::min(1.0F, t * 1.15F)) * (1 - 0.3F * t) +
                    0.12F * smoothstep(0.85F, 1.0F, t);
    profile.push_back({i == 0 ? 0 : r * size, 1.6F * t * size});
  }
  profile.push_back({0.22F * size, 1.5F * size});
  profile.push_back({0.0F, 0.4F * size});
  clay.at(at).lathe(profile, 28);
}

/// When and where a slab of the roof falls. Slabs near the middle go first; the rim stays.
struct Fall {
  bool falls = false;
  float start = 0, rest = 0, spin = 0;
  Vec3 drift, axis;
};

Fall fall_of(int i, int k) {
  const float c = 0.5F * (kSlabs - 1);
  const float dx = (static_cast<float>(i) - c) / c, dz = (static_cast<float>(k) - c) / c;
  const float r = std::hypot(dx, dz);
  Random random(hash(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)));
  Fall f;
  const float jitter = random.in(-0.12F, 0.12F);
  f.falls = r + jitter < 0.86F;
  f.start = kFirstFall + (kLastFall - kFirstFall) * saturate(r + jitter);
  f.rest = 0.45F + 1.3F * (1 - r) * random.next();
  f.spin = random.in(-1.3F, 1.3F);
  f.drift = {random.in(-1.2F, 1.2F), 0, random.in(-1.2F, 1.2F)};
  f.axis = normalize({random.in(-1, 1), random.in(-0.2F, 0.2F), random.in(-1, 1)});
  return f;
}

Affine fallen(const Fall& f, Vec3 home, float time) {
  if (!f.falls || time <= f.start) return translation(home);
  const float height = home.y - f.rest;
  const float duration = std::sqrt(2 * height / 9.81F);
  const float t = std::min(1.0F, (time - f.start) / duration);
  const Vec3 at = home + f.drift * t - Vec3{0, height * t * t, 0};
  return translation(at) * rotation(f.axis, f.spin * t);
}

}  // namespace

Scene make_tomb() {
  Scene s;
  s.name = "tomb";
  s.grid = {16, 8, 16};
  s.volume = {{-15, 0.7F, -15}, {15, 11.9F, 15}};
  const TombMaterials m = add_tomb_materials(s);

  MeshBuilder walls(m.wall, 3.6F), floor(m.floor, 2.4F), shafts(m.pillar, 2),
      blocks(m.pillar, 1.5F), statue(m.statue, 2), gold(m.gold, 1), clay(m.clay, 1),
      soil(m.soil, 4), posts(m.wood, 1), flames(m.flame, 1);
  // The walls lean and bulge a little; nothing is behind them.
  const auto wall = [&](Vec3 corner, Vec3 u, Vec3 inward) {
    walls.surface(64, 28, {length(u), kRoof}, [=](float a, float b) {
      const Vec3 p = corner + u * a + Vec3{0, kRoof * b, 0};
      const float bulge =
          std::min({a, 1 - a, b, 1 - b}) > 0 ? 0.35F * (fbm(p * 0.6F, 3) - 0.5F) : 0;
      return p + inward * bulge;
    });
  };
  wall({-kHalf, 0, -kHalf}, {2 * kHalf, 0, 0}, {0, 0, 1});
  wall({kHalf, 0, kHalf}, {-2 * kHalf, 0, 0}, {0, 0, -1});
  wall({-kHalf, 0, kHalf}, {0, 0, -2 * kHalf}, {1, 0, 0});
  wall({kHalf, 0, -kHalf}, {0, 0, 2 * kHalf}, {-1, 0, 0});
  floor.surface(80, 80, {2 * kHalf, 2 * kHalf}, [](float a, float b) {
    const Vec3 p{kHalf * (2 * a - 1), 0, kHalf * (1 - 2 * b)};
    return p + Vec3{0, 0.12F * (fbm(p * 0.5F, 3, 0, 5) - 0.5F), 0};
  });
  // Ground around the roof, seen from above and from the shaft it leaves.
  constexpr float top = kRoof + kThick, far = 60;
  soil.patch({-far, top, -kHalf}, {2 * far, 0, 0}, {0, 0, -(far - kHalf)}, 40, 20)
      .patch({-far, top, far}, {2 * far, 0, 0}, {0, 0, -(far - kHalf)}, 40, 20)
      .patch({-far, top, kHalf}, {far - kHalf, 0, 0}, {0, 0, -2 * kHalf}, 20, 20)
      .patch({kHalf, top, kHalf}, {far - kHalf, 0, 0}, {0, 0, -2 * kHalf}, 20, 20);
  soil.patch({-kHalf, kRoof, -kHalf}, {2 * kHalf, 0, 0}, {0, kThick, 0})
      .patch({kHalf, kRoof, kHalf}, {-2 * kHalf, 0, 0}, {0, kThick, 0})
      .patch({-kHalf, kRoof, kHalf}, {0, 0, -2 * kHalf}, {0, kThick, 0})
      .patch({kHalf, kRoof, -kHalf}, {0, 0, 2 * kHalf}, {0, kThick, 0});

  for (std::uint32_t i = 0; i < 12; ++i) {
    const float side = i % 2 ? 8.8F : -8.8F;
    const std::uint32_t pair = i / 2;
    const float along = -11.0F + 4.4F * static_cast<float>(pair);
    add_pillar(shafts, blocks, {side, 0, along}, 40 + 2 * i);
  }
  blocks.at(Vec3{0, 0, -8.5F})
      .stone({-3.6F, 0, -3.0F}, {3.6F, 0.5F, 3.4F}, 0.05F, 0.04F, 70, 12)
      .stone({-3.0F, 0.5F, -2.6F}, {3.0F, 1.1F, 2.6F}, 0.05F, 0.04F, 71, 12)
      .stone({-2.5F, 1.1F, -2.2F}, {2.5F, 1.8F, 2.2F}, 0.05F, 0.04F, 72, 12);
  add_statue(statue, gold, {0, 1.8F, -8.5F});
  Random random(5);
  for (int i = 0; i < 14; ++i) {
    const float side = i % 2 ? 1.0F : -1.0F;
    const float size = random.in(0.7F, 1.3F);
    add_vase(clay, {side * random.in(10.2F, 12.4F), 0, random.in(-12, 12)}, size);
  }
  const std::array<Vec3, 4> torches{
      {{-3.4F, 0, -4.2F}, {3.4F, 0, -4.2F}, {-6.8F, 0, 10.8F}, {6.8F, 0, 10.8F}}};
  for (const Vec3 at : torches) {
    posts.at(at)
        .cylinder({0, 0, 0}, {0, 2.0F, 0}, 0.1F, 16)
        .cylinder({0, 1.9F, 0}, {0, 2.1F, 0}, 0.3F, 24);
    flames.at(at).ellipsoid({0, 2.4F, 0}, {0.16F, 0.36F, 0.16F}, 16);
    s.lights.push_back({.type = LightType::point,
                        .colour = {5.0F, 2.6F, 1.0F},
                        .position = at + Vec3{0, 3.0F, 0}});
  }
  Object fixed{.name = "room", .meshes = {}, .transform = {}};
  for (MeshBuilder* b :
       {&walls, &floor, &shafts, &blocks, &statue, &gold, &clay, &soil, &posts, &flames}) {
    fixed.meshes.push_back(s.add_mesh(b->take()));
  }
  s.add_object(std::move(fixed));

  constexpr float size = 2 * kHalf / kSlabs;
  std::vector<Fall> falls;
  std::vector<Vec3> homes;
  for (int i = 0; i < kSlabs; ++i) {
    for (int k = 0; k < kSlabs; ++k) {
      const Vec3 home{-kHalf + size * (static_cast<float>(i) + 0.5F), kRoof + kThick / 2,
                      -kHalf + size * (static_cast<float>(k) + 0.5F)};
      MeshBuilder slab(m.slab, 2);
      // Slabs overlap by a little, so the closed roof is tight.
      const float h = size / 2 + 0.05F;
      slab.stone({-h, -kThick / 2, -h}, {h, kThick / 2, h}, 0.06F, 0.05F,
                 static_cast<std::uint32_t>(100 + i * kSlabs + k), 8);
      s.add_object({.name = "slab",
                    .meshes = {s.add_mesh(slab.take())},
                    .transform = translation(home),
                    .dynamic = true});
      falls.push_back(fall_of(i, k));
      homes.push_back(home);
    }
  }

  s.sky = {.zenith = {0.14F, 0.26F, 0.55F},
           .horizon = {0.42F, 0.48F, 0.55F},
           .ground = {0.12F, 0.10F, 0.08F},
           .sun_direction = {},
           .glow = {0.5F, 0.4F, 0.25F}};
  s.lights.push_back({.type = LightType::sun, .colour = Vec3{3.2F, 2.75F, 2.1F} * 1.4F});
  s.animate = [falls, homes](double time, FrameState& state) {
    const auto t = static_cast<float>(time);
    for (std::size_t i = 0; i < falls.size(); ++i) {
      state.transforms[i + 1] = fallen(falls[i], homes[i], t);
    }
    // The sun climbs and turns, so that light keeps moving after the last slab.
    const float azimuth = 0.5F + 0.06F * t, elevation = 0.80F + 0.03F * t;
    const Vec3 to{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                  std::cos(elevation) * std::cos(azimuth)};
    state.sky.sun_direction = to;
    state.lights.back().direction = -to;
    for (std::size_t i = 0; i + 1 < state.lights.size(); ++i) {
      const auto k = static_cast<float>(i);
      state.lights[i].colour *= 0.85F + 0.15F * std::sin(9 * t + 2 * k) * std::sin(5.3F * t + k);
    }
  };
  s.camera_path = [](double time) {
    const auto t = static_cast<float>(time);
    const float a = 0.25F * std::sin(0.35F * t);
    return Camera{.eye = {6.0F * std::sin(a), 3.2F + 0.5F * t, 11.4F - 0.5F * t},
                  .target = {0, 4.0F, -8},
                  .fov_y = 66,
                  .exposure = mix(3.0F, 0.7F, smoothstep(1.2F, 5.0F, t))};
  };
  return s;
}

}  // namespace gicodec::ddgi
