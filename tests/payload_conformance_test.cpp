// Every kind through everything: a new kind is a new row in payload_rows.h.
#include "payload_conformance.h"

#include "support.h"

#include <gtest/gtest.h>

namespace gicodec::test {
namespace {

TEST(PayloadConformance, ThereIsARowOfEveryKind) {
  for (const Kind* kind : built_in_kinds()) {
    const auto rows = payload_rows();
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [&](const Row& row) {
      return row.volume.kind == kind->id;
    })) << kind->name;
  }
}

TEST(PayloadConformance, DescriptionsAreExactAndSafe) {
  for (const Row& row : payload_rows()) EXPECT_EQ(check_description(row), "") << row.name;
}

TEST(PayloadConformance, EveryBackendIsExactAndSafe) {
  Generator random(1);
  Sweep sweep;
  for (const Row& row : payload_rows()) {
    const std::size_t textures = textures_of(row.volume).size();
    for (std::size_t texture = 0; texture < textures; ++texture) {
      for (const Backend* backend : built_in_backends()) {
        if (!sweep.takes()) continue;
        EXPECT_EQ(check_codec(row.volume, texture, *backend, random), "")
            << row.name << ", texture " << texture << ", " << backend->name();
      }
    }
  }
}

TEST(PayloadConformance, VolumesOfEveryKindAreExact) {
  Generator random(4);
  for (const Row& row : payload_rows()) {
    for (const Backend* backend : built_in_backends()) {
      EXPECT_EQ(check_volume(row.volume, *backend, random), "")
          << row.name << ", " << backend->name();
    }
  }
}

TEST(PayloadConformance, ContainersHoldRegionsOfEveryKind) {
  Generator random(2);
  for (const Row& row : payload_rows()) EXPECT_EQ(check_container(row, random), "") << row.name;
}

TEST(PayloadConformance, SessionsSurviveLoss) {
  Generator random(3);
  Sweep sweep;
  for (const Row& row : payload_rows()) {
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      for (const Backend* backend : built_in_backends()) {
        for (const unsigned lost_one_in : {0U, 3U}) {
          if (!sweep.takes()) continue;
          EXPECT_EQ(check_session(row, *backend, delivery, lost_one_in, random), "")
              << row.name << (delivery == Delivery::unicast ? ", own" : ", shared") << ", "
              << backend->name() << ", one in " << lost_one_in << " lost";
        }
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::test
