// Containers that encode does not write: other kinds, kinds of the future, volumes that are cut
// into regions, errors that are told, files that grow.
#include "tools/volume_files.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <limits>

namespace gicodec::tools {
namespace {

class CliVolumes : public VolumeFiles {};

TEST_F(CliVolumes, KindsThatAreNotKnownAreListedAndChecked) {
  add_probes("near", "vis");
  add_future("skin");
  const auto bytes = write("x.gic");
  const std::string unknown = "volume skin is of kind 77, which this program does not know";
  const std::string checked = unknown + ": its packets were checked, not decoded";
  expect_parts(program_.succeed({"info", "x.gic", "--verbose", "--packets"}).out,
               {"2 volumes, 2 textures", "volume near: probes, grid 4x2x3",
                "volume skin: unknown kind 77", checked, "texture surfels\n"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(json["volumes"][0]["kind"], "probes");
  EXPECT_EQ(json["volumes"][1]["kind"], nullptr);
  EXPECT_EQ(json["volumes"][1]["kind_number"], 77);
  EXPECT_EQ(json["textures"][1]["all"]["packets"], 2);
  EXPECT_EQ(json["texture_bytes"], nullptr) << "those of the other volume alone";
  EXPECT_EQ(json["ratio"], nullptr);
  EXPECT_FALSE(json["textures"][1].contains("format"));
  expect_parts(program_.succeed({"verify", "x.gic"}).out,
               {unknown + ": its 2 packets were checked, not decoded", "2 frames are sound"});

  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out"},
                          {unknown, "--volume near takes another volume alone"});
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out", "--volume", "skin"},
                          {unknown, "\"gicodec verify\" checks its packets"});
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out", "--volume", "far"},
                          {"has no volume far, only near, skin"});
  program_.expect_failure(Exit::bad_input,
                          {"preview", "x.gic", "-o", "a.png", "--texture", "surfels"},
                          {unknown, "\"gicodec info\" lists it"});
  program_.succeed({"preview", "x.gic", "-o", "a.png"});
  program_.succeed({"decode", "x.gic", "-o", "out", "--volume", "near"});
  EXPECT_EQ(program_.files("out").size(), 2U);
  expect_probes_in("out", "vis");
  expect_parts(program_.succeed({"verify", "x.gic", "out"}).out,
               {"2 of 2 files in 2 frames are bit-exact", unknown});

  // A bit of a packet that nothing decodes.
  auto damaged = bytes;
  damaged[end_of_packets(bytes) - 40] ^= std::byte{1};
  write_bytes(program_.path("bad.gic"), damaged);
  program_.expect_failure(Exit::bad_input, {"verify", "bad.gic"}, {"bad.gic"});
  program_.expect_failure(Exit::bad_input, {"info", "bad.gic"}, {"bad.gic"});
}

TEST_F(CliVolumes, NothingButAnUnknownKind) {
  add_future("");
  write("x.gic");
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out"},
                          {"volume 0 is of kind 77", "\"gicodec verify\""});
  program_.expect_failure(Exit::bad_input, {"preview", "x.gic", "-o", "a.png"},
                          {"volume 0 is of kind 77"});
  // Nothing is said of what only the kind tells: how many blocks "all" are, and their bytes.
  const Outcome info = program_.succeed({"info", "x.gic", "--packets"});
  for (const char* unknown : {":1", "bytes of textures", " 0 blocks", " 0 full"}) {
    EXPECT_EQ(info.out.find(unknown), std::string::npos) << info.out;
  }
  expect_parts(info.out, {"bytes per frame", "payload; all blocks, zstd"});
  const auto json = nlohmann::json::parse(
      program_.succeed({"info", "x.gic", "--packets", "--format", "json"}).out);
  const auto& keyframes = json["textures"][0]["keyframes"];
  EXPECT_EQ(keyframes["packets"], 1);
  for (const char* name : {"blocks", "full_texture_bytes", "record_bytes", "ratio_full",
                           "ratio_records", "bits_per_record"}) {
    EXPECT_EQ(keyframes.at(name), nullptr) << name;
  }
  EXPECT_EQ(json["textures"][0]["packets"][0].at("blocks"), nullptr);
  for (const char* name : {"texture_bytes", "ratio"}) EXPECT_EQ(json.at(name), nullptr) << name;
  const Outcome verified = program_.succeed({"verify", "x.gic"});
  expect_parts(verified.out, {"2 frames are sound\n"});
  EXPECT_EQ(verified.out.find("dumps"), std::string::npos) << verified.out;
}

