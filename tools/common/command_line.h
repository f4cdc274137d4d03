// The command lines of all tools. CLI11 does the work; compilers take so long over it that one file
// alone sees it.
#pragma once

#include "dump/error.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace gicodec::tools {

/// Which values an option takes.
struct Allowed {
  struct Whole {
    std::int64_t least, most;
  };
  struct Real {
    double least, most;
  };
  std::variant<Whole, Real, std::vector<std::string>> values;
};
[[nodiscard]] Allowed in_range(int least, int most);
[[nodiscard]] Allowed in_range(double least, double most);
[[nodiscard]] Allowed one_of(std::vector<std::string> names);

/// One option, owned by its Command; every call returns the same option.
class Option {
 public:
  Option* allow(const Allowed& allowed);
  Option* show_default();  ///< what the value is now
  Option* type_name(const std::string& name);
  Option* group(const std::string& name);  ///< its section of --help
  Option* required();
  Option* excludes(Option* other);
  Option* expected(int count);  ///< values each time that it is given, and never more
  Option* take_all();           ///< it may be given any number of times

 private:
  friend class Command;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

/// A program or one of its commands. Values that options are bound to must outlive it.
class Command {
 public:
  explicit Command(std::string description, std::string name);
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command();

  /// Names as "-o,--output", or "files" for what stands without a flag. Values are strings,
  /// numbers, lists and optionals of both: what command_line.cpp lists.
  template <typename T>
  Option* add_option(const std::string& names, T& value, const std::string& help = "");
  /// `set` gets the text.
  Option* add_option(const std::string& names, const std::function<void(const std::string&)>& set,
                     const std::string& help);
  Option* add_flag(const std::string& names, bool& value, const std::string& help);
  [[nodiscard]] Option* get_option(const std::string& name);
  void remove_option(Option* option);
  /// After parse(): whether the option of that name was on the line.
  [[nodiscard]] bool given(const std::string& name) const;

  Command* add_command(const std::string& name, const std::string& description);
  /// Runs while parsing, once all values are set.
  void callback(std::function<void()> run);
  void footer(const std::string& text);
  /// One of the commands has to be given; flags of the program may stand behind it.
  void require_command();
  void version(const std::string& text);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Exit::ok after printing what --help or --version asks for, else nothing: the program goes on.
  /// Throws Error of Exit::usage for a line that makes no sense.
  [[nodiscard]] std::optional<Exit> parse(int argc, const char* const* argv);

 private:
  explicit Command(CLI::App* app, std::string name);
  Option* keep(CLI::Option* option);
  void require_known_command(int argc, const char* const* argv) const;

  std::string name_;
  std::unique_ptr<CLI::App> own_;  ///< of a program; of its commands, it owns them
  CLI::App* app_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> commands_;
};

}  // namespace gicodec::tools
