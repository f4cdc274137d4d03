// glTF files that reach for what is not theirs, or for more than they are worth.
#include "ddgi/gltf.h"
#include "dump/error.h"
#include "tools/dump_support.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace gicodec::ddgi {
namespace {

namespace fs = std::filesystem;

/// (0, 0, 0), (1, 0, 0), (0, 1, 0) as floats.
constexpr std::string_view kTriangle = std::string_view(
    "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0", 36);

class GltfHostile : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_.path("scene/below"));
    write("scene/a.bin", kTriangle);
    write("scene/below/b.bin", kTriangle);
    write("secret.bin", kTriangle);
  }
  void write(const std::string& name, std::string_view content) const {
    tools::write_bytes(folder_.path(name), std::as_bytes(std::span(content)));
  }
  /// A file with triangles from the buffer `uri`; more members for the file, its mesh's primitives.
  std::string file(const std::string& uri, const std::string& members = "",
                   const std::string& primitives = R"({"attributes":{"POSITION":0}})",
                   std::size_t vertices = 3) const {
    write(
        "scene/a.gltf",
        fmt::format(
            R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"{}"}}],)"
            R"("bufferViews":[{{"buffer":0,"byteLength":{}}}],)"
            R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}}],)"
            R"("meshes":[{{"primitives":[{}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]{}}})",
            12 * vertices, uri, 12 * vertices, vertices, primitives, members));
    return folder_.path("scene/a.gltf");
  }
  static void expect_refused(const std::string& path, const std::string& words) {
    try {
      (void)load_gltf(path);
      ADD_FAILURE() << "loaded, without " << words;
    } catch (const tools::Error& error) {
      EXPECT_EQ(error.code(), tools::Exit::bad_input);
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }

  tools::TemporaryDirectory folder_;
};

TEST_F(GltfHostile, FilesOfItsFolder) {
  for (const char* uri : {"a.bin", "below/b.bin", "below/../a.bin"})
    EXPECT_EQ(load_gltf(file(uri)).triangle_count(), 1U) << uri;
}

TEST_F(GltfHostile, FilesOutsideOfItsFolder) {
  fs::create_symlink("../secret.bin", folder_.path("scene/link.bin"));
  fs::create_directory_symlink("..", folder_.path("scene/up"));
  for (const char* uri : {"../secret.bin", "below/../../secret.bin", "%2e%2e/secret.bin",
                          "link.bin", "up/secret.bin"}) {
    expect_refused(file(uri), "lies outside of its folder; --allow-outside");
    EXPECT_EQ(load_gltf(file(uri), true).triangle_count(), 1U) << uri;
  }
  // Whole paths lead nowhere: a glTF file's names are relative to it.
  for (const std::string& uri : {folder_.path("secret.bin"), "file://" + folder_.path("secret.bin"),
                                 folder_.path("scene/a.bin")})
    expect_refused(file(uri), "is no readable glTF");
  // Nor does the folder where the user happens to stand.
  const auto before = fs::current_path();
  fs::current_path(folder_.path(""));
  expect_refused(file("secret.bin"), "is no readable glTF");
  fs::current_path(before);
  // Images as well.
  write("x.png", "\x89PNG");
  expect_refused(file("a.bin", R"(,"images":[{"uri":"../x.png"}])"), "lies outside of its folder");
}

TEST_F(GltfHostile, ImagesAreWhatTheyAreCalled) {
  using namespace std::string_literals;
  const std::string jpeg = "\xff\xd8\xff\xe0\0\2\xff\xc0\0\x0b\x08\0\1\0\1\1\1\x11\0\xff\xd9"s;
  const auto named = [&](const std::string& name, const std::string& content) {
    write("scene/" + name, content);
    return file("a.bin", fmt::format(R"(,"images":[{{"uri":"{}"}}])", name));
  };
  expect_refused(named("a.png", jpeg), "image 0 is called a PNG and is a JPEG");
  // Kinds that the decoder knows and glTF does not, under any name.
  for (const std::string& content :
       {"BM"s + std::string(60, '\1'), "GIF89a\1\0\1\0\0\0\0"s, "8BPS\0\1"s + std::string(60, '\1'),
        "P6 1 1 255 abc"s, "#?RADIANCE\n"s, "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0abc"s,
        "\x89P"s + std::string(60, '\1'), "\x89PNG\r\n\x1a"s}) {
    for (const char* name : {"a.png", "a.jpg", "a.tga", "a"})
      expect_refused(named(name, content), "image 0 is no PNG or JPEG");
  }
}

TEST_F(GltfHostile, ImagesThatClaimMuch) {
  // 65536 x 65536 and 4096 x 4096 texels in a header alone.
  using namespace std::string_literals;
  std::string png =
      "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\1\0\0\0\1\0\0\x08\2\0\0\0"s + std::string(40, '\0');
  write("scene/a.png", png);
  expect_refused(file("a.bin", R"(,"images":[{"uri":"a.png"}])"), "image 0 has more than");
  png.replace(16, 8, "\0\0\x10\0\0\0\x10\0"s);
  write("scene/a.png", png);
  expect_refused(file("a.bin", R"(,"images":[{"uri":"a.png"}])"), "image 0 claims 16777216 texels");
  // One texel in a chunk of 1.9 GB.
  png.replace(16, 8, "\0\0\0\1\0\0\0\1"s);
  png.replace(33, 8, "\x70\0\0\x0dIDAT"s);
  write("scene/a.png", png);
  expect_refused(file("a.bin", R"(,"images":[{"uri":"a.png"}])"),
                 "image 0 is a PNG that is cut off");
}

TEST_F(GltfHostile, TheSameBytesAgainAndAgain) {
  constexpr std::size_t kVertices = 90'000, kUses = 300;
  write("scene/great.bin", std::string(12 * kVertices, '\0'));
  std::string primitives;
  for (std::size_t i = 0; i < kUses; ++i)
    primitives += (i > 0 ? "," : "") + std::string(R"({"attributes":{"POSITION":0}})");
  expect_refused(file("great.bin", "", primitives, kVertices), "use the same bytes too often");
}

TEST_F(GltfHostile, DepthWithoutEnd) {
  constexpr std::size_t kDeep = 200'000;
  expect_refused(file("a.bin", R"(,"extras":)" + std::string(kDeep, '[') + std::string(kDeep, ']')),
                 "nests more than 64 deep");
}

}  // namespace
}  // namespace gicodec::ddgi
