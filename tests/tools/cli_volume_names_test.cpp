// Volumes and textures of the same names and of any, and the files that they decode to.
#include "tools/volume_files.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <random>
#include <set>

namespace gicodec::tools {
namespace {

class CliVolumeNames : public VolumeFiles {};

TEST_F(CliVolumeNames, VolumesOfTheSameTextures) {
  add_probes("near", "vis");
  add_probes("far", "vis");
  write("x.gic");
  program_.succeed({"info", "x.gic"});
  program_.succeed({"verify", "x.gic"});
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out"},
                          {"files of the same names", "--volume far takes one volume alone"});
  program_.succeed({"decode", "x.gic", "-o", "out", "--volume", "1"});
  expect_probes_in("out", "vis");
  program_.expect_failure(Exit::bad_input, {"verify", "x.gic", "out"}, {"--volume"});
  program_.succeed({"verify", "x.gic", "out", "--volume", "near"});
}

// Numbers take what names do not tell apart, also where a number is another one's name.
TEST_F(CliVolumeNames, VolumesOfTheSameName) {
  for (const char* name : {"same", "same", "1"}) add_probes(name, "vis");
  write("x.gic");
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out"},
                          {"--volume 01 takes one volume alone, by its number"});
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "-o", "out", "--volume", "same"},
                          {"2 volumes are called same", "its number, 0 to 2"});
  program_.expect_failure(Exit::bad_input, {"verify", "x.gic", "--volume", "3"},
                          {"has no volume 3, only 0, 01, 1"});
  expect_parts(program_.succeed({"info", "x.gic"}).out,
               {"volume same (--volume 0): probes", "volume same (--volume 01): probes",
                "volume 1: probes"});
  for (const char* volume : {"0", "01", "1", "2"}) {
    program_.succeed({"decode", "x.gic", "-o", volume, "--volume", volume});
    expect_probes_in(volume, "vis");
  }
}

TEST_F(CliVolumeNames, TexturesOfAnyName) {
  const std::string longest(255, 'x');
  const std::map<std::string, std::string> stems{
      {"sky/light", "sky%2Flight"},
      {"sky%2Flight", "sky%252Flight"},
      {"..", "%2E."},
      {"a\nb", "a%0Ab"},
      {std::string("\0", 1), "%00"},
      {"\u202Eback", "%E2%80%AEback"},
      {"CON", kWindows ? "%43ON" : "CON"},
      {"a:b", kWindows ? "a%3Ab" : "a:b"},
      {"50% + %41", kWindows ? "50% + %2541" : "50% + %41"},
      {"%-", "%25-"},
      {"--output=x", "--output=x"},
      {longest, std::string(222, 'x') + "%~2be953982ac8bd9d"}};
  for (const auto& [name, stem] : stems) add_probes(name, name);
  write("x.gic");
  const std::string text = program_.succeed({"info", "x.gic", "--verbose", "--packets"}).out;
  expect_parts(text, {"texture sky/light: ", "texture a\\x0ab: ", "files a%0Ab.0000.exr"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "x.gic", "--format", "json"}).out);
  for (std::size_t i = 0; i < description_.textures.size(); ++i) {
    EXPECT_EQ(json["textures"][i]["name"], description_.textures[i].name);
    EXPECT_EQ(json["volumes"][i]["name"], description_.volumes[i].name);
  }
  expect_parts(program_.succeed({"verify", "x.gic"}).out, {"2 frames are sound"});
  program_.succeed({"preview", "x.gic", "--texture", "sky/light", "-o", "a.png"});
  program_.succeed({"preview", "x.gic", "--volume", "a\nb", "-o", "b.png"});
  expect_parts(program_.succeed({"decode", "x.gic", "-o", "out"}).err,
               {"texture sky/light: its files are named sky%2Flight, since",
                "texture a\\x0ab: its files are named a%0Ab, since"});
  EXPECT_EQ(program_.files("out").size(), 2 * stems.size());
  for (const auto& [name, stem] : stems) expect_probes_in("out", stem);
  expect_parts(program_.succeed({"verify", "x.gic", "out"}).out,
               {fmt::format("{0} of {0} files", 2 * stems.size())});
  program_.succeed({"decode", "x.gic", "-o", "raw", "--files", "raw"});
  EXPECT_EQ(program_.files("raw").size(), 4 * stems.size()) << "some lack sidecars";
  program_.succeed({"decode", "x.gic", "-o", "one", "--volume", ".."});
  EXPECT_EQ(program_.files("one").size(), 2);

  // What is packed again has the names again, unless they are too long.
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "y.gic", "out"}, {"rename its dumps"});
  for (const std::string& file : program_.files("out"))
    if (file.starts_with("xxx")) std::filesystem::remove(program_.path("out/" + file));
  program_.succeed({"encode", "-o", "y.gic", "out"});
  std::set<std::string> names;
  const auto again =
      nlohmann::json::parse(program_.succeed({"info", "y.gic", "--format", "json"}).out);
  for (const auto& texture : again["textures"]) names.insert(texture["name"]);
  EXPECT_EQ(names.size(), stems.size() - 1);
  for (const std::string& name : names) EXPECT_TRUE(stems.contains(name)) << name;
  program_.succeed({"decode", "y.gic", "-o", "again"});
  program_.succeed({"compare", "out", "again"});
}

// Some file systems have no two files whose names differ in case alone.
TEST_F(CliVolumeNames, NamesThatDifferInCase) {
  add_probes("one", "sky");
  add_probes("other", "Sky");
  write("x.gic");
  const Outcome outcome = program_.run({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(outcome.exit, kWindows ? static_cast<int>(Exit::bad_input) : 0) << outcome.err;
  if (kWindows) expect_parts(outcome.err, {"textures sky and Sky have files of the same names"});
  EXPECT_EQ(program_.files("out").size(), kWindows ? 0U : 4U);
}

// Different names, however much they look like escapes, have different files, and come back.
TEST_F(CliVolumeNames, NamesOfFilesLeadBackToTextures) {
  const std::vector<std::string> parts{"%", "2",  "F",     kWindows ? "g" : "f", "/", ".", "~", "-",
                                       "a", "\n", "\u20AC"};
  std::minstd_rand random(7);
  std::set<std::string> names;
  while (names.size() < 60) {
    std::string name;
    for (auto left = 1 + random() % 6; left > 0; --left) name += parts[random() % parts.size()];
    name += 'x';  // so that no number ends it
    if (names.insert(name).second) add_probes("", name);
  }
  write("x.gic");
  program_.succeed({"decode", "x.gic", "-o", "out"});
  EXPECT_EQ(program_.files("out").size(), 2 * names.size());
  program_.succeed({"verify", "x.gic", "out"});
  program_.succeed({"encode", "-o", "y.gic", "out"});
  const auto json =
      nlohmann::json::parse(program_.succeed({"info", "y.gic", "--format", "json"}).out);
  for (const auto& texture : json["textures"]) names.erase(texture["name"]);
  EXPECT_EQ(names, std::set<std::string>());
}

}  // namespace
}  // namespace gicodec::tools
