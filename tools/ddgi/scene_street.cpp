// The street: houses with lit windows on both sides, street lamps, trees and parked cars never
// move; a police car with turning lights and a car with head lamps drive through the night.
#include "noise.h"
#include "patterns.h"
#include "scenes.h"
#include "shapes.h"

namespace gicodec::ddgi {
namespace {

constexpr float kLength = 64;    // half length of the street
constexpr float kRoad = 5.5F;    // half width of the road
constexpr float kFront = 15.2F;  // from the middle to the houses
constexpr float kDepth = 20;     // of the houses

struct StreetMaterials {
  std::uint32_t asphalt, paving, grass, trunk, leaf, iron, roof, sill, glass, window, shop, bulb,
      rubber, chrome, white, black, red_paint, blue_paint, green_paint, red_beacon, blue_beacon,
      head_lamp, tail_lamp;
  std::array<std::uint32_t, 4> walls;
};

StreetMaterials add_street_materials(Scene& s) {
  const auto add = [&](const char* name, Image image) {
    const auto index = static_cast<std::int32_t>(s.add_image(std::move(image)));
    return s.add_material({.name = name, .image = index});
  };
  const auto plain = [&](const char* name, Vec3 colour, Vec3 emission = {}) {
    return s.add_material({.name = name, .colour = colour, .emission = emission});
  };
  StreetMaterials m{};
  m.asphalt = add("asphalt", mottled({0.10F, 0.10F, 0.11F}, {0.17F, 0.165F, 0.16F}, 16, 1.6F, 51));
  m.paving = add("paving", bricks({.colour = {0.36F, 0.34F, 0.32F},
                                   .mortar = {0.16F, 0.15F, 0.14F},
                                   .columns = 4,
                                   .rows = 4,
                                   .joint = 0.01F,
                                   .variation = 0.3F,
                                   .seed = 52}));
  m.grass = add("grass", mottled({0.10F, 0.20F, 0.06F}, {0.18F, 0.22F, 0.09F}, 8, 1.5F, 53));
  m.walls = {
      add("brick wall", bricks({.colour = {0.46F, 0.20F, 0.14F},
                                .mortar = {0.42F, 0.38F, 0.34F},
                                .columns = 8,
                                .rows = 24,
                                .joint = 0.006F,
                                .variation = 0.5F,
                                .seed = 54})),
      add("plaster wall", mottled({0.62F, 0.54F, 0.40F}, {0.50F, 0.44F, 0.33F}, 5, 1.3F, 55)),
      add("stone wall", bricks({.colour = {0.50F, 0.48F, 0.45F},
                                .mortar = {0.30F, 0.29F, 0.27F},
                                .columns = 3,
                                .rows = 6,
                                .joint = 0.008F,
                                .variation = 0.25F,
                                .seed = 56})),
      add("painted wall", mottled({0.30F, 0.42F, 0.48F}, {0.26F, 0.36F, 0.42F}, 6, 1.2F, 57))};
  m.trunk = add("trunk", wood({0.28F, 0.20F, 0.13F}, {0.16F, 0.11F, 0.07F}, 58));
  m.leaf = add("leaf", mottled({0.10F, 0.22F, 0.06F}, {0.22F, 0.32F, 0.10F}, 8, 1.8F, 59));
  m.roof = add("roof", roof_tiles({0.34F, 0.22F, 0.18F}, 60));
  m.sill = add("sill", mottled({0.58F, 0.55F, 0.50F}, {0.46F, 0.44F, 0.40F}, 6, 1.2F, 61));
  m.iron = plain("iron", {0.10F, 0.11F, 0.12F});
  m.glass = plain("glass", {0.05F, 0.06F, 0.08F});
  m.window = plain("lit window", {0.6F, 0.5F, 0.35F}, {0.34F, 0.22F, 0.09F});
  m.shop = plain("shop window", {0.6F, 0.6F, 0.6F}, {0.20F, 0.30F, 0.36F});
  m.bulb = plain("bulb", {0.8F, 0.7F, 0.5F}, {5, 3.6F, 1.8F});
  m.rubber = plain("rubber", {0.04F, 0.04F, 0.04F});
  m.chrome = plain("chrome", {0.55F, 0.56F, 0.58F});
  m.white = plain("white paint", {0.75F, 0.76F, 0.78F});
  m.black = plain("black paint", {0.05F, 0.05F, 0.06F});
  m.red_paint = plain("red paint", {0.55F, 0.06F, 0.05F});
  m.blue_paint = plain("blue paint", {0.07F, 0.14F, 0.42F});
  m.green_paint = plain("green paint", {0.10F, 0.28F, 0.16F});
  m.red_beacon = plain("red beacon", {0.6F, 0.1F, 0.1F});
  m.blue_beacon = plain("blue beacon", {0.1F, 0.1F, 0.6F});
  m.head_lamp = plain("head lamp", {0.8F, 0.8F, 0.8F}, {6, 6, 5});
  m.tail_lamp = plain("tail lamp", {0.6F, 0.1F, 0.1F}, {0.8F, 0.03F, 0.02F});
  return m;
}

struct Town {
  std::array<MeshBuilder, 4> walls;
  MeshBuilder asphalt, paving, grass, trunk, leaf, iron, roof, sill, glass, window, shop, bulb;
  explicit Town(const StreetMaterials& m)
      : walls{MeshBuilder(m.walls[0], 2.4F), MeshBuilder(m.walls[1], 4), MeshBuilder(m.walls[2], 3),
              MeshBuilder(m.walls[3], 4)},
        asphalt(m.asphalt, 6),
        paving(m.paving, 2),
        grass(m.grass, 4),
        trunk(m.trunk, 1),
        leaf(m.leaf, 1.5F),
        iron(m.iron),
        roof(m.roof, 2.5F),
        sill(m.sill, 2),
        glass(m.glass),
        window(m.window),
        shop(m.shop),
        bulb(m.bulb) {}
};

/// A house between z0 and z1 on one side of the street: a solid block with reliefs on its front.
void add_house(Town& town, float side, float z0, float z1, float height, std::uint32_t seed) {
  Random random(seed);
  MeshBuilder& wall = town.walls[seed % town.walls.size()];
  const float x0 = side * kFront, x1 = side * (kFront + kDepth);
  wall.at(Vec3{}).box({std::min(x0, x1), -0.3F, z0}, {std::max(x0, x1), height, z1}, false, 10);
  const auto on_front = [&](MeshBuilder& b, float depth, float za, float zb, float ya, float yb,
                            std::uint32_t cells) {
    const float out = x0 - side * depth, in = x0 + side * 0.05F;
    b.at(Vec3{}).stone({std::min(out, in), ya, za}, {std::max(out, in), yb, zb}, 0.04F, 0, 1,
                       cells);
  };
  on_front(town.sill, 0.45F, z0 - 0.1F, z1 + 0.1F, height - 0.7F, height - 0.1F, 8);
  on_front(town.sill, 0.2F, z0, z1, 3.6F, 3.95F, 8);
  const int columns = static_cast<int>((z1 - z0) / 3.2F);
  const float pitch = (z1 - z0) / static_cast<float>(columns);
  const int floors = static_cast<int>((height - 4.6F) / 3.0F) + 1;
  const bool shop = random.next() < 0.4F;
  for (int floor = 0; floor <= floors; ++floor) {
    const float y = floor == 0 ? 0.9F : 1.6F + 3.0F * static_cast<float>(floor);
    if (y + 2.0F > height - 0.8F) break;
    for (int i = 0; i < columns; ++i) {
      const float z = z0 + pitch * (static_cast<float>(i) + 0.5F);
      const bool lit = random.next() < (floor == 0 ? 0.2F : 0.3F);
      if (floor == 0 && i == columns / 2) {
        on_front(town.trunk, 0.1F, z - 0.7F, z + 0.7F, 0, 2.6F, 4);  // the door
        on_front(town.sill, 0.22F, z - 0.95F, z + 0.95F, 2.6F, 2.9F, 4);
        continue;
      }
      MeshBuilder& pane = floor == 0 && shop ? town.shop : lit ? town.window : town.glass;
      on_front(pane, 0.06F, z - 0.65F, z + 0.65F, y, y + 1.8F, 2);
      on_front(town.sill, 0.24F, z - 0.85F, z + 0.85F, y - 0.18F, y, 4);
      on_front(town.sill, 0.18F, z - 0.8F, z + 0.8F, y + 1.8F, y + 2.0F, 4);
      on_front(town.sill, 0.12F, z - 0.04F, z + 0.04F, y, y + 1.8F, 2);
    }
  }
  const std::array<Vec2, 3> gable{
      {{z0 - 0.3F, height}, {z1 + 0.3F, height}, {(z0 + z1) / 2, height + 3.5F}}};
  town.roof.at(Vec3{}).prism(gable, std::min(x0, x1) - 0.4F, std::max(x0, x1) + 0.4F);
}

void add_lamp(Town& town, Scene& s, float side, float z) {
  const Vec3 foot{side * (kRoad + 1.2F), 0, z};
  town.iron.at(foot)
      .cylinder({0, 0, 0}, {0, 0.6F, 0}, 0.16F, 20)
      .cylinder({0, 0.6F, 0}, {0, 6.2F, 0}, 0.07F, 16)
      .cylinder({0, 6.2F, 0}, {-side * 1.6F, 6.5F, 0}, 0.05F, 12)
      .ellipsoid({-side * 1.7F, 6.58F, 0}, {0.5F, 0.16F, 0.24F}, 20);
  town.bulb.at(foot).ellipsoid({-side * 1.7F, 6.36F, 0}, {0.26F, 0.1F, 0.16F}, 16);
  s.lights.push_back({.type = LightType::spot,
                      .colour = Vec3{3.4F, 2.3F, 1.1F},
                      .position = foot + Vec3{-side * 1.7F, 6.2F, 0},
                      .direction = {0, -1, 0},
                      .cos_inner = 0.75F,
                      .cos_outer = 0.25F});
}

void add_tree(Town& town, float side, float z, std::uint32_t seed) {
  Random random(seed);
  const Vec3 foot{side * (kRoad + 5.5F), 0, z};
  const std::array<Vec2, 6> trunk{
      {{0, 0}, {0.3F, 0}, {0.2F, 0.6F}, {0.16F, 2}, {0.13F, 3.4F}, {0, 3.6F}}};
  town.trunk.at(foot).lathe(trunk, 20);
  for (std::uint32_t i = 0; i < 5; ++i) {
    const float radius = random.in(0.8F, 1.25F);
    town.leaf.at(foot).sphere(
        {random.in(-0.9F, 0.9F), random.in(3.4F, 5.2F), random.in(-0.9F, 0.9F)}, radius, 28, 0.8F,
        seed * 8 + i);
  }
}

/// A car at the origin that looks along +z. Returns its meshes.
std::vector<std::uint32_t> add_car(Scene& s, const StreetMaterials& m, std::uint32_t paint,
                                   std::uint32_t door, bool police) {
  MeshBuilder body(paint), sides(door), glass(m.glass), rubber(m.rubber), chrome(m.chrome),
      head(m.head_lamp), tail(m.tail_lamp), red(m.red_beacon), blue(m.blue_beacon);
  body.stone({-0.92F, 0.35F, -2.2F}, {0.92F, 0.95F, 2.2F}, 0.22F, 0, 1, 16)
      .stone({-0.78F, 1.38F, -1.35F}, {0.78F, 1.5F, 0.6F}, 0.055F, 0, 2, 10);
  sides.stone({-0.94F, 0.45F, -0.95F}, {0.94F, 0.85F, 0.85F}, 0.06F, 0, 3, 10);
  glass.stone({-0.8F, 0.8F, -1.65F}, {0.8F, 1.42F, 1.0F}, 0.3F, 0, 4, 14);
  for (const float x : {-0.82F, 0.82F}) {
    for (const float z : {-1.4F, 1.4F}) {
      rubber.torus({x, 0.36F, z}, {1, 0, 0}, 0.26F, 0.11F, 32, 12);
      chrome.cylinder({x - 0.08F, 0.36F, z}, {x + 0.08F, 0.36F, z}, 0.2F, 24);
    }
    head.ellipsoid({x * 0.78F, 0.68F, 2.16F}, {0.18F, 0.12F, 0.07F}, 16);
    tail.ellipsoid({x * 0.78F, 0.7F, -2.16F}, {0.18F, 0.1F, 0.07F}, 16);
  }
  std::vector<std::uint32_t> meshes;
  for (MeshBuilder* b : {&body, &sides, &glass, &rubber, &chrome, &head, &tail})
    meshes.push_back(s.add_mesh(b->take()));
  if (police) {
    red.ellipsoid({-0.4F, 1.6F, -0.3F}, {0.28F, 0.12F, 0.14F}, 20);
    blue.ellipsoid({0.4F, 1.6F, -0.3F}, {0.28F, 0.12F, 0.14F}, 20);
    meshes.push_back(s.add_mesh(red.take()));
    meshes.push_back(s.add_mesh(blue.take()));
  }
  return meshes;
}

void build_town(Town& town, Scene& s) {
  town.asphalt.at(Vec3{}).surface(12, 160, {2 * kRoad, 2 * kLength + 20}, [](float u, float v) {
    const float x = kRoad * (2 * u - 1);
    return Vec3{x, 0.05F - 0.002F * x * x, (kLength + 10) * (1 - 2 * v)};
  });
  for (const float side : {-1.0F, 1.0F}) {
    const float a = side * kRoad, b = side * (kFront + 0.5F);
    town.paving.at(Vec3{}).box({std::min(a, b), -0.3F, -kLength - 10},
                               {std::max(a, b), 0.12F, kLength + 10}, false, 24);
    Random random(side > 0 ? 71 : 72);
    float z = -kLength - 8;
    for (std::uint32_t i = 0; z < kLength; ++i) {
      const float width = random.in(9.5F, 15);
      add_house(town, side, z, z + width, random.in(8.5F, 14.5F), 80 + 2 * i + (side > 0 ? 1 : 0));
      z += width + (i % 3 == 2 ? 3.5F : 0.0F);  // here and there an alley
    }
    for (int i = 0; i < 6; ++i) {
      const float at = -52.5F + 21 * static_cast<float>(i);
      add_lamp(town, s, side, at + (side > 0 ? 0.0F : 10.5F));
      add_tree(town, side, at + 6, static_cast<std::uint32_t>(100 + i) + (side > 0 ? 50 : 0));
      add_tree(town, side, at + 15, static_cast<std::uint32_t>(200 + i) + (side > 0 ? 50 : 0));
    }
    // Behind the alleys and ends of the street: ground and a far row, so that the sky stays above.
    const float far = side * (kFront + kDepth + 12), near = side * kFront;
    town.grass.at(Vec3{}).box({std::min(near, far), -0.4F, -kLength - 30},
                              {std::max(near, far), -0.02F, kLength + 30}, false, 10);
    town.grass.at(Vec3{}).box({-kFront, -0.4F, side * (kLength + 10) - 20},
                              {kFront, -0.02F, side * (kLength + 10) + 20}, false, 6);
  }
  add_house(town, -1, -kLength - 40, -kLength - 22, 12, 300);
  for (const float end : {-1.0F, 1.0F}) {
    town.walls[2].at(Vec3{}).box(
        {-kFront, -0.3F, std::min(end * (kLength + 12), end * (kLength + 20))},
        {kFront, 10, std::max(end * (kLength + 12), end * (kLength + 20))}, false, 8);
  }
}

}  // namespace

Scene make_street() {
  Scene s;
  s.name = "street";
  s.grid = {32, 4, 64};
  s.volume = {{-31, 0.7F, -63}, {31, 7.9F, 63}};
  const StreetMaterials m = add_street_materials(s);
  Town town(m);
  build_town(town, s);
  Object fixed{.name = "town"};
  for (MeshBuilder& wall : town.walls) fixed.meshes.push_back(s.add_mesh(wall.take()));
  for (MeshBuilder* b :
       {&town.asphalt, &town.paving, &town.grass, &town.trunk, &town.leaf, &town.iron, &town.roof,
        &town.sill, &town.glass, &town.window, &town.shop, &town.bulb}) {
    fixed.meshes.push_back(s.add_mesh(b->take()));
  }
  s.add_object(std::move(fixed));

  const std::array<std::uint32_t, 3> paints{m.green_paint, m.white, m.blue_paint};
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto meshes = add_car(s, m, paints[i], paints[i], false);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const float side = (i + k) % 2 ? 1.0F : -1.0F;
      const float z = -48.0F + 12.0F * static_cast<float>(3 * k + i);
      // Parked cars are unlit: their lamps are covered by paint.
      std::vector<std::uint32_t> unlit(meshes.begin(), meshes.begin() + 5);
      s.add_object({.name = "parked car",
                    .meshes = std::move(unlit),
                    .transform = translation({side * (kRoad - 1.1F), 0, z}) *
                                 rotation({0, 1, 0}, side > 0 ? 0 : kPi)});
    }
  }
  const std::uint32_t police = s.add_object(
      {.name = "police car", .meshes = add_car(s, m, m.white, m.black, true), .dynamic = true});
  const std::uint32_t car = s.add_object(
      {.name = "car", .meshes = add_car(s, m, m.red_paint, m.red_paint, false), .dynamic = true});

  s.sky = {.zenith = {0.0010F, 0.0014F, 0.0034F},
           .horizon = {0.0032F, 0.0030F, 0.0040F},
           .ground = {0.0006F, 0.0006F, 0.0007F}};
  s.lights.push_back({.type = LightType::sun,
                      .colour = {0.010F, 0.013F, 0.022F},
                      .direction = normalize({0.35F, -0.85F, 0.30F})});
  const std::size_t first = s.lights.size();
  for (int i = 0; i < 4; ++i) {  // red and blue beams, then the car's head lamps
    s.lights.push_back({.type = LightType::spot, .cos_inner = 0.93F, .cos_outer = 0.70F});
  }
  s.animate = [=](double time, FrameState& state) {
    const auto t = static_cast<float>(time);
    const Vec3 police_at{-1.9F, 0.04F, 22 - 1.5F * t}, car_at{1.9F, 0.04F, -44 + 8 * t};
    state.transforms[police] = translation(police_at) * rotation({0, 1, 0}, kPi);
    state.transforms[car] = translation(car_at);
    const float angle = 2 * kPi * 0.75F * t;
    const auto beam = [&](std::size_t light, float phase, float x, Vec3 colour) {
      Light& l = state.lights[first + light];
      l.position = police_at + Vec3{x, 2.0F, 0.3F};
      l.direction = normalize({std::cos(angle + phase), -0.12F, std::sin(angle + phase)});
      l.colour = colour;
    };
    beam(0, 0, 0.4F, {16, 0.5F, 0.3F});
    beam(1, kPi, -0.4F, {0.4F, 1.2F, 20});
    state.emission[m.red_beacon] = Vec3{5, 0.1F, 0.05F} * (0.55F + 0.45F * std::sin(2 * angle));
    state.emission[m.blue_beacon] = Vec3{0.1F, 0.3F, 6} * (0.55F - 0.45F * std::sin(2 * angle));
    for (std::size_t i = 0; i < 2; ++i) {
      Light& l = state.lights[first + 2 + i];
      l.position = car_at + Vec3{i ? 0.64F : -0.64F, 0.68F, 2.3F};
      l.direction = normalize({i ? 0.05F : -0.05F, -0.06F, 1});
      l.colour = {26, 24, 19};
      l.cos_inner = 0.97F;
      l.cos_outer = 0.86F;
    }
  };
  s.camera_path = [](double time) {
    const auto t = static_cast<float>(time);
    return Camera{.eye = {3.6F, 2.1F, 36 - 2.2F * t},
                  .target = {-1.2F, 2.6F, 12 - 2.2F * t},
                  .fov_y = 62,
                  .exposure = 7};
  };
  return s;
}

}  // namespace gicodec::ddgi
