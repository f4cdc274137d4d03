// Decodes textures to another kind of file than they came from: decode --files.
#pragma once

#include "stored_texture.h"

#include <string>

namespace gicodec::tools {

/// Makes a texture decode to files of a kind that is_written(). If it already does, all attributes
/// stay. Else StoredTexture::unsaid lists the attributes that such files cannot have.
void set_files(StoredTexture& texture, ImageKind kind);

/// Throws Error of Exit::bad_input, which names other kinds, if such files cannot hold the texture.
void require_format(const StoredTexture& texture, const std::string& path);
/// Throws Error of Exit::bad_input for an attribute that such files cannot have.
void require_attributes(const StoredTexture& texture, const std::string& path);

}  // namespace gicodec::tools
