// The committed sequences are what the tracer gives today; see testdata/regenerate.
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/sequence.h"
#include "rooms.h"

#include <gtest/gtest.h>

#include <cstring>
#include <ostream>

namespace gicodec::ddgi {
namespace {

/// Options of one call of gi-trace.
struct Case {
  const char* folder;
  const char* scene;
  TraceMode mode;
  double start;
  Grid grid;
  Box bounds;  ///< empty: the scene's own
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.folder; }

class Testdata : public ::testing::TestWithParam<Case> {};

TEST_P(Testdata, IsWhatTheTracerGives) {
  const Case& c = GetParam();
  const std::string folder = std::string(GICODEC_TESTDATA_DIR) + "/" + c.folder;
  const auto sequences = tools::group_sequences({folder});
  ASSERT_EQ(sequences.size(), 2U);
  ASSERT_EQ(tools::all_frames(sequences).size(), 8U);

  Scene scene = *make_scene(c.scene);
  scene.grid = c.grid;
  if (!c.bounds.empty()) scene.volume = c.bounds;
  test::Traced traced(std::move(scene), {.mode = c.mode, .rays = 256});
  if (c.mode == TraceMode::noisy) {
    for (int i = 0; i < 32; ++i) traced.volume.update(c.start);
  }
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    traced.volume.update(c.start + static_cast<double>(frame) / 10.0);
    const ProbeTextures& t = traced.volume.textures();
    for (const auto& sequence : sequences) {
      const auto dump = tools::read_dump(sequence.find(frame)->path);
      const bool color = sequence.name == "color";
      EXPECT_EQ(dump.info.desc, color ? t.color_desc : t.visibility_desc);
      const auto& texels = color ? t.color : t.visibility;
      ASSERT_EQ(dump.texels.size(), texels.size());
      EXPECT_EQ(std::memcmp(dump.texels.data(), texels.data(), texels.size()), 0)
          << sequence.name << " " << frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, Testdata,
    ::testing::Values(Case{"tomb-converged",
                           "tomb",
                           TraceMode::converged,
                           2.5,
                           {5, 4, 5},
                           {{-12, 1, -12}, {12, 11, 12}}},
                      Case{"villa-converged",
                           "villa",
                           TraceMode::converged,
                           0,
                           {5, 3, 6},
                           {{-14, 1.2F, -30}, {14, 8.2F, 10}}},
                      Case{"villa-noisy",
                           "villa",
                           TraceMode::noisy,
                           0,
                           {5, 3, 6},
                           {{-14, 1.2F, -30}, {14, 8.2F, 10}}},
                      Case{"street-converged", "street", TraceMode::converged, 2, {6, 3, 9}, {}}),
    [](const auto& sequence) {
      std::string name = sequence.param.folder;
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace gicodec::ddgi
