// glTF out and in again, and files that are broken in every way one can think of.
#include "ddgi/gltf.h"
#include "dump/error.h"
#include "rooms.h"

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

TEST_F(Gltf, TracesLikeTheOriginal) {
  Scene scene = test::busy_room();
  save_gltf(path("a.glb"), scene, 0, 5, 10);
  Scene back = load_gltf(path("a.glb"));
  back.grid = scene.grid;
  back.volume = scene.volume;
  back.sky = scene.sky;
  test::Traced a(std::move(scene), {.rays = 32}), b(std::move(back), {.rays = 32});
  a.volume.update(0.3);
  b.volume.update(0.3);
  ASSERT_EQ(a.volume.active_probes().size(), b.volume.active_probes().size());
  std::vector<std::uint32_t> codes;
  test::for_core_texels(a.volume.textures(), a.volume.active_probes(),
                        [&](auto, auto, auto, auto r, auto, auto) { codes.push_back(r); });
  std::size_t i = 0;
  test::for_core_texels(b.volume.textures(), b.volume.active_probes(),
                        [&](auto, auto, auto, auto r, auto, auto) {
                          EXPECT_NEAR(static_cast<double>(r), static_cast<double>(codes[i]), 2);
                          ++i;
                        });
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
  EXPECT_EQ(
      failure(write(
          "e.gltf",
          R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],"nodes":[{}],"scenes":[{"nodes":[0]}],"scene":0})")),
      tools::Exit::bad_input);
  const std::string mesh =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":COUNT,"type":"VEC3"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})";
  const auto with = [&](const char* count) {
    std::string text = mesh;
    return text.replace(text.find("COUNT"), 5, count);
  };
  // A PNG header that promises 60,000 × 60,000 texels.
  EXPECT_EQ(
      failure(
          write(
              "i.gltf",
              R"({"asset":{"version":"2.0"},"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAA6mAAAOpgCAYAAAA="}],"nodes":[{}],"scenes":[{"nodes":[0]}],"scene":0})"),
          "texels"),
      tools::Exit::bad_input);
  EXPECT_EQ(failure(write("f.gltf", with("3"))), tools::Exit::ok);
  EXPECT_EQ(failure(write("g.gltf", with("4"))), tools::Exit::bad_input);
  EXPECT_EQ(failure(write("h.gltf", with("4000000000"))), tools::Exit::bad_input);
}

}  // namespace
}  // namespace gicodec::ddgi
