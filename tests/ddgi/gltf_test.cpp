// glTF out and in again, and files that are broken in every way one can think of.
#include "ddgi/gltf.h"
#include "dump/error.h"
#include "rooms.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace gicodec::ddgi {
namespace {

class Gltf : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("gicodec_gltf_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
               "_" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  std::string write(const char* name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static tools::Exit failure(const std::string& file, const char* text = "") {
    try {
      (void)load_gltf(file);
    } catch (const tools::Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
      return error.code();
    }
    return tools::Exit::ok;
  }

  std::filesystem::path folder_;
};

/// A file with one triangle, (0, 0, 0), (1, 0, 0), (0, 1, 0); more members for its scene.
std::string triangle(const char* type, const std::string& members, const char* count = "3") {
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":36}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"{}"}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]{}}}],"scene":0}})",
      count, type, members);
}

TEST_F(Gltf, ASceneSurvives) {
  Scene scene = test::busy_room();
  scene.materials[0].image =
      static_cast<std::int32_t>(scene.add_image(make_image(8, [](float u, float v) {
        return Vec3{u, v, 0.5F};
      })));
  scene.cameras.push_back({.eye = {0, 1, 6}, .target = {0, 0, 0}, .fov_y = 50});
  save_gltf(path("a.glb"), scene, 0, 5, 10);
  const Scene back = load_gltf(path("a.glb"));
  EXPECT_EQ(back.triangle_count(), scene.triangle_count());
  ASSERT_EQ(back.objects.size(), scene.objects.size());
  EXPECT_FALSE(back.objects[0].dynamic);
  EXPECT_TRUE(back.objects[1].dynamic);
  ASSERT_EQ(back.images.size(), 1U);
  EXPECT_EQ(back.images[0].base().texels, scene.images[0].base().texels);
  ASSERT_EQ(back.lights.size(), 1U);
  EXPECT_NEAR(back.lights[0].colour.x, 8, 1e-4F);
  for (const double time : {0.0, 0.1, 0.25, 0.4}) {
    const FrameState a = scene.state_at(time), b = back.state_at(time);
    EXPECT_LT(length(a.transforms[1].t - b.transforms[1].t), 1e-5F) << time;
    EXPECT_LT(length(a.lights[0].position - b.lights[0].position), 1e-5F);
  }
  EXPECT_LT(length(back.camera_at(0.2).eye - Vec3{0, 1, 6}), 1e-5F);
  EXPECT_NEAR(back.camera_at(0.2).fov_y, 50, 1e-3F);
}

/// A room with a hole to the sky, lights of all kinds but area, a turned block and a moving ball.
Scene open_room() {
  Scene s;
  s.name = "open";
  const std::uint32_t wall = s.add_material({.name = "wall", .colour = {0.61F, 0.57F, 0.53F}});
  const std::uint32_t lamp = s.add_material(
      {.name = "lamp", .colour = {0.3F, 0.3F, 0.3F}, .emission = {3.3F, 2.1F, 0.7F}});
  MeshBuilder floor(wall), block(lamp), ball(wall);
  floor.box({-4, -0.5F, -4}, {4, 0, 4});
  block.box({-1, -1, -1}, {1, 1, 1});
  ball.sphere({}, 0.8F, 12);
  s.add_object({.name = "floor", .meshes = {s.add_mesh(floor.take())}});
  Affine turned = rotation({1, 2, 3}, 0.7F);
  turned.t = {-2, 1.3F, 1};
  s.add_object({.name = "block", .meshes = {s.add_mesh(block.take())}, .transform = turned});
  const std::uint32_t moving =
      s.add_object({.name = "ball", .meshes = {s.add_mesh(ball.take())}, .dynamic = true});
  s.lights.push_back(
      {.type = LightType::sun, .colour = {3, 2.7F, 2.3F}, .direction = normalize({-1, -2, -0.4F})});
  s.lights.push_back(
      {.type = LightType::point, .colour = {0.9F, 0.7F, 0.55F}, .position = {2, 2, 2}});
  s.lights.push_back({.type = LightType::spot,
                      .colour = {11, 13, 12},
                      .position = {3, 3.1F, -3},
                      .direction = normalize({-0.3F, -1, 0.21F}),
                      .cos_inner = 0.93F,
                      .cos_outer = 0.71F});
  s.sky = {.zenith = {0.14F, 0.26F, 0.55F},
           .horizon = {0.4F, 0.41F, 0.45F},
           .ground = {0.1F, 0.09F, 0.08F},
           .sun_direction = normalize({1, 2, 0.4F}),
           .glow = {0.3F, 0.25F, 0.2F}};
  s.volume = {{-3.3F, 0.4F, -3.1F}, {3.7F, 2.9F, 3.2F}};
  s.grid = {4, 2, 3};
  s.cameras.push_back({.eye = {0, 2, 7}, .target = {0, 1, 0}, .fov_y = 50, .exposure = 1.7F});
  s.animate = [moving](double time, FrameState& state) {
    state.transforms[moving] = translation({static_cast<float>(time) - 2, 1.1F, -1});
  };
  return s;
}

TEST_F(Gltf, GivesTheTexelsOfTheOriginal) {
  Scene scene = open_room();
  save_gltf(path("a.glb"), scene, 0.1, 4, 10);
  Scene back = load_gltf(path("a.glb"));
  EXPECT_EQ(back.grid, scene.grid);
  EXPECT_EQ(back.camera_at(0).exposure, 1.7F);
  test::Traced a(std::move(scene), {.rays = 64}), b(std::move(back), {.rays = 64});
  for (const std::uint32_t frame : {0U, 3U}) {
    a.volume.update(0.1 + frame / 10.0);
    b.volume.update(frame / 10.0);
    EXPECT_EQ(a.volume.textures(), b.volume.textures()) << frame;
  }
}

TEST_F(Gltf, ASceneWithoutLightsStaysDark) {
  Scene scene = test::room({2, 2, 2}, 0.5F, 0.25F);
  save_gltf(path("a.glb"), scene, 0, 1, 10);
  const Scene back = load_gltf(path("a.glb"));
  EXPECT_TRUE(back.lights.empty());
  EXPECT_EQ(back.sky.zenith, Vec3{});
}

TEST_F(Gltf, ExtrasAreChecked) {
  const auto file = [&](const std::string& extras) {
    return write("a.gltf", triangle("VEC3", ",\"extras\":{\"gicodec\":" + extras + "}"));
  };
  const std::string sky =
      R"({"sky":{"zenith":[0,0,ZENITH],"horizon":[0,0,0],"ground":[0,0,0],"sun_direction":SUN,"glow":[0,0,0]}})";
  const auto sky_with = [&](const char* zenith, const char* sun) {
    std::string text = sky;
    text.replace(text.find("ZENITH"), 6, zenith);
    return text.replace(text.find("SUN"), 3, sun);
  };
  EXPECT_EQ(load_gltf(file(sky_with("0.5", "[0,2,0]"))).sky.zenith.z, 0.5F);
  EXPECT_EQ(failure(file(sky_with("-1", "[0,1,0]")), "sky.zenith"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(sky_with("1e30", "[0,1,0]")), "sky.zenith"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(sky_with("\"x\"", "[0,1,0]")), "sky.zenith"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(sky_with("0", "[0,0,0]")), "sun_direction"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(sky_with("0", "[0,1]")), "sun_direction"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(R"({"sky":7})"), "extras.gicodec.sky"), tools::Exit::bad_input);
  const auto volume = [](const char* grid, const char* last) {
    return fmt::format(R"({{"volume":{{"grid":{},"first":[0,0,0],"last":{}}}}})", grid, last);
  };
  EXPECT_EQ(load_gltf(file(volume("[2,3,4]", "[1,2,3]"))).grid, (Grid{2, 3, 4}));
  EXPECT_EQ(failure(file(volume("[2,3]", "[1,2,3]")), "volume.grid"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(volume("[2,3,0]", "[1,2,3]")), "volume.grid"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(volume("[2,3,1.5]", "[1,2,3]")), "volume.grid"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(volume("[999999,999999,999999]", "[1,2,3]")), "volume.grid"),
            tools::Exit::bad_input);
  EXPECT_EQ(failure(file(volume("[2,3,4]", "[1,0,3]")), "volume.last"), tools::Exit::bad_input);
  EXPECT_EQ(failure(file(R"({"exposure":-1})"), "exposure"), tools::Exit::bad_input);
}

TEST_F(Gltf, WhatIsNotSupportedIsNamedWithItsCure) {
  const auto needs = [&](const char* extension, const char* text) {
    return failure(write("a.gltf", fmt::format(R"({{"asset":{{"version":"2.0"}},)"
                                               R"("extensionsRequired":["{}"],)"
                                               R"("buffers":[{{"byteLength":8}}]}})",
                                               extension)),
                   text);
  };
  for (const char* text : {"Draco", "KHR_draco_mesh_compression", "gltf-transform copy"})
    EXPECT_EQ(needs("KHR_draco_mesh_compression", text), tools::Exit::bad_input);
  EXPECT_EQ(needs("EXT_meshopt_compression", "without compression"), tools::Exit::bad_input);
  EXPECT_EQ(needs("KHR_texture_basisu", "PNG or JPEG"), tools::Exit::bad_input);
  EXPECT_EQ(needs("VENDOR_thing", "VENDOR_thing, which is not supported: export it without"),
            tools::Exit::bad_input);
  // glTF 1.0 has objects in place of arrays, and another binary header.
  EXPECT_EQ(
      failure(write("b.gltf", R"({"asset":{"version":"1.0"},"buffers":{"b":{"uri":"b.bin"}}})"),
              "is glTF 1.0"),
      tools::Exit::bad_input);
  using namespace std::string_literals;
  EXPECT_EQ(
      failure(write("c.glb", "glTF\1\0\0\0\x1c\0\0\0\x08\0\0\0\0\0\0\0{}      "s), "gltf-pipeline"),
      tools::Exit::bad_input);
  EXPECT_EQ(failure(write("d.gltf", R"({"asset":{"version":"3.0"}})"), "is glTF 3.0"),
            tools::Exit::bad_input);
}

TEST_F(Gltf, TheNameDoesNotMatter) {
  Scene scene = test::room({1, 1, 1}, 0.5F, 0);
  save_gltf(path("a.glb"), scene, 0, 1, 10);
  EXPECT_EQ(load_gltf(write("b.GLB", read(path("a.glb")))).triangle_count(), 12U);
}

TEST_F(Gltf, AFlatFileGetsVolumeAndCamera) {
  const Scene scene = load_gltf(write("a.gltf", triangle("VEC3", "")));
  EXPECT_NEAR(scene.volume.size().z, 1.0F / 8, 1e-6F);
  EXPECT_NEAR(scene.volume.center().z, 0, 1e-6F);
  EXPECT_EQ(scene.cameras.size(), 1U);
}

TEST_F(Gltf, QuantizedMeshesAreRead) {
  std::string text = triangle("VEC3", "");
  text.replace(text.find(R"("byteLength":36}],"accessors")"), 29,
               R"("byteLength":36,"byteStride":12}],"accessors")");
  text.replace(text.find("5126"), 4, "5122");  // shorts
  text.insert(1, R"("extensionsRequired":["KHR_mesh_quantization"],)");
  EXPECT_EQ(load_gltf(write("a.gltf", text)).triangle_count(), 1U);
}

TEST_F(Gltf, EveryPrefixIsRefused) {
  Scene scene = test::room({1, 1, 1}, 0.5F, 0);
  save_gltf(path("a.glb"), scene, 0, 1, 10);
  const std::string whole = read(path("a.glb"));
  for (std::size_t length = 0; length < whole.size(); length += length < 64 ? 1 : 97) {
    EXPECT_EQ(failure(write("b.glb", whole.substr(0, length))), tools::Exit::bad_input) << length;
  }
}

TEST_F(Gltf, DamagedBytesNeverCrash) {
  Scene scene = test::busy_room();
  scene.grid = {2, 2, 2};
  save_gltf(path("a.glb"), scene, 0, 3, 10);
  const std::string whole = read(path("a.glb"));
  const std::size_t json = std::min<std::size_t>(whole.size(), 6000);
  for (std::size_t i = 0; i < 300; ++i) {
    std::string damaged = whole;
    damaged[12 + (i * 7919) % (json - 12)] = static_cast<char>('0' + i % 75);
    (void)failure(write("b.glb", damaged));  // an error or a scene, but it returns
  }
}

TEST_F(Gltf, NonsenseIsNamed) {
  EXPECT_EQ(failure(path("missing.glb")), tools::Exit::io);
  EXPECT_EQ(failure(write("a.gltf", "")), tools::Exit::bad_input);
  EXPECT_EQ(failure(write("b.gltf", "{}")), tools::Exit::bad_input);
  EXPECT_EQ(failure(write("c.gltf", R"({"asset":{"version":"2.0"}})")), tools::Exit::bad_input);
  EXPECT_EQ(
      failure(write(
          "d.gltf",
          R"({"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}],"scene":0})")),
      tools::Exit::bad_input);
  // A PNG header that promises 60,000 × 60,000 texels.
  EXPECT_EQ(
      failure(
          write(
              "i.gltf",
              R"({"asset":{"version":"2.0"},"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAA6mAAAOpgCAYAAAA="}],"nodes":[{}],"scenes":[{"nodes":[0]}],"scene":0})"),
          "texels"),
      tools::Exit::bad_input);
  // Images whose views lie outside of their buffer, or of any.
  for (const char* view : {R"({"buffer":0,"byteOffset":200,"byteLength":40})",
                           R"({"buffer":0,"byteOffset":0,"byteLength":4000})",
                           R"({"buffer":0,"byteOffset":4000000000,"byteLength":40})"}) {
    std::string text = triangle("VEC3", R"(}],"images":[{"bufferView":1,"mimeType":"image/png")");
    text.replace(text.find("\"byteLength\":36}]"), 17,
                 R"("byteLength":36},)" + std::string(view) + "]");
    EXPECT_EQ(failure(write("v.gltf", text), "outside of its buffer"), tools::Exit::bad_input)
        << text;
  }
  EXPECT_EQ(failure(write("f.gltf", triangle("VEC3", "", "3"))), tools::Exit::ok);
  EXPECT_EQ(failure(write("g.gltf", triangle("VEC3", "", "4"))), tools::Exit::bad_input);
  EXPECT_EQ(failure(write("h.gltf", triangle("VEC3", "", "4000000000"))), tools::Exit::bad_input);
}

}  // namespace
}  // namespace gicodec::ddgi
