// Names of files on servers.
#pragma once

#include <string>
#include <string_view>

namespace gicodec::tools {

/// True for a path that names a file on a server: "http://…" or "https://…".
[[nodiscard]] bool is_url(std::string_view path);
/// A URL for messages: without user, password and what stands behind '?' and '#'.
[[nodiscard]] std::string shown_url(std::string_view url);
/// The host of a URL as shown_url() gives it, IPv6 without brackets.
[[nodiscard]] std::string host_of(std::string_view url);
/// True for names of this machine: 127.0.0.0/8, ::1 or localhost.
[[nodiscard]] bool is_loopback(std::string_view host);

}  // namespace gicodec::tools
