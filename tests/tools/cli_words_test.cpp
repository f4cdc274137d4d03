// Messages name the cure, and nothing that a file says disturbs the output.
#include "container_support.h"
#include "dump/image.h"
#include "tools/cli_support.h"

#include <gicodec/gicodec.h>
#include <gicodec/textures.h>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

/// Whether a terminal can be opened. Where /dev/pts is not mounted, none can.
bool has_terminals() {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0) return false;
  const bool open = grantpt(terminal) == 0 && unlockpt(terminal) == 0;
  const char* const name = open ? ptsname(terminal) : nullptr;
  const bool has = name != nullptr && access(name, R_OK | W_OK) == 0;
  close(terminal);
  return has;
}

class CliWords : public testing::Test {
 protected:
  void SetUp() override { dumps_ = program_.make_dumps(2); }
  void expect_usage(const std::vector<std::string>& arguments,
                    const std::vector<std::string>& parts) const {
    program_.expect_failure(Exit::usage, arguments, parts);
  }
  /// in/color.0001.exr with channels of other names, and one more.
  void write_layered() const {
    Dump dump = read_dump(dumps_[0]);
    dump.info.channels.names = {"irr.R", "irr.G", "irr.B", ""};
    fs::create_directories(program_.path("layered"));
    write_dump(program_.path("layered/color.0000.exr"), dump.info, dump.texels, Existing::replace);
  }

  Program program_;
  std::vector<std::string> dumps_;
};

TEST_F(CliWords, ValuesThatAreNoCodes) {
  const TextureDesc halves = probe_texture(Format::R16G16B16A16_SFLOAT, kColourDesc.grid, 8);
  Dump dump = random_dump(halves, 1);
  describe(dump.info.attributes, kColourDesc);
  write_dump(program_.path("half.exr"), dump.info, dump.texels, Existing::replace);
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "x.gic", "half.exr"},
                          {"is not n/1023", "--vk-format R16G16B16A16_SFLOAT"});
  dump.info.channels.alpha = false;
  for (std::size_t i = 6; i < dump.texels.size(); i += 8) {
    dump.texels[i] = dump.texels[i + 1] = std::byte{0};
  }
  write_dump(program_.path("rgb.exr"), dump.info, dump.texels, Existing::replace);
  program_.expect_failure(
      Exit::bad_input,
      {"encode", "-o", "x.gic", "--vk-format", "B10G11R11_UFLOAT_PACK32", "rgb.exr"},
      {"-bit code; files of this format hold codes 0 to ",
       "; --vk-format R16G16B16A16_SFLOAT keeps such values as they are"});
  program_.succeed({"encode", "-o", "x.gic", "--vk-format", "R16G16B16A16_SFLOAT", "half.exr"});
  program_.succeed({"verify", "x.gic", "half.exr"});

  const auto width = static_cast<std::uint32_t>(image_extent(kColourDesc).width);
  const auto height = static_cast<std::uint32_t>(image_extent(kColourDesc).height);
  const std::vector<std::uint8_t> pixels(std::size_t{3} * width * height, 7);
  write_png(program_.path("c.png"), width, height, 3, pixels);
  program_.expect_failure(
      Exit::bad_input,
      {"encode", "-o", "y.gic", "--grid", "4x2x3", "--vk-format", "A2R10G10B10_UNORM_PACK32",
       "c.png"},
      {"c.png: holds 8 bits per channel", "10 of A2R10G10B10", "--vk-format R8G8B8A8_UNORM"});
  program_.succeed({"encode", "-o", "z.gic", "c.png"});
  EXPECT_NE(program_.succeed({"info", "z.gic"}).out.find("R8G8B8_UNORM"), std::string::npos);
  // What is lost is said in quiet runs too.
  const Outcome quiet = program_.succeed({"-q", "encode", "-o", "q.gic", "c.png"});
  EXPECT_NE(quiet.err.find("that it is png (decode writes EXR) not kept"), std::string::npos)
      << quiet.err;
  // The EXR that stands for it is read as the same format.
  program_.succeed({"decode", "z.gic", "-o", "z"});
  program_.succeed({"compare", "c.png", "z/c.exr"});
  std::filesystem::create_directories(program_.path("pictures"));
  std::filesystem::copy(program_.path("c.png"), program_.path("pictures/c.png"));
  std::filesystem::copy(dumps_[0], program_.path("pictures/color.0000.exr"));
  program_.succeed({"encode", "-o", "p.gic", "pictures", "pictures/c.png"});
  program_.succeed({"decode", "p.gic", "-o", "p"});
  program_.succeed({"verify", "p.gic", "pictures"});
  program_.succeed({"compare", "pictures", "p"});
  program_.succeed(
      {"encode", "-o", "y.gic", "--grid", "4x2x3", "--vk-format", "R8G8B8A8_UNORM", "c.png"});
  program_.expect_failure(
      Exit::bad_input,
      {"encode", "-o", "z.gic", "--grid", "3x2x3", "--vk-format", "R8G8B8A8_UNORM", "c.png"},
      {"80 texels of width do not make the 6 = 3·2 columns of tiling atlas_xy_z"});
  program_.succeed({"decode", "y.gic", "-o", "back"});
  program_.succeed(
      {"compare", "--grid", "4x2x3", "--vk-format", "R8G8B8A8_UNORM", "c.png", "back/c.exr"});
}

