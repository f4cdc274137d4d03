// Containers that are cut off, damaged or hostile.
#include "container_support.h"
#include "tools/cli_support.h"

#include <gicodec/gicodec.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>

namespace gicodec::tools {
namespace {

class CliBadContainer : public testing::Test {
 protected:
  void SetUp() override {
    program_.make_dumps(4);
    program_.succeed({"encode", "-o", "x.gic", "in"});
    bytes_ = file_bytes(program_.path("x.gic"));
  }
  void cut(std::size_t size) {
    write_bytes(program_.path("cut.gic"), std::span(bytes_).first(size));
    std::filesystem::remove_all(program_.path("out"));
  }
  [[nodiscard]] std::size_t end_of_first_packet() const {
    MemorySource source(bytes_);
    ContainerPacket packet;
    EXPECT_EQ(ContainerReader::open(source)->next(packet), Status::ok);
    const auto at =
        std::search(bytes_.begin(), bytes_.end(), packet.bytes.begin(), packet.bytes.end());
    return static_cast<std::size_t>(at - bytes_.begin()) + packet.bytes.size();
  }

  Program program_;
  std::vector<std::byte> bytes_;
};

TEST_F(CliBadContainer, CutAnywhere) {
  for (std::size_t i = 0; i < 16; ++i) {
    const std::size_t size = bytes_.size() * i / 16;
    cut(size);
    const Outcome decoded = program_.run({"decode", "cut.gic", "-o", "out"});
    EXPECT_EQ(decoded.exit, 3) << size << decoded.err;
    EXPECT_NE(decoded.err.find("cut.gic"), std::string::npos) << decoded.err;
    // Whatever was recovered is right.
    for (const std::string& name : program_.files("out")) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)))
          << name << " at " << size;
    }
    EXPECT_EQ(program_.run({"info", "cut.gic"}).exit, 3);
    EXPECT_EQ(program_.run({"verify", "cut.gic", "in"}).exit, 3);
  }
}

TEST_F(CliBadContainer, CutTailIsRecovered) {
  cut(bytes_.size() - 1);
  const Outcome strict = program_.run({"decode", "cut.gic", "-o", "out"});
  EXPECT_EQ(strict.exit, 3);
  EXPECT_NE(
      strict.err.find("its end is missing (cut off, or still being written): it holds frames 0-3 "
                      "of frames 0-3; 4 frames before the cut were recovered"),
      std::string::npos)
      << strict.err;
  program_.succeed({"compare", "in", "out"});
  program_.succeed({"decode", "cut.gic", "-o", "out2", "--allow-incomplete"});
  EXPECT_NE(program_.succeed({"info", "cut.gic", "--allow-incomplete"}).out.find("WITHOUT ITS END"),
            std::string::npos);
}

TEST_F(CliBadContainer, DamagedAnywhere) {
  for (std::size_t i = 0; i < 32; ++i) {
    auto damaged = bytes_;
    damaged[bytes_.size() * i / 32] ^= std::byte{0x10};
    write_bytes(program_.path("bad.gic"), damaged);
    std::filesystem::remove_all(program_.path("out"));
    const Outcome decoded = program_.run({"decode", "bad.gic", "-o", "out"});
    // The seek index only helps finding frames; damage in it may go unnoticed.
    EXPECT_TRUE(decoded.exit == 3 || (decoded.exit == 0 && i >= 31)) << i << decoded.err;
    const auto files = program_.files("out");
    for (const std::string& name : files) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)));
    }
    EXPECT_EQ(std::filesystem::exists(program_.path("out")), !files.empty()) << i;
  }
}

TEST_F(CliBadContainer, InfoShowsWhatIsWhole) {
  auto damaged = bytes_;
  damaged[end_of_packets(bytes_) - 40] ^= std::byte{1};
  write_bytes(program_.path("bad.gic"), damaged);
  const Outcome text = program_.run({"info", "bad.gic"});
  EXPECT_EQ(text.exit, 3);
  EXPECT_NE(text.out.find("color"), std::string::npos) << text.out;
  EXPECT_NE(text.err.find("after frame 3"), std::string::npos) << text.err;
  EXPECT_NE(text.err.find("decode bad.gic --frames 0-2 -o"), std::string::npos) << text.err;
  program_.succeed({"decode", "bad.gic", "--frames", "0-2", "-o", "out"});
  const Outcome verified = program_.run({"verify", "bad.gic", "in", "--format", "json"});
  EXPECT_EQ(verified.exit, 3);
  EXPECT_NE(verified.out.find("\"damage\": \"bad.gic: in or after frame 3"), std::string::npos);
  const Outcome json = program_.run({"info", "bad.gic", "--format", "json"});
  EXPECT_EQ(json.exit, 3);
  EXPECT_NE(json.out.find("\"damage\": \"bad.gic: in or after frame 3"), std::string::npos)
      << json.out;
}

