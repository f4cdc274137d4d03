// The committed sequences are what the tracer gives today.
#include "ddgi/dump_folder.h"
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/sequence.h"
#include "rooms.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::ddgi {
namespace {

struct Case {
  const char* folder;
  const char* scene;
  TraceMode mode;
  double start;
  Grid grid;
  Box bounds;  ///< empty: the scene's own
};

class Testdata : public ::testing::TestWithParam<Case> {};

TEST_P(Testdata, IsWhatTheTracerGives) {
  const Case& c = GetParam();
  const std::string folder = std::string(GICODEC_TESTDATA_DIR) + "/" + c.folder;
  const auto sequences = tools::group_sequences({folder});
  ASSERT_EQ(sequences.size(), 2U);
  const auto frames = tools::all_frames(sequences);
  ASSERT_EQ(frames.size(), 4U);

  Scene scene = *make_scene(c.scene);
  scene.grid = c.grid;
  if (!c.bounds.empty()) scene.volume = c.bounds;
  test::Traced traced(std::move(scene), {.mode = c.mode, .rays = 256});
  if (c.mode == TraceMode::noisy) {
    for (int i = 0; i < 32; ++i) traced.volume.update(c.start);
  }
  for (const std::uint64_t frame : frames) {
    traced.volume.update(c.start + static_cast<double>(frame) / 10.0);
    const ProbeTextures& t = traced.volume.textures();
    for (const auto& sequence : sequences) {
      const auto dump = tools::read_dump(sequence.find(frame)->path);
      const bool color = sequence.name == kColorName;
      EXPECT_EQ(dump.info.desc, color ? t.color_desc : t.visibility_desc);
      const auto texels = std::as_bytes(std::span(color ? t.color : t.visibility));
      ASSERT_EQ(dump.texels.size(), texels.size());
      EXPECT_EQ(std::memcmp(dump.texels.data(), texels.data(), texels.size()), 0)
          << sequence.name << " " << frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, Testdata,
    ::testing::Values(
        Case{"tomb", "tomb", TraceMode::converged, 2.5, {5, 4, 7}, {{-12, 1, -12}, {12, 11, 12}}},
        Case{"villa", "villa", TraceMode::converged, 0, {6, 4, 8}, {}},
        Case{"villa-noisy", "villa", TraceMode::noisy, 0, {6, 4, 8}, {}},
        Case{"street", "street", TraceMode::converged, 2, {6, 4, 8}, {}}),
    [](const auto& sequence) {
      std::string name = sequence.param.folder;
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace gicodec::ddgi
