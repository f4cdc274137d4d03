// The command lines of all tools. CLI11 does the work; only command_line.cpp includes it, because
// it compiles slowly.
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

/// The values that an option takes.
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
  Option* show_default();  ///< help shows the present value
  Option* type_name(const std::string& name);
  Option* group(const std::string& name);  ///< its section of --help
  Option* required();
  Option* excludes(Option* other);
  Option* expected(int count);  ///< exactly so many values each time it is given
  Option* take_all();           ///< may be given any number of times

 private:
  friend class Command;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

/// A program or one of its commands. Bound values must outlive it.
class Command {
 public:
  explicit Command(std::string description, std::string name);
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command();

  /// `names`: "-o,--output", or "files" for positional arguments. `T`: strings, numbers, lists and
  /// optionals of both, as command_line.cpp lists them.
  template <typename T>
  Option* add_option(const std::string& names, T& value, const std::string& help = "");
  /// `set` is called with the option's text.
  Option* add_option(const std::string& names, const std::function<void(const std::string&)>& set,
                     const std::string& help);
  Option* add_flag(const std::string& names, bool& value, const std::string& help);
  [[nodiscard]] Option* get_option(const std::string& name);
  void remove_option(Option* option);
  /// After parse(): true if the option was given.
  [[nodiscard]] bool given(const std::string& name) const;

  /// After parse(): the options that were given, as on a command line, in the order of --help,
  /// without these.
  [[nodiscard]] std::string given_options(const std::vector<std::string>& except) const;

  Command* add_command(const std::string& name, const std::string& description);
  /// `run` is called during parse(), after all values are set.
  void callback(std::function<void()> run);
  void footer(const std::string& text);
  /// Requires one of the commands; the program's flags may follow it.
  void require_command();
  void version(const std::string& text);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Parses the arguments. Returns Exit::ok after printing --help or --version, else nullopt: the
  /// program goes on. Throws Error of Exit::usage for an invalid command line.
  [[nodiscard]] std::optional<Exit> parse(int argc, const char* const* argv);

 private:
  explicit Command(CLI::App* app, std::string name);
  Option* keep(CLI::Option* option);
  void require_known_command(int argc, const char* const* argv) const;

  std::string name_;
  std::unique_ptr<CLI::App> own_;  ///< a program's; it owns those of its commands
  CLI::App* app_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> commands_;
};

}  // namespace gicodec::tools
