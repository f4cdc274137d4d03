// Names of files on servers.
#pragma once

#include <string>
#include <string_view>

namespace gicodec::tools {

/// True for a path that names a file on a server: "http://…" or "https://…".
[[nodiscard]] bool is_url(std::string_view path);
/// A URL for messages: without user, password and what stands behind '?' and '#'.
[[nodiscard]] std::string shown_url(std::string_view url);
/// True for a URL of this machine by name, to which a token may go in clear.
[[nodiscard]] bool is_here(std::string_view url);

}  // namespace gicodec::tools
