#include "tcp.h"

#include "dump/error.h"
#include "dump/url.h"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr int kQueue = 512;               ///< connections that wait to be accepted
constexpr std::size_t kNetwork = 8;       ///< bytes of an IPv6 address that identify its network
constexpr std::size_t kMappedBytes = 12;  ///< in front of an IPv4 address that is mapped to IPv6

std::string text_of(int family, const void* bytes) {
  char text[INET6_ADDRSTRLEN] = "?";
  inet_ntop(family, bytes, text, sizeof text);
  return text;
}

TcpPeer peer_of(const sockaddr_storage& from) {
  in_addr v4{};
  std::uint16_t port = 0;
  if (from.ss_family == AF_INET6) {
    const auto& v6 = reinterpret_cast<const sockaddr_in6&>(from);
    port = ntohs(v6.sin6_port);
    if (!IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr)) {
      in6_addr network{};
      std::memcpy(&network, &v6.sin6_addr, kNetwork);
      const bool loopback = IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr) != 0;
      return {fmt::format("[{}]:{}", text_of(AF_INET6, &v6.sin6_addr), port),
              loopback ? "::1" : text_of(AF_INET6, &network) + "/64", loopback};
    }
    std::memcpy(&v4, v6.sin6_addr.s6_addr + kMappedBytes, sizeof v4);
  } else {
    const auto& ip = reinterpret_cast<const sockaddr_in&>(from);
    v4 = ip.sin_addr;
    port = ntohs(ip.sin_port);
  }
  const std::string host = text_of(AF_INET, &v4);
  return {fmt::format("{}:{}", host, port), host, tools::is_loopback(host)};
}

}  // namespace

int listen_tcp(const Address& address) {
  addrinfo wanted{};
  wanted.ai_flags = AI_PASSIVE;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = fmt::format("{}", address.port);
  const int error = getaddrinfo(address.host.c_str(), port.c_str(), &wanted, &found);
  if (error != 0) {
    fail(Exit::io, "{}: is no address that is known here: {}", address.host, gai_strerror(error));
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, freeaddrinfo);
  const int descriptor =
      socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP);
  const int on = 1, off = 0;
  bool good = descriptor >= 0;
  good = good && setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0;
  if (good && found->ai_family == AF_INET6) {
    good = setsockopt(descriptor, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off) == 0;
  }
  good = good && bind(descriptor, found->ai_addr, found->ai_addrlen) == 0 &&
         listen(descriptor, kQueue) == 0;
  if (good) return descriptor;
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  fail(Exit::io, "{}: cannot be listened to: {}", to_string(address), std::strerror(reason));
}

std::uint16_t port_of(int descriptor) {
  sockaddr_storage at{};
  socklen_t size = sizeof at;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&at), &size) != 0) return 0;
  return at.ss_family == AF_INET6 ? ntohs(reinterpret_cast<const sockaddr_in6&>(at).sin6_port)
                                  : ntohs(reinterpret_cast<const sockaddr_in&>(at).sin_port);
}

TcpPeer peer_from_string(const std::string& text, std::uint16_t port) {
  sockaddr_storage from{};
  auto& v4 = reinterpret_cast<sockaddr_in&>(from);
  if (inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    return peer_of(from);
  }
  auto& v6 = reinterpret_cast<sockaddr_in6&>(from);
  if (inet_pton(AF_INET6, text.c_str(), &v6.sin6_addr) != 1) return {};
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(port);
  return peer_of(from);
}

int accept_tcp(int descriptor, TcpPeer& peer) {
  sockaddr_storage from{};
  socklen_t size = sizeof from;
  const int accepted =
      accept4(descriptor, reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (accepted < 0) return -1;
  const int on = 1;
  setsockopt(accepted, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  try {
    peer = peer_of(from);
  } catch (...) {
    ::close(accepted);
    throw;
  }
  return accepted;
}

bool peer_is_here(int descriptor) noexcept {
  constexpr std::uint32_t kLoopback = 127, kNetworkShift = 24;
  sockaddr_storage to{};
  socklen_t size = sizeof to;
  if (getpeername(descriptor, reinterpret_cast<sockaddr*>(&to), &size) != 0) return false;
  in_addr v4 = reinterpret_cast<const sockaddr_in&>(to).sin_addr;
  if (to.ss_family == AF_INET6) {
    const in6_addr& v6 = reinterpret_cast<const sockaddr_in6&>(to).sin6_addr;
    if (!IN6_IS_ADDR_V4MAPPED(&v6)) return IN6_IS_ADDR_LOOPBACK(&v6) != 0;
    std::memcpy(&v4, v6.s6_addr + kMappedBytes, sizeof v4);
  }
  return ntohl(v4.s_addr) >> kNetworkShift == kLoopback;
}

TcpState tcp_state(int descriptor) {
  constexpr unsigned kMicroseconds = 1000;
  tcp_info info{};
  socklen_t size = sizeof info;
  int waiting = 0;
  if (getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 ||
      ioctl(descriptor, SIOCINQ, &waiting) != 0) {
    return {};
  }
  // The unread bytes are read later than the total and may be more.
  const std::uint64_t unread =
      std::min<std::uint64_t>(info.tcpi_bytes_received, static_cast<unsigned>(waiting));
  return {info.tcpi_bytes_received - unread, info.tcpi_bytes_acked,
          (info.tcpi_rtt + kMicroseconds / 2) / kMicroseconds};
}

void allow_files(std::size_t count) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= count) return;
  const rlim_t most = limit.rlim_max;
  limit.rlim_cur = std::min<rlim_t>(count, most);
  if (most < count || setrlimit(RLIMIT_NOFILE, &limit) != 0) {
    fail(Exit::io,
         "{} connections need {} open files, and this process may have {}: raise that (ulimit -n, "
         "LimitNOFILE=) or lower --max-clients",
         count, count, most);
  }
}

}  // namespace gicodec::streaming
