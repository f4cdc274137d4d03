// The villa: two halls and a colonnaded court between them. Sun and moon go round in a few
// seconds; an orrery turns under the opening of the main hall's roof.
#include "noise.h"
#include "patterns.h"
#include "scenes.h"
#include "shapes.h"

namespace gicodec::ddgi {
namespace {

constexpr float kDay = 16;         // seconds of a day
constexpr float kMorning = 0.29F;  // of the day, at time 0
constexpr float kX = 13;           // half width of the house
constexpr float kZ = 29;           // half length
constexpr float kWall = 0.8F;      // thickness
constexpr float kHall = 9.5F;      // height of the main hall
constexpr float kWing = 6.5F;      // height of the other rooms

struct VillaMaterials {
  std::uint32_t plaster, red, stone, marble, mosaic, wood, roof, lawn, water, bronze, gold, cloth,
      clay, leaf, lamp;
};

VillaMaterials add_villa_materials(Scene& s) {
  const auto add = [&](const char* name, Image image) {
    const auto index = static_cast<std::int32_t>(s.add_image(std::move(image)));
    return s.add_material({.name = name, .image = index});
  };
  VillaMaterials m{};
  m.plaster = add("plaster", mottled({0.78F, 0.72F, 0.62F}, {0.66F, 0.58F, 0.48F}, 5, 1.3F, 21));
  m.red = add("red plaster", mottled({0.58F, 0.14F, 0.09F}, {0.46F, 0.12F, 0.08F}, 6, 1.2F, 22));
  m.stone = add("stone", bricks({.colour = {0.62F, 0.57F, 0.48F},
                                 .mortar = {0.40F, 0.36F, 0.30F},
                                 .columns = 2,
                                 .rows = 4,
                                 .joint = 0.008F,
                                 .variation = 0.2F,
                                 .seed = 23}));
  m.marble = add("marble", marble({0.82F, 0.80F, 0.76F}, {0.48F, 0.46F, 0.46F}, 24));
  m.mosaic = add("mosaic",
                 mosaic({0.70F, 0.62F, 0.48F}, {0.16F, 0.26F, 0.36F}, {0.52F, 0.17F, 0.10F}, 25));
  m.wood = add("wood", wood({0.48F, 0.30F, 0.16F}, {0.28F, 0.16F, 0.08F}, 26));
  m.roof = add("roof tiles", roof_tiles({0.62F, 0.27F, 0.14F}, 27));
  m.lawn = add("lawn", mottled({0.20F, 0.34F, 0.10F}, {0.34F, 0.36F, 0.16F}, 8, 1.5F, 28));
  m.water = add("water", mottled({0.05F, 0.20F, 0.26F}, {0.08F, 0.28F, 0.34F}, 6, 1.5F, 29));
  m.bronze = add("bronze", mottled({0.42F, 0.28F, 0.14F}, {0.30F, 0.22F, 0.12F}, 6, 1.5F, 30));
  m.gold = add("gold", mottled({0.82F, 0.60F, 0.20F}, {0.64F, 0.44F, 0.12F}, 6, 1, 31));
  m.cloth = add("cloth", checker({0.20F, 0.12F, 0.42F}, {0.46F, 0.30F, 0.12F}, 32));
  m.clay = add("clay", mottled({0.62F, 0.28F, 0.15F}, {0.45F, 0.19F, 0.10F}, 8, 1.4F, 33));
  m.leaf = add("leaf", mottled({0.12F, 0.26F, 0.08F}, {0.22F, 0.36F, 0.12F}, 8, 1.8F, 34));
  m.lamp = s.add_material({.name = "lamp", .colour = {0.8F, 0.7F, 0.5F}});
  return m;
}

struct Builders {
  MeshBuilder plaster, red, stone, marble, mosaic, wood, roof, lawn, water, bronze, gold, cloth,
      clay, leaf, lamp;
  explicit Builders(const VillaMaterials& m)
      : plaster(m.plaster, 4),
        red(m.red, 3),
        stone(m.stone, 2),
        marble(m.marble, 2.5F),
        mosaic(m.mosaic, 2),
        wood(m.wood, 2),
        roof(m.roof, 2.5F),
        lawn(m.lawn, 5),
        water(m.water, 4),
        bronze(m.bronze, 1),
        gold(m.gold, 1),
        cloth(m.cloth, 1),
        clay(m.clay, 1),
        leaf(m.leaf, 1.5F),
        lamp(m.lamp, 1) {}
};

void add_column(MeshBuilder& marble, MeshBuilder& stone, Vec3 foot, float height) {
  std::vector<Vec2> shaft;
  for (int i = 0; i <= 14; ++i) {
    const float t = static_cast<float>(i) / 14;
    shaft.push_back({0.42F + 0.03F * std::sin(kPi * t) - 0.07F * t, 0.45F + (height - 0.9F) * t});
  }
  marble.at(foot).lathe(shaft, 48, 12, 0.045F);
  const std::array<Vec2, 8> base{{{0, 0.2F},
                                  {0.62F, 0.2F},
                                  {0.66F, 0.26F},
                                  {0.62F, 0.32F},
                                  {0.52F, 0.36F},
                                  {0.54F, 0.42F},
                                  {0.46F, 0.46F},
                                  {0, 0.5F}}};
  const std::array<Vec2, 6> head{{{0, height - 0.5F},
                                  {0.38F, height - 0.5F},
                                  {0.44F, height - 0.42F},
                                  {0.62F, height - 0.26F},
                                  {0.66F, height - 0.2F},
                                  {0, height - 0.2F}}};
  stone.at(foot).lathe(base, 32).lathe(head, 32);
  stone.at(foot)
      .box({-0.68F, 0, -0.68F}, {0.68F, 0.2F, 0.68F})
      .box({-0.7F, height - 0.2F, -0.7F}, {0.7F, height, 0.7F});
}

/// A wall in the x direction (or z, if turned) with openings at the given places along it.
struct Opening {
  float from, to, sill, lintel;
};
void add_wall(MeshBuilder& out, Vec3 lo, Vec3 hi, bool along_z, std::span<const Opening> openings) {
  const auto piece = [&](float from, float to, float bottom, float top) {
    if (to - from < 1e-3F || top - bottom < 1e-3F) return;
    const Vec3 a = along_z ? Vec3{lo.x, bottom, from} : Vec3{from, bottom, lo.z};
    const Vec3 b = along_z ? Vec3{hi.x, top, to} : Vec3{to, top, hi.z};
    out.at(Vec3{}).box(a, b, false, 4);
  };
  float at = along_z ? lo.z : lo.x;
  const float end = along_z ? hi.z : hi.x;
  for (const Opening& o : openings) {
    piece(at, o.from, lo.y, hi.y);
    piece(o.from, o.to, lo.y, o.sill);
    piece(o.from, o.to, o.lintel, hi.y);
    at = o.to;
  }
  piece(at, end, lo.y, hi.y);
}

void add_vase(MeshBuilder& clay, MeshBuilder& leaf, Vec3 at, float size, std::uint32_t seed) {
  std::vector<Vec2> profile;
  for (int i = 0; i <= 20; ++i) {
    const float t = static_cast<float>(i) / 20;
    profile.push_back({i == 0 ? 0 : size * (0.24F + 0.3F * std::sin(2.6F * t)), size * 1.2F * t});
  }
  profile.push_back({0, size * 1.1F});
  clay.at(at).lathe(profile, 28);
  Random random(seed);
  for (int i = 0; i < 6; ++i) {
    const float radius = random.in(0.28F, 0.45F) * size;
    leaf.at(at + Vec3{0, 1.5F * size, 0})
        .sphere({random.in(-0.35F, 0.35F) * size, random.in(-0.1F, 0.5F) * size,
                 random.in(-0.35F, 0.35F) * size},
                radius, 16, 0.5F, seed + static_cast<std::uint32_t>(i));
  }
}

void add_couch(MeshBuilder& wood, MeshBuilder& cloth, const Affine& at) {
  wood.at(at).stone({-1.5F, 0.25F, -0.6F}, {1.5F, 0.5F, 0.6F}, 0.05F, 0, 1, 6);
  for (const float x : {-1.35F, 1.35F}) {
    for (const float z : {-0.48F, 0.48F}) wood.at(at).cylinder({x, 0, z}, {x, 0.3F, z}, 0.08F, 12);
  }
  cloth.at(at)
      .stone({-1.45F, 0.5F, -0.56F}, {1.45F, 0.75F, 0.56F}, 0.11F, 0.02F, 2, 12)
      .ellipsoid({-1.15F, 0.9F, 0}, {0.28F, 0.26F, 0.5F}, 24)
      .ellipsoid({1.15F, 0.9F, 0}, {0.28F, 0.26F, 0.5F}, 24);
}

void add_statue(MeshBuilder& marble, Vec3 at) {
  marble.at(at)
      .stone({-0.6F, 0, -0.6F}, {0.6F, 1.2F, 0.6F}, 0.05F, 0, 3, 6)
      .ellipsoid({0, 2.0F, 0}, {0.42F, 1.0F, 0.38F}, 32, 0.25F, 7)
      .ellipsoid({0, 2.9F, 0}, {0.46F, 0.6F, 0.32F}, 32, 0.1F, 8)
      .ellipsoid({-0.48F, 2.75F, 0.1F}, {0.14F, 0.55F, 0.16F}, 20)
      .ellipsoid({0.48F, 2.95F, 0.1F}, {0.14F, 0.5F, 0.16F}, 20)
      .cylinder({0, 3.3F, 0}, {0, 3.6F, 0}, 0.13F, 16)
      .ellipsoid({0, 3.8F, 0}, {0.24F, 0.32F, 0.28F}, 24, 0.08F, 9);
}

/// A gable roof over a part of the house, its ridge along x, with an underside.
void add_gable(MeshBuilder& roof, float z0, float z1, float eaves, float rise) {
  const float zm = (z0 + z1) / 2, x = kX + 0.7F;
  const std::array<Vec2, 3> outline{{{z0 - 0.7F, eaves}, {z1 + 0.7F, eaves}, {zm, eaves + rise}}};
  roof.at(Vec3{}).prism(outline, -x, x);
}

void build_house(Builders& b) {
  // Ground, floors. From below only the back of the lawn is to be seen.
  b.lawn.at(Vec3{}).surface(90, 90, {180, 180}, [](float u, float v) {
    const Vec3 p{90 * (2 * u - 1), 0, 90 * (1 - 2 * v)};
    const float far = smoothstep(18, 60, std::max(std::abs(p.x), std::abs(p.z) - 14));
    return p + Vec3{0, -0.25F + 7 * far * (fbm(p * 0.05F, 4) - 0.35F), 0};
  });
  b.stone.at(Vec3{}).box({-kX - 1, -0.1F, -kZ - 1}, {kX + 1, 0, kZ + 1}, false, 12);
  b.mosaic.at(Vec3{}).patch({-kX, 0.02F, -6}, {2 * kX, 0, 0}, {0, 0, -(kZ - 6)}, 8, 8);
  b.marble.at(Vec3{}).patch({-kX, 0.02F, kZ}, {2 * kX, 0, 0}, {0, 0, -(kZ - 16)}, 8, 8);

  // Main hall, z from -29 to -6, open to the court by a row of doors.
  const std::array<Opening, 4> sides{{{-26, -23, 2.5F, 6.5F},
                                      {-21, -18, 2.5F, 6.5F},
                                      {-16.5F, -13.5F, 2.5F, 6.5F},
                                      {-12, -9, 2.5F, 6.5F}}};
  const std::array<Opening, 3> doors{
      {{-9.5F, -5.5F, 0, 5.5F}, {-2.5F, 2.5F, 0, 6.5F}, {5.5F, 9.5F, 0, 5.5F}}};
  add_wall(b.plaster, {-kX, 0, -kZ}, {-kX + kWall, kHall, -6}, true, sides);
  add_wall(b.plaster, {kX - kWall, 0, -kZ}, {kX, kHall, -6}, true, sides);
  add_wall(b.red, {-kX + kWall, 0, -kZ}, {kX - kWall, kHall, -kZ + kWall}, false, {});
  add_wall(b.plaster, {-kX + kWall, 0, -6 - kWall}, {kX - kWall, kHall, -6}, false, doors);
  // Its flat roof with the opening that the orrery hangs under.
  const float y = kHall, t = 0.8F;
  b.stone.at(Vec3{})
      .box({-kX - 0.5F, y, -kZ - 0.5F}, {kX + 0.5F, y + t, -23}, false, 6)
      .box({-kX - 0.5F, y, -12}, {kX + 0.5F, y + t, -5.5F}, false, 6)
      .box({-kX - 0.5F, y, -23}, {-6.5F, y + t, -12}, false, 6)
      .box({6.5F, y, -23}, {kX + 0.5F, y + t, -12}, false, 6);
  for (const float x : {-8.5F, 8.5F}) {
    for (const float z : {-24.5F, -20.0F, -15.5F, -11.0F})
      add_column(b.marble, b.stone, {x, 0, z}, kHall);
  }

  // Court, z from -6 to 16: roofed walks on both sides, a pool between.
  for (const float side : {-1.0F, 1.0F}) {
    const float outer = side * kX, inner = side * 6.5F;
    const std::array<Opening, 2> gates{{{-1, 2, 0, 4.5F}, {9, 12, 1.5F, 4.5F}}};
    add_wall(b.red, {std::min(outer, outer - side * kWall), 0, -6},
             {std::max(outer, outer - side * kWall), kWing, 16}, true, gates);
    b.roof.at(Vec3{}).box({std::min(outer + side * 0.5F, inner - side * 0.7F), kWing, -6},
                          {std::max(outer + side * 0.5F, inner - side * 0.7F), kWing + 0.4F, 16},
                          false, 8);
    for (int i = 0; i < 6; ++i) {
      add_column(b.marble, b.stone, {inner, 0, -4.0F + 3.6F * static_cast<float>(i)}, kWing);
    }
  }
  b.lawn.at(Vec3{}).patch({-5.6F, 0.03F, 15}, {11.2F, 0, 0}, {0, 0, -20}, 10, 10);
  b.marble.at(Vec3{})
      .stone({-3.6F, 0, -1}, {-3.1F, 0.45F, 11}, 0.06F, 0, 4, 8)
      .stone({3.1F, 0, -1}, {3.6F, 0.45F, 11}, 0.06F, 0, 5, 8)
      .stone({-3.1F, 0, -1}, {3.1F, 0.45F, -0.5F}, 0.06F, 0, 6, 8)
      .stone({-3.1F, 0, 10.5F}, {3.1F, 0.45F, 11}, 0.06F, 0, 7, 8);
  b.water.at(Vec3{}).patch({-3.1F, 0.3F, 10.5F}, {6.2F, 0, 0}, {0, 0, -11}, 4, 4);

  // Wing, z from 16 to 29: two rooms under a gable.
  const std::array<Opening, 2> entrances{{{-8.5F, -5.5F, 0, 4.5F}, {5.5F, 8.5F, 0, 4.5F}}};
  const std::array<Opening, 3> windows{
      {{-9, -6, 1.5F, 4.5F}, {-1.5F, 1.5F, 0, 4.8F}, {6, 9, 1.5F, 4.5F}}};
  const std::array<Opening, 1> between{{{20, 24, 0, 4.5F}}};
  const std::array<Opening, 1> lateral{{{20, 24, 1.5F, 4.5F}}};
  add_wall(b.plaster, {-kX, 0, 16}, {kX, kWing, 16 + kWall}, false, entrances);
  add_wall(b.plaster, {-kX, 0, kZ - kWall}, {kX, kWing, kZ}, false, windows);
  add_wall(b.plaster, {-kX, 0, 16 + kWall}, {-kX + kWall, kWing, kZ - kWall}, true, lateral);
  add_wall(b.plaster, {kX - kWall, 0, 16 + kWall}, {kX, kWing, kZ - kWall}, true, lateral);
  add_wall(b.red, {-kWall / 2, 0, 16 + kWall}, {kWall / 2, kWing, kZ - kWall}, true, between);
  b.wood.at(Vec3{}).box({-kX, kWing, 16}, {kX, kWing + 0.4F, kZ}, false, 8);
  add_gable(b.roof, 16, kZ, kWing + 0.4F, 3.6F);
}

void furnish(Builders& b, Scene& s) {
  for (const float side : {-1.0F, 1.0F}) {
    add_statue(b.marble, {side * 4.0F, 0, -26.5F});
    add_statue(b.marble, {side * 10.8F, 0, 14});
    add_couch(b.wood, b.cloth, translation({side * 10.8F, 0, -18}) * rotation({0, 1, 0}, kPi / 2));
    add_couch(b.wood, b.cloth, translation({side * 8, 0, 26}));
    add_couch(b.wood, b.cloth, translation({side * 10.5F, 0, 20}) * rotation({0, 1, 0}, kPi / 2));
    add_vase(b.clay, b.leaf, {side * 4.6F, 0, -2.5F}, 0.9F, 40);
    add_vase(b.clay, b.leaf, {side * 4.6F, 0, 12.6F}, 0.9F, 50);
    add_vase(b.clay, b.leaf, {side * 11.3F, 0, -8.2F}, 1.1F, 60);
    add_vase(b.clay, b.leaf, {side * 3.2F, 0, 18}, 0.8F, 70);
  }
  Random random(9);
  for (std::uint32_t i = 0; i < 18; ++i) {
    const float side = i % 2 ? 1.0F : -1.0F;
    const Vec3 at{side * random.in(19, 40), -0.2F, random.in(-45, 45)};
    b.wood.at(at).cylinder({}, {0, 3.5F, 0}, 0.25F, 12);
    b.leaf.at(at)
        .ellipsoid({0, 5.2F, 0}, {1.5F, 3.2F, 1.5F}, 28, 0.7F, i)
        .sphere({0.5F, 4, 0.4F}, 1.4F, 20, 0.7F, i + 30);
  }
  for (const Vec3 at : {Vec3{-5, 0, -24},
                        {5, 0, -24},
                        {-11.4F, 0, -12.6F},
                        {11.4F, 0, -12.6F},
                        {-6, 0, 22.5F},
                        {6, 0, 22.5F}}) {
    b.bronze.at(at)
        .cylinder({}, {0, 2.0F, 0}, 0.07F, 12)
        .cylinder({0, 1.95F, 0}, {0, 2.1F, 0}, 0.3F, 24);
    b.lamp.at(at).ellipsoid({0, 2.35F, 0}, {0.16F, 0.28F, 0.16F}, 16);
    s.lights.push_back({.type = LightType::point, .position = at + Vec3{0, 3.0F, 0}});
  }
}

/// A planet of the orrery: an arm around the axis and what it carries.
struct Planet {
  float orbit, height, radius, rate, phase;
  bool ring;
};
constexpr std::array<Planet, 5> kPlanets{{{1.9F, 6.6F, 0.50F, 0.9F, 0.3F, false},
                                          {2.9F, 7.0F, 0.75F, 0.62F, 2.1F, false},
                                          {3.9F, 7.4F, 0.85F, 0.44F, 4.0F, false},
                                          {5.0F, 7.8F, 1.35F, 0.28F, 5.3F, false},
                                          {5.6F, 8.3F, 1.05F, -0.2F, 1.2F, true}}};
constexpr Vec3 kOrrery{0, 0, -17.5F};

void add_orrery(Scene& s, const VillaMaterials& m) {
  MeshBuilder foot(m.bronze, 1), sun(m.gold, 1);
  const std::array<Vec2, 9> profile{{{0, 0},
                                     {1.8F, 0},
                                     {1.8F, 0.3F},
                                     {1.2F, 0.5F},
                                     {0.5F, 0.9F},
                                     {0.3F, 1.6F},
                                     {0.22F, 4},
                                     {0.2F, 8.5F},
                                     {0, 8.6F}}};
  foot.at(kOrrery).lathe(profile, 48);
  sun.at(kOrrery)
      .sphere({0, 5.4F, 0}, 0.9F, 48)
      .torus({0, 5.4F, 0}, {0.2F, 1, 0.1F}, 1.5F, 0.07F, 96, 12);
  s.add_object({.name = "orrery", .meshes = {s.add_mesh(foot.take()), s.add_mesh(sun.take())}});
  for (std::size_t i = 0; i < kPlanets.size(); ++i) {
    const Planet& p = kPlanets[i];
    MeshBuilder arm(m.bronze, 1), ball(i % 2 ? m.gold : m.marble, 2);
    arm.cylinder({0, p.height, 0}, {p.orbit, p.height, 0}, 0.07F, 12)
        .cylinder({p.orbit, p.height - 0.2F, 0}, {p.orbit, p.height + 0.3F, 0}, 0.07F, 12)
        .torus({0, p.height, 0}, {0, 1, 0}, 0.28F, 0.09F, 32, 12);
    ball.sphere({p.orbit, p.height + 0.3F + p.radius, 0}, p.radius, 48);
    if (p.ring)
      ball.torus({p.orbit, p.height + 0.3F + p.radius, 0}, {0.3F, 1, 0}, 1.7F, 0.16F, 64, 8);
    s.add_object({.name = "planet",
                  .meshes = {s.add_mesh(arm.take()), s.add_mesh(ball.take())},
                  .dynamic = true});
  }
}

/// Sun, moon, sky and lamps at a time of the day in [0, 1); 0 is midnight.
void set_day(float day, FrameState& state, std::uint32_t lamp, std::size_t lamps) {
  const float angle = 2 * kPi * (day - 0.25F);  // 0 at sunrise
  const Vec3 to = normalize({std::cos(angle), 0.92F * std::sin(angle), 0.38F});
  const float height = to.y;
  const float daylight = smoothstep(-0.12F, 0.28F, height);
  const float low = 1 - smoothstep(0.0F, 0.45F, height);
  const float direct = smoothstep(-0.02F, 0.16F, height);
  const Vec3 warm = lerp({3.0F, 2.75F, 2.4F}, {2.6F, 1.25F, 0.5F}, low);

  Sky& sky = state.sky;
  sky.zenith = lerp({0.0012F, 0.0018F, 0.0045F},
                    lerp({0.13F, 0.26F, 0.58F}, {0.10F, 0.14F, 0.30F}, low), daylight);
  sky.horizon = lerp({0.0020F, 0.0026F, 0.0055F},
                     lerp({0.46F, 0.54F, 0.62F}, {0.60F, 0.30F, 0.16F}, low), daylight);
  sky.ground = lerp({0.0008F, 0.0009F, 0.0012F}, {0.12F, 0.11F, 0.08F}, daylight);
  sky.sun_direction = to;
  sky.glow = warm * (0.22F * daylight);

  Light& sun = state.lights[lamps];
  sun.direction = -to;
  sun.colour = warm * (1.15F * direct);
  Light& moon = state.lights[lamps + 1];
  const Vec3 moon_to = normalize({-to.x, std::abs(to.y) * 0.9F + 0.25F, 0.30F});
  moon.direction = -moon_to;
  moon.colour = Vec3{0.020F, 0.026F, 0.042F} * (1 - daylight);

  const float lit = 1 - smoothstep(0.02F, 0.2F, height);
  for (std::size_t i = 0; i < lamps; ++i) state.lights[i].colour = Vec3{0.55F, 0.30F, 0.12F} * lit;
  state.emission[lamp] = Vec3{1.3F, 0.7F, 0.26F} * lit;
}

}  // namespace

Scene make_villa() {
  Scene s;
  s.name = "villa";
  s.grid = {16, 8, 32};
  s.volume = {{-15, -0.95F, -31}, {15, 10.6F, 31}};  // the lowest layer lies below the floors
  const VillaMaterials m = add_villa_materials(s);
  Builders b(m);
  build_house(b);
  furnish(b, s);
  Object house{.name = "house"};
  for (MeshBuilder* part : {&b.plaster, &b.red, &b.stone, &b.marble, &b.mosaic, &b.wood, &b.roof,
                            &b.lawn, &b.water, &b.bronze, &b.cloth, &b.clay, &b.leaf, &b.lamp}) {
    house.meshes.push_back(s.add_mesh(part->take()));
  }
  s.add_object(std::move(house));
  const std::size_t lamps = s.lights.size();
  s.lights.push_back({.type = LightType::sun});
  s.lights.push_back({.type = LightType::sun});
  add_orrery(s, m);

  const std::size_t first = s.objects.size() - kPlanets.size();
  s.animate = [first, lamps, lamp = m.lamp](double time, FrameState& state) {
    const auto t = static_cast<float>(time);
    for (std::size_t i = 0; i < kPlanets.size(); ++i) {
      state.transforms[first + i] =
          translation(kOrrery) * rotation({0, 1, 0}, kPlanets[i].phase + kPlanets[i].rate * t);
    }
    const float day = kMorning + t / kDay;
    set_day(day - std::floor(day), state, lamp, lamps);
  };
  s.camera_path = [](double time) {
    const auto t = static_cast<float>(time);
    const float day = kMorning + t / kDay;
    const float sun = std::sin(2 * kPi * (day - std::floor(day) - 0.25F));
    const float a = 0.22F * std::sin(0.3F * t);
    return Camera{.eye = {9.6F * std::sin(0.5F + a), 2.6F, -9.2F},
                  .target = {-1.5F, 3.9F, -22},
                  .fov_y = 68,
                  .exposure = mix(9.0F, 1.5F, smoothstep(-0.15F, 0.3F, sun))};
  };
  return s;
}

}  // namespace gicodec::ddgi
