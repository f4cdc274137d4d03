// Loading that does not keep a program from ending.
#pragma once

#include "common/program.h"
#include "ddgi/parallel.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>

namespace gicodec::streaming {

/// Runs `work` on a thread of its own; returns or throws what it does, or nullopt once the program
/// is interrupted. Then the thread still runs, because parsers of files cannot be stopped: call
/// end_now(), and destroy nothing that the work refers to.
template <typename Work>
[[nodiscard]] std::optional<std::invoke_result_t<Work>> unless_interrupted(Work work) {
  using Result = std::invoke_result_t<Work>;
  std::packaged_task<Result()> task(std::move(work));
  std::future<Result> result = task.get_future();
  std::thread worker(std::move(task));
  while (result.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
    if (!tools::interrupted()) continue;
    worker.detach();
    return std::nullopt;
  }
  worker.join();
  try {
    return result.get();
  } catch (const ddgi::Cancelled&) {
    return std::nullopt;
  }
}

/// Ends a program while a thread is still loading, without destroying anything that it uses. For
/// the time before there are connections.
[[noreturn]] inline void end_now(tools::Exit exit) {
  std::fflush(stdout);
  std::quick_exit(static_cast<int>(exit));
}

}  // namespace gicodec::streaming
