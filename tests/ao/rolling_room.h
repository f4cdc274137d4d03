// A room with a ball that moves close above its floor, which it darkens.
#pragma once

#include "ddgi/rooms.h"

namespace gicodec::ao::test {

inline constexpr std::uint32_t kBall = 1;  ///< its object

inline ddgi::Scene rolling_room() {
  ddgi::Scene scene = ddgi::test::busy_room();
  scene.animate = [](double time, ddgi::FrameState& state) {
    state.transforms[kBall] = ddgi::translation({static_cast<float>(time) - 2, -2.1F, 3});
  };
  return scene;
}

}  // namespace gicodec::ao::test
