#include "url.h"

#include "text.h"

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

std::string host_of(std::string_view url) {
  std::string_view host = url.substr(url.find("://") + 3);
  host = host.substr(0, host.find('/'));
  if (host.starts_with('[')) return std::string(host.substr(1, host.find(']') - 1));
  return std::string(host.substr(0, host.find(':')));
}

bool is_loopback(std::string_view host) {
  const bool digits = host.find_first_not_of("0123456789.") == std::string_view::npos;
  return host == "localhost" || host == "::1" || (digits && host.starts_with("127."));
}

}  // namespace gicodec::tools
