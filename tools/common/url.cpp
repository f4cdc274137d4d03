#include "url.h"

#include "dump/text.h"

namespace gicodec::tools {

bool is_url(std::string_view path) {
  const std::string scheme = lower_case(std::string(path.substr(0, path.find(':') + 1)));
  return (scheme == "http:" || scheme == "https:") && path.substr(scheme.size()).starts_with("//");
}

std::string shown_url(std::string_view url) {
  const auto scheme = url.find("://") + 3;
  std::string_view rest = url.substr(scheme, url.find_first_of("?#") - scheme);
  const auto user = rest.substr(0, rest.find('/')).rfind('@');
  if (user != std::string_view::npos) rest.remove_prefix(user + 1);
  return std::string(url.substr(0, scheme)) + std::string(rest);
}

bool is_here(std::string_view url) {
  std::string_view host = url.substr(url.find("://") + 3);
  host = host.substr(0, host.find('/'));
  host =
      host.starts_with('[') ? host.substr(0, host.find(']') + 1) : host.substr(0, host.find(':'));
  return host == "127.0.0.1" || host == "localhost" || host == "[::1]";
}

}  // namespace gicodec::tools
