// The table of cures: each advice is caused, followed, and gives back the bits.
#include "container_support.h"
#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/texture_file.h"
#include "tools/cli_support.h"
#include "tools/dump_support.h"
#include "tools/unknown_volume.h"

#include <gicodec/encoder.h>
#include <gicodec/engines.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

class CliCures : public testing::Test {
 protected:
  /// What rows have been shown, of all tests of this program.
  static std::set<Cure>& shown() {
    static std::set<Cure> cures;
    return cures;
  }
  void SetUp() override { fs::create_directories(program_.path("in")); }

  [[nodiscard]] std::string path(const std::string& name) const { return program_.path(name); }
  void write(const std::string& name, const Dump& dump) const {
    write_dump(path(name), dump.info, dump.texels);
  }
  /// A map without a word about what it is, as of a foreign program.
  static Dump foreign(Format format, Grid size = {8, 8, 1}, std::uint32_t seed = 1) {
    Dump dump = random_dump(map_texture(format, size, {8, 8, 1}), seed);
    dump.info.attributes.clear();
    return dump;
  }
  void write_levels(const std::string& name, std::uint32_t levels) const {
    TextureHead head;
    head.texels = {16, 16, 1};
    head.levels = levels;
    write_dumps(path(name), random_images(Format::R8G8B8A8_UNORM, head));
  }

  /// Runs `failing`, which ends with `exit` and gives this advice, then the advised commands. Flags
  /// that these have besides stand in the advice.
  void follow(Cure cure, const std::string& advice, const Words& failing,
              const std::vector<Words>& advised, Exit exit = Exit::bad_input) {
    SCOPED_TRACE(advice);
    const Outcome outcome = program_.run(failing);
    EXPECT_EQ(outcome.exit, static_cast<int>(exit)) << outcome.err;
    EXPECT_NE(outcome.err.find(advice), std::string::npos) << outcome.err;
    for (const Words& command : advised) {
      for (const std::string& word : command) {
        const bool named = !word.starts_with("--") || command[0] == "crop" ||
                           advice.find(word) != std::string::npos ||
                           std::ranges::find(failing, word) != failing.end();
        EXPECT_TRUE(named) << word << " is not advised";
      }
      program_.succeed(command);
    }
    shown().insert(cure);
  }
  void follow(Cure cure, const Words& failing, const std::vector<Words>& advised,
              Exit exit = Exit::bad_input) {
    follow(cure, std::string(cure_text(cure)), failing, advised, exit);
  }
  /// Decodes x.gic; expects the files of a folder, or a file of them.
  void expect_back(const std::string& container = "x.gic", const std::string& folder = "in",
                   const std::string& only = "") {
    fs::remove_all(path("out"));
    program_.succeed({"decode", container, "-o", "out"});
    std::size_t files = 0;
    for (const std::string& name : program_.files(folder)) {
      if (!only.empty() && name != only) continue;
      EXPECT_EQ(file_bytes(path("out/" + name)), file_bytes(path(folder + "/" + name))) << name;
      ++files;
    }
    EXPECT_EQ(program_.files("out").size(), files);
    fs::remove(path(container));
    fs::remove_all(path("in"));
    fs::create_directories(path("in"));
  }

  Program program_;
};

