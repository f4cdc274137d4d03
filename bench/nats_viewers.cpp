// Simulated viewers of script/bench-nats: connections that subscribe to everything, count and hash
// what comes, and print it at the end. nats_viewers PORT PREFIX COUNT SECONDS
#include <xxhash.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

struct Viewer {
  int socket = -1;
  std::string bytes;     ///< received and not yet taken
  std::size_t data = 0;  ///< bytes of a message whose line was taken, with its end
  std::uint64_t messages = 0, received = 0, hash = 0;
};

[[noreturn]] void fail(const char* what) {
  std::perror(what);
  std::exit(1);
}

int connect_to(std::uint16_t port, const std::string& greeting) {
  const int made = socket(AF_INET, SOCK_STREAM, 0);
  if (made < 0) fail("socket");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail("connect");
  if (write(made, greeting.data(), greeting.size()) != static_cast<ssize_t>(greeting.size()))
    fail("write");
  return made;
}

/// Takes whole lines and messages: "MSG subject sid size" or "HMSG subject sid head size".
void take(Viewer& viewer) {
  std::size_t at = 0;
  const std::string_view all = viewer.bytes;
  while (true) {
    if (viewer.data > 0) {
      if (all.size() - at < viewer.data) break;
      viewer.hash ^= XXH3_64bits(all.data() + at, viewer.data);
      ++viewer.messages;
      at += std::exchange(viewer.data, 0);
    }
    const std::size_t end = all.find("\r\n", at);
    if (end == std::string_view::npos) break;
    const std::string_view line = all.substr(at, end - at);
    at = end + 2;
    if (line.starts_with("PING")) {
      if (write(viewer.socket, "PONG\r\n", 6) != 6) fail("write");
    } else if (line.starts_with("MSG") || line.starts_with("HMSG")) {
      const std::string size(line.substr(line.rfind(' ') + 1));
      viewer.data = std::strtoull(size.c_str(), nullptr, 10) + 2;
    } else if (line.starts_with("-ERR")) {
      std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
      std::exit(1);
    }
  }
  viewer.bytes.erase(0, at);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: nats_viewers PORT PREFIX COUNT SECONDS\n");
    return 2;
  }
  const auto port = static_cast<std::uint16_t>(std::atoi(argv[1]));
  const std::string prefix = argv[2];
  const auto count = static_cast<std::size_t>(std::atoi(argv[3]));
  const double seconds = std::atof(argv[4]);
  rlimit files{count + 64, count + 64};
  if (setrlimit(RLIMIT_NOFILE, &files) != 0) fail("setrlimit");
  const std::string greeting = "CONNECT {\"verbose\":false,\"headers\":true}\r\nSUB " + prefix +
                               ".*.*.*.*.*.* 1\r\nSUB " + prefix + ".tick 2\r\n";
  const int poll = epoll_create1(0);
  std::vector<Viewer> viewers(count);
  for (std::size_t i = 0; i < count; ++i) {
    viewers[i].socket = connect_to(port, greeting);
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.u64 = i;
    if (epoll_ctl(poll, EPOLL_CTL_ADD, viewers[i].socket, &event) != 0) fail("epoll_ctl");
  }
  std::printf("connected\n");
  std::fflush(stdout);
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::vector<epoll_event> events(1024);
  std::vector<char> buffer(1 << 16);
  while (passed() < seconds) {
    const int ready = epoll_wait(poll, events.data(), static_cast<int>(events.size()), 20);
    for (int e = 0; e < ready; ++e) {
      Viewer& viewer = viewers[events[static_cast<std::size_t>(e)].data.u64];
      const ssize_t read_bytes = read(viewer.socket, buffer.data(), buffer.size());
      if (read_bytes <= 0) {
        std::fprintf(stderr, "a connection was closed\n");
        return 1;
      }
      viewer.received += static_cast<std::uint64_t>(read_bytes);
      viewer.bytes.append(buffer.data(), static_cast<std::size_t>(read_bytes));
      take(viewer);
    }
  }
  std::uint64_t messages = 0, bytes = 0;
  for (const Viewer& viewer : viewers) messages += viewer.messages, bytes += viewer.received;
  const auto [least, most] =
      std::minmax_element(viewers.begin(), viewers.end(),
                          [](const Viewer& a, const Viewer& b) { return a.messages < b.messages; });
  std::printf(
      "{\"messages\": %llu, \"bytes\": %llu, \"least\": %llu, \"most\": %llu, \"hash\": %llu}\n",
      static_cast<unsigned long long>(messages), static_cast<unsigned long long>(bytes),
      static_cast<unsigned long long>(least->messages),
      static_cast<unsigned long long>(most->messages),
      static_cast<unsigned long long>(viewers.front().hash));
}
