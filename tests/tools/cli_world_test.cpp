// Where volumes stand in the world, and what frames stand for: told to encode, shown by info.
#include "common/world.h"
#include "tools/cli_support.h"
#include "tools/dump_support.h"

#include <gicodec/engines.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

class CliWorld : public testing::Test {
 protected:
  CliWorld() {
    const VolumeDesc volume = *three_volume({3, 2, 2});
    std::filesystem::create_directories(program_.path("in"));
    for (unsigned frame = 4; frame < 7; ++frame) {
      const Dump dump = random_dump(textures_of(volume)[0]->desc, frame);
      write_dump(program_.path(fmt::format("in/grid.{:04}.ktx2", frame)), dump.info, dump.texels);
    }
  }
  [[nodiscard]] static Arguments encode(const Arguments& more) {
    return Arguments{"encode", "-o", "x.gic", "--layout", "three", "--grid", "3x2x2", "in"} + more;
  }
  void expect_shown(const std::string& part) {
    const auto shown = program_.succeed({"info", "x.gic"});
    EXPECT_NE(shown.out.find(part), std::string::npos) << part << "\n" << shown.out;
  }

  Program program_;
};

TEST_F(CliWorld, AnEngineSaysWhereItsAxesPoint) {
  program_.succeed(encode({}));
  expect_shown("layout three, axes right up back (right-handed), a unit is 1 m\n");
  program_.succeed(encode(
      {"--axes", "forward,right,up", "--unit", "0.01", "--bounds", "-400,-250.5,0,400,1e3,300"}));
  expect_shown(
      "layout three, axes forward right up (left-handed), a unit is 0.01 m, lights -400 -250.5 0 "
      "to 400 1000 300\n");
}

TEST_F(CliWorld, FramesHaveTimesAndNames) {
  program_.succeed(
      encode({"--state", "6=18:late afternoon", "--state", "4=6", "--state", "5=:lamp: \"on\""}));
  expect_shown("  frame 4 at 6\n  frame 5: lamp: \"on\"\n  frame 6 at 18: late afternoon\n");
  const auto json = program_.succeed({"info", "--format", "json", "x.gic"});
  EXPECT_NE(json.out.find(R"("gicodec:states": "4 6 \n5 - lamp: \"on\"\n6 18 late afternoon")"),
            std::string::npos)
      << json.out;
}

TEST_F(CliWorld, WrongValuesAreNamed) {
  const auto refuse = [&](const Arguments& flags, const std::vector<std::string>& parts) {
    program_.expect_failure(Exit::usage, encode(flags), parts);
  };
  for (const char* axes : {"up", "right,up", "right,left,up", "right,up,back,", "Right,up,back",
                           "right,up,back,down", "x,y,z"}) {
    refuse({"--axes", axes}, {"--axes does not take", axes, "such as right,up,back"});
  }
  for (const char* bounds : {"1", "0,0,0,1,1", "0,0,0,1,1,nan", "0,0,0,1,0,1", "0,0,0,1,1,1,1"}) {
    refuse({"--bounds", bounds}, {"--bounds does not take", bounds});
  }
  std::vector<const char*> states{"4", "4=", "4=:", "=1:a", "4=x:a", "x=1"};
  // Windows has no such arguments.
  if (!kWindows) states.insert(states.end(), {"4=1:a\nb", "4=1:\xff"});
  for (const char* state : states) {
    refuse({"--state", state}, {"--state does not take", "such as 4=12.5:noon"});
  }
  refuse({"--state", "7=1"}, {"there is no frame 7", "4 to 6"});
  refuse({"--state", "4=1", "--state", "4=2"}, {"names frame 4 twice"});
  refuse({"--unit", "0"}, {"--unit"});
  EXPECT_FALSE(std::filesystem::exists(program_.path("x.gic")));
}

TEST(World, AxesHaveAHand) {
  EXPECT_TRUE(is_right_handed("right up back"));      // three.js, Godot
  EXPECT_FALSE(is_right_handed("right up forward"));  // Unity
  EXPECT_FALSE(is_right_handed("forward right up"));  // Unreal
  EXPECT_TRUE(is_right_handed("right forward up"));   // Blender
  EXPECT_TRUE(is_right_handed("left up forward"));    // glTF
  EXPECT_FALSE(is_right_handed("up right back"));
}

/// What a file says that it may not say is as if it said nothing.
TEST(World, DamagedValuesAreLeftOut) {
  const Place place = place_of({{"gicodec:axes", "right up up"},
                                {"gicodec:unit", "-1"},
                                {"gicodec:bounds", "0 0 0 1 1 inf"}});
  EXPECT_TRUE(place.axes.empty());
  EXPECT_FALSE(place.metres);
  EXPECT_FALSE(place.bounds);
  const auto states =
      states_of({{"gicodec:states", "a 1 b\n3\n\n18446744073709551616 1 c\n7 - d\n"}});
  ASSERT_EQ(states.size(), 1U);
  EXPECT_EQ(states[0].frame, 7U);
  EXPECT_EQ(states[0].name, "d");
}

/// What is written is what is read.
TEST(World, ComesBack) {
  Metadata metadata;
  const Place place{"three", "right up back", 0.1, std::array<double, 6>{-0.1, 0, 1e-9, 1, 2, 1e9}};
  add_place(metadata, place);
  add_states(metadata, {{0, 0.1, ""}, {1, std::nullopt, "a b"}, {UINT64_MAX, -3e5, " c "}});
  const Place again = place_of(metadata);
  EXPECT_EQ(again.layout, place.layout);
  EXPECT_EQ(again.axes, place.axes);
  EXPECT_EQ(again.metres, place.metres);
  EXPECT_EQ(again.bounds, place.bounds);
  const auto states = states_of(metadata);
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].time, 0.1);
  EXPECT_EQ(states[1].name, "a b");
  EXPECT_FALSE(states[1].time);
  EXPECT_EQ(states[2].frame, UINT64_MAX);
  EXPECT_EQ(states[2].name, " c ");
}

}  // namespace
}  // namespace gicodec::tools
