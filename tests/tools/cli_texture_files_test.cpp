// DDS, KTX2 and raw dumps, and textures that are none of probes, through every command; flags of
// engines' layouts.
#include "dump/block_place.h"
#include "dump/texture_file.h"
#include "tools/cli_support.h"

#include <gicodec/engines.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>

namespace gicodec::tools {
namespace {

constexpr std::array<const char*, 3> kEndings = {"dds", "ktx2", "raw"};

/// Random, but zero where no block is.
std::vector<std::byte> texels_of_blocks(const TextureDesc& desc, std::uint32_t seed) {
  const auto random = random_texels(desc, seed);
  std::vector<std::byte> texels(random.size());
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockPlace place = block_place(desc, extent(desc), block);
    copy_block(place, random, place, texels);
  }
  return texels;
}

class CliTextureFiles : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(program_.path("in")); }

  /// Frames in which some texels change.
  void write(const std::string& name, const char* ending, const TextureDesc& desc,
             const Attributes& attributes, unsigned frames = 2) {
    DumpInfo info = make_info(desc);
    info.attributes = attributes;
    auto texels = texels_of_blocks(desc, 7);
    for (unsigned frame = 0; frame < frames; ++frame) {
      const BlockPlace place = block_place(desc, extent(desc), frame % block_count(desc));
      texels[place.offset] ^= std::byte{0x5A};
      write_dump(program_.path(fmt::format("in/{}.{:04}.{}", name, frame, ending)), info, texels);
    }
  }
  void expect_all_back(const std::string& folder = "out") {
    const auto names = program_.files("in");
    EXPECT_EQ(program_.files(folder), names);
    for (const std::string& name : names) {
      EXPECT_EQ(file_bytes(program_.path(folder + "/" + name)),
                file_bytes(program_.path("in/" + name)))
          << name;
    }
  }
  void expect_part(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "lacks " << part;
  }

  Program program_;
};

TEST_F(CliTextureFiles, ComeBackByteForByte) {
  unsigned number = 0;
  for (const char* ending : kEndings) {
    for (const auto& [records, block] : {std::pair(Grid{21, 9, 1}, BlockShape{8, 8, 1}),
                                         {{9, 10, 3}, {8, 8, 1}},
                                         {{9, 6, 7}, {4, 4, 4}}}) {
      write(fmt::format("t{}", number++), ending,
            map_texture(Format::R16G16B16A16_SFLOAT, records, block),
            std::string_view(ending) == "dds" ? Attributes{}
                                              : Attributes{{"key", "string", "value"}});
    }
  }
  // Of a raw file only the sidecar says that its slices are an array.
  for (unsigned frame = 0; frame < 2; ++frame) {
    const std::string path = program_.path(fmt::format("in/t7.{:04}.json", frame));
    const auto bytes = file_bytes(path);
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    text.insert(text.find("\"attributes\""), "\"block\": [8, 8, 1],\n  ");
    write_bytes(path, std::as_bytes(std::span(text)));
    const Dump dump = read_dump(program_.path(fmt::format("in/t7.{:04}.raw", frame)));
    write_dump(program_.path(fmt::format("in/t7.{:04}.raw", frame)), dump.info, dump.texels,
               Existing::replace);
  }
  std::filesystem::rename(program_.path("in/t8.0000.json"), program_.path("in/t8.json"));
  std::filesystem::remove(program_.path("in/t8.0001.json"));
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const Outcome info = program_.succeed({"info", "x.gic"});
  expect_part(info.out, "textures, grid 3x2x1");
  expect_part(info.out, "files t8.0000.raw");
  expect_part(program_.succeed({"verify", "x.gic", "in"}).out, "18 of 18 files");
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  program_.succeed({"compare", "in", "out"});
  // With other bits, or another key.
  Dump dump = read_dump(program_.path("out/t5.0001.ktx2"));
  dump.texels[100] ^= std::byte{1};
  write_dump(program_.path("out/t5.0001.ktx2"), dump.info, dump.texels, Existing::replace);
  expect_part(program_.run({"verify", "x.gic", "out"}).out, "17 of 18 files");
  const Outcome compared = program_.run({"compare", "in/t5.0001.ktx2", "out/t5.0001.ktx2"});
  EXPECT_EQ(compared.exit, 1);
  expect_part(compared.out, "texel (3, 1), block 0 (0, 0, 0), channel B");
  dump.texels[100] ^= std::byte{1};
  set_attribute(dump.info.attributes, {"key", "string", "other"});
  write_dump(program_.path("out/t5.0001.ktx2"), dump.info, dump.texels, Existing::replace);
  expect_part(program_.run({"verify", "x.gic", "out"}).out, "key");
}

