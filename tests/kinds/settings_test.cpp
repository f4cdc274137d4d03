// Settings of kinds on the command line, and the rows of the table.
#include "kinds/settings.h"
#include "common/volume_words.h"
#include "ddgi/rooms.h"
#include "dump/error.h"
#include "programs/kind_flags.h"
#include "programs/kind_table.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/kind.h>
#include <gicodec/photons.h>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <set>

namespace gicodec::kinds {
namespace {

constexpr std::array<Setting, 3> kKnown{
    {{"side", "4", "texels"}, {"share", "0.5", "of all"}, {"form", "flat", "flat or round"}}};

Settings given(const std::vector<std::string>& texts) { return {"things", kKnown, texts}; }

/// What the message of a refusal says; empty if nothing was refused.
template <typename Call>
std::string refused(const Call& call) {
  try {
    call();
  } catch (const tools::Error& error) {
    EXPECT_EQ(error.code(), tools::Exit::usage);
    return error.what();
  }
  return "";
}

TEST(Settings, TheLastOneCounts) {
  const Settings settings = given({"side=7", "share=0.25", "side=9"});
  EXPECT_EQ(settings.whole("side", 1, 10), 9U);
  EXPECT_EQ(settings.number("share", 0, 1), 0.25);
  EXPECT_EQ(settings.text("form"), "flat");
  EXPECT_EQ(settings.choice("form", std::array<std::string_view, 2>{"round", "flat"}), 1U);
}

TEST(Settings, RefusalsNameWhatIsAllowed) {
  EXPECT_EQ(refused([] { (void)given({"size=3"}); }),
            "--set: things have no setting \"size\"; there are: side, share, form");
  EXPECT_EQ(refused([] { (void)given({"side"}); }), "--set: expected NAME=VALUE, not \"side\"");
  for (const char* text : {"side=0", "side=11", "side=4x", "side=", "side=-1", "side=1.5"}) {
    EXPECT_NE(refused([&] {
                (void)given({text}).whole("side", 1, 10);
              }).find("expected a whole number from 1 to 10"),
              std::string::npos)
        << text;
  }
  for (const char* text : {"share=2", "share=nan", "share=inf", "share=", "share=1;"}) {
    EXPECT_NE(refused([&] {
                (void)given({text}).number("share", 0, 1);
              }).find("expected a number from 0 to 1"),
              std::string::npos)
        << text;
  }
  const std::array<std::string_view, 2> forms{"flat", "round"};
  EXPECT_EQ(refused([&] { (void)given({"form=square"}).choice("form", forms); }),
            "--set form: expected one of flat, round, not \"square\"");
}

TEST(TracedKinds, AreKindsOfTheLibrary) {
  std::set<std::string_view> names;
  for (const TracedKind& kind : traced_kinds()) {
    EXPECT_NE(find_kind(kind.name), nullptr) << kind.name;
    EXPECT_TRUE(names.insert(kind.name).second);
    EXPECT_EQ(find_traced_kind(kind.name), &kind);
    EXPECT_FALSE(kind.summary.empty());
    for (const auto known : {kind.settings, kind.drawing}) {
      std::set<std::string_view> settings;
      for (const Setting& setting : known) {
        EXPECT_TRUE(settings.insert(setting.name).second) << setting.name;
        EXPECT_FALSE(setting.usual.empty()) << setting.name;
      }
    }
  }
  for (int id = 0; id <= UINT8_MAX; ++id) {
    VolumeEntry volume;
    volume.kind = static_cast<std::uint8_t>(id);
    EXPECT_EQ(tools::is_drawn(volume), find_traced_kind(volume.kind) != nullptr) << id;
  }
  EXPECT_EQ(find_traced_kind("textures"), nullptr);
}

TEST(TracedKinds, HelpTellsAllSettings) {
  for (const TracedKind& kind : traced_kinds()) {
    if (kind.flags) continue;
    EXPECT_NE(settings_help().find(std::string(kind.name) + ": "), std::string::npos);
    EXPECT_NE(settings_help().find(help_of(kind.settings)), std::string::npos);
    EXPECT_EQ(drawing_help().find(std::string(kind.name)) == std::string::npos,
              kind.drawing.empty());
    EXPECT_NE(drawing_help().find(help_of(kind.drawing)), std::string::npos);
  }
}

TEST(Kinds, LightKeepsToTheMemoryThatItIsAllowed) {
  // 80 MiB of photons.
  const VolumeDesc desc = *photon_volume(256, 16384, PhotonForm::halves);
  const TracedKind& photons = *find_traced_kind("photons");
  const ddgi::Scene scene = ddgi::test::busy_room();
  const ddgi::RayScene rays(scene);
  EXPECT_NE(make_light(photons, rays, desc, {512}), nullptr);
  try {
    static_cast<void>(make_light(photons, rays, desc, {64}));
    FAIL();
  } catch (const tools::Error& error) {
    EXPECT_EQ(error.code(), tools::Exit::bad_input);
    EXPECT_NE(std::string(error.what()).find("--max-memory"), std::string::npos) << error.what();
  }
}

/// How each kind is drawn: what it takes, and that there is nothing else.
TEST(Kinds, LightIsDrawnAsSet) {
  const VolumeDesc vectors = *irradiance_vector_volume({3, 2, 4});
  const VolumeDesc photons = *photon_volume(16, 64, PhotonForm::halves);
  const ddgi::Scene scene = ddgi::test::busy_room();
  const ddgi::RayScene rays(scene);
  const auto made = [&](const char* name, const VolumeDesc& desc,
                        const std::vector<std::string>& set) {
    return make_light(*find_traced_kind(name), rays, desc, {4096, set}) != nullptr;
  };
  EXPECT_TRUE(made("irradiance_vectors", vectors, {}));
  EXPECT_TRUE(made("irradiance_vectors", vectors, {"fill=none", "interpolation=tricubic"}));
  EXPECT_TRUE(made("photons", photons, {}));
  EXPECT_EQ(refused([&] { made("photons", photons, {"fill=none"}); }),
            "--set: photons have no setting \"fill\"; there are: none");
  EXPECT_EQ(refused([&] { made("irradiance_vectors", vectors, {"rays=6"}); }),
            "--set: irradiance_vectors have no setting \"rays\"; there are: interpolation, fill");
  EXPECT_EQ(refused([&] { made("irradiance_vectors", vectors, {"fill=all"}); }),
            "--set fill: expected one of none, push-pull, smooth, not \"all\"");
}

}  // namespace
}  // namespace gicodec::kinds
