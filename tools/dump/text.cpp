#include "dump/text.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <deque>
#include <type_traits>
#include <vector>

namespace gicodec::tools {
namespace {

std::atomic<int> first_output_error = 0;

/// Bytes of the first character of `text`, and its code; 0 if it is not UTF-8.
std::size_t read_character(std::string_view text, std::uint32_t& code) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(0);
  const std::size_t size = lead < 0x80   ? 1
                           : lead < 0xC2 ? 0
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 0;
  if (size <= 1) {
    code = lead;
    return size;
  }
  if (size > text.size()) return 0;
  code = lead & (0x7FU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  const bool overlong = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000);
  return overlong || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? 0 : size;
}

bool is_safe(std::uint32_t code) {
  if (code < 0x20 || (code >= 0x7F && code < 0xA0)) return false;
  const bool turns = (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return !turns && code != 0x200E && code != 0x200F && code != 0x2028 && code != 0x2029;
}

void escape(char byte, std::string& to) {
  constexpr const char* kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  to += "\\x";
  to += kDigits[value >> 4];
  to += kDigits[value & 15];
}

/// Copies `text`. For each character, replace(code, bytes, to) may append other text and return
/// true. Escapes bytes that are not UTF-8.
template <typename Replace>
std::string replaced(std::string_view text, const Replace& replace) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    std::uint32_t code = 0;
    const std::size_t size = read_character(text, code);
    if (size == 0) {
      escape(text.front(), out);
    } else if (!replace(code, text.substr(0, size), out)) {
      out += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return out;
}

}  // namespace

void write_text(std::FILE* stream, std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (!written && stream == stdout && first_output_error == 0) first_output_error = errno;
}

void print_arguments(std::FILE* stream, fmt::string_view format, fmt::format_args arguments) {
  using Argument = fmt::basic_format_arg<fmt::format_context>;
  std::deque<std::string> texts;
  std::vector<Argument> safe;
  for (int i = 0; const Argument argument = arguments.get(i); ++i) {
    safe.push_back(fmt::visit_format_arg(
        [&](const auto& value) -> Argument {
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_convertible_v<T, fmt::string_view>) {
            const fmt::string_view text = texts.emplace_back(
                printable({fmt::string_view(value).data(), fmt::string_view(value).size()}));
            return fmt::format_args(fmt::make_format_args(text)).get(0);
          } else {
            return argument;
          }
        },
        argument));
  }
  write_text(stream,
             fmt::vformat(format, fmt::format_args(safe.data(), static_cast<int>(safe.size()))));
}

void flush_text(std::FILE* stream) {
  if (std::fflush(stream) != 0 && stream == stdout && first_output_error == 0)
    first_output_error = errno;
}

int output_error() noexcept { return first_output_error; }

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%^";
  const bool plain = std::all_of(word.begin(), word.end(), [&](char c) {
    return kPlain.find(c) != std::string_view::npos || static_cast<unsigned char>(c) >= 0x80;
  });
  if (plain && !word.empty()) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::string printable(std::string_view text) {
  return replaced(text, [](std::uint32_t code, std::string_view bytes, std::string& to) {
    if (is_safe(code)) return false;
    for (const char byte : bytes) escape(byte, to);
    return true;
  });
}

std::string utf8_text(std::string_view text) {
  return replaced(text, [](std::uint32_t, std::string_view, std::string&) { return false; });
}

std::string printable_json(std::string_view json) {
  return replaced(json, [](std::uint32_t code, std::string_view, std::string& to) {
    if (is_safe(code) || code == '\n') return false;
    to += fmt::format("\\u{:04x}", code);  // none is beyond U+FFFF
    return true;
  });
}

std::string message(std::string_view text) {
  constexpr std::size_t kFront = 1200, kEnd = 600;
  if (text.size() <= kFront + kEnd) return printable(text);
  // Cuts before escaping, so that no escape is cut; a cut character becomes escapes.
  return printable(text.substr(0, kFront)) + " [...] " + printable(text.substr(text.size() - kEnd));
}

}  // namespace gicodec::tools
