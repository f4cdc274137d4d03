// What a server's flags have to be for what it shows.
#pragma once

#include "server_flags.h"
#include "source.h"

namespace gicodec::streaming {

/// Throws Error that names the cure where the backend refuses its flags, or a texture.
void check_backend(const ServerFlags& flags, const SourceVolume& volume);

}  // namespace gicodec::streaming