TEST_F(CliWords, ChannelsOfOtherNames) {
  write_layered();
  program_.expect_failure(
      Exit::bad_input, {"encode", "-o", "x.gic", "layered"},
      {"channel R", "irr.B, irr.G, irr.R", "--channels R=irr.R,G=irr.G,B=irr.B"});
  for (const std::string mapping : {"R=irr.R,G=irr.G,B=irr.B", "color=R=irr.R,G=irr.G,B=irr.B"}) {
    program_.succeed({"encode", "-o", "x.gic", "--channels", mapping, "layered"});
    program_.succeed({"verify", "x.gic", "layered"});
  }
  EXPECT_NE(program_.succeed({"info", "x.gic"}).out.find("R is irr.R"), std::string::npos);
  program_.succeed({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(file_bytes(program_.path("out/color.0000.exr")),
            file_bytes(program_.path("layered/color.0000.exr")));
  program_.expect_failure(Exit::bad_input,
                          {"encode", "-o", "y.gic", "--channels", "R=x,G=irr.G,B=irr.B", "layered"},
                          {"no channel x", "irr.B, irr.G, irr.R"});
  for (const char* wrong : {"R", "R=", "R=a,R=b", "R=a,G=a", "Q=a"}) {
    expect_usage({"encode", "-o", "y.gic", "--channels", wrong, "layered"}, {"--channels", wrong});
  }
}

TEST_F(CliWords, ChannelsThatArePassedOver) {
  // One component of three.
  program_.succeed({"encode", "-o", "x.gic", "--channels", "R=G", "--vk-format", "R16_SFLOAT",
                    "in/vis.0000.exr"});
  EXPECT_NE(program_.succeed({"info", "x.gic"}).out.find("not kept: channel R"), std::string::npos);
  program_.succeed({"verify", "x.gic", "in/vis.0000.exr"});
  program_.expect_failure(Exit::io, {"decode", "x.gic", "-o", "in", "--overwrite"},
                          {"may be the original", "lacks channel R"});
}

TEST_F(CliWords, HostileChannelNames) {
  std::FILE* file = std::fopen(program_.path("bad.gic").c_str(), "wb");
  FileSink sink(file);
  const test::ProbeTexture texture{
      "vis", kVisDesc, {{"channels", "R:HALF G:HALF"}, {"channel:R", "G"}}};
  const auto description = test::probe_description({&texture, 1});
  ASSERT_EQ(ContainerWriter::create(sink, description)->finish(), Status::ok);
  std::fclose(file);
  program_.expect_failure(Exit::bad_input, {"info", "bad.gic"}, {"same name"});
}

TEST_F(CliWords, SettingsThatAreRefused) {
  expect_usage({"encode", "-o", "x.gic", "--preset", "slow", "in"},
               {"slow", "turbo, fast or strong"});
  expect_usage({"encode", "-o", "x.gic", "--backend", "lz4", "--level", "99", "in"},
               {"99", "-64 to 12"});
  expect_usage({"encode", "-o", "x.gic", "--backend", "raw", "--level", "1", "in"}, {"neither"});
  expect_usage({"frobnicate", "in"}, {"frobnicate is no command", "encode", "backends"});
  expect_usage({"preview", dumps_[0], "-o", "x.jpg"}, {"x.jpg", "name it x.png"});
  program_.succeed({"preview", dumps_[0], "-o", "x.PNG"});
}

TEST_F(CliWords, NumbersAndNamesThatAreNone) {
  expect_usage({"encode", "-o", "x.gic", "--gop", "-1", "in"}, {"--gop", "\"-1\"", "whole number"});
  expect_usage({"encode", "-o", "x.gic", "--chunk", "many", "in"}, {"\"many\"", "0 to 4096"});
  expect_usage({"preview", dumps_[0], "--exposure", "nan", "-o", "x.png"},
               {"\"nan\"", "no number"});
  expect_usage({"encode", "--core", "-o", "x.gic", "in"}, {"--core", "a value is missing", "-o"});
  expect_usage({"encode", "-o", "x.gic", "--core", "colr=8", "in"}, {"--core colr=8", "color"});
  expect_usage({"encode", "-o", "x.gic", "--max-error", "=2", "in"}, {"called \"\"", "color"});
  expect_usage({"encode", "-o", "x.gic", "--max-error", "color=2,vis=3", "in"},
               {"2,vis=3", "once for each texture"});
  EXPECT_EQ(program_.succeed({"help", "encode"}).out, program_.succeed({"encode", "--help"}).out);
  EXPECT_EQ(program_.succeed({"help"}).out, program_.succeed({"--help"}).out);
}

TEST_F(CliWords, MissingFilesAndGrids) {
  program_.expect_failure(Exit::io, {"encode", "-o", "nowhere/x.gic", "in"},
                          {"no folder nowhere", "make it"});
  program_.expect_failure(Exit::io, {"compare", dumps_[0], "absent.exr"}, {"absent.exr"});
  program_.expect_failure(Exit::io, {"compare", "absent", "in"}, {"absent"});
  program_.succeed({"encode", "-o", "x.gic", "--grid", "4,2,3", "in"});
  expect_usage({"encode", "-o", "x.gic", "--grid", "4x2,3", "in"}, {"4x2,3"});
  expect_usage({"encode", "-o", "x.exr", "in"}, {"x.exr", "named like a dump", ".gic"});
  for (const char* command : {"compare", "crop"}) {
    std::vector<std::string> words{command, "x.gic", "in"};
    if (words[0] == "crop")
      words = {"crop", "x.gic", "-o", "c", "--size", "1x1x1", "--origin=0,0,0"};
    program_.expect_failure(Exit::bad_input, words,
                            {"x.gic: is a container", "gicodec decode x.gic"});
  }
}

TEST_F(CliWords, UpperCaseExtensions) {
  fs::create_directories(program_.path("upper"));
  fs::copy(dumps_[0], program_.path("upper/COLOR.0000.EXR"));
  program_.succeed({"encode", "-o", "x.gic", "upper"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(program_.files("out"), std::vector<std::string>{"COLOR.0000.EXR"});
}

TEST_F(CliWords, NothingBinaryToATerminal) {
  if (!has_terminals()) GTEST_SKIP() << "no terminal can be opened here: is /dev/pts mounted?";
  program_.succeed({"encode", "-o", "x.gic", "in"});
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"encode", "-o", "-", "in"},
        {"preview", "x.gic", "-o", "-"},
        {"encode", "-o", "/dev/stdout", "in"}}) {
    Circumstances terminal;
    terminal.terminal = true;
    const Outcome outcome = program_.run_in(terminal, command);
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_NE(outcome.err.find("is a terminal"), std::string::npos) << outcome.err;
  }
}

TEST_F(CliWords, NoTextInAContainer) {
  Circumstances mixed;
  mixed.one_stream = true;
  const Outcome outcome = program_.run_in(mixed, {"encode", "-o", "-", "in"});
  EXPECT_EQ(outcome.exit, 0);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const auto expected = file_bytes(program_.path("x.gic"));
  const auto got = std::as_bytes(std::span(outcome.out));
  EXPECT_TRUE(std::equal(got.begin(), got.end(), expected.begin(), expected.end()));
}

TEST_F(CliWords, InfoSumsUp) {
  program_.succeed({"encode", "-o", "x.gic", "in"});
  std::uint64_t files = 0, texels = 0;
  for (const std::string& dump : dumps_) {
    files += file_bytes(dump).size();
    texels += read_dump(dump).texels.size();
  }
  const double size = static_cast<double>(file_bytes(program_.path("x.gic")).size());
  const std::string text = program_.succeed({"info", "x.gic", "--fps", "10"}).out;
  for (const std::string& part :
       {std::string("2 frames (0-1)"),
        fmt::format("{:.2f}:1 of {} bytes of textures", static_cast<double>(texels) / size, texels),
        fmt::format("{:.2f}:1 of {} bytes of files", static_cast<double>(files) / size, files),
        std::string("bytes per frame"), std::string("bit/s at 10 fps")}) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "lacks " << part;
  }
  EXPECT_EQ(text.find("modes"), std::string::npos) << text;
  EXPECT_NE(program_.succeed({"info", "x.gic", "--verbose"}).out.find("modes"), std::string::npos);

  const auto json = nlohmann::json::parse(
      program_.succeed({"info", "x.gic", "--fps", "10", "--format", "json"}).out);
  EXPECT_EQ(json["first_frame"], 0);
  EXPECT_EQ(json["last_frame"], 1);
  EXPECT_EQ(json["texture_bytes"], texels);
  EXPECT_EQ(json["file_bytes"], files);
  EXPECT_NEAR(json["ratio"].get<double>(), static_cast<double>(texels) / size, 1e-9);
  EXPECT_NEAR(json["bits_per_second"].get<double>(), 80 * json["bytes_per_frame"].get<double>(),
              1e-6);
  EXPECT_FALSE(json["textures"][0].contains("native"));
  const auto verbose = nlohmann::json::parse(
      program_.succeed({"info", "x.gic", "--verbose", "--format", "json"}).out);
  EXPECT_TRUE(verbose["textures"][0].contains("native"));
}

