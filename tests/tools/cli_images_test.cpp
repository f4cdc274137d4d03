// Files of several images through the command line: they come back, one texture an image.
#include "dump/dump.h"
#include "dump/texture_file.h"
#include "tools/cli_support.h"
#include "tools/dump_support.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

/// All levels and faces of a texture.
std::vector<Dump> images_of(Format format, const Grid& size, bool volume, std::uint32_t levels,
                            std::uint32_t faces) {
  TextureHead head;
  head.texels = size;
  head.volume = volume;
  head.levels = levels;
  head.faces = faces;
  return random_images(format, head);
}

class CliImages : public testing::Test {
 protected:
  CliImages() { std::filesystem::create_directories(program_.path("in")); }

  void write(const std::string& name, std::span<const Dump> images) {
    write_dumps(program_.path("in/" + name), images);
  }
  void expect_all_back() {
    for (const std::string& name : program_.files("in")) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)))
          << name;
    }
  }
  void expect_part(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "lacks " << part;
  }

  Program program_;
};

TEST_F(CliImages, WhatNoDumpIsAndOtherKindsLackIsNamed) {
  Dump raw = random_dump(map_texture(Format::R16_SFLOAT, {8, 8, 1}, {8, 8, 1}), 1);
  write("a.0000.raw", {&raw, 1});
  for (const char* name : {"in/a.json", "in/scene.json"}) {
    write_bytes(program_.path(name), std::as_bytes(std::span("{}")));
  }
  const auto packed = program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_part(packed.err, "leaves out a.json, scene.json, which are no dumps");
  // A shell names sidecars too.
  program_.succeed({"encode", "-o", "x.gic", "in/a.0000.raw", "in/a.0000.json"});

  Dump rgb = random_dump(map_texture(Format::R16G16B16A16_SFLOAT, {8, 8, 1}, {8, 8, 1}), 2);
  rgb = without_alpha(rgb);
  rgb.info.attributes = {{"exr:origin", "v2i", "-7 100"}};
  write("rgb.exr", {&rgb, 1});
  program_.succeed({"encode", "-o", "y.gic", "in/rgb.exr"});
  const auto files = program_.succeed({"decode", "y.gic", "-o", "out", "--files", "ktx2"});
  expect_part(files.err, "exr:origin");
  expect_part(files.err, "an alpha of 0");
  const auto compared = program_.succeed({"compare", "in/rgb.exr", "out/rgb.ktx2"});
  expect_part(compared.out, "their attributes and channels are not compared");
}

TEST_F(CliImages, AsManyTexturesAsAContainerHolds) {
  const Dump dump = random_dump(map_texture(Format::R16_SFLOAT, {2, 2, 1}, {8, 8, 1}), 1);
  for (int i = 0; i < 256; ++i) write(fmt::format("a{}b.exr", i), {&dump, 1});
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"verify", "x.gic", "in"});
}

TEST_F(CliImages, CroppedLayersArePackedAsLayers) {
  Dump layer = random_dump(map_texture(Format::R32G32B32_SFLOAT, {16, 16, 1}, {8, 8, 1}), 1);
  layer.info.attributes.clear();
  const char* letter = "RGB";
  for (std::size_t i = 0; i < 3; ++i) {
    layer.info.channels.names[i] = fmt::format("Lightmap.{}", letter[i]);
  }
  write("a.exr", {&layer, 1});
  program_.succeed({"crop", "--origin", "1,0,0", "--size", "1x1x1", "-o", "small", "in"});
  program_.succeed({"encode", "-o", "x.gic", "small"});
  program_.succeed({"verify", "x.gic", "small"});
}

