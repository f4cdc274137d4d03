#include "file_names.h"

#include "dump/file_system.h"
#include "dump/sequence.h"
#include "dump/text.h"
#include "dump/texture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gicodec::tools {
namespace {

constexpr std::size_t kLongest = 255;   ///< bytes of a file's name
constexpr std::size_t kNumber = 10;     ///< digits of a frame's number for which there is room
constexpr std::size_t kHash = 18;       ///< bytes of %~ and the hash
constexpr const char* kNothing = "%-";  ///< stands for an empty text
constexpr std::string_view kSidecar = ".json";
/// What no name has there.
constexpr std::string_view kWindowsHasNot = "\\:*?\"<>|";

/// Bytes of the first character of `text`; 0 if a terminal does not show it as it is.
std::size_t shown_size(std::string_view text) {
  constexpr std::size_t kMax = 4;
  for (std::size_t size = 1; size <= std::min(kMax, text.size()); ++size) {
    if (printable(text.substr(0, size)) == text.substr(0, size)) return size;
  }
  return 0;
}

/// True of names that are devices on Windows, with any extension: CON, COM1.
bool is_device(std::string_view name) {
  std::string stem = lower_case(std::string(name.substr(0, name.find('.'))));
  stem.erase(stem.find_last_not_of(' ') + 1);
  constexpr std::string_view kAlone[] = {"con", "prn", "aux", "nul", "conin$", "conout$"};
  if (std::ranges::count(kAlone, stem) > 0) return true;
  // The frame's number may follow at once; some write it above the line.
  const bool numbered = stem.starts_with("com") || stem.starts_with("lpt");
  const std::string_view number = std::string_view(stem).substr(numbered ? 3 : 0);
  constexpr std::string_view kAbove[] = {"\u00B9", "\u00B2", "\u00B3"};
  return numbered &&
         (number.empty() || (number.size() == 1 && number[0] >= '0' && number[0] <= '9') ||
          std::ranges::count(kAbove, number) > 0);
}

int hex_digit(char c) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  return static_cast<int>(static_cast<std::ptrdiff_t>(kDigits.find(c)) & 0xFF);
}

/// The byte that "%2F..." stands for; -1 if it is no escape.
int escaped_byte(std::string_view text) {
  if (text.size() < 3 || text[0] != '%') return -1;
  const int high = hex_digit(text[1]), low = hex_digit(text[2]);
  if (high > 15 || low > 15) return -1;
  const int byte = high * 16 + low;
  if (kWindows) return byte;
  const bool may_stay = byte > ' ' && byte < 0x7F && byte != '%' && byte != '.' && byte != '/';
  return may_stay ? -1 : byte;
}

bool reads_as_escape(std::string_view text) {
  return escaped_byte(text) >= 0 || text.starts_with("%~") || text.starts_with(kNothing);
}

/// File names: a number between two texts, or one name.
struct Names {
  std::string before;
  unsigned digits = 0;  ///< least digits of the number, padded with zeros; 0: no number
  std::string after;
};

bool all_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// True if `text`, followed by a number of `digits` or more, can be a number of `wanted` digits or
/// more.
bool completes(std::string_view text, unsigned digits, unsigned wanted) {
  if (!all_digits(text)) return false;
  return text.empty() || text[0] != '0' || text.size() + digits <= wanted;
}

bool is_one_of(const std::string& name, const Names& names) {
  if (names.digits == 0) return name == names.before + names.after;
  const std::size_t around = names.before.size() + names.after.size();
  if (name.size() < around + names.digits || !name.starts_with(names.before) ||
      !name.ends_with(names.after))
    return false;
  const auto number = std::string_view(name).substr(names.before.size(), name.size() - around);
  return all_digits(number) && (number.size() == names.digits || number[0] != '0');
}

bool meet(const Names& a, const Names& b) {
  if (a.digits == 0) return is_one_of(a.before + a.after, b);
  if (b.digits == 0) return is_one_of(b.before + b.after, a);
  if (a.after != b.after) return false;
  if (a.before.size() > b.before.size()) return meet(b, a);
  if (!b.before.starts_with(a.before)) return false;
  return completes(std::string_view(b.before).substr(a.before.size()), b.digits, a.digits);
}