TEST_F(CliWords, BackendsAreListed) {
  const std::string text = program_.succeed({"backends"}).out;
  EXPECT_NE(text.find("native   made for"), std::string::npos) << text;
  EXPECT_NE(text.find("run on this machine"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(program_.succeed({"backends", "--format", "json"}).out);
  EXPECT_FALSE(json["instruction_sets"].empty());
  const auto& all = json["backends"];
  const auto native =
      std::ranges::find_if(all, [](const auto& b) { return b["name"] == "native"; });
  ASSERT_NE(native, all.end());
  EXPECT_EQ((*native)["id"], 4);
  EXPECT_EQ((*native)["usable"], true);
}

TEST_F(CliWords, InfoNamesPlanesAndWhatThereIs) {
  write_bytes(program_.path("a.raw"),
              random_texels(map_texture(Format::R16G16B16A16_UNORM, {8, 8, 1}, {8, 8, 1}), 1));
  program_.succeed({"encode", "-o", "a.gic", "--preset", "fast", "--vk-format",
                    "R16G16B16A16_UNORM", "--extent", "8x8", "a.raw"});
  const std::string text = program_.succeed({"info", "a.gic", "--verbose"}).out;
  EXPECT_EQ(text.find(" high"), std::string::npos) << text;
  EXPECT_EQ(text.find("updates"), std::string::npos) << "there are none: " << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "a.gic", "--format", "json"}).out);
  EXPECT_EQ(json["textures"][0]["space"], "grid");
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const Outcome decoded = program_.succeed({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(decoded.err.find("do not say"), std::string::npos) << decoded.err;
  EXPECT_EQ(program_.run({"preview", "x.gic", "-o", "p.png", "--gamma", "10.5"}).exit, 2);
  program_.succeed({"preview", "x.gic", "-o", "p.png", "--gamma", "10"});
}

TEST_F(CliWords, OptionsTakeOneValueEach) {
  const auto encode = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), dumps_.begin(), dumps_.end());
    program_.succeed(arguments);
  };
  const std::string grid = to_string(read_dump_info(dumps_[0]).desc.grid);
  encode({"encode", "-o", "x.gic", "--guard-band", "1", "--grid", grid});
  encode({"encode", "-o", "x.gic", "--channels", "color=R=R,G=G,B=B"});
  encode({"crop", "-o", "small", "--size", "1x1x1", "--origin", "0,0,0"});
}

