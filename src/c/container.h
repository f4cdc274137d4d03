// A container's description as C sees it.
#pragma once

#include <gicodec/c/container.h>
#include <gicodec/container.h>

#include "c/calls.h"

struct gicodec_container {
  gicodec::ContainerDescription description;
};

namespace gicodec::c {

[[nodiscard]] Status take_geometry(const gicodec_geometry* given, VolumeGeometry& out) noexcept;
[[nodiscard]] Status give_geometry(const VolumeGeometry& geometry, gicodec_geometry* out) noexcept;

}  // namespace gicodec::c
