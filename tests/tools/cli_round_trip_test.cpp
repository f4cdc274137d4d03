#include "tools/cli_support.h"

#include <gicodec/isa.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace gicodec::tools {
namespace {

class CliRoundTrip : public testing::TestWithParam<Arguments> {};

TEST_P(CliRoundTrip, FilesComeBackByteForByte) {
  const Program program;
  const Arguments dumps = program.make_dumps(5);
  program.succeed(Arguments{"encode", "-o", "x.gic", "--gop", "3"} + GetParam() + dumps);
  program.succeed({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(program.files("out"), program.files("in"));
  for (const std::string& name : program.files("in")) {
    EXPECT_EQ(file_bytes(program.path("out/" + name)), file_bytes(program.path("in/" + name)))
        << name;
  }
  const Outcome verified = program.succeed(Arguments{"verify", "x.gic"} + dumps);
  EXPECT_NE(verified.out.find("10 of 10 files in 5 frames are bit-exact"), std::string::npos);
  EXPECT_NE(program.succeed({"info", "x.gic"}).out.find("lossless"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, CliRoundTrip,
                         testing::Values(Arguments{}, Arguments{"--backend", "raw"},
                                         Arguments{"--backend", "lz4", "--level", "9"},
                                         Arguments{"--backend", "zstd", "--no-difference"},
                                         Arguments{"--backend", "native", "--preset", "strong"},
                                         Arguments{"--preset", "fast", "--threads", "3"},
                                         Arguments{"--threads", "1"}, Arguments{"--threads", "7"}));
#ifdef GICODEC_WITH_HEVC
INSTANTIATE_TEST_SUITE_P(Hevc, CliRoundTrip,
                         testing::Values(Arguments{"--backend", "hevc", "--preset", "ultrafast"},
                                         Arguments{"--backend", "hevc", "--hevc-packing", "planes"},
                                         Arguments{"--backend", "hevc", "--hevc-layout",
                                                   "packed"}));
#endif

TEST(Cli, OutputDoesNotDependOnThreads) {
  const Program program;
  const Arguments dumps = program.make_dumps(4);
  program.succeed(Arguments{"encode", "-o", "1.gic", "--threads", "1"} + dumps);
  program.succeed(Arguments{"encode", "-o", "4.gic", "--threads", "4"} + dumps);
  EXPECT_EQ(file_bytes(program.path("1.gic")), file_bytes(program.path("4.gic")));
}

TEST(Cli, OutputDoesNotDependOnInstructionSet) {
  const Program program;
  const Arguments dumps = program.make_dumps(4);
  program.succeed(Arguments{"encode", "-o", "best.gic"} + dumps);
  for (const Isa isa : supported_isas()) {
    const std::string name(to_string(isa));
    program.succeed(Arguments{"encode", "-o", name + ".gic", "--isa", name} + dumps);
    EXPECT_EQ(file_bytes(program.path(name + ".gic")), file_bytes(program.path("best.gic")))
        << name;
    program.succeed(Arguments{"verify", "--isa", name, "best.gic"} + dumps);
  }
  program.expect_failure(Exit::usage, Arguments{"encode", "-o", "x.gic", "--isa", "mmx"} + dumps,
                         {"--isa", "mmx"});
}

TEST(Cli, StandardInputAndOutput) {
  const Program program;
  program.make_dumps(3);
  const Outcome packed = program.succeed({"encode", "-q", "-o", "-", "in"});
  write_bytes(program.path("x.gic"), std::as_bytes(std::span(packed.out)));
  const Outcome unpacked = program.run({"decode", "-", "-o", "out"}, program.path("x.gic"));
  EXPECT_EQ(unpacked.exit, 0) << unpacked.err;
  EXPECT_EQ(program.succeed({"compare", "in", "out"}).out.find("differ"), std::string::npos);
  const Outcome verified = program.run({"verify", "-", "in"}, program.path("x.gic"));
  EXPECT_EQ(verified.exit, 0) << verified.err;
}

TEST(Cli, SomeFrames) {
  const Program program;
  program.make_dumps(6);
  program.succeed({"encode", "-o", "x.gic", "--gop", "2", "in"});
  program.succeed({"decode", "x.gic", "-o", "out", "--frames", "3-4"});
  EXPECT_EQ(program.files("out"), (std::vector<std::string>{"color.0003.exr", "color.0004.exr",
                                                            "vis.0003.exr", "vis.0004.exr"}));
  for (const std::string& name : program.files("out")) {
    EXPECT_EQ(file_bytes(program.path("out/" + name)), file_bytes(program.path("in/" + name)));
  }
  program.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "none", "--frames", "9"},
                         {"9"});
}

TEST(Cli, FilesWithoutAttributes) {
  const Program program;
  std::filesystem::create_directories(program.path("in"));
  for (const TextureDesc& desc : {kColourDesc, kVisDesc}) {
    Dump dump = random_dump(desc, 1);
    dump.info.attributes.clear();
    write_dump(program.path(desc.block.x == 8 ? "in/color.exr" : "in/vis.exr"), dump.info,
               dump.texels);
  }
  program.succeed({"encode", "-o", "x.gic", "in"});  // As textures of any kind.
  program.succeed({"verify", "x.gic", "in"});
  program.succeed({"encode", "-o", "x.gic", "--grid", "4x2x3", "--core", "color=8", "--core",
                   "vis=16", "--guard-band", "1", "in"});
  program.succeed({"decode", "x.gic", "-o", "out"});
  for (const std::string& name : program.files("in")) {
    EXPECT_EQ(file_bytes(program.path("out/" + name)), file_bytes(program.path("in/" + name)));
  }
  program.succeed({"compare", "--grid", "4x2x3", "in", "out"});
}

TEST(Cli, AttributesThatChange) {
  const Program program;
  Dump dump = random_dump(kVisDesc, 1);
  std::filesystem::create_directories(program.path("in"));
  for (int frame = 0; frame < 3; ++frame) {
    set_attribute(dump.info.attributes, {"camera", "v3f", fmt::format("{} 0 0.5", frame)});
    if (frame == 1) set_attribute(dump.info.attributes, {"note", "string", "only here"});
    if (frame == 2) std::erase_if(dump.info.attributes, [](auto& a) { return a.name == "note"; });
    write_dump(program.path(fmt::format("in/vis.{}.exr", frame)), dump.info, dump.texels,
               Existing::replace);
  }
  program.succeed({"encode", "-o", "x.gic", "in"});
  program.succeed({"decode", "x.gic", "-o", "out"});
  for (const std::string& name : program.files("in")) {
    EXPECT_EQ(file_bytes(program.path("out/" + name)), file_bytes(program.path("in/" + name)));
  }
}

TEST(Cli, InactiveProbes) {
  const Program program;
  const Arguments dumps = program.make_dumps(2);
  const std::string list = "# inside walls\n0-2, 7\n20\n";
  write_bytes(program.path("inactive.txt"), std::as_bytes(std::span(list)));
  program.succeed(Arguments{"encode", "-o", "x.gic", "--inactive", "inactive.txt"} + dumps);
  const Outcome verified = program.succeed(Arguments{"verify", "x.gic"} + dumps);
  EXPECT_NE(verified.out.find("5 inactive probes were not stored and not compared"),
            std::string::npos);
  program.succeed({"decode", "x.gic", "-o", "out"});
  const Outcome compared =
      program.run({"compare", "--format", "json", dumps[0], program.path("out/color.0000.exr")});
  EXPECT_EQ(compared.exit, 1);
  EXPECT_EQ(nlohmann::json::parse(compared.out)["probes"]["different"], 5);

  for (const auto& [text, part] :
       std::vector<std::pair<std::string, std::string>>{{"24", "probe 24 is out of range"},
                                                        {"3\n1-4\n", "probe 3 is named twice"},
                                                        {"1\n2 x\n", "line 2"},
                                                        {"9-4", "reversed"},
                                                        {"1-", "line 1"}}) {
    write_bytes(program.path("inactive.txt"), std::as_bytes(std::span(text)));
    program.expect_failure(Exit::bad_input,
                           Arguments{"encode", "-o", "y.gic", "--inactive", "inactive.txt"} + dumps,
                           {"inactive.txt", part});
  }
}

TEST(Cli, VerifyFindsOneBit) {
  const Program program;
  program.make_dumps(3);
  program.succeed({"encode", "-o", "x.gic", "in"});
  Dump dump = read_dump(program.path("in/vis.0001.exr"));
  const Extent size = image_extent(kVisDesc);
  dump.texels[4 * (20 * size.width + 37) + 2] ^= std::byte{1};
  write_dump(program.path("in/vis.0001.exr"), dump.info, dump.texels, Existing::replace);
  const Outcome outcome = program.run({"verify", "x.gic", "in"});
  EXPECT_EQ(outcome.exit, 1);
  for (const char* part : {"vis.0001.exr", "frame 1", "1 of 24 probes and 1 texels",
                           "texel (37, 20), probe 10 (2, 0, 1), channel G", "NOT VERIFIED"}) {
    EXPECT_NE(outcome.out.find(part), std::string::npos) << outcome.out;
  }
  const auto json =
      nlohmann::json::parse(program.run({"verify", "x.gic", "in", "--format", "json"}).out);
  EXPECT_EQ(json["identical"], false);
  EXPECT_EQ(json["files_identical"], 5);
  EXPECT_EQ(outcome.out.find("LOSSY"), std::string::npos) << outcome.out;
}

TEST(Cli, VerifyFindsMissingAndLeftOverFiles) {
  const Program program;
  const Arguments dumps = program.make_dumps(3);
  program.succeed({"encode", "-o", "x.gic", "in"});
  Arguments fewer(dumps.begin(), dumps.end() - 1);
  EXPECT_EQ(program.run(Arguments{"verify", "x.gic"} + fewer).exit, 1);
  const Outcome said = program.run(Arguments{"verify", "--format", "json", "x.gic"} + fewer);
  EXPECT_NE(said.out.find("\"missing\": \"vis.0002.exr was not given\""), std::string::npos)
      << said.out;
  EXPECT_NE(program.succeed({"verify", "x.gic"}).out.find("name the dumps to compare them"),
            std::string::npos);
  std::filesystem::copy(dumps[0], program.path("in/color.0003.exr"));
  const Outcome more = program.run({"verify", "x.gic", "in"});
  EXPECT_EQ(more.exit, 1);
  EXPECT_NE(more.out.find("color.0003.exr: frame 3: x.gic has no such frame of texture color\n"),
            std::string::npos)
      << more.out;
}

TEST(Cli, CompareCounts) {
  const Program program;
  const Arguments dumps = program.make_dumps(1);
  Dump dump = read_dump(dumps[0]);
  for (const std::size_t texel : {0U, 1U, 500U}) {
    dump.texels[4 * texel] ^= std::byte{1};
  }
  write_dump(program.path("b.exr"), dump.info, dump.texels, Existing::replace);
  const Outcome text = program.run({"compare", dumps[0], "b.exr"});
  EXPECT_EQ(text.exit, 1);
  EXPECT_NE(text.out.find("channel B: 3 texels, at most 1 codes"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("PSNR"), std::string::npos);
  const auto json =
      nlohmann::json::parse(program.run({"compare", "--format", "json", dumps[0], "b.exr"}).out);
  EXPECT_EQ(json["texels"]["different"], 3);
  EXPECT_EQ(json["first"]["x"], 0);
  EXPECT_EQ(json["channels"][2]["max_distance"], 1);
  EXPECT_GT(json["psnr_db"], 0);
  program.succeed({"compare", dumps[0], dumps[0]});
  program.expect_failure(Exit::bad_input, {"compare", dumps[0], dumps[1]}, {"cannot be compared"});
}

/// Floats are as far apart as there are others between them; -0 is just before 0.
TEST(Cli, CompareCountsAcrossZero) {
  const Program program;
  const std::string vis = program.make_dumps(1)[1];
  Dump dump = read_dump(vis);
  const std::size_t bytes = dump.info.desc.record.bytes;
  std::fill_n(dump.texels.begin(), bytes, std::byte{0});
  write_dump(program.path("a.exr"), dump.info, dump.texels, Existing::replace);
  for (const int beyond : {0, 5}) {
    dump.texels[0] = static_cast<std::byte>(beyond);
    dump.texels[bytes / 2 - 1] = std::byte{0x80};
    write_dump(program.path("b.exr"), dump.info, dump.texels, Existing::replace);
    const Outcome compared = program.run({"compare", "--format", "json", "a.exr", "b.exr"});
    const auto channels = nlohmann::json::parse(compared.out)["channels"];
    EXPECT_EQ(
        std::max(channels[0]["max_distance"].get<int>(), channels[1]["max_distance"].get<int>()),
        1 + beyond);
  }
}

TEST(Cli, CropKeepsTexels) {
  const Program program;
  program.make_dumps(2);
  const Outcome said =
      program.succeed({"crop", "--origin", "1,0,1", "--size", "2x2x2", "-o", "small", "in"});
  EXPECT_NE(said.err.find("small: 4 files written"), std::string::npos) << said.err;
  EXPECT_EQ(program.files("small"), program.files("in"));
  const Dump whole = read_dump(program.path("in/color.0001.exr"));
  const Dump part = read_dump(program.path("small/color.0001.exr"));
  EXPECT_EQ(part.info.desc.grid, (Grid{2, 2, 2}));
  const BlockOrigin from = block_origin(whole.info.desc, 2 + 4 * (1 + 2 * 2));
  const BlockOrigin to = block_origin(part.info.desc, 1 + 2 * (1 + 2 * 1));
  const std::size_t a = 4 * ((from.y + 3) * image_extent(whole.info.desc).width + from.x);
  const std::size_t b = 4 * ((to.y + 3) * image_extent(part.info.desc).width + to.x);
  EXPECT_TRUE(std::equal(&whole.texels[a], &whole.texels[a + 40], &part.texels[b]));
  program.expect_failure(Exit::usage,
                         {"crop", "--origin", "3,0,0", "--size", "2x2x2", "-o", "no", "in"},
                         {"do not fit"});
}

TEST(Cli, PreviewWritesPng) {
  if (!kWithImages) GTEST_SKIP() << "without PNG";
  const Program program;
  program.make_dumps(2);
  program.succeed({"encode", "-o", "x.gic", "in"});
  const Outcome said = program.succeed({"preview", "x.gic", "--frame", "1", "-o", "c.png"});
  EXPECT_NE(said.err.find("c.png: shows texture color, frame 1"), std::string::npos) << said.err;
  EXPECT_EQ(program.succeed({"preview", "-q", "x.gic", "-o", "quiet.png"}).err, "");
  program.succeed({"preview", "x.gic", "--texture", "vis", "-o", "v.png"});
  program.succeed({"preview", "in/color.0001.exr", "-o", "d.png"});
  EXPECT_EQ(file_bytes(program.path("c.png")), file_bytes(program.path("d.png")));
  EXPECT_GT(file_bytes(program.path("v.png")).size(), 100U);
  program.expect_failure(Exit::bad_input, {"preview", "x.gic", "--frame", "7", "-o", "n.png"},
                         {"no frame 7"});
  program.expect_failure(Exit::bad_input, {"preview", "x.gic", "--texture", "z", "-o", "n.png"},
                         {"no texture z"});
}

TEST(Cli, BoundedErrors) {
  const Program program;
  program.make_dumps(3);
  const Outcome encoded = program.succeed(
      {"encode", "-o", "x.gic", "--max-error", "color=2", "--max-error", "vis=0.01", "in"});
  EXPECT_NE(encoded.err.find("LOSSY"), std::string::npos);
  const auto info =
      nlohmann::json::parse(program.succeed({"info", "--format", "json", "x.gic"}).out);
  EXPECT_EQ(info["textures"][0]["lossy"], true);
  EXPECT_EQ(info["textures"][0]["largest_error"], 2);
  EXPECT_FLOAT_EQ(info["textures"][1]["largest_error"], 0.01F);
  EXPECT_NE(program.succeed({"info", "x.gic"}).out.find("LOSSY (off by at most 2)"),
            std::string::npos);

  const Outcome verified = program.succeed(
      {"verify", "--max-error", "color=2", "--max-error", "vis=0.01", "x.gic", "in"});
  EXPECT_NE(verified.out.find("texture color, --max-error 2: off are R by 2"), std::string::npos)
      << verified.out;
  EXPECT_NE(verified.out.find("6 within --max-error"), std::string::npos) << verified.out;
  const auto json =
      nlohmann::json::parse(program
                                .succeed({"verify", "--format", "json", "--max-error", "color=2",
                                          "--max-error", "vis=0.01", "x.gic", "in"})
                                .out);
  EXPECT_EQ(json["files_within_max_error"], 6);
  EXPECT_EQ(json["textures"][0]["largest_distances"][0], 2);
  // Less than that does not hold, nor does nothing.
  for (const std::string error : {"color=1", "color=2"}) {
    EXPECT_EQ(program.run({"verify", "--max-error", error, "x.gic", "in"}).exit, 1);
  }
  EXPECT_EQ(program.run({"verify", "x.gic", "in"}).exit, 1);

  // Decoded dumps say what they lost, and so does what is made of them.
  program.succeed({"decode", "x.gic", "-o", "out"});
  program.succeed({"encode", "-o", "y.gic", "out"});
  EXPECT_NE(program.succeed({"info", "y.gic"}).out.find("LOSSY (off by at most 2)"),
            std::string::npos);
  const Outcome same = program.succeed({"verify", "y.gic", "out"});
  EXPECT_EQ(same.out.find("compares it so"), std::string::npos) << same.out;
  // Errors on top of errors: what each file says of its own is nothing to compare.
  program.succeed({"encode", "-o", "z.gic", "--max-error", "color=1", "out"});
  program.succeed({"verify", "--max-error", "color=1", "z.gic", "out"});
  program.succeed({"verify", "--max-error", "color=3", "--max-error", "vis=0.01", "z.gic", "in"});
  EXPECT_EQ(program.run({"verify", "z.gic", "out"}).exit, 1);

  program.expect_failure(Exit::usage, {"encode", "-o", "n.gic", "--max-error", "colour=1", "in"},
                         {"no texture is called \"colour\"", "color"});
  program.expect_failure(Exit::usage, {"encode", "-o", "n.gic", "--max-error", "color=0.5", "in"},
                         {"less than one code", "color"});
  for (const std::string bad : {"-1", "nan", "inf", "1x", ""}) {
    program.expect_failure(Exit::usage,
                           {"encode", "-o", "n.gic", "--max-error", "vis=" + bad, "in"},
                           {"--max-error does not take"});
  }
  program.expect_failure(Exit::usage, {"verify", "--max-error", "1", "x.gic"}, {"needs the dumps"});
}

#ifdef GICODEC_WITH_HEVC
TEST(Cli, LossyColourIsReported) {
  const Program program;
  program.make_dumps(2);
  const Outcome encoded = program.succeed({"encode", "-o", "x.gic", "--backend", "hevc", "--preset",
                                           "ultrafast", "--lossy", "qp=20", "in"});
  EXPECT_NE(encoded.err.find("LOSSY"), std::string::npos);
  const auto info =
      nlohmann::json::parse(program.succeed({"info", "--format", "json", "x.gic"}).out);
  EXPECT_EQ(info["textures"][0]["lossy"], true);
  EXPECT_EQ(info["textures"][0]["largest_error"], nullptr);
  EXPECT_EQ(info["textures"][1]["lossy"], false);
  EXPECT_EQ(info["textures"][1]["largest_error"], 0);
  const Outcome verified = program.run({"verify", "x.gic", "in"});
  EXPECT_EQ(verified.exit, 1);
  EXPECT_NE(verified.out.find("coded LOSSY (qp=20)"), std::string::npos);
  EXPECT_NE(verified.out.find("PSNR"), std::string::npos);
  EXPECT_EQ(verified.out.find("vis.0000"), std::string::npos);
  EXPECT_NE(program.succeed({"decode", "x.gic", "-o", "out"}).err.find("LOSSY"), std::string::npos);
  // Also of what it gave back, and of what is made of that.
  const Outcome again = program.succeed({"verify", "x.gic", "out"});
  EXPECT_NE(again.out.find("coded LOSSY (qp=20)"), std::string::npos) << again.out;
  EXPECT_NE(program.succeed({"encode", "-o", "y.gic", "out"}).err.find("LOSSY"), std::string::npos);
  EXPECT_NE(program.succeed({"info", "y.gic"}).out.find("LOSSY (qp=20)"), std::string::npos);
  program.succeed({"verify", "y.gic", "out"});
  program.succeed({"decode", "y.gic", "-o", "out", "--overwrite"});
  program.succeed({"verify", "y.gic", "out"});
  EXPECT_NE(program.succeed({"preview", "x.gic", "-o", "x.png"}).err.find("LOSSY"),
            std::string::npos);
}
#endif

}  // namespace
}  // namespace gicodec::tools
