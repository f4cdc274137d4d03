// Makes text from files safe to show: names and attributes may hold any bytes.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// Escapes control characters, marks that change the direction of writing, and bytes that are not
/// UTF-8, as \x1b. The result stays on its line, and terminals do not obey it. Safe text stays as
/// it is, so the function is idempotent.
[[nodiscard]] std::string printable(std::string_view text);

/// printable(), cut in the middle to about 2,000 bytes: messages begin with the error, end with the
/// hint.
[[nodiscard]] std::string message(std::string_view text);

/// Text for JSON: escapes bytes that are not UTF-8 as \xHH.
[[nodiscard]] std::string utf8_text(std::string_view text);
/// Escapes characters of JSON's strings that printable() would escape, as \uHHHH.
[[nodiscard]] std::string printable_json(std::string_view json);

/// A word of a command line, quoted where a shell would read it otherwise.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Text with ASCII letters in lower case.
[[nodiscard]] std::string lower_case(std::string text);

/// "a, b, c": what `text_of` gives of each.
template <typename Range, typename TextOf>
[[nodiscard]] std::string listed(const Range& range, const TextOf& text_of) {
  std::string list;
  for (const auto& one : range) (list += list.empty() ? "" : ", ") += std::invoke(text_of, one);
  return list;
}

/// "a, b and 3 more": the first of `count` names.
template <typename Range>
[[nodiscard]] std::string listed(const Range& first, std::size_t count) {
  const std::string list = listed(first, std::identity{});
  return count > first.size() ? fmt::format("{} and {} more", list, count - first.size()) : list;
}

/// Writes text unchanged. output_error() keeps the reason of the first failure on standard output.
void write_text(std::FILE* stream, std::string_view text);
/// Flushes; output_error() also keeps the reason of a failure.
void flush_text(std::FILE* stream);
/// That reason, an errno; 0 if nothing failed.
[[nodiscard]] int output_error() noexcept;

/// fmt::print() with printable() text arguments. Does not throw if the stream cannot be written;
/// see output_error().
void print_arguments(std::FILE* stream, fmt::string_view format, fmt::format_args arguments);
template <typename... Args>
void print(std::FILE* stream, fmt::format_string<Args...> format, const Args&... args) {
  print_arguments(stream, format, fmt::make_format_args(args...));
}
/// The same, to standard output.
template <typename... Args>
void print(fmt::format_string<Args...> format, const Args&... args) {
  print_arguments(stdout, format, fmt::make_format_args(args...));
}

}  // namespace gicodec::tools
