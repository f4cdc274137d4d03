#include "transport.h"

#include "dump/error.h"
#include "dump/file.h"
#include "dump/url.h"

#include <fmt/format.h>

#include <charconv>

namespace gicodec::streaming {

using tools::Exit;
using tools::fail;

namespace {

constexpr std::string_view kSecure = "wss://", kPlain = "ws://";
constexpr std::size_t kMaxPorts = 12;  ///< bytes of a file with two of them

}  // namespace

Address parse_address(const std::string& text, const char* flag) {
  const std::size_t colon = text.rfind(':');
  Address address{text.substr(0, colon), 0, Via::enet};
  const bool bracketed = address.host.starts_with('[') && address.host.ends_with(']');
  if (bracketed) address.host = address.host.substr(1, address.host.size() - 2);
  const bool sound =
      !address.host.empty() && (address.host.find(':') != std::string::npos) == bracketed;
  const char* const end = text.data() + text.size();
  if (colon != std::string::npos && sound) {
    const auto parsed = std::from_chars(text.data() + colon + 1, end, address.port);
    if (parsed.ec == std::errc{} && parsed.ptr == end) return address;
  }
  fail(Exit::usage,
       "{}: expected an address and a port such as 127.0.0.1:4600 or [::1]:4600, not \"{}\"", flag,
       text);
}

Address parse_server(const std::string& text, const char* flag) {
  const bool secure = text.starts_with(kSecure), plain = text.starts_with(kPlain);
  if (!secure && !plain) return parse_address(text, flag);
  std::string rest = text.substr(secure ? kSecure.size() : kPlain.size());
  if (rest.ends_with('/')) rest.pop_back();
  Address address = parse_address(rest, flag);
  address.via = secure ? Via::web : Via::plain_web;
  if (plain && !tools::is_loopback(address.host)) {
    fail(Exit::usage,
         "{}: ws:// is not encrypted and only for this machine itself; use wss://{} and a server "
         "with a certificate",
         flag, rest);
  }
  return address;
}

std::string to_string(const Address& address) {
  if (address.via == Via::nats) return address.host;
  const bool bracketed = address.host.find(':') != std::string::npos;
  return fmt::format("{}{}{}{}:{}",
                     address.via == Via::web         ? kSecure
                     : address.via == Via::plain_web ? kPlain
                                                     : std::string_view(),
                     bracketed ? "[" : "", address.host, bracketed ? "]" : "", address.port);
}

void write_ports(const std::string& path, const std::vector<std::uint16_t>& ports) {
  if (path.empty()) return;
  tools::check_report(path, [](std::string_view head) {
    return head.size() <= kMaxPorts && head.find_first_not_of("0123456789\n") == head.npos;
  });
  const std::string text = fmt::format("{}\n", fmt::join(ports, "\n"));
  tools::write_file(path, std::as_bytes(std::span(text)), tools::Existing::replace);
}

}  // namespace gicodec::streaming
