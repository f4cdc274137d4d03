#include "settings.h"

#include "dump/error.h"
#include "dump/text.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <utility>

namespace gicodec::kinds {
namespace {

using tools::Exit;
using tools::fail;

}  // namespace

Settings::Settings(std::string_view kind, std::span<const Setting> known,
                   std::span<const std::string> given, std::string flag)
    : flag_(std::move(flag)) {
  for (const Setting& setting : known) values_.emplace(setting.name, setting.usual);
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      fail(Exit::usage, "--set: expected NAME=VALUE, not \"{}\"", text);
    const auto found = values_.find(std::string_view(text).substr(0, equals));
    if (found == values_.end())
      fail(Exit::usage, "--set: {} have no setting \"{}\"; there are: {}", kind,
           text.substr(0, equals), known.empty() ? "none" : tools::listed(known, &Setting::name));
    found->second = text.substr(equals + 1);
  }
}

const std::string& Settings::text(std::string_view name) const {
  return values_.find(name)->second;
}

double Settings::number(std::string_view name, double least, double most) const {
  const std::string& value = text(name);
  double number = 0;
  const char* const end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, number);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == end;
  if (!whole || !(number >= least && number <= most))
    fail(Exit::usage, "{}{}: expected a number from {:g} to {:g}, not \"{}\"", flag_, name, least,
         most, value);
  return number;
}

std::uint32_t Settings::whole(std::string_view name, std::uint32_t least,
                              std::uint32_t most) const {
  const std::string& value = text(name);
  std::uint32_t number = 0;
  const char* const end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, number);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == end;
  if (!whole || number < least || number > most)
    fail(Exit::usage, "{}{}: expected a whole number from {} to {}, not \"{}\"", flag_, name, least,
         most, value);
  return number;
}

std::size_t Settings::choice(std::string_view name,
                             std::span<const std::string_view> allowed) const {
  const std::string& value = text(name);
  std::string names;
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    if (allowed[i] == value) return i;
    names += (i == 0 ? "" : ", ") + std::string(allowed[i]);
  }
  fail(Exit::usage, "{}{}: expected one of {}, not \"{}\"", flag_, name, names, value);
}

ddgi::GatherOptions gather_options(const Settings& settings, std::uint32_t least,
                                   std::uint32_t most, std::uint32_t seed) {
  return {.rays = settings.whole("rays", least, most),
          .turned = settings.whole("rays-turned", 0, 1) == 1,
          .anew = settings.whole("rays-anew", 0, 1) == 1,
          .warmup = settings.whole("warmup", 0, 100),
          .seed = seed};
}

std::vector<float> numbers_from_string(std::string_view text, std::size_t count) {
  std::vector<float> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (values.size() < count) {
    if (!values.empty() && (at == end || *at++ != ',')) return {};
    const auto parsed = std::from_chars(at, end, values.emplace_back());
    if (parsed.ec != std::errc{} || !(std::abs(values.back()) <= 1e6F)) return {};
    at = parsed.ptr;
  }
  return at == end ? values : std::vector<float>{};
}

std::string help_of(std::span<const Setting> known) {
  std::string text;
  for (const Setting& setting : known) {
    text +=
        fmt::format("  {:13}  {} (default: {})\n", setting.name, setting.summary, setting.usual);
  }
  return text;
}

}  // namespace gicodec::kinds
