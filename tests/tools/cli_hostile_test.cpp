// What files of a mebibyte may cost: whatever they say, `info` takes 256 MB at most, and the other
// commands what they were allowed. What takes more than linear time does not end before ctest ends
// it.
#include "support.h"
#include "tools/cli_support.h"
#include "tools/hostile_containers.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec::tools {
namespace {

class CliHostile : public testing::Test {
 protected:
  /// The program is killed, or fails for want of memory, beyond this.
  [[nodiscard]] Outcome within(std::size_t mebibytes, const std::vector<std::string>& arguments) {
    Circumstances narrow{.kill_when = {}};
    narrow.memory = std::uint64_t{mebibytes} << 20;
    return program_.run_in(narrow, arguments);
  }
  void expect_bounded(const HostileContainer& hostile, const Outcome& outcome,
                      const std::string& refusal) const {
    EXPECT_EQ(outcome.exit, refusal.empty() ? 0 : 3) << hostile.name << outcome.err;
    EXPECT_NE(outcome.err.find(refusal), std::string::npos) << hostile.name << outcome.err;
    EXPECT_LT(outcome.err.size(), 8192U) << hostile.name;
    EXPECT_EQ((outcome.out + outcome.err).find('\x1b'), std::string::npos) << hostile.name;
  }
  static const std::vector<HostileContainer>& containers() {
    static const auto all = hostile_containers();
    return all;
  }

  Program program_;
};

constexpr std::size_t kOfInfo = 256;
constexpr const char* kWantsMemory = "--max-memory";

TEST_F(CliHostile, Info) {
  unsigned turn = 0;
  for (const HostileContainer& hostile : containers()) {
    ASSERT_LE(hostile.bytes.size(), kHostileBytes) << hostile.name;
    write_bytes(program_.path("x.gic"), hostile.bytes);
    // To tell what is in it no texture is needed.
    const std::string refusal = hostile.refusal == kWantsMemory ? "" : hostile.refusal;
    // The first two do all that the others do, which take turns.
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{"--metadata", "--packets", "--verbose"},
                                               {"--packets", "--verbose", "--format", "json"},
                                               {},
                                               {"--format", "json"}}) {
      if (more.size() < 3 && !test::everything() && more.empty() != (turn % 2 == 0)) continue;
      std::vector<std::string> arguments{"info", "x.gic"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      expect_bounded(hostile, within(kOfInfo, arguments), refusal);
    }
    ++turn;
  }
}

TEST_F(CliHostile, CommandsThatDecode) {
  program_.make_dumps(1);
  constexpr std::size_t kAllowed = 64, kBeside = 320;
  for (const HostileContainer& hostile : containers()) {
    // Thousands of files, each of which waits for the disk.
    if (hostile.name == "small packets") continue;
    write_bytes(program_.path("x.gic"), hostile.bytes);
    std::filesystem::remove_all(program_.path("out"));
    const auto run = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.end(), {"--max-memory", std::to_string(kAllowed)});
      return within(kAllowed + kBeside, arguments);
    };
    expect_bounded(hostile, run({"decode", "x.gic", "-o", "out", "--threads", "1"}),
                   hostile.refusal);
    const Outcome verified = run({"verify", "x.gic", "in", "--threads", "1"});
    EXPECT_EQ(verified.exit, hostile.refusal.empty() || hostile.small ? 1 : 3)
        << hostile.name << verified.err;
    // What writes pictures starts threads of its own.
    const Outcome drawn =
        within(2048, {"preview", "x.gic", "-o", "x.png", "--overwrite", "--max-memory", "64"});
    EXPECT_EQ(drawn.exit, hostile.refusal.empty() && !hostile.empty ? 0 : 3)
        << hostile.name << drawn.err;
  }
}

// Each packet costs what its blocks do, whatever the region has.
TEST_F(CliHostile, SmallPacketsOfAGreatRegion) {
  write_bytes(program_.path("x.gic"), small_packets_of_a_great_region());
  const Outcome verified = within(1024, {"verify", "x.gic", "--threads", "1"});
  EXPECT_EQ(verified.exit, 0) << verified.err;
}