TEST_F(CliImages, LevelsAndFacesComeBack) {
  auto packed = images_of(Format::R16G16B16A16_SFLOAT, {16, 16, 1}, false, 5, 6);
  set_attribute(packed[0].info.attributes, {kKtx2Scheme, "string", "Zstandard"});
  write("packed.ktx2", packed);
  set_attribute(packed[0].info.attributes, {kKtx2Scheme, "string", "ZLIB"});
  write("zlib.ktx2", packed);
  for (const char* ending : {"ktx2", "dds"}) {
    const auto name = [&](const char* stem) { return fmt::format("{}.{}", stem, ending); };
    write(name("mips"), images_of(Format::R8G8B8A8_SRGB, {20, 7, 1}, false, 5, 1));
    write(name("array"), images_of(Format::R16_SFLOAT, {8, 8, 3}, false, 2, 1));
    write(name("cubes"), images_of(Format::BC1_RGBA_UNORM_BLOCK, {16, 16, 2}, false, 3, 6));
    write(name("deep"), images_of(Format::R8_UNORM, {8, 4, 6}, true, 4, 1));
  }
  std::vector<std::string> command = {"encode", "-o", "x.gic"};
  for (const char* file : {"packed.ktx2", "zlib.ktx2", "mips.ktx2", "array.ktx2", "deep.ktx2"}) {
    command.push_back(fmt::format("in/{}", file));
  }
  program_.succeed(command);
  program_.succeed(
      {"encode", "-o", "y.gic", "in/cubes.ktx2", "in/mips.dds", "in/array.dds", "in/deep.dds"});
  program_.succeed({"encode", "-o", "z.gic", "in/cubes.dds"});
  for (const char* container : {"x.gic", "y.gic", "z.gic"}) {
    program_.succeed({"decode", container, "-o", "out"});
  }
  expect_all_back();
  expect_part(program_
                  .succeed({"verify", "x.gic", "in/packed.ktx2", "in/zlib.ktx2", "in/mips.ktx2",
                            "in/array.ktx2", "in/deep.ktx2"})
                  .out,
              "5 of 5 files in 1 frame are bit-exact");
  const std::string info = program_.succeed({"info", "x.gic"}).out;
  for (const char* texture : {"packed.px", "packed.nz.mip4", "mips.mip4", "deep.mip3"}) {
    expect_part(info, texture);
  }
  program_.succeed({"decode", "--plain", "x.gic", "-o", "plain"});
  constexpr std::size_t kScheme = 44;
  EXPECT_EQ(word_at(file_bytes(program_.path("in/packed.ktx2")), kScheme), 2U);
  EXPECT_EQ(word_at(file_bytes(program_.path("plain/packed.ktx2")), kScheme), 0U);
  program_.succeed({"compare", "--texels-only", "in/packed.ktx2", "plain/packed.ktx2"});
}

TEST_F(CliImages, SequencesOfThem) {
  for (int frame = 0; frame < 3; ++frame) {
    auto images = images_of(Format::R16G16B16A16_SFLOAT, {8, 8, 1}, false, 2, 6);
    images[3].texels[0] = static_cast<std::byte>(frame);
    set_attribute(images[0].info.attributes, time_attribute(frame));
    write(fmt::format("sky.{:04}.ktx2", frame), images);
  }
  program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_part(program_.succeed({"verify", "x.gic", "in"}).out,
              "3 of 3 files in 3 frames are bit-exact");
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  // Another image of one frame: that file differs, and it alone.
  auto images = read_dumps(program_.path("in/sky.0001.ktx2"));
  images[7].texels[5] ^= std::byte{1};
  write_dumps(program_.path("in/sky.0001.ktx2"), images, Existing::replace);
  const auto outcome = program_.run({"verify", "x.gic", "in"});
  EXPECT_EQ(outcome.exit, static_cast<int>(Exit::different));
  expect_part(outcome.out, "2 of 3 files in 3 frames are bit-exact: NOT VERIFIED");
  // A frame with other images.
  write_dumps(program_.path("in/sky.0002.ktx2"),
              images_of(Format::R16G16B16A16_SFLOAT, {8, 8, 1}, false, 1, 6), Existing::replace);
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "y.gic", "in"},
                          {"sky.0002.ktx2: has 6 images, and ", "sky.0000.ktx2 has 12"});
}

