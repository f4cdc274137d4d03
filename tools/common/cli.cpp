#include "cli.h"

#include "dump/data_text.h"
#include "dump/file_system.h"

#include <gicodec/threads.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <thread>
#include <utility>

namespace gicodec::tools {

void add_output_format(Command& command, std::string& format) {
  command.add_option("--format", format, "Output as text or json")
      ->allow(one_of({"text", "json"}))
      ->show_default();
}

void add_overwrite(Command& command, bool& overwrite, const char* what) {
  command.add_flag("--overwrite", overwrite, what);
}

void add_allow_incomplete(Command& command, bool& allow) {
  command.add_flag("--allow-incomplete", allow, "Go on even if the container's end is missing");
}

void add_threads(Command& command, unsigned& threads) {
  threads = std::max(1U, std::thread::hardware_concurrency());
  command.add_option("--threads", threads, "Threads to use; default: one per processor")
      ->allow(in_range(1, 256))
      ->type_name("N");
}

void add_isa(Command& command, Isa& isa) {
  // Help is the same on all machines.
  const std::function<void(const std::string&)> set = [&isa](const std::string& name) {
    const std::optional<Isa> found = isa_from_string(name);
    if (!found || !is_supported(*found)) {
      fail(Exit::usage, "--isa: \"{}\" is none of {}, which this machine has", name,
           listed(supported_isas(), [](Isa one) { return to_string(one); }));
    }
    isa = *found;
  };
  command
      .add_option("--isa", set,
                  "Instruction set of every kernel: scalar, sse4, avx2, avx512, neon; default: the "
                  "best that this machine has. The bytes are the same")
      ->type_name("NAME");
}

void remark(const std::string& text) { print(stderr, "gicodec: {}\n", message(text)); }

void print_json(nlohmann::ordered_json json) { write_json(stdout, std::move(json), 2); }

Progress::Progress(std::string label, std::size_t total, const Cli& cli)
    : label_(std::move(label)), total_(total), shown_(!cli.quiet && is_terminal(stderr)) {}

Progress::~Progress() {
  if (shown_ && done_ > 0) print(stderr, "\r\033[K");
}

void Progress::step() {
  check_interrupt();
  ++done_;
  if (!shown_) return;
  if (total_ > 0) {
    print(stderr, "\r\033[K{}: {} of {}", label_, done_, total_);
  } else {
    print(stderr, "\r\033[K{}: {}", label_, done_);
  }
  std::fflush(stderr);
}

void run_all(unsigned threads, const std::vector<std::function<void()>>& tasks) {
  struct Tasks {
    const std::vector<std::function<void()>>& all;
    std::vector<std::exception_ptr> errors;
    std::atomic<std::size_t> next{0};

    static void take(void* self, unsigned) noexcept {
      Tasks& tasks = *static_cast<Tasks*>(self);
      for (std::size_t i = tasks.next++; i < tasks.all.size(); i = tasks.next++) {
        try {
          tasks.all[i]();
        } catch (...) {
          tasks.errors[i] = std::current_exception();
        }
      }
    }
  };
  Tasks all{tasks, std::vector<std::exception_ptr>(tasks.size())};
  const Executor executor = own_threads();
  executor.run(executor.self, static_cast<unsigned>(std::min<std::size_t>(threads, tasks.size())),
               Tasks::take, &all);
  for (const auto& error : all.errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace gicodec::tools