TEST_F(CliWords, TexturesThatAreNotThereAreNamed) {
  for (const char* value : {"--grid=clor=4x2x3", "--channels=clor=R=R,G=G,B=B"}) {
    program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", value, "in"},
                            {"no texture is called \"clor\"", "color, vis"});
    program_.expect_failure(
        Exit::usage, {"crop", "-o", "c", "--size", "1x1x1", "--origin", "0,0,0", value, "in"},
        {"no texture is called \"clor\""});
    program_.expect_failure(Exit::usage, {"compare", value, "in", "in"},
                            {"no texture is called \"clor\""});
    program_.expect_failure(Exit::usage, {"preview", dumps_[0], "-o", "x.png", value},
                            {"no texture is called \"clor\""});
  }
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--core", "x", "in"},
                          {"--core does not take \"x\"", "0 to"});
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--vk-format", "RGBA", "in"},
                          {"does not take \"RGBA\"", "R16G16_SFLOAT"});
}

TEST_F(CliWords, FilesThatAreNoImagesAreNamed) {
  write_bytes(program_.path("in/camera.json"), std::as_bytes(std::span("{}")));
  std::vector<std::string> arguments = {"encode", "-o", "x.gic", "in/camera.json"};
  arguments.insert(arguments.end(), dumps_.begin(), dumps_.end());
  program_.expect_failure(Exit::bad_input, arguments, {"in/camera.json", "no image", "folder"});
}

