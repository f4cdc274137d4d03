// Texture coordinates of a map in an exported scene.
#include "ddgi/gltf.h"
#include "halves.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace gicodec::maps {
namespace {

/// A .glb as its two chunks.
struct Glb {
  nlohmann::json json;
  std::string bytes;

  explicit Glb(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    std::uint32_t size = 0;
    std::memcpy(&size, &file[12], sizeof size);
    json = nlohmann::json::parse(file.substr(20, size));
    bytes = file.substr(20 + size + 8);
  }
  template <typename T>
  [[nodiscard]] std::vector<T> accessor(const nlohmann::json& number, std::size_t per) const {
    const auto& accessor = json["accessors"][number.get<std::size_t>()];
    const auto& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    std::vector<T> out(accessor["count"].get<std::size_t>() * per);
    std::memcpy(out.data(), &bytes[view.value("byteOffset", std::size_t{0})],
                out.size() * sizeof(T));
    return out;
  }
};

class MapGltf : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("gicodec_map_gltf_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()));
};

TEST_F(MapGltf, CarriesTheMapsCoordinatesOfEveryTriangle) {
  const ddgi::Scene scene = test::halves();
  const std::string path = (folder_ / "halves.glb").string();
  const auto uvs = second_uvs(scene, 64);
  ddgi::save_gltf(path, scene, 0, 1, 10, tools::Existing::refuse, uvs);
  const Glb file(path);
  std::size_t instance = 0;
  for (const auto& mesh : file.json["meshes"]) {
    for (const auto& primitive : mesh["primitives"]) {
      const auto coordinates = file.accessor<float>(primitive["attributes"]["TEXCOORD_1"], 2);
      const auto indices = file.accessor<std::uint32_t>(primitive["indices"], 1);
      ASSERT_EQ(indices.size(), uvs[instance].size() * 3);
      for (std::size_t i = 0; i < indices.size(); ++i) {
        const Vec2 corner = uvs[instance][i / 3][i % 3];
        ASSERT_EQ(coordinates[2 * indices[i]], corner.x);
        ASSERT_EQ(coordinates[2 * indices[i] + 1], corner.y);
        ASSERT_GT(std::min(corner.x, corner.y), 0);
        ASSERT_LT(std::max(corner.x, corner.y), 1);
      }
      ++instance;
    }
  }
  EXPECT_EQ(instance, uvs.size());
}

TEST_F(MapGltf, TheSceneIsTheSameWithThem) {
  const ddgi::Scene scene = test::halves();
  const std::string with = (folder_ / "with.glb").string(), without = (folder_ / "o.glb").string();
  ddgi::save_gltf(with, scene, 0, 1, 10, tools::Existing::refuse, second_uvs(scene, 64));
  ddgi::save_gltf(without, scene, 0, 1, 10);
  EXPECT_EQ(Glb(without).json.dump().find("TEXCOORD_1"), std::string::npos);
  const ddgi::Scene a = ddgi::load_gltf(with), b = ddgi::load_gltf(without);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    ASSERT_EQ(a.meshes[m].triangles.size(), b.meshes[m].triangles.size());
    for (std::size_t t = 0; t < a.meshes[m].triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t p = a.meshes[m].triangles[t][i], q = b.meshes[m].triangles[t][i];
        ASSERT_EQ(a.meshes[m].positions[p], b.meshes[m].positions[q]);
        ASSERT_EQ(a.meshes[m].normals[p], b.meshes[m].normals[q]);
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::maps
