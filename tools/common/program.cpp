#include "program.h"

#include "dump/file.h"
#include "dump/memory_reserve.h"

#include <gicodec/version.h>

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace gicodec::tools {
namespace {

/// Other threads than the one that took the signal look at it.
std::atomic<int> caught_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int signal) { caught_signal = signal; }
/// Until the program ends: it may have begun to wait for a pipe right after the signal to end.
extern "C" void wake(int) { alarm(1); }
extern "C" void note_and_wake(int signal) {
  caught_signal = signal;
  alarm(1);
}

void catch_signals(Interrupts interrupts) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // A file that may not grow is an error like a full disk.
  const bool once = interrupts == Interrupts::once;
  struct sigaction again {};
  again.sa_handler = wake;
  if (once) sigaction(SIGALRM, &again, nullptr);
  struct sigaction action {};
  action.sa_handler = once ? note_and_wake : note_signal;
  action.sa_flags = once ? static_cast<int>(SA_RESETHAND) : SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it.
}

/// What libraries allocate where no exception may leave: without memory they end the program.
[[noreturn]] void end_without_memory() {
  if (!memory_ran_out()) std::abort();
  remove_temporaries();
  constexpr char kWords[] = "not enough memory\n";
  static_cast<void>(!write(STDERR_FILENO, kWords, sizeof kWords - 1));
  _exit(static_cast<int>(Exit::internal));
}

int end_by(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  return EXIT_FAILURE;
}

}  // namespace

bool interrupted() noexcept { return caught_signal != 0; }

void check_interrupt() {
  if (caught_signal != 0) throw Interrupted{caught_signal};
}

int run_program(Command& app, int argc, char** argv, const std::function<Exit()>& run,
                Interrupts interrupts, const std::string& formats) {
  const auto report = [&](Exit exit, const char* what) {
    print(stderr, "{}: {}\n", app.name(), message(what));
    return static_cast<int>(exit);
  };
  keep_standard_numbers();
  keep_memory_reserve();
  std::set_terminate(end_without_memory);
  catch_signals(interrupts);
  try {
    app.version(fmt::format("{} {}{}", app.name(), kVersionString, formats));
    if (const auto exit = app.parse(argc, argv)) return static_cast<int>(*exit);
    const Exit exit = run();
    finish_standard_output();
    return static_cast<int>(exit);
  } catch (const Interrupted& interrupted) {
    return end_by(interrupted.signal);
  } catch (const Error& error) {
    // The cause of a failed read or write.
    if (interrupts == Interrupts::once && interrupted()) return end_by(caught_signal);
    return report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    std::fputs(app.name().c_str(), stderr);  // what needs none
    std::fputs(": not enough memory\n", stderr);
    return static_cast<int>(Exit::internal);
  } catch (const std::exception& error) {
    return report(Exit::internal, error.what());
  }
}

}  // namespace gicodec::tools
