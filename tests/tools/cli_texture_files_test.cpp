// DDS, KTX2 and raw dumps, and textures that are none of probes, through every command; flags of
// engines' layouts.
#include "dump/block_place.h"
#include "dump/texture_file.h"
#include "tools/cli_support.h"

#include <gicodec/engines.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>
#include <sys/stat.h>
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
  const Outcome encoded = program_.succeed(
      {"encode", "-o", "x.gic", "--grid", "4x3x2", "--tiling", "slices_xz_y", "in"});
  EXPECT_EQ(encoded.err.find("--layout"), std::string::npos) << encoded.err;
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

// What an EXR alone has goes, text stays, also where it is another in a later frame.
TEST_F(CliTextureFiles, OtherKindsOfFilesKeepText) {
  Dump dump = random_dump(kVisDesc, 1);
  set_attribute(dump.info.attributes, {"compression", "compression", "0x00"});
  set_attribute(dump.info.attributes, {"place", "v3f", "1 2.5 3"});
  set_attribute(dump.info.attributes, {"note", "string", "first"});
  write_dump(program_.path("in/vis.0000.exr"), dump.info, dump.texels);
  set_attribute(dump.info.attributes, {"note", "string", "0xfe"});
  write_dump(program_.path("in/vis.0001.exr"), dump.info, dump.texels);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  for (const std::string ending : {"ktx2", "raw"}) {
    expect_part(program_.succeed({"decode", "x.gic", "-o", ending, "--files", ending}).err,
                "texture vis: " + ending + " files do not have its attributes compression, note");
    const auto at = [&](unsigned frame) {
      return read_dump(program_.path(fmt::format("{0}/vis.{1:04}.{0}", ending, frame)))
          .info.attributes;
    };
    EXPECT_EQ(find_attribute(at(0), "note")->value, "first");
    EXPECT_EQ(find_attribute(at(1), "note"), nullptr);
    EXPECT_EQ(find_attribute(at(1), "place")->value, "1 2.5 3");
    EXPECT_EQ(find_attribute(at(1), "compression"), nullptr);
  }
  program_.succeed({"decode", "x.gic", "-o", "out", "--files", "exr"});
  EXPECT_EQ(file_bytes(program_.path("out/vis.0001.exr")),
            file_bytes(program_.path("in/vis.0001.exr")));
  // A key that EXR files cannot have.
  dump.info.attributes = make_info(kVisDesc).attributes;
  set_attribute(dump.info.attributes, {"name", "string", "x"});
  set_attribute(dump.info.attributes, {"bits", "bytes", "0xfe"});
  std::filesystem::create_directories(program_.path("keys"));
  write_dump(program_.path("keys/vis.0000.ktx2"), dump.info, dump.texels);
  program_.succeed({"encode", "-o", "y.gic", "keys"});
  expect_part(program_.succeed({"decode", "y.gic", "-o", "keyless", "--files", "exr"}).err,
              "texture vis: exr files do not have its attributes bits");
  program_.succeed({"compare", "keys", "keyless"});
}