TEST_F(CliImages, LayersComeBack) {
  const TextureDesc color = map_texture(Format::R16G16B16A16_SFLOAT, {9, 7, 1}, {8, 8, 1}),
                    depth = map_texture(Format::R32_SFLOAT, {9, 7, 1}, {8, 8, 1});
  std::vector<Dump> images = {{make_info(color), random_texels(color, 1)},
                              {make_info(depth), random_texels(depth, 2)}};
  images[0].info.attributes = {{"note", "string", "kept"}};
  images[1].info.attributes.clear();
  images[1].info.channels.names[0] = "depth.Z";
  images[1].info.head = false;
  write("a.exr", images);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"verify", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  expect_part(program_.succeed({"compare", "in/a.exr", "out/a.exr"}).out,
              "depth.Z of in/a.exr and out/a.exr are identical");
  program_.succeed({"decode", "x.gic", "--overwrite", "-o", "in"});
  // A box of both, and what it lacks.
  program_.succeed({"crop", "--origin", "0,0,0", "--size", "1x1x1", "-o", "small", "in"});
  const std::string box = program_.path("small/a.exr");
  EXPECT_EQ(read_dumps(box, settle_formats({&box, 1}, {})).size(), 2U);
  // Channels that a flag leaves out are named before anything is written, and keep the original.
  const std::vector<std::string> left = {"encode",          "-o", "y.gic", "--channels",
                                         "R=R,G=G,B=B,A=A", "in"};
  expect_part(program_.succeed(left).err, "in/a.exr: channel depth.Z not kept");
  expect_part(program_.succeed({"verify", "y.gic", "in"}).out,
              "channel depth.Z of the files not kept");
  program_.expect_failure(Exit::io, {"decode", "y.gic", "--overwrite", "-o", "in"},
                          {"may be the original", "channel depth.Z"});
}

TEST_F(CliImages, DdsFilesOfNvidiaTextureTools) {
  if (std::system("command -v nvcompress nvassemble >/dev/null") != 0) {
    GTEST_SKIP() << "nvcompress is missing; script/bootstrap ci installs it";
  }
  const std::string folder = program_.path("in"), picture = program_.path("a.png");
  const Dump colour = random_dump(kColourDesc, 1);
  write_dump(program_.path("a.exr"), colour.info, colour.texels);
  program_.succeed({"preview", "a.exr", "-o", "a.png"});
  const auto run = [](const std::string& command) {
    ASSERT_EQ(std::system((command + " >/dev/null 2>&1").c_str()), 0) << command;
  };
  for (const char* format : {"rgb", "bc1", "bc1a", "bc2", "bc3", "bc3n", "bc4", "bc5"}) {
    for (const char* levels : {"", "-nomips"}) {
      run(fmt::format("nvcompress -nocuda -fast {} -{} '{}' '{}/{}{}.dds'", levels, format, picture,
                      folder, format, levels));
    }
  }
  const std::string faces = fmt::format("'{0}' '{0}' '{0}' '{0}' '{0}' '{0}'", picture);
  run(fmt::format("nvassemble -cube {} -o '{}/cube.dds'", faces, folder));
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  EXPECT_EQ(program_.files("in").size(), 17U);
}

TEST_F(CliImages, InfoSaysWhatAFileHolds) {
  write("sky box.ktx2", images_of(Format::R16_SFLOAT, {8, 8, 1}, false, 2, 6));
  const std::string text = program_.succeed({"info", "in/sky box.ktx2"}).out;
  for (const char* part : {"12 images", "px: R16_SFLOAT, 8x8", "nz.mip1: R16_SFLOAT, 4x4",
                           "to pack it: gicodec encode -o 'sky box.gic' 'in/sky box.ktx2'"}) {
    expect_part(text, part);
  }
  expect_part(program_.succeed({"info", "--format", "json", "in/sky box.ktx2"}).out,
              "\"name\": \"nz.mip1\"");
}

/// Long values are cut, and how long they are is said.
TEST_F(CliImages, InfoShowsAttributes) {
  const TextureDesc desc = map_texture(Format::R16_SFLOAT, {8, 8, 1}, {8, 8, 1});
  Dump dump{make_info(desc), random_texels(desc, 1)};
  set_attribute(dump.info.attributes, {"short", "string", std::string(60, 's')});
  set_attribute(dump.info.attributes, {"long", "string", std::string(61, 'l')});
  set_attribute(dump.info.attributes, {"other", "mine", "0x" + std::string(100, 'a')});
  set_attribute(dump.info.attributes, {"compression", "compression", "0x00"});
  write("x.exr", {&dump, 1});
  const std::string text = program_.succeed({"info", "in/x.exr"}).out;
  expect_part(text, "short: " + std::string(60, 's') + "\n");
  expect_part(text, "long: " + std::string(60, 'l') + "... (61 bytes)\n");
  expect_part(text, "other: 0x" + std::string(58, 'a') + "... (50 bytes)\n");
  expect_part(text, "compression: none\n");
}

