// Program::run_in() where programs are started by fork().
#include "sanitizers.h"
#include "tools/cli_support.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string_view>

namespace gicodec::tools {
namespace {

/// Most memory of a running process in kilobytes. What the system tells after its end counts this
/// program's own as well, from which it was forked.
std::optional<long> peak_of(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  for (std::string word; status >> word;) {
    long kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes;
  }
  return std::nullopt;
}

/// In the child.
void limit_memory(std::uint64_t bytes) {
#if defined(GICODEC_ASAN)
  constexpr std::uint64_t kSanitizer = 256;  // MiB
  const std::string options =
      fmt::format("quarantine_size_mb=1:hard_rss_limit_mb={}:max_allocation_size_mb={}",
                  (bytes >> 20) + kSanitizer, bytes >> 20);
  setenv("ASAN_OPTIONS", options.c_str(), 1);
#elif defined(GICODEC_TSAN)
  // It takes several times the memory that it watches, so that single allocations are all to look
  // at.
  const char* const others = getenv("TSAN_OPTIONS");
  const std::string options =
      fmt::format("{}:max_allocation_size_mb={}", others == nullptr ? "" : others, bytes >> 20);
  setenv("TSAN_OPTIONS", options.c_str(), 1);
#else
  const rlimit limit{bytes, bytes};
  if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(125);
#endif
}

}  // namespace

Outcome Program::run_in(const Circumstances& circumstances,
                        const std::vector<std::string>& arguments) const {
  const TemporaryDirectory streams;
  const std::string out = streams.path("out"), err = streams.path("err");
  std::vector<char*> argv = {
      const_cast<char*>(circumstances.program == nullptr ? GICODEC_CLI : circumstances.program)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  // x265 and OpenImageIO (its messages) do not free everything; only LeakSanitizer looks at this.
  const std::string suppressions = streams.path("suppressions");
  write_bytes(
      suppressions,
      std::as_bytes(std::span(std::string_view("leak:libx265\nleak:ImageInput::geterror\n"))));
  const std::string lsan_options = "print_suppressions=0:suppressions=" + suppressions;
  const std::string root = directory_.path("");
  const int terminal = circumstances.terminal ? posix_openpt(O_RDWR | O_NOCTTY) : -1;
  if (circumstances.terminal && (grantpt(terminal) != 0 || unlockpt(terminal) != 0)) std::abort();
  const std::string screen = circumstances.terminal         ? ptsname(terminal)
                             : circumstances.output.empty() ? out
                                                            : circumstances.output;
  const pid_t child = fork();
  if (child == 0) {
    const auto redirect = [](const std::string& path, int flags, int to) {
      const int from = open(path.c_str(), flags, 0644);
      if (from < 0 || dup2(from, to) < 0) _exit(125);
    };
    redirect(circumstances.input, O_RDONLY, 0);
    redirect(screen, O_WRONLY | O_CREAT | O_NOCTTY, 1);
    if (circumstances.one_stream) {
      dup2(1, 2);
    } else {
      redirect(err, O_WRONLY | O_CREAT, 2);
    }
    if (circumstances.unread) {
      int ends[2] = {};
      if (pipe(ends) != 0 || dup2(ends[1], 1) < 0) _exit(125);
      close(ends[0]);
      close(ends[1]);
    }
    if (circumstances.closed) {
      close(1);
      close(2);
    }
    const rlimit limit{circumstances.file_bytes, circumstances.file_bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(125);
    if (circumstances.memory != kNoLimit) limit_memory(circumstances.memory);
    if (chdir(root.c_str()) != 0) _exit(125);
    setenv("LSAN_OPTIONS", lsan_options.c_str(), 1);
    const std::string& libraries = circumstances.libraries;
    if (!libraries.empty()) setenv("LD_LIBRARY_PATH", libraries.c_str(), 1);
#if defined(GICODEC_FAILING_MALLOC)
    if (circumstances.failing_allocation != 0 || !circumstances.allocations.empty()) {
      setenv("LD_PRELOAD", GICODEC_FAILING_MALLOC, 1);
      setenv("GICODEC_FAILING", fmt::format("{}", circumstances.failing_allocation).c_str(), 1);
      setenv("GICODEC_ALLOCATIONS", circumstances.allocations.c_str(), 1);
    }
#endif
    execv(argv[0], argv.data());
    _exit(126);
  }
  int status = 0;
  long peak = 0;
  while (circumstances.kill_when && waitpid(child, &status, WNOHANG) == 0) {
    peak = peak_of(child).value_or(peak);
    if (circumstances.kill_when()) {
      kill(child, circumstances.signal);
      break;
    }
    usleep(200);
  }
  waitpid(child, &status, 0);
  if (terminal >= 0) close(terminal);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const auto text = [](const std::string& path) {
    return std::filesystem::exists(path) ? file_text(path) : std::string();
  };
  return {code, text(out), text(err), peak};
}

}  // namespace gicodec::tools
