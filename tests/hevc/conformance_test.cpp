// Every kind's textures through HEVC, by the bodies of the conformance test.
#include <gicodec/hevc.h>

#include "payload_conformance.h"

#include <gtest/gtest.h>

namespace gicodec::test {
namespace {

TEST(HevcConformance, TakesEveryTexture) {
  for (const HevcPacking packing : {HevcPacking::paper, HevcPacking::planes}) {
    HevcSettings settings;
    settings.packing = packing;
    const HevcBackend backend(settings);
    Generator random(4);
    for (const Row& row : payload_rows()) {
      const auto textures = textures_of(row.volume);
      for (std::size_t texture = 0; texture < textures.size(); ++texture) {
        EXPECT_EQ(check_codec(row.volume, texture, backend, random), "")
            << row.name << ", " << textures[texture]->name;
      }
    }
  }
}

TEST(HevcConformance, SessionsSurviveLoss) {
  const HevcBackend backend;
  Generator random(5);
  for (const Row& row : payload_rows()) {
    // HEVC remembers its last picture, so its packets are not shared.
    EXPECT_EQ(check_session(row, backend, Delivery::unicast, 3, random), "") << row.name;
  }
}

}  // namespace
}  // namespace gicodec::test
