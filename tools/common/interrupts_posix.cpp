#include "interrupts.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

namespace gicodec::tools {
namespace {

/// Other threads than the one that took the signal look at it.
std::atomic<int> caught = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int signal) { caught = signal; }
/// Until the program ends: it may have begun to wait for a pipe right after the signal to end.
extern "C" void wake(int) { alarm(1); }
extern "C" void note_and_wake(int signal) {
  caught = signal;
  alarm(1);
}

}  // namespace

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

int caught_signal() noexcept { return caught; }

int end_by(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  return EXIT_FAILURE;
}

void end_now(int exit, std::string_view words) noexcept {
  static_cast<void>(!write(STDERR_FILENO, words.data(), words.size()));
  _exit(exit);
}

}  // namespace gicodec::tools
