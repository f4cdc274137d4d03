// Probes as a kind: their settings, and containers of what is traced, with what dumps of them say.
#include "probes/probes.h"
#include "common/container_input.h"
#include "ddgi/rooms.h"
#include "dump/error.h"
#include "programs/feed_container.h"
#include "programs/kind_flags.h"
#include "tools/dump_support.h"

#include <gicodec/engines.h>

#include <gtest/gtest.h>

#include <limits>

namespace gicodec::probes {
namespace {

kinds::Settings settings(const std::vector<std::string>& given) {
  return {"probes", kTracedProbes.settings, given, "--"};
}

std::string refused(const std::vector<std::string>& given) {
  try {
    (void)options_of(settings(given), 1);
  } catch (const tools::Error& error) {
    EXPECT_EQ(error.code(), tools::Exit::usage);
    return error.what();
  }
  return "";
}

TEST(ProbeSettings, UsualOnesAreThePapers) {
  const ProbeOptions usual = options_of(settings({}), 3);
  const ddgi::TraceOptions trace{.seed = 3};
  EXPECT_EQ(usual.trace.mode, trace.mode);
  EXPECT_EQ(usual.trace.rays, trace.rays);
  EXPECT_EQ(usual.trace.hysteresis, trace.hysteresis);
  EXPECT_EQ(usual.trace.seed, trace.seed);
  EXPECT_EQ(usual.trace.rotation, trace.rotation);
  EXPECT_EQ(usual.trace.clamp, trace.clamp);
  EXPECT_EQ(usual.trace.irradiance_threshold, trace.irradiance_threshold);
  EXPECT_EQ(usual.trace.forms.color, trace.forms.color);
  EXPECT_EQ(usual.trace.forms.encoding, trace.forms.encoding);
  EXPECT_EQ(usual.trace.forms.visibility_core, trace.forms.visibility_core);
  EXPECT_EQ(usual.layout, nullptr);
  EXPECT_FALSE(usual.fine);
}

TEST(ProbeSettings, AreWhatIsGiven) {
  const ProbeOptions options = options_of(
      settings({"mode=noisy", "rotation=fixed", "clamp=2", "core=vis=14,color=6", "sh=l2",
                "vk-format=color=R16G16B16A16_SFLOAT", "fine=4x2x3", "fine-spacing=0.25"}),
      1);
  EXPECT_EQ(options.trace.mode, ddgi::TraceMode::noisy);
  EXPECT_EQ(options.trace.rotation, ddgi::Rotation::fixed);
  EXPECT_EQ(options.trace.clamp, 2);
  EXPECT_EQ(options.trace.forms.color, Format::R16G16B16A16_SFLOAT);
  EXPECT_EQ(options.trace.forms.encoding, ddgi::Encoding::linear);
  EXPECT_EQ(options.trace.forms.color_core, 6);
  EXPECT_EQ(options.trace.forms.visibility_core, 14);
  EXPECT_EQ(options.trace.forms.sh, ddgi::ShForm::l2);
  EXPECT_EQ(options.fine->grid, (Grid{4, 2, 3}));
  EXPECT_EQ(options.fine->spacing, 0.25F);
  const ProbeOptions flax = options_of(settings({"layout=flax"}), 1);
  EXPECT_EQ(flax.layout, find_engine_layout("flax"));
  EXPECT_EQ(flax.trace.forms.encoding, ddgi::Encoding::linear);
  EXPECT_EQ(options_of(settings({"layout=flax", "encoding=gamma5"}), 1).trace.forms.encoding,
            ddgi::Encoding::gamma5);
}

TEST(ProbeSettings, RefusalsNameFlags) {
  for (const auto& [given, said] :
       {std::pair{"rays=0", "--rays: expected a whole number from 1 to 65536, not \"0\""},
        {"clamp=0", "--clamp: expected a number from"},
        {"core=color=1", "--core: expected 2 to 64 texels, not \"1\""},
        {"core=color=6,", "--core: \"\" does not begin with color= or vis="},
        {"vk-format=vis=R16_UNORM", "vis cannot be R16_UNORM; there are R16G16_SFLOAT"},
        {"layout=unknown", "unknown is not known; there are paper, g3d"},
        {"fine=0x1x1", "--fine: expected a grid"}}) {
    EXPECT_NE(refused({given}).find(said), std::string::npos) << given << ": " << refused({given});
  }
  for (const char* other : {"sh=l1", "core=vis=14", "vk-format=color=R8G8B8A8_UNORM", "fine=2x2x2"})
    EXPECT_NE(refused({"layout=rtxgi", other}).find("leave out"), std::string::npos) << other;
}

/// --help, and with it the manual pages, names every layout there is.
TEST(ProbeSettings, LayoutsAreNamed) {
  std::string names;
  for (const EngineLayout& layout : engine_layouts())
    names += (names.empty() ? "" : ", ") + std::string(layout.name);
  const auto row = std::ranges::find(kTracedProbes.settings, "layout", &kinds::Setting::name);
  EXPECT_TRUE(row->summary.ends_with(": " + names)) << row->summary;
}

/// What is traced comes back from its container, frame by frame, and says what dumps are to say.
TEST(ProbeContainers, HoldEveryFrame) {
  std::vector<std::vector<std::string>> all{
      {},
      {"sh=l1-over-l0", "vk-format=color=R16G16B16A16_SFLOAT", "encoding=gamma5"},
      {"mode=noisy", "warmup=2"},
      {"fine=3x2x2"}};
  for (const EngineLayout& layout : engine_layouts())
    all.push_back({"layout=" + std::string(layout.name)});
  tools::TemporaryDirectory directory;
  const std::string path = directory.path("x.gic");
  for (std::vector<std::string> given : all) {
    SCOPED_TRACE(given.empty() ? "" : given.front());
    given.emplace_back("rays=16");
    kinds::Feed feed = kTracedProbes.trace({ddgi::test::busy_room(), settings(given), 1, 2});
    feed.scene = {"room", 1};
    kinds::FeedContainer container(path, feed, {1, 4}, "native");
    std::vector<kinds::FeedFrame> frames;
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
      frames.push_back(feed.next({1 + static_cast<double>(frame) / 4, {}}));
      container.add(frame, frames.back());
    }
    container.finish();
    tools::ContainerInput input(path);
    for (const kinds::FeedFrame& frame : frames) {
      ASSERT_TRUE(input.next_frame());
      std::size_t id = 0;
      for (std::size_t v = 0; v < feed.volumes.size(); ++v) {
        for (const auto& texels : frame.volumes[v].textures) {
          const tools::DumpInfo info = input.textures()[id].info_at(input.frame());
          EXPECT_EQ(input.texels(id++), texels);
          if (feed.volumes[v].files.empty()) continue;
          const auto said = [&](const char* name) {
            const tools::Attribute* found = find_attribute(info.attributes, name);
            return found == nullptr ? "nothing" : found->value;
          };
          EXPECT_EQ(said(tools::kTimeAttribute), fmt::format("{}", frame.time));
          EXPECT_EQ(said(tools::kSceneAttribute), "room");
          EXPECT_NE(said(tools::kOriginAttribute), "nothing");
        }
      }
    }
    EXPECT_FALSE(input.next_frame());
  }
}

}  // namespace
}  // namespace gicodec::probes