// The attribute may do without the prefix, and it comes back as it was.
TEST_F(CliWords, FormatsWithoutPrefix) {
  fs::create_directories(program_.path("short"));
  Dump dump = read_dump(dumps_[0]);
  set_attribute(
      dump.info.attributes,
      {"gicodec:vkFormat", "string", std::string(find_format(dump.info.desc.record.format)->name)});
  write_dump(program_.path("short/color.0000.exr"), dump.info, dump.texels);
  program_.succeed({"encode", "-o", "x.gic", "short"});
  program_.succeed({"verify", "x.gic", "short"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  program_.succeed({"compare", "short", "out"});
}

TEST_F(CliWords, FractionsAreTaken) {
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"info", "x.gic", "--fps", "29.97"});
  program_.succeed({"preview", "x.gic", "-o", "x.png", "--max-distance", "0.25"});
}

TEST_F(CliWords, NothingObeysWhatFilesSay) {
  Dump dump = read_dump(dumps_[0]);
  set_attribute(dump.info.attributes, {"note", "string", "\x1b]0;title\x07 \xff\xfe\u202E \n x"});
  fs::create_directories(program_.path("odd"));
  write_dump(program_.path("odd/color.0000.exr"), dump.info, dump.texels, Existing::replace);
  program_.succeed({"encode", "-o", "x.gic", "odd"});
  // Names that decode could not give to a file are refused.
  for (const auto& [name, shown] :
       {std::pair("co\xfflor", "co\\xfflor"), {"co\x1b[1mlor", "co\\x1b[1mlor"}}) {
    fs::create_directories(program_.path("bytes"));
    write_dump(program_.path(fmt::format("bytes/{}.0000.exr", name)), dump.info, dump.texels,
               Existing::replace);
    const Outcome refused = program_.run({"encode", "-o", "y.gic", "bytes"});
    EXPECT_EQ(refused.exit, 3);
    EXPECT_NE(refused.err.find(shown), std::string::npos) << refused.err;
    fs::remove_all(program_.path("bytes"));
  }
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"info", "x.gic", "--metadata"},
        {"info", "x.gic", "--format", "json"},
        {"verify", "x.gic", "odd", "--format", "json"},
        {"compare", "odd", "odd", "--format", "json"},
        {"verify", "x.gic", "in"}}) {
    const Outcome outcome = program_.run(command);
    EXPECT_LE(outcome.exit, 1) << outcome.err;
    const std::string all = outcome.out + outcome.err;
    EXPECT_EQ(all.find_first_of("\x1b\x07\xff"), std::string::npos) << command[0];
    if (command.back() == "json") {
      EXPECT_FALSE(nlohmann::json::parse(outcome.out).is_discarded());
    }
  }
  const Outcome failed = program_.run({"info", "odd/co\xfflor\x1b.exr"});
  EXPECT_EQ(failed.exit, 4);
  EXPECT_EQ(failed.err.find_first_of("\x1b\xff"), std::string::npos);
  EXPECT_NE(failed.err.find("\\x1b"), std::string::npos) << failed.err;
}

