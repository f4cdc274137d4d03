#include "error_flags.h"

#include "dump/error.h"
#include "named_value.h"
#include "volume_words.h"

#include <gicodec/error_bound.h>

#include <charconv>
#include <cmath>
#include <optional>

namespace gicodec::tools {
namespace {

constexpr const char* kExpected =
    "a number of codes or ULP from 1 on, or for floats a relative error below 1";

std::optional<float> parse_error(std::string_view text) {
  float value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == end;
  if (!whole || !valid_error(value)) return std::nullopt;
  return value;
}

}  // namespace

void add_error_flag(Command& command, std::vector<std::string>& values, const std::string& what,
                    const std::string& group) {
  constexpr const char* kUnits =
      ": codes or ULP from 1 on, or for floats a relative error below 1 (of the smallest normal "
      "number, below it); default: 0, bit by bit";
  command.add_option("--max-error", values, what + kUnits)
      ->type_name("[NAME=]E")
      ->group(group)
      ->expected(1)
      ->take_all();
}

float max_error_for(const std::vector<std::string>& values, const std::string& texture,
                    const Record& record) {
  const float asked =
      value_for(values, texture, "--max-error", kExpected, parse_error).value_or(0.0F);
  const float error = asked >= 1 ? std::floor(asked) : asked;  // as the library rounds it
  if (error > 0 && !allows_error(record, error)) {
    fail(Exit::usage,
         "--max-error {} is less than one code or ULP of texture {} ({}); codes are given from 1 "
         "on, --max-error {}=0 leaves it exact, --max-error NAME={} is for another texture alone",
         error, texture, record_text(record), texture, error);
  }
  return error;
}

void refuse_error_of(const std::vector<std::string>& values, const std::string& texture) {
  for (const std::string& value : values) {
    if (value.starts_with(texture + "=") && parse_error(value.substr(texture.size() + 1)) != 0.0F)
      fail(Exit::usage, "--max-error {}: texture {} must stay exact; leave it out", value, texture);
  }
}

void check_error_names(const std::vector<std::string>& values,
                       const std::vector<std::string>& textures) {
  check_value_names(values, "--max-error", textures);
}

}  // namespace gicodec::tools
