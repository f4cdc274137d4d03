// A crowd of handshakes, as after a restart of a server with many clients.
#include "sanitizers.h"
#include "stream/web.h"
#include "stream/web_link.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gicodec::streaming {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kPatience = std::chrono::seconds(60);
constexpr unsigned kAddresses = 200;

/// A connection from 127.0.`network`.`host` that says nothing; -1 if the system refuses it.
int connect_from(unsigned network, unsigned host, std::uint16_t port) {
  const int link = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in from{}, to{};
  from.sin_family = to.sin_family = AF_INET;
  const std::string name = "127.0." + std::to_string(network) + "." + std::to_string(host);
  inet_pton(AF_INET, name.c_str(), &from.sin_addr);
  inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
  to.sin_port = htons(port);
  if (bind(link, reinterpret_cast<const sockaddr*>(&from), sizeof from) == 0 &&
      connect(link, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    return link;
  }
  ::close(link);
  return -1;
}

bool is_closed(int link) {
  char byte = 0;
  const ssize_t size = recv(link, &byte, 1, MSG_DONTWAIT);
  return size == 0 || (size < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
}

bool waits_until(const auto& condition) {
  for (const auto end = Clock::now() + kPatience; Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return false;
}

/// libwebsockets 4.1 does not free all that it makes of a context without TLS.
template <typename... Args>
std::unique_ptr<Web> make_web(Args&&... args) {
  const test::LeakAllowed not_looked_for;
  return std::make_unique<Web>(std::forward<Args>(args)...);
}

/// Newcomers whose addresses come before all others in any order, and after them, and between.
TEST(WebCrowd, TheOldestHandshakesMakeRoomAndAnHonestClientGetsIn) {
  NetOptions options;
  options.open_timeout = 600;  // Who goes, goes to make room.
  const auto server =
      make_web(WebListen{{"127.0.0.1", 0, Via::plain_web}, {}, {}, {}}, nullptr, options);
  std::vector<int> links;
  for (unsigned i = 0; i < kAddresses; ++i) {
    links.push_back(connect_from(1 + i % 7, 1 + i * 89 % 251, server->port()));
    ASSERT_GE(links.back(), 0) << i;
    // As the server takes them one after the other, it is known which are the oldest.
    if (i >= HalfOpen::kMax) {
      ASSERT_TRUE(waits_until([&] { return is_closed(links[i - HalfOpen::kMax]); })) << i;
    }
  }
  for (std::size_t i = kAddresses - HalfOpen::kMax; i < kAddresses; ++i) {
    EXPECT_FALSE(is_closed(links[i])) << i;
  }
  const auto client = make_web(NetOptions{});
  static_cast<void>(client->connect({"127.0.0.1", server->port(), Via::plain_web}));
  bool is_in = false, is_seen = false;
  EXPECT_TRUE(waits_until([&] {
    NetEvent event;
    while (client->next(event)) is_in = is_in || event.type == NetEvent::Type::opened;
    while (server->next(event)) is_seen = is_seen || event.type == NetEvent::Type::opened;
    return is_in && is_seen;
  }));
  for (const int link : links) ::close(link);
}

/// Its connections are open, so that none of them makes room.
TEST(WebCrowd, OneAddressTooManyIsClosedAndCounted) {
  NetOptions options;
  options.links = 8;
  options.links_per_address = 1;
  const auto server =
      make_web(WebListen{{"127.0.0.1", 0, Via::plain_web}, {}, {}, {}}, nullptr, options);
  const auto client = make_web(NetOptions{});
  static_cast<void>(client->connect({"127.0.0.1", server->port(), Via::plain_web}));
  EXPECT_TRUE(waits_until([&] {
    NetEvent event;
    while (server->next(event)) {
      if (event.type == NetEvent::Type::opened) return true;
    }
    return false;
  }));
  EXPECT_EQ(server->turned_away().count, 0U);
  const int first = connect_from(0, 1, server->port());
  ASSERT_GE(first, 0);
  EXPECT_TRUE(waits_until([&] { return is_closed(first); }));
  const TurnedAway crowd = server->turned_away();
  EXPECT_EQ(crowd.count, 1U);
  EXPECT_EQ(crowd.last.rfind("127.0.0.1:", 0), 0U) << crowd.last;
  EXPECT_EQ(server->turned_away().count, 0U);
  ::close(first);
}

}  // namespace
}  // namespace gicodec::streaming