// What is left is named with the command that gives it back, and compared with its own bytes.
TEST_F(CliBadContainer, InfoNamesTheCure) {
  const auto ratio_of_packets = [&](const std::string& name) {
    const auto json = nlohmann::json::parse(program_.run({"info", name, "--format", "json"}).out);
    EXPECT_EQ(json["ratio_files"], nullptr);
    EXPECT_NEAR(json["ratio"].get<double>(),
                json["texture_bytes"].get<double>() / json["packet_bytes"].get<double>(), 1e-9);
    return json["frames"].get<int>();
  };
  // In the second packet, so that nothing but a texture of frame 0 is left.
  const std::size_t first = end_of_first_packet();
  auto damaged = bytes_;
  damaged[first + 100] ^= std::byte{1};
  write_bytes(program_.path("bad.gic"), damaged);
  const Outcome bad = program_.run({"info", "bad.gic"});
  EXPECT_EQ(bad.exit, 3);
  EXPECT_NE(bad.err.find("\"gicodec decode bad.gic -o DIR\" gives back what comes before"),
            std::string::npos)
      << bad.err;
  EXPECT_EQ(ratio_of_packets("bad.gic"), 1);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"decode", "bad.gic", "-o", "out"}, {"verify", "bad.gic"}}) {
    const Outcome outcome = program_.run(command);
    EXPECT_EQ(outcome.exit, 3);
    EXPECT_NE(outcome.err.find("in or after frame 0: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("; \"gicodec decode bad.gic -o DIR\" gives back what comes before"),
              std::string::npos)
        << outcome.err;
  }
  EXPECT_EQ(program_.files("out"), std::vector<std::string>{"color.0000.exr"});

  cut(first + 100);
  for (const char* command : {"info", "verify"}) {
    const Outcome outcome = program_.run({command, "cut.gic"});
    EXPECT_EQ(outcome.exit, 3);
    EXPECT_NE(outcome.err.find("\"gicodec decode cut.gic --allow-incomplete -o DIR\""),
              std::string::npos)
        << outcome.err;
  }
  EXPECT_EQ(ratio_of_packets("cut.gic"), 1);
  program_.succeed({"decode", "cut.gic", "--allow-incomplete", "-o", "out2"});
  EXPECT_EQ(program_.files("out2"), std::vector<std::string>{"color.0000.exr"});

  // Before the first packet ends.
  damaged = bytes_;
  damaged[first - 100] ^= std::byte{1};
  write_bytes(program_.path("bad.gic"), damaged);
  program_.expect_failure(Exit::bad_input, {"info", "bad.gic"},
                          {"before the first frame", "nothing can be given back; get it again"});
}

TEST_F(CliBadContainer, NoContainer) {
  write_bytes(program_.path("text"), std::vector<std::byte>(64));
  program_.expect_failure(Exit::bad_input, {"info", "text"}, {"is not a .gic container"});
  program_.expect_failure(Exit::io, {"info", "absent.gic"}, {"absent.gic", "No such file"});
  write_bytes(program_.path("empty.gic"), {});
  program_.expect_failure(Exit::bad_input, {"info", "empty.gic"}, {"empty.gic"});
}

/// A container of one frame with such an entry.
void write_container(const std::string& path, const test::ProbeTexture& texture) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  FileSink sink(file);
  auto writer = ContainerWriter::create(sink, test::probe_description({&texture, 1}));
  ASSERT_TRUE(writer.ok());
  auto encoder = Encoder::create(texture.desc);
  const auto texels = random_texels(texture.desc, 1);
  const auto packet = encoder->encode(ConstTextureView(texels));
  ASSERT_EQ(writer->add(3, *packet), Status::ok);
  ASSERT_EQ(writer->finish(), Status::ok);
  std::fclose(file);
}