TEST_F(CliTextureFiles, ProbesByFlags) {
  const TextureDesc irradiance =
      probe_texture(Format::A2B10G10R10_UNORM_PACK32, {4, 3, 2}, 6, 1, Tiling::slices_xz_y);
  const TextureDesc distance =
      probe_texture(Format::R16G16_SFLOAT, {4, 3, 2}, 14, 1, Tiling::slices_xz_y);
  write("irradiance", "dds", irradiance, {});
  write("distance", "dds", distance, {});
  program_.succeed({"encode", "-o", "x.gic", "--grid", "4x3x2", "--tiling", "slices_xz_y", "in"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(json["volumes"].size(), 1U);
  EXPECT_EQ(json["volumes"][0]["kind"], "probes");
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  program_.succeed({"verify", "x.gic", "in"});
  program_.succeed({"preview", "x.gic", "-o", "a.png"});
  program_.succeed({"preview", "in/irradiance.0000.dds", "-o", "b.png"});
}

TEST_F(CliTextureFiles, LayoutsThatDoNotFit) {
  const auto volume = rtxgi_volume({3, 2, 2});
  for (const NamedTexture& texture : volume->sets.front().textures) {
    write(texture.name, "dds", texture.desc, {}, 1);
  }
  const std::string first = volume->sets.front().textures.front().name;
  const auto expect = [&](Exit exit, std::vector<std::string> flags,
                          const std::vector<std::string>& parts) {
    flags.insert(flags.begin(), {"encode", "-o", "x.gic"});
    flags.emplace_back("in");
    program_.expect_failure(exit, flags, parts);
  };
  expect(Exit::usage, {"--layout", "rtx"}, {"--layout does not take \"rtx\"", "rtxgi"});
  expect(Exit::usage, {"--layout", "rtxgi"}, {"needs --grid with its probes"});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "a=3x2x2"}, {"no texture is called \"a\""});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", first + "=3x2x2"}, {"needs --grid"});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "3x2x2", "--core", "8"},
         {"leave out one of them"});
  expect(Exit::bad_input, {"--layout", "rtxgi", "--grid", "3x2x3"}, {"texels do not match grid"});
  expect(Exit::bad_input, {"--layout", "rtxgi-float32", "--grid", "3x2x2"},
         {"is of format", "not R32"});
  expect(Exit::usage, {"--layout", "bevy", "--grid", "3x2x2"},
         {"--layout bevy has no texture", "name the files after these"});
  std::filesystem::remove(program_.path(fmt::format("in/{}.0000.dds", first)));
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "3x2x2"}, {"there are no files of " + first});
}

TEST_F(CliTextureFiles, WhatIsInNoBlockIsNotLost) {
  const TextureDesc desc = brick_texture(Format::R8_UNORM, 5, {4, 4, 4}, {2, 2, 2});
  auto texels = texels_of_blocks(desc, 1);
  EXPECT_FALSE(record_in_no_block(desc, texels));
  const auto at = static_cast<std::size_t>(texture_bytes(desc)) - 3;
  texels[at] = std::byte{1};
  EXPECT_EQ(record_in_no_block(desc, texels), at);
}

TEST_F(CliTextureFiles, CropsBlocks) {
  write("t", "ktx2", map_texture(Format::R8G8B8A8_UNORM, {21, 9, 6}, {4, 4, 4}),
        make_info(map_texture(Format::R8G8B8A8_UNORM, {21, 9, 6}, {4, 4, 4})).attributes);
  write("d", "dds", map_texture(Format::R8G8B8A8_UNORM, {21, 9, 1}, {8, 8, 1}), {});
  program_.succeed(
      {"crop", "--origin", "2,1,0", "--size", "4x2x2", "-o", "small", "in/t.0000.ktx2"});
  const Dump whole = read_dump(program_.path("in/t.0000.ktx2")),
             part = read_dump(program_.path("small/t.0000.ktx2"));
  EXPECT_EQ(part.info.desc.records, (Grid{13, 5, 6}));
  for (std::size_t z = 0; z < 6; ++z) {
    for (std::size_t y = 0; y < 5; ++y) {
      for (std::size_t x = 0; x < 13 * 4; ++x) {
        ASSERT_EQ(part.texels[(z * 5 + y) * 13 * 4 + x],
                  whole.texels[((z * 9) + y + 4) * 21 * 4 + 8 * 4 + x]);
      }
    }
  }
  program_.succeed(
      {"crop", "--origin", "1,0,0", "--size", "1x1x1", "-o", "small", "in/d.0001.dds"});
  EXPECT_EQ(texels_of(read_dump(program_.path("small/d.0001.dds")).info.desc), (Grid{8, 8, 1}));
  program_.expect_failure(
      Exit::usage, {"crop", "--origin", "5,0,0", "--size", "2x1x1", "-o", "none", "in/t.0000.ktx2"},
      {"2x1x1 blocks from (5, 0, 0) on do not fit its grid 6x3x2"});
}

TEST_F(CliTextureFiles, SlicesOfExrFiles) {
  const TextureDesc desc = map_texture(Format::R32_SFLOAT, {9, 6, 7}, {4, 4, 4});
  write("t", "exr", desc, make_info(desc).attributes);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_part(program_.succeed({"info", "x.gic"}).out, "blocks of 4x4x4");
  program_.succeed({"verify", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_all_back();
  // Without attributes, by flags.
  std::filesystem::create_directories(program_.path("bare"));
  DumpInfo bare = make_info(desc);
  bare.attributes.clear();
  write_dump(program_.path("bare/t.0000.exr"), bare, random_texels(desc, 1));
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "y.gic", "bare"},
                          {"--grid", "--extent"});
  program_.succeed({"encode", "-o", "y.gic", "--extent", "9x6x7", "--block", "t=8x8x2", "bare"});
  expect_part(program_.succeed({"info", "y.gic"}).out, "blocks of 8x6x2");
  program_.succeed({"verify", "y.gic", "bare"});
}

}  // namespace
}  // namespace gicodec::tools
