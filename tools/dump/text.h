// Text from files, made safe to show: names and attributes may hold anything.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// The same text with control characters, marks that turn the direction of writing and bytes that
/// are no UTF-8 as escapes such as \x1b, so that it stays on its line and no terminal obeys it.
/// Text that is safe comes back as it is, so doing it twice changes nothing.
[[nodiscard]] std::string printable(std::string_view text);

/// printable(), at most some 2,000 bytes of it: where a message would be longer its middle goes.
/// What went wrong stands in front, what helps at the end.
[[nodiscard]] std::string message(std::string_view text);

/// For JSON, which is UTF-8: bytes that are no UTF-8 as \xHH, anything else as it is.
[[nodiscard]] std::string utf8_text(std::string_view text);
/// JSON with characters that printable() would not show, which stand in its strings alone, as
/// \uHHHH.
[[nodiscard]] std::string printable_json(std::string_view json);

/// Letters of ASCII in lower case.
[[nodiscard]] std::string lower_case(std::string text);

/// Text as it is. Why a first write to standard output failed is kept for output_error().
void write_text(std::FILE* stream, std::string_view text);
/// What was written goes out now; why it failed is kept, too.
void flush_text(std::FILE* stream);
/// That errno; 0 if all went well so far.
[[nodiscard]] int output_error() noexcept;

/// fmt::print() of which each text among the arguments is printable(). Throws nothing where the
/// stream cannot be written: what depends on it asks at the end.
void print_arguments(std::FILE* stream, fmt::string_view format, fmt::format_args arguments);
template <typename... Args>
void print(std::FILE* stream, fmt::format_string<Args...> format, const Args&... args) {
  print_arguments(stream, format, fmt::make_format_args(args...));
}
/// The same to standard output.
template <typename... Args>
void print(fmt::format_string<Args...> format, const Args&... args) {
  print_arguments(stdout, format, fmt::make_format_args(args...));
}

}  // namespace gicodec::tools