TEST_F(CliBadContainer, HostileMetadata) {
  const std::string path = program_.path("bad.gic");
  for (const std::string name : {"../../escape", "/tmp/escape", "a/b", "a\nb", ".hidden",
                                 "a\xc2\x9b"
                                 "31m"}) {
    write_container(path, {name, kVisDesc});
    const auto before = program_.files();
    const std::string folder = fmt::format("in-{}", before.size());
    program_.succeed({"decode", "bad.gic", "-o", folder, "--overwrite"});
    EXPECT_EQ(program_.files(folder).size(), 1U) << "outside of the folder, or hidden in it";
    std::filesystem::remove_all(program_.path(folder));
    EXPECT_EQ(program_.files(), before);
  }
  for (const auto& [key, value] : std::vector<std::pair<std::string, std::string>>{
           {"digits", "19"},
           {"digits", "-1"},
           {"digits", "99999999999"},
           {"extension", ".x"},
           {"extension", "json"},
           {"extension", "3/"},
           {"attribute@99999999999999999999:a", "int 1"},
           {"file bytes", "99999999999999999999"},
           {"digits", "4x"},
           {"extension", "/../../x"},
           {"channels", "R:HALF"},
           {"separator", "/"},
           {"channel:R", ""},
           {"channel:Z", "x"},
           {"file bytes", "-1"},
           {"channels", "R:HALF G:HALF B:HALF"},
           {"inactive", "0-99"},
           {"inactive", "5,5"},
           {"inactive", "x"},
           {"slots", "2x2x2"},
           {"slots", "99999x99999x99999"},
           {"padding", "0 0"},
           {"padding", "1"},
           {"padding", "9 9"},
           {"padding", "300 1"},
           {"attribute:a", "int 12 34"},
           {"attribute:a", "preview 0x"},
           {"attribute:dataWindow", "box2i 0x00"},
           {"attribute:compression", "compression 0x"},
           {"attribute:", "int 1"},
           {"attribute@x:a", "int 1"},
           {"attribute@3:a", "v3f 1"}}) {
    write_container(path, {"vis", kVisDesc, {{key, value}}});
    program_.expect_failure(Exit::bad_input, {"decode", "bad.gic", "-o", "."}, {});
    if (key.starts_with("attribute")) {
      program_.expect_failure(Exit::bad_input, {"verify", "bad.gic"}, {"attribute"});
    }
  }
  // Heads of files that are of another texture.
  for (const auto& [extension, field, value] : {std::tuple("dds", "dds:header", "bytes 0x00"),
                                                {"dds", "dds:header", "string x"},
                                                {"ktx2", "ktx2:head", "bytes 0xABCD"},
                                                {"ktx2", "ktx2:scheme", "string BasisLZ"},
                                                {"raw", "raw:extent", "v3i 1 2 3"},
                                                {"raw", "raw:extent", "v3i x"}}) {
    write_container(
        path,
        {"vis", kVisDesc, {{"extension", extension}, {std::string("attribute:") + field, value}}});
    program_.expect_failure(Exit::bad_input, {"decode", "bad.gic", "-o", "."}, {field});
  }
}

TEST_F(CliBadContainer, TexturesWithFilesOfTheSameNames) {
  std::FILE* file = std::fopen(program_.path("twice.gic").c_str(), "wb");
  ASSERT_NE(file, nullptr);
  FileSink sink(file);
  const test::ProbeTexture textures[] = {{"vis.", kVisDesc, {{"separator", ""}}},
                                         {"vis", kVisDesc}};
  auto writer = ContainerWriter::create(sink, test::probe_description(textures));
  ASSERT_TRUE(writer.ok());
  ASSERT_EQ(writer->finish(), Status::ok);
  std::fclose(file);
  program_.expect_failure(Exit::bad_input, {"decode", "twice.gic", "-o", "out"},
                          {"vis. and vis", "the same names"});
}

// Of other frames, or a sidecar's.
TEST_F(CliBadContainer, TexturesWhoseFilesMayMeet) {
  using Textures = std::array<test::ProbeTexture, 2>;
  const auto decode = [&](const Textures& textures) {
    std::FILE* file = std::fopen(program_.path("twice.gic").c_str(), "wb");
    FileSink sink(file);
    auto writer = ContainerWriter::create(sink, test::probe_description(textures));
    EXPECT_TRUE(writer.ok());
    EXPECT_EQ(writer->finish(), Status::ok);
    std::fclose(file);
    return program_.run({"decode", "twice.gic", "-o", "out"});
  };
  const auto with = [](std::string extension, std::string digits, std::string separator = ".") {
    return Metadata{{"extension", std::move(extension)},
                    {"digits", std::move(digits)},
                    {"separator", std::move(separator)}};
  };
  for (const Textures& textures :
       {Textures{{{"a", kVisDesc, with("raw", "4")}, {"a.0001", kVisDesc, with("raw", "0")}}},
        Textures{{{"a", kVisDesc, with("raw", "4")}, {"a.00", kVisDesc, with("raw", "2", "")}}},
        Textures{{{"a", kVisDesc, with("exr", "1")}, {"a.1", kVisDesc, with("exr", "3", "")}}}}) {
    const Outcome outcome = decode(textures);
    EXPECT_EQ(outcome.exit, 3) << textures[1].name;
    EXPECT_NE(outcome.err.find("the same names"), std::string::npos) << outcome.err;
  }
  for (const Textures& textures :
       {Textures{{{"a", kVisDesc, with("raw", "4")}, {"a.001", kVisDesc, with("raw", "0")}}},
        Textures{{{"a", kVisDesc, with("raw", "4")}, {"a.0001", kVisDesc, with("exr", "0")}}},
        Textures{{{"a", kVisDesc, with("exr", "4")}, {"a.00", kVisDesc, with("exr", "4", "")}}},
        Textures{{{"foo", kVisDesc, with("raw", "0")}, {"foo1", kVisDesc, with("raw", "0")}}}}) {
    const Outcome outcome = decode(textures);
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("0 files written: it has no frame"), std::string::npos)
        << outcome.err;
  }
}

TEST_F(CliBadContainer, ForeignContainersDecode) {
  write_container(program_.path("other.gic"), {"vis", kVisDesc, {{"unknown", "value"}}});
  program_.succeed({"decode", "other.gic", "-o", "out"});
  const Dump dump = read_dump(program_.path("out/vis.0003.exr"));
  EXPECT_EQ(dump.info.desc, kVisDesc);
  EXPECT_EQ(dump.texels, random_texels(kVisDesc, 1));
}

}  // namespace
}  // namespace gicodec::tools
