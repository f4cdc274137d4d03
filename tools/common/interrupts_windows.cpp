#include "interrupts.h"

#include "dump/file.h"

#include <windows.h>

#include <atomic>
#include <csignal>

/// Makes mingw's runtime library expand patterns among the arguments, as shells do elsewhere.
extern "C" {
int _dowildcard = -1;
}

namespace gicodec::tools {
namespace {

std::atomic<int> caught = 0;
std::atomic<bool> ends_at_second = false;

/// Runs in a thread of its own.
BOOL WINAPI note_event(DWORD event) {
  const bool again = caught.exchange(event == CTRL_C_EVENT ? SIGINT : SIGTERM) != 0;
  if (event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT) return !again || !ends_at_second;
  // The system ends the process after five seconds.
  Sleep(4000);
  remove_temporaries();
  end_now(static_cast<int>(STATUS_CONTROL_C_EXIT), "");
}

}  // namespace

void catch_signals(Interrupts interrupts) {
  ends_at_second = interrupts == Interrupts::once;
  SetConsoleCtrlHandler(note_event, TRUE);
}

int caught_signal() noexcept { return caught; }

int end_by(int) { return static_cast<int>(STATUS_CONTROL_C_EXIT); }

void end_now(int exit, std::string_view words) noexcept {
  DWORD written = 0;
  WriteFile(GetStdHandle(STD_ERROR_HANDLE), words.data(), static_cast<DWORD>(words.size()),
            &written, nullptr);
  TerminateProcess(GetCurrentProcess(), static_cast<UINT>(exit));
  for (;;) Sleep(INFINITE);
}

}  // namespace gicodec::tools
