#include "common/command_line.h"

#include "dump/file_system.h"
#include "dump/text.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <iostream>
#include <limits>
#include <ranges>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <utility>

namespace gicodec::tools {

Allowed in_range(int least, int most) { return {Allowed::Whole{least, most}}; }
Allowed in_range(double least, double most) { return {Allowed::Real{least, most}}; }
Allowed one_of(std::vector<std::string> names) { return {std::move(names)}; }

/// A check of a number's text, with the same message for all types. `range`: as help shows it.
template <typename T>
static CLI::Validator number_check(T least, T most, const std::string& kind,
                                   const std::string& range) {
  return {[=](const std::string& text) {
            T value{};
            // NaN fails the comparison.
            const bool good =
                CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? std::string() : "\"" + text + "\" is no " + kind;
          },
          range};
}

static std::string text_of(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Name of the check that a number fits its type; an option's own range replaces it.
static constexpr const char* kOfType = "of type";

Option* Option::allow(const Allowed& allowed) {
  if (!std::holds_alternative<std::vector<std::string>>(allowed.values)) {
    option_->get_validator(kOfType)->active(false);
  }
  if (const auto* whole = std::get_if<Allowed::Whole>(&allowed.values)) {
    const std::string least = std::to_string(whole->least), most = std::to_string(whole->most);
    option_->check(number_check(whole->least, whole->most,
                                "whole number from " + least + " to " + most,
                                "INT in [" + least + " - " + most + "]"));
  } else if (const auto* real = std::get_if<Allowed::Real>(&allowed.values)) {
    const std::string least = text_of(real->least), most = text_of(real->most);
    option_->check(number_check(real->least, real->most, "number from " + least + " to " + most,
                                "FLOAT in [" + least + " - " + most + "]"));
  } else {
    option_->check(CLI::IsMember(std::get<std::vector<std::string>>(allowed.values)));
  }
  return this;
}

Option* Option::show_default() {
  option_->capture_default_str();
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::group(const std::string& name) {
  option_->group(name);
  return this;
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::expected(int count) {
  option_->expected(count)->allow_extra_args(false);
  return this;
}

Option* Option::take_all() {
  option_->take_all();
  return this;
}

/// The first argument that no option and no command takes.
static std::string unknown_of(const CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> left = app.remaining(true);
  std::string unknown;
  for (int i = 1; i < argc; ++i) {
    if (std::ranges::find(left, argv[i]) == left.end()) continue;
    unknown += (unknown.empty() ? "" : " ") + std::string(argv[i]);
  }
  return unknown;
}

Command::Command(std::string description, std::string name)
    : name_(std::move(name)),
      own_(std::make_unique<CLI::App>(std::move(description), name_)),
      app_(own_.get()) {
  app_->allow_windows_style_options(false);  // paths begin like these
}

Command::Command(CLI::App* app, std::string name) : name_(std::move(name)), app_(app) {}

Command::~Command() = default;

Option* Command::keep(CLI::Option* option) {
  options_.push_back(std::unique_ptr<Option>(new Option(option)));
  return options_.back().get();
}

/// Checks numbers of options without a range.
template <typename T>
static void check_number(CLI::Option* option) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_integral_v<T>) {
    const std::string least = std::to_string(Limits::min()), most = std::to_string(Limits::max());
    option->check(
        number_check(Limits::min(), Limits::max(), "whole number from " + least + " to " + most, "")
            .name(kOfType));
  } else if constexpr (std::is_floating_point_v<T>) {
    option->check(number_check(Limits::lowest(), Limits::max(), "number", "").name(kOfType));
  }
}

/// Refuses an option as another option's value: "--core -o x.gic" lacks a core.
static void needs_value(const CLI::App& app, CLI::Option* option) {
  if (option->get_positional()) return;
  option->check(CLI::Validator(
      [&app](const std::string& text) {
        const bool is_option =
            text.size() > 1 && text[0] == '-' && app.get_option_no_throw(text) != nullptr;
        return is_option ? "a value is missing before " + text : std::string();
      },
      ""));
}

template <typename T>
Option* Command::add_option(const std::string& names, T& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(names, value, help);
  if constexpr (requires { typename T::value_type; } && !std::ranges::range<T>) {
    check_number<typename T::value_type>(option);
  } else {
    check_number<T>(option);
  }
  needs_value(*app_, option);
  return keep(option);
}
#define GICODEC_OPTION_OF(...) \
  template Option* Command::add_option(const std::string&, __VA_ARGS__&, const std::string&)
GICODEC_OPTION_OF(std::string);
GICODEC_OPTION_OF(std::vector<std::string>);
GICODEC_OPTION_OF(int);
GICODEC_OPTION_OF(std::uint16_t);
GICODEC_OPTION_OF(std::uint32_t);
GICODEC_OPTION_OF(std::uint64_t);
GICODEC_OPTION_OF(float);
GICODEC_OPTION_OF(double);
GICODEC_OPTION_OF(std::optional<float>);
GICODEC_OPTION_OF(std::optional<double>);
#undef GICODEC_OPTION_OF

Option* Command::add_option(const std::string& names,
                            const std::function<void(const std::string&)>& set,
                            const std::string& help) {
  CLI::Option* const option = app_->add_option_function<std::string>(names, set, help);
  needs_value(*app_, option);
  return keep(option);
}

Option* Command::add_flag(const std::string& names, bool& value, const std::string& help) {
  return keep(app_->add_flag(names, value, help));
}

bool Command::given(const std::string& name) const { return app_->count(name) > 0; }

std::string Command::given_options(const std::vector<std::string>& except) const {
  std::string text;
  for (const CLI::Option* const option : app_->get_options()) {
    const std::string name = option->get_name();
    const bool left_out = std::find(except.begin(), except.end(), name) != except.end();
    if (option->count() == 0 || left_out) continue;
    text += (text.empty() ? "" : " ") + name;
    if (option->get_expected_max() == 0) continue;  // a flag
    for (const std::string& value : option->results()) text += " " + shell_word(value);
  }
  return text;
}

Option* Command::get_option(const std::string& name) { return keep(app_->get_option(name)); }

void Command::remove_option(Option* option) { app_->remove_option(option->option_); }

Command* Command::add_command(const std::string& name, const std::string& description) {
  commands_.push_back(
      std::unique_ptr<Command>(new Command(app_->add_subcommand(name, description), name)));
  return commands_.back().get();
}

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::require_command() {
  app_->require_subcommand(1);
  app_->fallthrough();
}

void Command::version(const std::string& text) { app_->set_version_flag("--version", text); }

void Command::require_known_command(int argc, const char* const* argv) const {
  const auto first = std::find_if(argv + 1, argv + argc, [](auto* text) { return text[0] != '-'; });
  if (commands_.empty() || first == argv + argc) return;
  std::string known;
  for (const auto& command : commands_) {
    if (command->name_ == *first) return;
    known += (known.empty() ? "" : ", ") + command->name_;
  }
  fail(Exit::usage, "{} is no command; there are {}", *first, known);
}

std::optional<Exit> Command::parse(int argc, const char* const* argv) {
  // "help" and "help COMMAND" mean "--help" and "COMMAND --help".
  std::vector<const char*> line(argv, argv + argc);
  if (!commands_.empty() && argc > 1 && std::string_view(argv[1]) == "help") {
    line.erase(line.begin() + 1);
    line.push_back("--help");
    argc = static_cast<int>(line.size());
    argv = line.data();
  }
  require_known_command(argc, argv);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // An unknown argument is reported before a missing one.
    const std::string unknown = unknown_of(*app_, argc, argv);
    const bool incomplete = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr ||
                            dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    if (incomplete && !unknown.empty()) fail(Exit::usage, "not expected: {}; see --help", unknown);
    const std::string_view what = error.what();
    if (const auto twice = what.find(": At Most 1 required"); twice != what.npos)
      fail(Exit::usage, "{} is given more than once; see --help", what.substr(0, twice));
    if (error.get_exit_code() != 0) fail(Exit::usage, "{}; see --help", error.what());
    app_->exit(error);
    const bool read_enough = !std::cout.flush() && reader_ended(errno);  // "--help | head"
    if (!std::cout && !read_enough) fail(Exit::io, "standard output: cannot be written");
    return Exit::ok;
  }
  return std::nullopt;
}

}  // namespace gicodec::tools
