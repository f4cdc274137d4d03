#include "program.h"

#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/memory_reserve.h"

#include <gicodec/version.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace gicodec::tools {
namespace {

/// What libraries allocate where no exception may leave: without memory they end the program.
[[noreturn]] void end_without_memory() {
  if (!memory_ran_out()) std::abort();
  remove_temporaries();
  end_now(static_cast<int>(Exit::internal), "not enough memory\n");
}

}  // namespace

bool interrupted() noexcept { return caught_signal() != 0; }

void check_interrupt() {
  if (caught_signal() != 0) throw Interrupted{caught_signal()};
}

int run_program(Command& app, int argc, char** argv, const std::function<Exit()>& run,
                Interrupts interrupts, const std::string& formats) {
  const auto report = [&](Exit exit, const char* what) {
    print(stderr, "{}: {}\n", app.name(), message(what));
    return static_cast<int>(exit);
  };
  prepare_standard_streams();
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
    if (interrupts == Interrupts::once && interrupted()) return end_by(caught_signal());
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
