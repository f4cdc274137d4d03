// The commands of gicodec, each in a file of its name, and what they share.
#pragma once

#include "common/program.h"
#include "dump/error.h"
#include "dump/text.h"

#include <gicodec/isa.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace gicodec::tools {

struct Cli {
  Command app{"Packs, unpacks and inspects light probe textures without losing a bit.", "gicodec"};
  bool quiet = false;
  std::function<Exit()> run;  ///< the chosen command
};

void add_backends(Cli& cli);
void add_compare(Cli& cli);
void add_crop(Cli& cli);
void add_decode(Cli& cli);
void add_encode(Cli& cli);
void add_info(Cli& cli);
void add_preview(Cli& cli);
void add_verify(Cli& cli);
void add_view(Cli& cli);

/// Adds "--format text|json".
void add_output_format(Command& command, std::string& format);
/// Adds "--overwrite".
void add_overwrite(Command& command, bool& overwrite, const char* what);
/// Adds "--allow-incomplete".
void add_allow_incomplete(Command& command, bool& allow);
/// Adds "--threads N", preset to the number of processors.
void add_threads(Command& command, unsigned& threads);
/// Adds "--isa NAME" with the instruction sets of this machine.
void add_isa(Command& command, Isa& isa);

/// Prints a warning or remark to standard error, as a message() behind the program's name.
void remark(const std::string& text);
/// Prints to standard output, by utf8_text() and printable_json().
void print_json(nlohmann::ordered_json json);

/// Shows a count of steps on a terminal, nothing elsewhere. Each step also calls check_interrupt().
class Progress {
 public:
  Progress(std::string label, std::size_t total, const Cli& cli);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();
  void step();

 private:
  std::string label_;
  std::size_t total_;
  std::size_t done_ = 0;
  bool shown_;
};

/// Starts tasks in order on up to `threads` threads, and returns when all have ended. Rethrows the
/// exception of the first task in the list that failed.
void run_all(unsigned threads, const std::vector<std::function<void()>>& tasks);

}  // namespace gicodec::tools
