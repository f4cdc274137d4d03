// Textures as another kind of file than they came from: decode --files.
#pragma once

#include "stored_texture.h"

#include <string>

namespace gicodec::tools {

/// Makes a texture come back as files of a kind that is written. Those that do already keep all
/// that their heads said; of others StoredTexture::unsaid names the attributes that such files
/// cannot have.
void set_files(StoredTexture& texture, ImageKind kind);

/// Throws Error of Exit::bad_input, which names other kinds, where such files cannot hold it.
void require_format(const StoredTexture& texture, const std::string& path);

}  // namespace gicodec::tools