TEST_F(CliCures, Formats) {
  write("in/a.exr", without_alpha(foreign(Format::R16G16B16A16_SFLOAT)));
  const Words as_codes{"encode", "-o", "x.gic", "in", "--vk-format", "A2R10G10B10_UNORM_PACK32"};
  follow(Cure::keep_values, to_cure(Cure::keep_values, "R16G16B16A16_SFLOAT"), as_codes,
         {{"encode", "-o", "x.gic", "in", "--vk-format", "R16G16B16A16_SFLOAT"}});
  expect_back();

  write("in/a.exr", foreign(Format::R16_SFLOAT));
  follow(Cure::leave_format_out, {"encode", "-o", "x.gic", "in", "--vk-format", "R32_SFLOAT"},
         {{"encode", "-o", "x.gic", "in"}});
  expect_back();

  write("in/a.raw", foreign(Format::R8G8B8A8_UNORM));
  fs::remove(path("in/a.json"));
  follow(Cure::describe_raw, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in", "--vk-format", "R8G8B8A8_UNORM", "--extent", "8x8x1"}});
  follow(Cure::fix_format,
         {"encode", "-o", "x.gic", "in", "--vk-format", "R8_UNORM", "--extent", "8x8x1"},
         {{"encode", "-o", "x.gic", "in", "--vk-format", "R8G8B8A8_UNORM", "--extent", "8x8x1"}});
  expect_back();

  write("in/a.dds", foreign(Format::R8G8B8A8_UNORM));
  auto bytes = file_bytes(path("in/a.dds"));
  bytes[128] = std::byte{27};  // DXGI_FORMAT_R8G8B8A8_TYPELESS
  write_bytes(path("in/a.dds"), bytes);
  follow(Cure::read_as_format, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in", "--vk-format", "R8G8B8A8_UNORM"}});
  expect_back();

  for (const char* name : {"in/a.ktx2", "in/b.dds"}) {
    write(name, foreign(Format::R8G8B8A8_UNORM));
    const Words failing{"encode", "-o", "x.gic", "in", "--vk-format", "R8_UNORM"};
    const std::vector<Words> advised{
        {"encode", "-o", "x.gic", "in"},
        {"encode", "-o", "x.gic", "in", "--vk-format", "R8G8B8A8_UNORM"}};
    follow(Cure::check_format, failing, advised);
    expect_back();
  }
}

TEST_F(CliCures, Channels) {
  if (!kWithImages) GTEST_SKIP() << "without PNG";
  Dump named = without_alpha(foreign(Format::R16G16B16A16_SFLOAT));
  for (std::size_t i = 0; i < 3; ++i) {
    named.info.channels.names[i] = std::string("light") + "RGB"[i];
  }
  write("in/a.exr", named);
  const Words failing{"encode", "-o", "x.gic", "in", "--vk-format", "R16G16B16A16_SFLOAT"};
  Words advised = failing;
  const std::string mapping = "R=lightR,G=lightG,B=lightB";
  advised.insert(advised.end(), {"--channels", mapping});
  follow(Cure::map_channels, to_cure(Cure::map_channels, "--channels " + mapping), failing,
         {advised});
  expect_back();

  // Pictures come back as EXR, with the texels that were read.
  write("a.exr", random_dump(ddgi_irradiance({2, 2, 2}), 1));
  program_.succeed({"preview", "a.exr", "-o", "in/a.png"});
  follow(Cure::pick_channels, {"encode", "-o", "x.gic", "in/a.png", "--vk-format", "R8_UNORM"},
         {{"encode", "-o", "x.gic", "in/a.png"},
          {"verify", "x.gic", "in/a.png"},
          {"encode", "-o", "x.gic", "in/a.png", "--vk-format", "R8_UNORM", "--channels", "R=R"},
          {"verify", "x.gic", "in/a.png"}});
  follow(Cure::more_bits,
         {"encode", "-o", "x.gic", "in/a.png", "--vk-format", "A2R10G10B10_UNORM_PACK32"},
         {{"encode", "-o", "x.gic", "in/a.png", "--vk-format", "R8G8B8A8_UNORM"},
          {"verify", "x.gic", "in/a.png"}});
}

TEST_F(CliCures, Probes) {
  Dump probes = random_dump(kColourDesc, 1);
  const auto attributes = std::exchange(probes.info.attributes, {});
  write("in/color.exr", probes);
  follow(Cure::grid_or_block, {"encode", "-o", "x.gic", "in", "--guard-band", "1"},
         {{"encode", "-o", "x.gic", "in", "--guard-band", "1", "--grid", "4x2x3"}});
  follow(Cure::grid_or_block, {"encode", "-o", "x.gic", "in", "--guard-band", "1"},
         {{"encode", "-o", "x.gic", "in", "--block", "8x8x1"}});
  follow(Cure::fix_columns, {"encode", "-o", "x.gic", "in", "--grid", "7x2x3"},
         {{"encode", "-o", "x.gic", "in", "--grid", "4x2x3"}});
  expect_back();

  probes.info.attributes = attributes;
  set_attribute(probes.info.attributes, {"gicodec:core", "int", "99999"});
  write("in/color.exr", probes);
  follow(Cure::give_flag, to_cure(Cure::give_flag, "--core"), {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in", "--core", "8"}});
  expect_back();

  const VolumeDesc rtxgi = *find_engine_layout("rtxgi")->make({4, 2, 3});
  for (const NamedTexture* texture : textures_of(rtxgi)) {
    write(fmt::format("in/{}.0000.exr", texture->name), random_dump(texture->desc, 1));
  }
  follow(Cure::fix_layout, {"encode", "-o", "x.gic", "in", "--layout", "rtxgi", "--grid", "4x3x2"},
         {{"encode", "-o", "x.gic", "in", "--layout", "rtxgi", "--grid", "4x2x3"}});
  expect_back();

  // A pool of more slots than bricks.
  const VolumeDesc pool = *find_engine_layout("unity-apv-l1")->make({19, 27, 1});
  for (const NamedTexture* texture : textures_of(pool)) {
    write(fmt::format("in/{}.0000.dds", texture->name), random_dump(texture->desc, 1));
  }
  follow(Cure::leave_layout_out,
         {"encode", "-o", "x.gic", "in", "--layout", "unity-apv-l1", "--grid", "19x27x1"},
         {{"encode", "-o", "x.gic", "in"}});
  expect_back();
}

TEST_F(CliCures, NumbersInNames) {
  const auto sequence = [&](const Words& names) {
    std::uint32_t seed = 0;
    for (const std::string& name : names) {
      write("in/" + name, foreign(Format::R16_SFLOAT, {8, 8, 1}, ++seed));
    }
  };
  const Words plain{"encode", "-o", "x.gic", "in"};
  const auto with = [&](Words flags) {
    flags.insert(flags.begin(), plain.begin(), plain.end());
    return flags;
  };
  for (const char* flag : {"--allow-gaps", "--stills"}) {
    sequence({"a.0000.exr", "a.0002.exr"});
    follow(Cure::gaps, plain, {with({flag})});
    expect_back();
  }
  sequence({"a_1.exr", "a_2.exr"});
  follow(Cure::stills, plain, {with({"--stills"})}, Exit::ok);
  expect_back();
  sequence({"a_1.exr", "a_2.exr", "a_11.exr", "a_12.exr"});
  follow(Cure::frames_from, to_cure(Cure::frames_from, "'a_#'", " --allow-gaps"), plain,
         {with({"--frames-from", "a_#", "--allow-gaps"})}, Exit::ok);
  expect_back();

  // Names are no commands.
  sequence({"$(touch x)_1.exr", "$(touch x)_11.exr"});
  follow(Cure::frames_from, to_cure(Cure::frames_from, "'$(touch x)_#'", " --allow-gaps"), plain,
         {with({"--frames-from", "$(touch x)_#", "--allow-gaps"})}, Exit::ok);
  expect_back();

  sequence({"a_0001.exr", "a_0002.exr", "a.0003.exr"});
  follow(Cure::rename, plain, {});
  fs::rename(path("in/a.0003.exr"), path("in/b.0003.exr"));
  program_.succeed(with({"--allow-gaps"}));
  expect_back();
  sequence({"a.0001.exr", "a.02.exr"});
  follow(Cure::name_it, to_cure(Cure::name_it, "a.01.exr"), plain, {});
  fs::rename(path("in/a.0001.exr"), path("in/a.01.exr"));
  program_.succeed(plain);
  expect_back();

  sequence({"a.0000.exr"});
  fs::create_directories(path("more"));
  fs::copy_file(path("in/a.0000.exr"), path("more/a.0000.exr"));
  follow(Cure::one_folder, {"encode", "-o", "x.gic", "in", "more"},
         {plain, {"encode", "-o", "y.gic", "more"}});
  program_.succeed({"verify", "y.gic", "more"});
  expect_back();
}

TEST_F(CliCures, ManyFiles) {
  for (int i = 0; i <= 10'000; ++i) write_bytes(path(fmt::format("in/n{}_.exr", i)), {});
  write("in/a.exr", foreign(Format::R16_SFLOAT));
  follow(Cure::fewer_files, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in/a.exr"}});
  expect_back("x.gic", "in", "a.exr");

  Words all{"encode", "-o", "x.gic"};
  for (int i = 0; i < 257; ++i) {
    write(fmt::format("in/n{}_.exr", i), foreign(Format::R16_SFLOAT, {1, 1, 1}));
    all.push_back(fmt::format("in/n{}_.exr", i));
  }
  const Words some(all.begin(), all.begin() + 100);
  Words rest(all.begin() + 100, all.end());
  rest.insert(rest.begin(), {"encode", "-o", "y.gic"});
  follow(Cure::fewer_textures, all, {some, rest}, Exit::usage);
  fs::remove_all(path("out"));
  program_.succeed({"decode", "x.gic", "-o", "out"});
  program_.succeed({"decode", "y.gic", "-o", "out"});
  EXPECT_EQ(program_.files("out"), program_.files("in"));
}

TEST_F(CliCures, FilesOfOtherKinds) {
  if (!kWithImages) GTEST_SKIP() << "without PNG";
  for (const char* name : {"in/a.exr", "more/b.exr"}) {
    fs::create_directories(fs::path(path(name)).parent_path());
    write(name, foreign(Format::R16_SFLOAT));
  }
  fs::create_directories(path("in/sub"));
  write_bytes(path("in/notes.txt"), {});
  program_.succeed({"preview", "in/a.exr", "-o", "in/b.png"});
  follow(Cure::name_others, "b.png, sub/; name them to take them", {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in", "in/b.png"}}, Exit::ok);
  program_.succeed({"verify", "x.gic", "in/a.exr", "in/b.png"});
  fs::remove(path("in/a.exr"));
  follow(Cure::name_others, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in/b.png"}});
  fs::remove_all(path("in"));
  fs::create_directories(path("in"));

  write("in/a.0000.exr", foreign(Format::R16_SFLOAT));
  write("in/a.0001.exr", foreign(Format::R16_SFLOAT, {4, 4, 1}));
  follow(Cure::stills, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in", "--stills"}});
  expect_back();

  write("in/a.dds", foreign(Format::R8G8B8A8_UNORM));
  const auto size = fs::file_size(path("in/a.dds"));
  fs::resize_file(path("in/a.dds"), size + 11);
  follow(Cure::cut_rest, to_cure(Cure::cut_rest, size, "in/a.dds"), {"encode", "-o", "x.gic", "in"},
         {});
  fs::resize_file(path("in/a.dds"), size);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_back();
}

TEST_F(CliCures, ImagesOfAFile) {
  write_levels("in/a.0000.ktx2", 3);
  write_levels("in/a.0001.ktx2", 1);
  follow(
      Cure::one_kind, {"encode", "-o", "x.gic", "in"},
      {{"encode", "-o", "x.gic", "in/a.0000.ktx2"}, {"encode", "-o", "y.gic", "in/a.0001.ktx2"}});
  program_.succeed({"verify", "y.gic", "in/a.0001.ktx2"});
  expect_back("x.gic", "in", "a.0000.ktx2");

  write_levels("in/a.ktx2", 2);
  const Words flags{"--origin", "0,0,0", "--size", "1x1x1"};
  Words failing{"crop", "-o", "small", "in"}, advised{"crop", "-o", "small", "files"};
  failing.insert(failing.end(), flags.begin(), flags.end());
  advised.insert(advised.end(), flags.begin(), flags.end());
  follow(Cure::raw_files, failing,
         {{"encode", "-o", "x.gic", "in"},
          {"decode", "x.gic", "--files", "raw", "-o", "files"},
          advised});
  EXPECT_EQ(program_.files("small"), (Words{"a.json", "a.mip1.json", "a.mip1.raw", "a.raw"}));
  expect_back();
}

TEST_F(CliCures, LargeFiles) {
  write("large.dds", foreign(Format::R16G16B16A16_SFLOAT));
  auto bytes = file_bytes(path("large.dds"));
  for (const std::size_t at : {12U, 16U}) set_word(bytes, at, 16384);
  write_bytes(path("large.dds"), bytes);
  fs::resize_file(path("large.dds"), 148 + (std::uint64_t{2} << 30));
  follow(Cure::crop, {"encode", "-o", "x.gic", "large.dds"},
         {{"crop", "--origin", "0,0,0", "--size", "2x1x1", "-o", "in", "large.dds"},
          {"encode", "-o", "x.gic", "in"}});
  expect_back();
}

TEST_F(CliCures, Containers) {
  write("in/a.exr", foreign(Format::R16_SFLOAT));
  const Words encode{"encode", "-o", "x.gic", "in"};
  program_.succeed(encode);
  follow(Cure::decode_first, to_cure(Cure::decode_first, "x.gic"),
         {"encode", "-o", "y.gic", "x.gic"},
         {{"decode", "x.gic", "-o", "DIR"}, {"encode", "-o", "y.gic", "DIR"}});
  expect_back("y.gic");

  write("in/a.exr", foreign(Format::R16_SFLOAT));
  write_bytes(path("notes.txt"), {});
  follow(Cure::name_dumps, {"encode", "-o", "x.gic", "notes.txt"}, {encode});
  write_bytes(path("notes"), std::as_bytes(std::span("notes")));
  follow(Cure::name_container, {"encode", "-o", "notes", "in"}, {encode}, Exit::io);
  fs::remove_all(path("out"));
  program_.succeed({"decode", "x.gic", "-o", "out"});
  follow(Cure::overwrite, {"decode", "x.gic", "-o", "out"},
         {{"decode", "x.gic", "-o", "out", "--overwrite"}}, Exit::io);
  EXPECT_EQ(file_bytes(path("out/a.exr")), file_bytes(path("in/a.exr")));

  write("in/a.exr.ktx2", foreign(Format::ASTC_4x4_UNORM_BLOCK));
  program_.succeed({"encode", "-o", "x.gic", "in/a.exr.ktx2"});
  follow(Cure::other_files, "--files takes", {"decode", "x.gic", "--files", "dds", "-o", "files"},
         {{"decode", "x.gic", "--files", "ktx2", "-o", "files"}});
  EXPECT_EQ(file_bytes(path("files/a.exr.ktx2")), file_bytes(path("in/a.exr.ktx2")));
}

TEST_F(CliCures, Codes) {
  Dump black = without_alpha(foreign(Format::R32G32B32A32_SFLOAT));
  std::ranges::fill(black.texels, std::byte{0});
  write("in/black.exr", black);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  follow(Cure::as_floats, to_cure(Cure::as_floats, "R32G32B32A32_SFLOAT"),
         {"decode", "x.gic", "--files", "dds", "-o", "dds"},
         {{"encode", "-o", "y.gic", "in", "--vk-format", "R32G32B32A32_SFLOAT"},
          {"decode", "y.gic", "--files", "dds", "-o", "dds"},
          {"compare", "in/black.exr", "dds/black.dds"}});
  expect_back();
}

TEST_F(CliCures, Memory) {
  write("in/a.exr", foreign(Format::R32G32B32A32_SFLOAT, {512, 512, 1}));
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const Words failing{"decode", "x.gic", "-o", "out", "--max-memory", "1"};
  const std::string said = program_.run(failing).err;
  const auto at = said.find("--max-memory ");
  ASSERT_NE(at, std::string::npos) << said;
  const std::string much = std::to_string(std::stoi(said.substr(at + 13)));
  follow(Cure::more_memory, to_cure(Cure::more_memory, much), failing,
         {{"decode", "x.gic", "-o", "out", "--max-memory", much}});
  expect_back();
}

TEST_F(CliCures, Frames) {
  if (!kWithImages) GTEST_SKIP() << "without PNG";
  program_.make_dumps(3);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  auto bytes = file_bytes(path("x.gic"));
  bytes.resize(end_of_packets(bytes));
  write_bytes(path("y.gic"), bytes);
  follow(Cure::incomplete, {"preview", "y.gic", "-o", "a.png"},
         {{"preview", "y.gic", "-o", "b.png", "--allow-incomplete"},
          {"decode", "y.gic", "-o", "out", "--allow-incomplete"}});
  EXPECT_EQ(program_.files("out"), program_.files("in"));
}

/// Containers as encode does not write them.
TEST_F(CliCures, OtherContainers) {
  const NamedTexture named{"vis", kVisDesc, {}, {}};
  const auto texels = random_texels(kVisDesc, 1);
  const auto write_container = [&](const ContainerDescription& description, unsigned frames) {
    test::MemorySink sink;
    auto writer = *ContainerWriter::create(sink, description);
    auto encoder = *Encoder::create(kVisDesc, {.backend = "zstd"});
    for (unsigned frame = 0; frame < frames; ++frame) {
      const auto packet = encoder.encode(ConstTextureView(texels), Selection::all());
      ASSERT_EQ(writer.add(frame, *packet), Status::ok);
    }
    ASSERT_EQ(writer.finish(), Status::ok);
    write_bytes(path("x.gic"), sink.bytes);
  };
  const auto expect_texels = [&](const std::string& file) {
    EXPECT_EQ(read_dump(path(file)).texels, texels) << file;
  };
  ContainerDescription description;
  ASSERT_EQ(add_volume(description, "near", *probe_volume({&named, 1})), Status::ok);
  auto stills = description;
  stills.textures[0].metadata = {{"digits", "0"}};
  write_container(stills, 2);
  follow(Cure::one_frame, to_cure(Cure::one_frame, 1), {"decode", "x.gic", "-o", "both"},
         {{"decode", "x.gic", "-o", "one", "--frames", "1"}});
  expect_texels("one/vis.exr");

  auto two = description;
  ASSERT_EQ(add_volume(two, "far", *probe_volume({&named, 1})), Status::ok);
  write_container(two, 1);
  follow(Cure::one_volume, to_cure(Cure::one_volume, "far"), {"decode", "x.gic", "-o", "two"},
         {{"decode", "x.gic", "-o", "far", "--volume", "far"},
          {"decode", "x.gic", "-o", "near", "--volume", "near"}});
  expect_texels("near/vis.0000.exr");

  test::add_unknown_volume(description, "skin", 77, {std::byte{1}});
  write_container(description, 1);
  follow(Cure::other_volume, to_cure(Cure::other_volume, "near"), {"decode", "x.gic", "-o", "skin"},
         {{"decode", "x.gic", "-o", "known", "--volume", "near"}});
  expect_texels("known/vis.0000.exr");
}

TEST_F(CliCures, Originals) {
  program_.make_dumps(1);
  write_bytes(path("off.txt"), std::as_bytes(std::span("3", 1)));
  program_.succeed({"encode", "-o", "x.gic", "--inactive", "off.txt", "in"});
  follow(Cure::other_folder, {"decode", "x.gic", "-o", "in", "--overwrite"},
         {{"decode", "x.gic", "-o", "other", "--overwrite"}}, Exit::io);
  EXPECT_EQ(program_.files("other"), program_.files("in"));
}

TEST_F(CliCures, Metadata) {
  Dump dump = foreign(Format::R16_SFLOAT);
  for (int frame = 0; frame < 3; ++frame) {
    // Of a type that OpenEXR does not read a byte at a time.
    const std::string value(std::size_t{25} << 20, static_cast<char>('a' + frame));
    set_attribute(dump.info.attributes, {"manifest", "blob", "0x" + value});
    write(fmt::format("in/a.{:04}.exr", frame), dump);
  }
  follow(Cure::fewer_frames, {"encode", "-o", "x.gic", "in"},
         {{"encode", "-o", "x.gic", "in/a.0000.exr", "in/a.0001.exr"},
          {"encode", "-o", "y.gic", "in/a.0002.exr"},
          {"decode", "y.gic", "-o", "rest"}});
  EXPECT_EQ(file_bytes(path("rest/a.0002.exr")), file_bytes(path("in/a.0002.exr")));
  fs::remove(path("in/a.0002.exr"));
  expect_back();
}

/// Behind all others.
TEST_F(CliCures, ZEveryRowIsShown) {
  if (!kWithImages) GTEST_SKIP() << "without PNG";
  if (shown().empty()) GTEST_SKIP() << "runs behind the other tests of this suite";
  shown().insert(Cure::play_gaps);  // of gi-server, tests/streaming
  for (int row = 0; row <= static_cast<int>(kLastOwnCure); ++row) {
    const auto cure = static_cast<Cure>(row);
    EXPECT_TRUE(shown().contains(cure)) << cure_text(cure);
  }
}

}  // namespace
}  // namespace gicodec::tools
