// What a server's flags have to be for what it shows.
#pragma once

#include "server_flags.h"
#include "source.h"

namespace gicodec::streaming {

/// Throws Error that names the cure where the backend refuses its flags, or a texture.
void check_backend(const ServerFlags& flags, const SourceVolume& volume);

/// What our own clients may have to say in a second: where they look, for each update that they
/// have it and where they look then, and what they subscribe to, all of it twice.
[[nodiscard]] double messages_of_clients(const ServerFlags& flags, const Source& source);

}  // namespace gicodec::streaming