#ifdef GICODEC_WITH_HEVC
TEST_F(CliWords, TheEncoderInUseIsNamed) {
  const Outcome encoded =
      program_.succeed({"encode", "-o", "x.gic", "--backend", "hevc", "--preset", "ultrafast",
                        "--hevc-encoder", "hevc_nosuch,libx265", dumps_[0]});
  EXPECT_NE(encoded.err.find("hevc (libx265)"), std::string::npos) << encoded.err;
  EXPECT_NE(program_.succeed({"info", "x.gic"}).out.find("hevc (libx265)"), std::string::npos);
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(json["textures"][0]["encoder"], "libx265");
  expect_usage({"encode", "-o", "y.gic", "--backend", "hevc", "--preset", "quick", "in"},
               {"quick", "ultrafast", "placebo"});
}
#endif

// Neither does the library that writes pictures speak for itself.
TEST_F(CliWords, PicturesThatNoPngHolds) {
  const auto preview = [&](Grid grid, Tiling tiling, const std::vector<std::string>& parts) {
    TextureDesc desc = probe_texture(Format::R8_UNORM, grid, 2, 1);
    desc.layout = tiling;
    const test::ProbeTexture texture{"vis", desc};
    test::MemorySink sink;
    auto writer = ContainerWriter::create(sink, test::probe_description({&texture, 1}));
    auto encoder = Encoder::create(desc, {.backend = "zstd"});
    const std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(desc)));
    const std::vector<std::uint32_t> one{0};
    const auto packet = encoder->encode(ConstTextureView(texels), Selection(one));
    ASSERT_EQ(writer->add(0, *packet), Status::ok);
    ASSERT_EQ(writer->finish(), Status::ok);
    write_bytes(program_.path("y.gic"), sink.bytes);
    program_.expect_failure(Exit::bad_input, {"preview", "y.gic", "-o", "a.png"}, parts);
    const std::string said = program_.run({"preview", "y.gic", "-o", "a.png"}).err;
    EXPECT_EQ(said.find("libpng"), std::string::npos) << said;
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  };
  preview({1024, 1024, 1}, Tiling::atlas_xy_z,
          {"a.png: 4194304x4 texels do not fit in a PNG, whose sides have 1000000 at most",
           "\"gicodec crop\""});
  preview({1024, 1025, 1}, Tiling::atlas_xy_z, {"4198400x4 texels", "slices_xy_z"});
  preview({64, 64, 64}, Tiling::blocks, {"4x1048576 texels", "\"gicodec decode\""});
  // What is said helps.
  program_.succeed({"decode", "y.gic", "-o", "out"});
  program_.succeed({"crop", "--origin", "0,0,0", "--size", "8x8x8", "-o", "small", "out"});
  program_.succeed({"preview", "small/vis.0000.exr", "-o", "b.png"});
}

}  // namespace
}  // namespace gicodec::tools