/// An EXR header and nothing behind it but a table of zeros.
class Header {
 public:
  Header() { word(20000630).word(2); }
  Header& word(std::uint32_t value) { return raw({reinterpret_cast<const char*>(&value), 4}); }
  Header& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  Header& attribute(std::string_view name, std::string_view type, std::string_view value) {
    const auto size = static_cast<std::uint32_t>(value.size());
    return raw(name).end().raw(type).end().word(size).raw(value);
  }
  Header& channels(std::size_t count, std::uint32_t type) {
    std::string list;
    for (std::size_t i = 0; i < count; ++i) {
      list += fmt::format("c{:03}", i) + std::string(1, '\0');
      for (const std::uint32_t field : {type, 0U, 1U, 1U}) {
        list.append(reinterpret_cast<const char*>(&field), 4);
      }
    }
    return attribute("channels", "chlist", list + std::string(1, '\0'));
  }
  Header& window(std::uint32_t width, std::uint32_t height) {
    std::string box;
    for (const std::uint32_t field : {0U, 0U, width - 1, height - 1}) {
      box.append(reinterpret_cast<const char*>(&field), 4);
    }
    attribute("displayWindow", "box2i", box);
    return attribute("dataWindow", "box2i", box);
  }
  Header& end() { return raw(std::string_view("\0", 1)); }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(bytes_));
  }

 private:
  std::string bytes_;
};

TEST_F(CliHostile, ImagesThatClaimMuch) {
  Header many, attributes, great;
  many.channels(300, 1).window(16, 16).end();
  for (int i = 0; i < 5000; ++i) attributes.attribute(fmt::format("a{}", i), "int", "1234");
  attributes.end();
  great.channels(4, 2).window(16384, 16384).end().raw(std::string(1 << 18, '\1'));
  // OpenEXR would go on behind the four bytes of the number, and take what follows for a header.
  Header hidden, chunk;
  hidden.channels(1, 1).window(16, 16).attribute("a", "int",
                                                 std::string("1234b\0x\0\xff\xff\xff\x7f", 12));
  hidden.end().raw(std::string(4096, '\1'));
  // Few lines, but of a compression that packs many together.
  chunk.channels(4, 2).attribute("compression", "compression", "\x09").window(1 << 18, 1);
  chunk.end().raw(std::string(4096, '\1'));
  const std::vector<std::pair<const Header*, std::string>> cases{
      {&hidden, "attribute a is damaged"},
      {&chunk, "claims 1073741824 bytes of samples"},
      {&many, "more than 256 channels"},
      {&attributes, "more than 4096 attributes"},
      {&great, "claims 4294967296 bytes of samples"}};
  for (const auto& [header, refusal] : cases) {
    write_bytes(program_.path("a.exr"), header->bytes());
    write_bytes(program_.path("b.exr"), header->bytes());
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"compare", "a.exr", "b.exr"},
             {"crop", "--origin", "0,0,0", "--size", "1x1x1", "-o", "out", "a.exr"},
             {"encode", "-o", "x.gic", "--threads", "1", "a.exr"},
             {"preview", "a.exr", "-o", "a.png"}}) {
      const Outcome outcome = within(kOfInfo, command);
      EXPECT_EQ(outcome.exit, 3) << command[0] << outcome.err;
      EXPECT_NE(outcome.err.find(refusal), std::string::npos) << command[0] << outcome.err;
    }
  }
}

TEST_F(CliHostile, ListsOfProbesWithoutEnd) {
  program_.make_dumps(1);
  const Outcome outcome =
      within(512, {"encode", "-o", "x.gic", "--threads", "1", "--inactive", "/dev/zero", "in"});
  EXPECT_EQ(outcome.exit, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("/dev/zero: has more than"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace gicodec::tools