TEST_F(CliVolumes, IrradianceVectors) {
  add_vectors("hall");
  description_.volumes[0].geometry = {{3, 2, 2}, {1, 2, 3}, {0.5F, 0.5F, 2}, {0, -1, 4}};
  description_.epoch = 1234;
  description_.scene = {"hall of tests", 0xABCD};
  write("x.gic");
  expect_parts(program_.succeed({"info", "x.gic"}).out,
               {"volume hall: irradiance_vectors, grid 3x2x2",
                "origin 1 2 3, spacing 0.5 0.5 2, scroll 0 -1 4", "epoch 1234",
                "scene hall of tests", "000000000000abcd",
                "texture vectors: 7 bytes: R 9 ufloat, G 9 ufloat, B 9 ufloat, E 5 exponent, "
                "x 8 snorm, y 8 snorm, z 8 snorm, 12 blocks of 6x1, guard band 0"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(json["volumes"][0]["geometry"]["scroll"], (std::vector<int>{0, -1, 4}));
  EXPECT_EQ(json["epoch"], 1234);
  EXPECT_EQ(json["scene"], "hall of tests");
  EXPECT_EQ(json["textures"].size(), 1U);
  EXPECT_EQ(json["textures"][0]["block"], (std::vector<int>{6, 1, 1}));
  expect_parts(program_.succeed({"verify", "x.gic"}).out,
               {"volume hall: its 2 packets were decoded", "2 frames are sound"});
  const auto verified =
      nlohmann::json::parse(program_.succeed({"verify", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(verified["sound"], true);
  EXPECT_EQ(verified["compared"], false);
  EXPECT_EQ(verified.at("identical"), nullptr);
  EXPECT_EQ(verified["textures"][0]["packets"], 2);
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out"},
                          {"texture vectors of volume hall has records of its kind's own"});
  program_.succeed({"preview", "x.gic", "--texture", "vectors", "-o", "b.png"});
}

TEST_F(CliVolumes, TexturesOfBlocksOfOneRow) {
  add_textures("hall");
  write("x.gic");
  expect_parts(
      program_.succeed({"info", "x.gic"}).out,
      {"volume hall: textures", "texture direction: R8G8B8_SNORM, 12 blocks of 6x1, guard band 0",
       "texture color: E5B9G9R9_UFLOAT_PACK32"});
  expect_parts(program_.succeed({"verify", "x.gic"}).out,
               {"volume hall: its 4 packets were decoded", "2 frames are sound"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  const Dump dump = read_dump(program_.path("out/color.0001.exr"));
  EXPECT_EQ(dump.texels, contents(description_.textures[1].desc, 1));
  EXPECT_EQ(dump.info.desc.block, (BlockShape{6, 1, 1}));
  expect_parts(program_.succeed({"verify", "x.gic", "out"}).out, {"4 of 4 files"});
  program_.succeed({"preview", "x.gic", "--texture", "color", "-o", "b.png"});
#ifdef DDGI_RENDER
  const std::vector<std::string> refused = {"x.gic", "volume hall is of kind textures",
                                            "which is not drawn",
                                            "\"gicodec decode\" makes dumps of it"};
  const Outcome drawn =
      program_.run_in({.program = DDGI_RENDER, .kill_when = {}},
                      {"--scene", "villa", "--stream", "x.gic", "--frame", "1", "-o", "a.png"});
  EXPECT_EQ(drawn.exit, static_cast<int>(Exit::bad_input));
  expect_parts(drawn.err, refused);
#endif
}

// Not its checksums, but what it builds on: only decoding finds that.
TEST_F(CliVolumes, VerifyDecodes) {
  add_vectors("hall");
  test::MemorySink sink;
  auto writer = ContainerWriter::create(sink, description_);
  const TextureDesc& desc = description_.textures[0].desc;
  auto encoder = Encoder::create(desc, {.backend = "zstd"});
  (void)encoder->encode(ConstTextureView(contents(desc, 0)));
  ASSERT_EQ(writer->add(1, *encoder->encode(ConstTextureView(contents(desc, 1)))), Status::ok);
  ASSERT_EQ(writer->finish(), Status::ok);
  write_bytes(program_.path("x.gic"), sink.bytes);
  program_.succeed({"info", "x.gic"});
  program_.expect_failure(Exit::bad_input, {"verify", "x.gic"}, {"frame 1", "texture vectors"});
}

TEST_F(CliVolumes, RegionsComeBackAsOneTexture) {
  add_probes("near", "vis", {3, 1, 2});
  const auto bytes = write("x.gic");
  expect_parts(program_.succeed({"info", "x.gic", "--packets"}).out,
               {"grid 4x2x3, cut into regions of 3x1x2", "region    7"});
  const auto json = nlohmann::json::parse(
      program_.succeed({"info", "x.gic", "--packets", "--format", "json"}).out);
  EXPECT_EQ(json["volumes"][0]["region"], (std::vector<int>{3, 1, 2}));
  EXPECT_EQ(json["textures"][0]["packets"][7]["region"], 7);
  EXPECT_EQ(json["textures"][0]["keyframes"]["blocks"], 24);
  EXPECT_EQ(json["textures"][0]["keyframes"]["full_texture_bytes"], texture_bytes(kVisDesc));
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_probes_in("out", "vis");
  program_.succeed({"verify", "x.gic", "out"});
  program_.succeed({"preview", "x.gic", "--frame", "1", "-o", "a.png"});
  program_.succeed({"preview", "out/vis.0001.exr", "-o", "b.png"});
  EXPECT_EQ(file_bytes(program_.path("a.png")), file_bytes(program_.path("b.png")));
  program_.succeed({"decode", "x.gic", "-o", "late", "--frames", "1"});
  EXPECT_EQ(file_bytes(program_.path("late/vis.0001.exr")),
            file_bytes(program_.path("out/vis.0001.exr")));
}

// Recordings do not say what files they are of: whole volumes and such in regions, probes and
// others.
TEST_F(CliVolumes, RecordingsBecomeAnyKindOfFile) {
  add_probes("near", "vis", {3, 1, 2});
  add_textures("hall");
  write("x.gic");
  for (const std::string ending : {"exr", "ktx2", "raw"}) {
    const std::string out = program_.path(ending) + "/";
    const Outcome decoded = program_.succeed({"decode", "x.gic", "-o", ending, "--files", ending});
    EXPECT_EQ(decoded.err.find("attributes"), std::string::npos) << decoded.err;
    EXPECT_EQ(program_.files(ending).size(), ending == "raw" ? 12U : 6U);
    for (unsigned frame = 0; frame < 2; ++frame) {
      const Dump vis = read_dump(out + fmt::format("vis.{:04}.{}", frame, ending));
      EXPECT_EQ(vis.info.desc, kVisDesc);
      EXPECT_EQ(vis.texels, contents(kVisDesc, frame));
      const TextureDesc& desc = description_.textures[2].desc;
      EXPECT_EQ(read_dump(out + fmt::format("color.{:04}.{}", frame, ending)).texels,
                contents(desc, frame));
    }
  }
  program_.succeed({"decode", "x.gic", "-o", "usual"});
  program_.succeed({"compare", "usual", "exr"});
  // DDS has no format of three bytes a record.
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "dds", "--files", "dds"},
                          {"x.gic: texture direction is of format R8G8B8_SNORM, which dds files "
                           "cannot have; --files takes exr, ktx2, raw for it"});
  expect_parts(
      program_.succeed({"decode", "x.gic", "-o", "dds", "--files", "dds", "--volume", "near"}).err,
      {"texture vis: dds files do not have its attributes gicodec:border"});
  const Dump dump = read_dump(program_.path("dds/vis.0001.dds"), hints_of(kVisDesc));
  EXPECT_EQ(dump.texels, contents(kVisDesc, 1));
  program_.expect_failure(Exit::io, {"decode", "x.gic", "-o", "raw", "--files", "raw"},
                          {"raw/vis.0000.", "exists", "--overwrite"});
  program_.succeed({"decode", "x.gic", "-o", "raw", "--files", "raw", "--overwrite"});
  program_.expect_failure(Exit::usage, {"decode", "x.gic", "-o", "out", "--files", "png"},
                          {"--files", "exr,dds,ktx2,raw"});
}

// A keyframe brings a block, and takes back those that packets before it brought.
TEST_F(CliVolumes, KeyframesOfRegionsTakeBlocksBack) {
  const Grid size{3, 1, 2};
  add_probes("near", "vis", size);
  const TextureDesc part = region_texture(kVisDesc, size, 0);
  const auto texels = random_texels(part, 3);
  test::MemorySink sink;
  auto writer = ContainerWriter::create(sink, description_);
  auto decoder = Decoder::create(part);
  std::vector<std::vector<std::byte>> wanted;
  for (const std::uint32_t frame : {0U, 1U}) {
    auto encoder = Encoder::create(part, {.backend = "zstd"});
    const std::vector<std::uint32_t> brought{2 * frame + 1, 2 * frame + 2};
    const auto packet = encoder->encode(ConstTextureView(texels), Selection(brought));
    ASSERT_EQ(writer->add(frame, *packet, 0), Status::ok);
    ASSERT_EQ(decoder->decode(*packet), Status::ok);
    ASSERT_EQ(decoder->read(TextureView{wanted.emplace_back(texels.size())}), Status::ok);
  }
  ASSERT_NE(wanted[0], wanted[1]);
  ASSERT_EQ(writer->finish(), Status::ok);
  write_bytes(program_.path("x.gic"), sink.bytes);
  program_.succeed({"decode", "x.gic", "-o", "out"});
  for (std::uint32_t frame = 0; frame < 2; ++frame) {
    const Dump dump = read_dump(program_.path(fmt::format("out/vis.{:04}.exr", frame)));
    EXPECT_EQ(cut(kVisDesc, size, 0, dump.texels), wanted[frame]) << frame;
    for (std::uint32_t other = 1; other < regions_of(kVisDesc, size).regions(); ++other) {
      const auto got = cut(kVisDesc, size, other, dump.texels);
      EXPECT_EQ(got, std::vector<std::byte>(got.size())) << frame << " " << other;
    }
  }
}

TEST_F(CliVolumes, ErrorsThatAreToldAreShown) {
  add_probes("near", "vis");
  description_.textures[0].largest_error = 3;
  write("x.gic");
  expect_parts(program_.succeed({"info", "x.gic"}).out, {"LOSSY (off by at most 3)"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  EXPECT_EQ(json["textures"][0]["largest_error"], 3);
  EXPECT_EQ(json["textures"][0]["lossy"], true);
  // What comes out of it says so as well, and what is made of that.
  EXPECT_NE(program_.succeed({"decode", "x.gic", "-o", "out"}).err.find("off by at most 3"),
            std::string::npos);
  program_.succeed({"encode", "-o", "y.gic", "out"});
  expect_parts(program_.succeed({"info", "y.gic"}).out, {"LOSSY (off by at most 3)"});
  description_.textures[0].largest_error = std::numeric_limits<float>::infinity();
  write("x.gic");
  expect_parts(program_.succeed({"info", "x.gic"}).out, {"LOSSY (by how much is unknown)"});
}

TEST_F(CliVolumes, FilesThatGrowSaySo) {
  add_probes("near", "vis");
  std::FILE* file = std::fopen(program_.path("x.gic").c_str(), "wb");
  FileSink sink(file);
  auto writer = ContainerWriter::create(sink, description_);
  auto encoder = Encoder::create(kVisDesc);
  const auto info = [&] { return program_.run({"info", "x.gic"}); };
  for (unsigned frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(writer->add(frame, *encoder->encode(ConstTextureView(contents(kVisDesc, frame)))),
              Status::ok);
    if (frame == 1) {
      ASSERT_EQ(writer->flush(), Status::ok);
    }
    const Outcome growing = info();
    EXPECT_EQ(growing.exit, static_cast<int>(Exit::bad_input));
    expect_parts(growing.out, {fmt::format("{} frame", frame + 1), "WITHOUT ITS END"});
    expect_parts(growing.err, {"its end is missing (cut off, or still being written)",
                               fmt::format("it holds frames 0-{}", frame)});
    const Outcome json = program_.run({"info", "x.gic", "--allow-incomplete", "--format", "json"});
    EXPECT_EQ(json.exit, 0);
    EXPECT_EQ(nlohmann::json::parse(json.out)["finished"], false);
  }
  ASSERT_EQ(writer->finish(), Status::ok);
  std::fclose(file);
  const Outcome whole = info();
  EXPECT_EQ(whole.exit, 0);
  EXPECT_EQ(whole.out.find("WITHOUT ITS END"), std::string::npos);
}

// One volume per grid, whatever the order of the files.
TEST_F(CliVolumes, EncodeGroupsTexturesByGrid) {
  std::filesystem::create_directories(program_.path("in"));
  const TextureDesc wide = ddgi_visibility({5, 2, 3});
  for (const auto& [name, desc] : {std::pair("a", kVisDesc), {"b", wide}, {"c", kColourDesc}}) {
    const Dump dump = random_dump(desc, 1);
    write_dump(program_.path(fmt::format("in/{}.0000.exr", name)), dump.info, dump.texels);
  }
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  ASSERT_EQ(json["volumes"].size(), 2U);
  EXPECT_EQ(json["volumes"][0]["name"], "4x2x3");
  EXPECT_EQ(json["volumes"][0]["textures"], 2);
  EXPECT_EQ(json["textures"][1]["name"], "c");
  EXPECT_EQ(json["textures"][2]["volume"], 1);
  program_.succeed({"verify", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "out", "--volume", "5x2x3"});
  EXPECT_EQ(program_.files("out"), std::vector<std::string>{"b.0000.exr"});
}

// A record of three bytes, by the default and others.
TEST_F(CliVolumes, RecordsOfAnySize) {
  std::filesystem::create_directories(program_.path("in"));
  const Dump dump = random_dump(probe_texture(Format::R8G8B8_SNORM, {2, 2, 2}, 4), 1);
  write_dump(program_.path("in/n.0000.exr"), dump.info, dump.texels);
  for (const std::string backend : {"native", "zstd"}) {
    program_.succeed({"encode", "-o", backend + ".gic", "--backend", backend, "in"});
    program_.succeed({"verify", backend + ".gic", "in"});
  }
}

}  // namespace
}  // namespace gicodec::tools
