// Text from files, made safe to show: names and attributes may hold anything.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

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

/// printable() for text, anything else as it is.
template <typename T>
[[nodiscard]] decltype(auto) shown(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return printable(value);
  } else {
    return (value);
  }
}

/// Text as it is. Why a first write to standard output failed is kept for output_error().
void write_text(std::FILE* stream, std::string_view text);
/// What was written goes out now; why it failed is kept, too.
void flush_text(std::FILE* stream);
/// That errno; 0 if all went well so far.
[[nodiscard]] int output_error() noexcept;

/// fmt::print() with printable() arguments. Throws nothing where the stream cannot be written: who
/// depends on it asks at the end.
template <typename... Args>
void print(std::FILE* stream, fmt::format_string<Args...> format, Args&&... args) {
  [&](const auto&... safe) {
    write_text(stream, fmt::vformat(format, fmt::make_format_args(safe...)));
  }(shown(args)...);
}
/// The same to standard output.
template <typename... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  tools::print(stdout, format, std::forward<Args>(args)...);
}

}  // namespace gicodec::tools