TEST_F(CliTextureFiles, LayoutsThatDoNotFit) {
  const auto volume = rtxgi_volume({3, 2, 2});
  for (const NamedTexture& texture : volume->groups.front().textures) {
    write(texture.name, "dds", texture.desc, {}, 1);
  }
  const std::string first = volume->groups.front().textures.front().name;
  const auto expect = [&](Exit exit, std::vector<std::string> flags,
                          const std::vector<std::string>& parts) {
    flags.insert(flags.begin(), {"encode", "-o", "x.gic"});
    flags.emplace_back("in");
    program_.expect_failure(exit, flags, parts);
  };
  expect(Exit::usage, {"--layout", "rtx"}, {"--layout does not take \"rtx\"", "rtxgi"});
  expect(Exit::usage, {"--layout", "rtxgi"}, {"needs --grid with its probes"});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "a=3x2x2"}, {"no texture is called \"a\""});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", first + "=3x2x2"},
         {"leave out " + first + "="});
  for (const char* bad : {"3x2", "0x2x2", "3x2x2 ", "3x2,2"}) {
    expect(Exit::usage, {"--layout", "rtxgi", "--grid", bad},
           {fmt::format("--grid does not take \"{}\"", bad), "probes"});
  }
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "3x2x2", "--grid", "3x2x2"},
         {"takes one --grid"});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "99999999x2x2"}, {"65535", "16777216"});
  program_.expect_failure(
      Exit::io, {"encode", "-o", "x.gic", "--layout", "rtxgi", "--grid", "3x2x2", "absent.dds"},
      {"absent.dds: does not exist"});
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "3x2x2", "--core", "8"},
         {"leave out one of them"});
  expect(Exit::bad_input, {"--layout", "rtxgi", "--grid", "3x2x3"},
         {"texels do not match grid", "texels in 2 slices"});
  expect(Exit::bad_input, {"--layout", "rtxgi-float32", "--grid", "3x2x2"},
         {"is of format", "not R32"});
  expect(Exit::usage, {"--layout", "bevy", "--grid", "3x2x2"},
         {"--layout bevy has no texture", "name the files after these"});
  std::filesystem::remove(program_.path(fmt::format("in/{}.0000.dds", first)));
  expect(Exit::usage, {"--layout", "rtxgi", "--grid", "3x2x2"}, {"there are no files of " + first});
}

// ProbeData, one record a probe: what engines read of probes that are drawn by nobody.
TEST_F(CliTextureFiles, StatesOfProbesAreKept) {
  const std::vector<std::string> layout{"--layout", "rtxgi", "--grid", "3x2x2"};
  const auto volume = rtxgi_volume({3, 2, 2});
  for (const NamedTexture& texture : volume->groups.front().textures) {
    write(texture.name, "dds", texture.desc, {});
  }
  expect_part(program_.succeed({"encode", "-o", "w.gic", "in"}).err,
              "named as the textures of --layout rtxgi are");
  const auto command = [&](std::vector<std::string> words) {
    words.insert(words.end(), layout.begin(), layout.end());
    return words;
  };
  write_bytes(program_.path("inactive.txt"), std::as_bytes(std::span(std::string_view("0-2"))));
  const Outcome encoded =
      program_.succeed(command({"encode", "-o", "x.gic", "--inactive", "inactive.txt", "in"}));
  expect_part(encoded.err, "3 inactive probes are not stored");
  expect_part(encoded.err, "whole, as states of probes, ProbeData");
  const std::string verified = program_.succeed({"verify", "x.gic", "in"}).out;
  expect_part(verified, "texture ProbeIrradiance: 3 inactive probes");
  EXPECT_EQ(verified.find("texture ProbeData: 3"), std::string::npos) << verified;
  program_.succeed({"decode", "x.gic", "-o", "out"});
  const auto same = [&](const char* name) {
    return file_bytes(program_.path(fmt::format("in/{}", name))) ==
           file_bytes(program_.path(fmt::format("out/{}", name)));
  };
  EXPECT_TRUE(same("ProbeData.0001.dds"));
  EXPECT_FALSE(same("ProbeIrradiance.0001.dds"));

  const Outcome lossy =
      program_.succeed(command({"encode", "-o", "y.gic", "--max-error", "3", "in"}));
  expect_part(lossy.err, "ProbeData stays exact; --max-error ProbeData=3");
  std::filesystem::remove_all(program_.path("out"));
  program_.succeed({"decode", "y.gic", "-o", "out"});
  EXPECT_TRUE(same("ProbeData.0001.dds"));
  program_.succeed({"verify", "--max-error", "3", "y.gic", "in"});
  program_.succeed({"verify", "--max-error", "3", "y.gic", "out"});
  const Outcome named = program_.succeed(
      command({"encode", "-o", "z.gic", "--max-error", "3", "--max-error", "ProbeData=3", "in"}));
  EXPECT_EQ(named.err.find("stays exact"), std::string::npos) << named.err;
  EXPECT_EQ(program_.run({"verify", "--max-error", "3", "z.gic", "in"}).exit, 1);
  program_.succeed({"verify", "--max-error", "3", "--max-error", "ProbeData=3", "z.gic", "in"});
}