/// A still is of the first frame, whatever its number.
TEST_F(CliImages, StillsBesideLaterFramesAreVerified) {
  const TextureDesc desc = map_texture(Format::R16_SFLOAT, {8, 8, 1}, {8, 8, 1});
  for (const char* name : {"a.0005.exr", "a.0006.exr", "sky.exr"}) {
    const Dump dump{make_info(desc), random_texels(desc, static_cast<std::uint32_t>(name[3]))};
    write(name, {&dump, 1});
  }
  program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_part(program_.succeed({"verify", "x.gic", "in"}).out, "3 of 3 files");
  expect_part(program_.run({"verify", "x.gic", "in/sky.exr"}).out, "1 of ");
}

TEST_F(CliImages, FlagsNameTexturesOfBothSidesOfAComparison) {
  for (const char* name : {"l.raw", "r.raw"})
    write_bytes(program_.path(name), std::vector<std::byte>(32));
  program_.succeed({"compare", "l.raw", "r.raw", "--vk-format", "l=R8G8_UNORM", "--vk-format",
                    "r=R8G8_UNORM", "--extent", "4x4"});
  EXPECT_EQ(program_
                .run({"compare", "l.raw", "r.raw", "--vk-format", "R8G8_UNORM", "--extent", "4x4",
                      "--block", "none=4x4x1"})
                .exit,
            2);
}

TEST_F(CliImages, NegativeFramesAndStillsComeBack) {
  const TextureDesc desc = map_texture(Format::R16_SFLOAT, {5, 3, 1}, {8, 8, 1});
  std::uint32_t seed = 0;
  for (const char* name : {"foo.-002.exr", "foo.-001.exr", "foo.000.exr", "foo.001.exr", "sky.exr",
                           "bar.-002.exr", "bar.-001.exr", "bar.0000.exr", "bar.0001.exr",
                           "irr_1001.exr", "irr_1002.exr", "irr_1011.exr", "b_1.exr", "b_2.exr"}) {
    const Dump dump{make_info(desc), random_texels(desc, ++seed)};
    write(name, {&dump, 1});
  }
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "x.gic", "in"},
                          {"--allow-gaps", "--stills"});  // b has frames 1 and 2, foo others.
  const auto outcome = program_.succeed({"encode", "-o", "x.gic", "--allow-gaps", "in"});
  expect_part(outcome.err, "b_1.exr and 1 more: their numbers are taken for those of frames");
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  expect_part(program_.succeed({"verify", "x.gic", "in"}).out, "14 of 14 files");
  expect_part(program_.run({"verify", "x.gic", "in/foo.001.exr"}).out, "1 of ");
  program_.succeed({"encode", "-o", "y.gic", "--stills", "in"});
  expect_part(program_.succeed({"verify", "y.gic", "in"}).out, "14 of 14 files in 1 frame");
  program_.succeed({"encode", "-o", "z.gic", "--stills", "--frames-from", "foo.#", "in"});
  expect_part(program_.succeed({"verify", "z.gic", "in"}).out, "14 of 14 files in 4 frames");
}

TEST_F(CliImages, RawFilesWithoutASidecar) {
  write_bytes(program_.path("in/a.raw"), std::vector<std::byte>(8 * 4 * 2 * 4));
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "x.gic", "in/a.raw"},
                          {"has no sidecar", "--vk-format and --extent do without one"});
  program_.succeed(
      {"encode", "-o", "x.gic", "--vk-format", "R8G8B8A8_SRGB", "--extent", "8x4x2", "in/a.raw"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  EXPECT_EQ(program_.files("out"), std::vector<std::string>{"a.raw"});
}

TEST_F(CliImages, TexturesTooLargeForAContainer) {
  const Dump small = images_of(Format::R16G16B16A16_SFLOAT, {8, 8, 1}, false, 1, 1)[0];
  write("a.dds", {&small, 1});
  auto bytes = file_bytes(program_.path("in/a.dds"));
  set_word(bytes, 12, 16384);
  set_word(bytes, 16, 16384);
  write_bytes(program_.path("in/a.dds"), bytes);
  std::filesystem::resize_file(program_.path("in/a.dds"), 148 + (std::uint64_t{2} << 30));
  program_.expect_failure(
      Exit::bad_input, {"encode", "-o", "x.gic", "in/a.dds"},
      {"in/a.dds: 16384x16384x1 records of R16G16B16A16_SFLOAT take 2147483648", "gicodec crop"});
}

}  // namespace
}  // namespace gicodec::tools
