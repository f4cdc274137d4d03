// Checks a server's flags against its source.
#pragma once

#include "server_flags.h"
#include "source.h"

namespace gicodec::streaming {

/// Throws tools::Error with a remedy if the backend refuses its flags, or a texture.
void check_backend(const ServerFlags& flags, const SourceVolume& volume);

}  // namespace gicodec::streaming