TEST_F(CliTextureFiles, MaxErrorIsForLight) {
  const auto volume = unity_apv_volume(2);
  for (const NamedTexture* texture : textures_of(*volume)) {
    write(texture->name, "ktx2", texture->desc, {}, 1);
  }
  const Outcome encoded = program_.succeed({"encode", "-o", "x.gic", "--layout", "unity-apv",
                                            "--grid", "2x1x1", "--max-error", "2", "in"});
  expect_part(encoded.err, "Validity, SkyOcclusionL0L1 stay exact; --max-error Validity=2");
  const auto json = nlohmann::json::parse(
      program_.succeed({"verify", "x.gic", "in", "--max-error", "2", "--format", "json"}).out);
  for (const auto& texture : json["textures"]) {
    const bool light = std::string(texture["name"]).starts_with('L');
    EXPECT_EQ(texture["max_error"], light ? 2 : 0) << texture["name"];
  }
  expect_part(program_.succeed({"info", "x.gic"}).out, "LOSSY");
}

// A texture that is all there is is meant.
TEST_F(CliTextureFiles, MaxErrorOfIntegersAlone) {
  write("a", "ktx2", map_texture(Format::R16_UINT, {9, 9, 1}, {8, 8, 1}), {});
  const Outcome encoded = program_.succeed({"encode", "-o", "x.gic", "--max-error", "2", "in"});
  expect_part(encoded.err, "LOSSY");
  program_.succeed({"verify", "--max-error", "2", "x.gic", "in"});
}

TEST_F(CliTextureFiles, ChannelsAreThoseOfImages) {
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {9, 9, 1}, {8, 8, 1});
  for (const char* ending : kEndings) {
    write(ending, ending, desc, {}, 1);
    program_.expect_failure(Exit::usage,
                            {"preview", fmt::format("in/{}.0000.{}", ending, ending), "-o", "a.png",
                             "--channels", "R=G,G=R,B=B"},
                            {"--channels R=G,G=R,B=B", "has no channels", "leave it out"});
  }
}

#ifndef _WIN32  // has no pipes in folders
TEST_F(CliTextureFiles, PipesAreRefused) {
  for (const char* ending : {"dds", "ktx2", "raw", "exr"}) {
    const std::string name = fmt::format("u.0000.{}", ending);
    ASSERT_EQ(mkfifo(program_.path(name).c_str(), 0600), 0);
    program_.expect_failure(Exit::io, {"encode", "-o", "x.gic", name},
                            {name, "is no regular file"});
  }
}
#endif

TEST_F(CliTextureFiles, FoldersOfDifferentKinds) {
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {9, 9, 1}, {8, 8, 1});
  write("t", "dds", desc, {}, 3);
  std::filesystem::rename(program_.path("in"), program_.path("dds"));
  std::filesystem::create_directories(program_.path("in"));
  write("t", "raw", desc, {}, 2);
  const Outcome compared = program_.run({"compare", "dds", "in"});
  EXPECT_EQ(compared.exit, 1);
  expect_part(compared.out, "dds/t.0001.dds and in/t.0001.raw are identical: 4 blocks, 81 texels");
  expect_part(compared.out, "in/t.0002.dds does not exist");
  std::filesystem::remove(program_.path("dds/t.0002.dds"));
  program_.succeed({"compare", "in", "dds"});
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
  program_.succeed({"encode", "-o", "z.gic", "bare"});
  expect_part(program_.succeed({"info", "z.gic"}).out, "blocks of 8x8");
  program_.succeed({"encode", "-o", "y.gic", "--extent", "9x6x7", "--block", "t=8x8x2", "bare"});
  expect_part(program_.succeed({"info", "y.gic"}).out, "blocks of 8x6x2");
  program_.succeed({"verify", "y.gic", "bare"});
}

}  // namespace
}  // namespace gicodec::tools
