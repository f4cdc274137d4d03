// The names of all files that a texture may come back as, whatever its frames are.
#pragma once

#include "stored_texture.h"

namespace gicodec::tools {

/// Whether a file of one, its sidecars included, may have the name of a file of the other.
[[nodiscard]] bool names_meet(const StoredTexture& a, const StoredTexture& b);

}  // namespace gicodec::tools
