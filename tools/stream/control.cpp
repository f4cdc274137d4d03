#include "control.h"

#include "clock.h"
#include "dump/error.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr std::size_t kMaxAskers = 8;
constexpr std::size_t kMaxCommand = 256;  ///< bytes
constexpr double kPatience = 5;           ///< seconds for a whole exchange
constexpr const char* kError = "error: ";

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    fail(Exit::usage, "{}: a socket's path has 1 to {} bytes; use a shorter one", path,
         sizeof address.sun_path - 1);
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

int new_socket(int flags) {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0);
  if (descriptor < 0) fail(Exit::io, "a socket cannot be opened: {}", std::strerror(errno));
  return descriptor;
}

bool reaches(int descriptor, const std::string& path) {
  const sockaddr_un to = address_of(path);
  return connect(descriptor, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
}

/// Removes the socket of a server that has ended.
void remove_stale(const std::string& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) return;
  if (!S_ISSOCK(found.st_mode)) fail(Exit::io, "{}: is there and no socket; move it away", path);
  const int probe = new_socket(SOCK_NONBLOCK);
  const bool taken = reaches(probe, path) || errno != ECONNREFUSED;
  close(probe);
  if (taken) fail(Exit::io, "{}: another server answers there; choose another path", path);
  unlink(path.c_str());
}

/// Device and inode of the file at this path; zeros if there is none.
std::pair<std::uint64_t, std::uint64_t> identity(const std::string& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino};
}

bool would_wait() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Control::Control(std::string path) : path_(std::move(path)) {
  const sockaddr_un at = address_of(path_);
  remove_stale(path_);
  descriptor_ = new_socket(SOCK_NONBLOCK);
  // Before it has a name, so that there is no time in which others may open it.
  const bool made = fchmod(descriptor_, S_IRUSR | S_IWUSR) == 0 &&
                    bind(descriptor_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
  const bool listens = made && listen(descriptor_, kMaxAskers) == 0;
  const int error = errno;
  file_ = identity(path_);
  if (listens) return;
  close(descriptor_);
  fail(Exit::io, "{}: cannot be listened to: {}", path_, std::strerror(error));
}

Control::~Control() {
  for (const Asker& asker : askers_) close(asker.descriptor);
  // Another file may have taken the name meanwhile.
  if (identity(path_) == file_) unlink(path_.c_str());
  close(descriptor_);
}

bool Control::serve(Asker& asker,
                    const std::function<std::string(const std::string& command)>& answer) {
  if (now() - asker.accepted > kPatience) return false;
  while (!asker.answered) {
    char bytes[kMaxCommand];
    const ssize_t got = recv(asker.descriptor, bytes, sizeof bytes, 0);
    if (got < 0) return would_wait();
    asker.command.append(bytes, static_cast<std::size_t>(got));
    const std::size_t end = asker.command.find('\n');
    if (end != std::string::npos) {
      asker.answer = answer(asker.command.substr(0, end));
    } else if (asker.command.size() > kMaxCommand) {
      asker.answer = fmt::format("{}a command has at most {} bytes\n", kError, kMaxCommand);
    } else if (got == 0) {
      return false;
    } else {
      continue;
    }
    asker.answered = true;
  }
  while (!asker.answer.empty()) {
    const ssize_t sent =
        send(asker.descriptor, asker.answer.data(), asker.answer.size(), MSG_NOSIGNAL);
    if (sent < 0) return would_wait();
    asker.answer.erase(0, static_cast<std::size_t>(sent));
  }
  return false;
}

void Control::serve(const std::function<std::string(const std::string& command)>& answer) {
  while (askers_.size() < kMaxAskers) {
    const int asker = accept4(descriptor_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (asker < 0) break;
    askers_.push_back({asker, now(), {}, {}});
  }
  for (auto it = askers_.begin(); it != askers_.end();) {
    if (serve(*it, answer)) {
      ++it;
      continue;
    }
    close(it->descriptor);
    it = askers_.erase(it);
  }
}

std::string ask(const std::string& path, const std::string& command) {
  if (command.size() > kMaxCommand || command.find('\n') != std::string::npos)
    fail(Exit::usage, "--ask: a command is one line of at most {} bytes", kMaxCommand);
  const int descriptor = new_socket(0);
  const std::string line = command + "\n";
  std::string answer;
  bool good = reaches(descriptor, path) && send(descriptor, line.data(), line.size(),
                                                MSG_NOSIGNAL) == static_cast<ssize_t>(line.size());
  if (!good) {
    const int error = errno;
    close(descriptor);
    fail(Exit::io, "{}: no server answers: {}", path, std::strerror(error));
  }
  const double end = now() + 2 * kPatience;
  ssize_t got = 1;
  while (got > 0 && now() < end) {
    pollfd wait{descriptor, POLLIN, 0};
    if (poll(&wait, 1, 100) <= 0) continue;
    char bytes[4096];
    got = recv(descriptor, bytes, sizeof bytes, 0);
    if (got > 0) answer.append(bytes, static_cast<std::size_t>(got));
  }
  close(descriptor);
  if (answer.empty()) fail(Exit::io, "{}: the server does not answer", path);
  if (answer.starts_with(kError)) {
    answer.erase(0, std::strlen(kError));
    while (answer.ends_with('\n')) answer.pop_back();
    fail(Exit::bad_input, "{}", answer);
  }
  return answer;
}

}  // namespace gicodec::streaming
