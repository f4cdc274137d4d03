// raw_asker PATH [N]: says what is on standard input to the socket of a gi-server's --control, and
// prints what comes back. With N: opens so many connections, says nothing, and stays until killed.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>

namespace {

int connected(const char* path, int flags) {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::strncpy(to.sun_path, path, sizeof to.sun_path - 1);
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | flags, 0);
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0)
    return descriptor;
  std::perror(path);
  std::exit(1);
}

void say(int descriptor) {
  char bytes[4096];
  std::string line;
  while (const std::size_t got = std::fread(bytes, 1, sizeof bytes, stdin)) line.append(bytes, got);
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t sent = send(descriptor, line.data() + at, line.size() - at, MSG_NOSIGNAL);
    if (sent < 0) break;  // It has heard enough; the answer is there.
    at += static_cast<std::size_t>(sent);
  }
  shutdown(descriptor, SHUT_WR);
  ssize_t got = 0;
  while ((got = recv(descriptor, bytes, sizeof bytes, 0)) > 0) {
    std::fwrite(bytes, 1, static_cast<std::size_t>(got), stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2) {
    const int descriptor = connected(argv[1], 0);
    say(descriptor);
    close(descriptor);
    return 0;
  }
  if (argc != 3) return 2;
  for (int i = std::atoi(argv[2]); i > 0; --i) static_cast<void>(connected(argv[1], SOCK_NONBLOCK));
  std::puts("connected");
  std::fflush(stdout);
  pause();
  return 0;
}
