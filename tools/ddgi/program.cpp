#include "program.h"

#include <gicodec/version.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace gicodec::ddgi {
namespace {

volatile std::sig_atomic_t caught_signal = 0;
void note_signal(int signal) { caught_signal = signal; }

}  // namespace

const char* const kExitCodes =
    "Exit codes: 0 success, 1 a comparison found a difference, 2 wrong usage, 3 damaged or\n"
    "unsuitable input, 4 a file cannot be opened, read or written, 5 an internal error.";

bool interrupted() noexcept { return caught_signal != 0; }

void check_interrupt() {
  if (caught_signal != 0) throw Interrupted{caught_signal};
}

int run_program(tools::Command& app, int argc, char** argv,
                const std::function<tools::Exit()>& run) {
  using tools::Exit;
  const auto report = [&](Exit exit, const char* message) {
    std::fputs(fmt::format("{}: {}\n", app.get_name(), message).c_str(), stderr);
    return static_cast<int>(exit);
  };
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // A file that may not grow is an error like a full disk.
  std::signal(SIGINT, note_signal);
  std::signal(SIGTERM, note_signal);
  try {
    app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), kVersionString));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      const bool asked = error.get_exit_code() == 0;
      app.exit(error);
      return static_cast<int>(asked ? Exit::ok : Exit::usage);
    }
    const Exit exit = run();
    if (std::fflush(stdout) != 0) return report(Exit::io, "standard output: cannot be written");
    return static_cast<int>(exit);
  } catch (const Interrupted& interrupted) {
    std::signal(interrupted.signal, SIG_DFL);
    std::raise(interrupted.signal);
    return EXIT_FAILURE;
  } catch (const tools::Error& error) {
    return report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return report(Exit::internal, "not enough memory");
  } catch (const std::exception& error) {
    return report(Exit::internal, error.what());
  }
}

}  // namespace gicodec::ddgi
