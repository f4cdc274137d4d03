// The names of all files that a texture may decode to, for any frames.
#pragma once

#include "stored_texture.h"

namespace gicodec::tools {

/// True if a file of one texture, sidecars included, may have the name of a file of the other.
[[nodiscard]] bool names_meet(const StoredTexture& a, const StoredTexture& b);

}  // namespace gicodec::tools
