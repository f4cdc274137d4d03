#include "supervisor.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace gicodec::test {
namespace {

constexpr char kEndOfName = '\n';
constexpr char kAllDone = '\0';  ///< in place of a name

void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t size = ::write(descriptor, text.data(), text.size());
    if (size <= 0) std::_Exit(EXIT_FAILURE);
    text.remove_prefix(static_cast<std::size_t>(size));
  }
}

constexpr const char* kPipe = "GICODEC_SUPERVISOR_PIPE";  ///< of a child: its descriptor
constexpr const char* kBut = "GICODEC_SUPERVISOR_BUT";    ///< of a child: names, a line each

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; (at = text.find(kEndOfName)) != std::string_view::npos;) {
    lines.emplace_back(text.substr(0, at));
    text.remove_prefix(at + 1);
  }
  return lines;
}

[[noreturn]] void run(const Work& work, int to_parent) {
  const std::vector<std::string> but = split(std::getenv(kBut));
  // Programs that tests start are no children of this kind.
  ::unsetenv(kPipe);
  ::unsetenv(kBut);
  ::fcntl(to_parent, F_SETFD, FD_CLOEXEC);
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // What was said before a crash is seen.
  const bool good = work(
      but, [&](std::string_view name) { write_all(to_parent, std::string(name) + kEndOfName); });
  write_all(to_parent, std::string{kAllDone, kEndOfName});
  std::exit(good ? EXIT_SUCCESS : EXIT_FAILURE);  // Looks for leaks, under AddressSanitizer.
}

/// A program of its own rather than a copy of this one, whose libraries may have started threads.
[[noreturn]] void become_child(char** arguments, const std::vector<std::string>& but,
                               int to_parent) {
  std::string names;
  for (const std::string& name : but) names += name + kEndOfName;
  ::setenv(kPipe, std::to_string(to_parent).c_str(), 1);
  ::setenv(kBut, names.c_str(), 1);
  ::fcntl(to_parent, F_SETFD, 0);
  ::execv("/proc/self/exe", arguments);
  std::_Exit(EXIT_FAILURE);
}

/// What is written there until its end, by lines.
std::vector<std::string> lines_of(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  ssize_t size = 0;
  while ((size = ::read(descriptor, buffer.data(), buffer.size())) > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(size));
  }
  return split(text);
}

std::string end_of(int status) {
  return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                             : "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

bool supervise(char** arguments, const Work& work) {
  if (const char* pipe = std::getenv(kPipe)) run(work, std::atoi(pipe));
  std::vector<std::string> begun;
  std::vector<std::string> crashed;
  bool good = true;
  while (true) {
    std::fflush(nullptr);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    const pid_t child = ::fork();
    if (child < 0) return false;
    if (child == 0) become_child(arguments, begun, ends[1]);
    ::close(ends[1]);
    std::vector<std::string> names = lines_of(ends[0]);
    ::close(ends[0]);
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return false;
    good = good && WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
    const bool done = !names.empty() && names.back() == std::string(1, kAllDone);
    if (done || names.empty()) {
      if (!done) crashed.push_back("before anything began, " + end_of(status));
      break;
    }
    crashed.push_back(names.back() + ", " + end_of(status));
    std::printf("CRASHED: %s; the others go on\n", crashed.back().c_str());
    begun.insert(begun.end(), names.begin(), names.end());
  }
  for (const std::string& one : crashed) std::printf("CRASHED: %s\n", one.c_str());
  return good && crashed.empty();
}

}  // namespace gicodec::test
