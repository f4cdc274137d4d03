#include "program.h"

#include "dump/file.h"

#include <gicodec/version.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace gicodec::ddgi {
namespace {

/// Other threads than the one that took the signal look at it.
std::atomic<int> caught_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);
void note_signal(int signal) { caught_signal = signal; }

}  // namespace

bool interrupted() noexcept { return caught_signal != 0; }

void check_interrupt() {
  if (caught_signal != 0) throw Interrupted{caught_signal};
}

int run_program(tools::Command& app, int argc, char** argv,
                const std::function<tools::Exit()>& run) {
  using tools::Exit;
  const auto report = [&](Exit exit, const char* message) {
    tools::print(stderr, "{}: {}\n", app.name(), message);
    return static_cast<int>(exit);
  };
  tools::keep_standard_numbers();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of its write
  std::signal(SIGINT, note_signal);
  std::signal(SIGTERM, note_signal);
  if (std::signal(SIGHUP, note_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
  try {
    app.version(fmt::format("{} {}", app.name(), kVersionString));
    if (const auto exit = app.parse(argc, argv)) return static_cast<int>(*exit);
    const Exit exit = run();
    tools::finish_standard_output();
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