/// True if attribute raw:sidecar of any frame has the value `where`.
bool has_sidecar(const StoredTexture& texture, std::string_view where) {
  const auto says = [&](const Attribute* attribute) {
    return where == (attribute == nullptr ? std::string_view() : attribute->value);
  };
  return says(find_attribute(texture.info.attributes, kRawSidecar)) ||
         std::ranges::any_of(texture.changes, [&](const FrameAttribute& change) {
           return change.attribute.name == kRawSidecar && says(&change.attribute);
         });
}

std::vector<Names> names_of(const StoredTexture& texture) {
  const auto& [digits, extension, separator, base, counts_sign] = texture.names;
  const std::string stem = folded(file_stem(texture));
  const std::string before = digits == 0 ? stem : stem + folded(separator);
  const std::string ending = folded(extension.empty() ? "" : "." + extension);
  std::vector<Names> names{{before, digits, ending}};
  if (image_kind("x" + ending) != ImageKind::raw) return names;
  if (has_sidecar(texture, "")) names.push_back({before, digits, std::string(kSidecar)});
  if (has_sidecar(texture, "shared")) {
    names.push_back({folded(texture_path(texture.file_name(0))), 0, std::string(kSidecar)});
  }
  return names;
}

}  // namespace

std::string as_file_name(std::string_view text, std::size_t most, std::string_view also) {
  if (text.empty()) return kNothing;
  std::string part;
  std::size_t end = 0;  // where it may be cut
  for (std::string_view rest = text; !rest.empty();) {
    if (part.size() + kHash <= most) end = part.size();
    const std::size_t shown = shown_size(rest);
    const char first = rest[0];
    const bool hides = part.empty() && first == '.';
    const bool windows_refuses =
        kWindows && (kWindowsHasNot.find(first) != std::string_view::npos ||
                     (part.empty() && is_device(text)) || (rest.size() == 1 && first == ' '));
    if (shown == 0 || first == '/' || hides || windows_refuses ||
        also.find(first) != std::string_view::npos || reads_as_escape(rest)) {
      part += fmt::format("%{:02X}", static_cast<unsigned char>(first));
      rest.remove_prefix(1);
    } else {
      part += rest.substr(0, shown);
      rest.remove_prefix(shown);
    }
  }
  if (part.size() <= most) return part;
  return fmt::format("{}%~{:016x}", part.substr(0, end), XXH3_64bits(text.data(), text.size()));
}

std::string from_file_name(const std::string& part) {
  std::string text;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const int byte = escaped_byte(std::string_view(part).substr(i));
    text += byte < 0 ? part[i] : static_cast<char>(byte);
    if (byte >= 0) i += 2;
  }
  const bool written = is_utf8(text) && as_file_name(text, part.size()) == part;
  return written ? text : part;
}

std::string file_stem(const StoredTexture& texture) {
  const auto& [digits, extension, separator, base, counts_sign] = texture.names;
  std::size_t rest = extension.empty() ? 0 : 1 + extension.size();
  const bool is_raw = image_kind("x." + extension) == ImageKind::raw;
  if (is_raw && has_sidecar(texture, "")) rest = std::max(rest, kSidecar.size());
  if (digits > 0) {
    rest += separator.size() +
            (texture.made_of_files ? digits : std::max<std::size_t>(digits, kNumber));
  }
  return as_file_name(texture.file, kLongest - rest);
}

bool names_meet(const StoredTexture& a, const StoredTexture& b) {
  if (of_one_file(a, b)) return a.info.place == b.info.place && a.info.image == b.info.image;
  const auto others = names_of(b);
  return std::ranges::any_of(names_of(a), [&](const Names& own) {
    return std::ranges::any_of(others, [&](const Names& other) { return meet(own, other); });
  });
}

}  // namespace gicodec::tools
