// The names of the files that a texture decodes to (gicodec(1), "File names").
#pragma once

#include "stored_texture.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// Any text as part of a file's name, different texts as different parts. It stays as it is where
/// it can: UTF-8 that a terminal shows unchanged, without directories, not hidden. Bytes that
/// cannot stay, and those of `also`, become %2F; so does a % that would be read as such. Where that
/// has more than `most` bytes, it ends in %~ and a hash.
[[nodiscard]] std::string as_file_name(std::string_view text, std::size_t most,
                                       std::string_view also = {});
/// The inverse; text that as_file_name() does not write stays as it is.
[[nodiscard]] std::string from_file_name(const std::string& part);

/// What the files of a texture are called before their numbers: its name, by as_file_name().
[[nodiscard]] std::string file_stem(const StoredTexture& texture);

/// True if a file of one texture, sidecars included, may have the name of a file of the other.
[[nodiscard]] bool names_meet(const StoredTexture& a, const StoredTexture& b);

}  // namespace gicodec::tools
