// Volumes of engines' layouts to test with.
#pragma once

#include <gicodec/engines.h>

namespace gicodec::test {

/// Odd sizes: blocks that end within tiles, slots that are free.
inline Grid engine_grid(GridUnit unit) {
  switch (unit) {
    case GridUnit::probe:
      return {5, 2, 3};
    case GridUnit::brick:
      return {7, 1, 1};
    case GridUnit::cell:
      return {3, 2, 1};
    case GridUnit::voxel:
      return {7, 5, 3};
    case GridUnit::texel:
      return {19, 11, 2};
  }
  return {};
}

}  // namespace gicodec::test
