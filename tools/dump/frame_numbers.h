// Numbers in names of files, and which of them are frames'.
#pragma once

#include "dump/sequence.h"

#include <charconv>
#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::tools {

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
/// Between a name and its number.
constexpr bool is_separator(char c) noexcept { return c == '.' || c == '_' || c == '-'; }

/// A file's name, split before the number at its end.
struct ParsedName {
  std::string name;
  std::string separator;
  std::string number;  ///< with its sign; empty: none
  std::string extension;

  [[nodiscard]] bool is_negative() const { return number.starts_with('-'); }
  [[nodiscard]] unsigned digits() const {
    return static_cast<unsigned>(number.size()) - (is_negative() ? 1 : 0);
  }
  [[nodiscard]] std::int64_t value() const {
    std::int64_t value = 0;
    std::from_chars(number.data(), number.data() + number.size(), value);
    return value;
  }
  /// Makes the number a part of the name.
  void keep_number() {
    name += separator + number;
    separator.clear();
    number.clear();
  }
};

/// Takes any number at the end of a name for a frame's, but a side as in 1024x1024.
[[nodiscard]] ParsedName parse_name(const std::string& path);

struct Input {
  std::string path;
  ParsedName parsed;
};

/// Returns numbers that are no frame's to the names. `remarks`, if not null: what was taken for
/// what.
void settle_numbers(std::vector<Input>& inputs, const NumberOptions& options,
                    std::vector<std::string>* remarks);

}  // namespace gicodec::tools
