#include "dump/ktx2_keys.h"

#include "dump/error.h"
#include "dump/texture_file.h"

#include <gicodec/container.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace gicodec::tools {
namespace {

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

/// Reads a key, NUL, and a value, which is text if its only NUL is its last byte.
/// nullopt for a key that is no attribute's name; the head keeps it.
std::optional<Attribute> read_entry(std::span<const std::byte> entry) {
  const std::string_view text(reinterpret_cast<const char*>(entry.data()), entry.size());
  const std::size_t end = text.find('\0');
  const std::string key(text.substr(0, end));
  if (end == std::string_view::npos || key.empty() || !is_utf8(key) || is_head_field(key)) {
    return std::nullopt;
  }
  const std::string_view value = text.substr(end + 1);
  const bool is_text = value.find('\0') + 1 == value.size() && !value.empty() && is_utf8(value) &&
                       !value.starts_with("0x");
  if (is_text) return text_attribute(key, value.substr(0, value.size() - 1));
  return bytes_attribute(key, entry.subspan(end + 1));
}

}  // namespace

Attributes read_ktx2_keys(std::span<const std::byte> bytes, const std::string& path) {
  Attributes attributes;
  while (!bytes.empty()) {
    if (bytes.size() < 4 || word_at(bytes, 0) > bytes.size() - 4) {
      fail(Exit::bad_input, "{}: its keys and values are damaged: one is longer than their part",
           path);
    }
    const std::size_t size = word_at(bytes, 0);
    if (attributes.size() == kMaxAttributes) {
      fail(Exit::bad_input, "{}: has more than {} keys", path, kMaxAttributes);
    }
    if (auto entry = read_entry(bytes.subspan(4, size))) attributes.push_back(*std::move(entry));
    bytes = bytes.subspan(std::min(bytes.size(), padded(4 + size)));
  }
  std::ranges::stable_sort(attributes, {}, &Attribute::name);
  const auto same = [](const Attribute& a, const Attribute& b) { return a.name == b.name; };
  attributes.erase(std::unique(attributes.begin(), attributes.end(), same), attributes.end());
  return attributes;
}

std::vector<std::byte> write_ktx2_keys(const Attributes& attributes, const std::string& path) {
  std::vector<std::byte> all;
  for (const Attribute& attribute : attributes) {
    if (is_head_field(attribute.name)) continue;
    std::vector<std::byte> value;
    if (attribute.value.starts_with("0x")) {
      value = attribute_bytes(attribute, path);
    } else {
      const auto text = std::as_bytes(std::span(attribute.value));
      value.assign(text.begin(), text.end());
      value.push_back(std::byte{0});
    }
    const auto key = std::as_bytes(std::span(attribute.name));
    if (attribute.name.empty() || attribute.name.find('\0') != std::string::npos) {
      fail(Exit::bad_input, "{}: attribute {} cannot be written as a key of KTX2", path,
           attribute.name);
    }
    const std::size_t size = key.size() + 1 + value.size();
    if (size > kMaxHeadBytes || all.size() > kMaxHeadBytes) {
      fail(Exit::bad_input, "{}: its attributes take more than {} bytes", path, kMaxHeadBytes);
    }
    const std::size_t at = all.size();
    all.resize(at + padded(4 + size));
    set_word(all, at, static_cast<std::uint32_t>(size));
    std::ranges::copy(key, all.begin() + static_cast<std::ptrdiff_t>(at + 4));
    std::ranges::copy(value, all.begin() + static_cast<std::ptrdiff_t>(at + 5 + key.size()));
  }
  return all;
}

}  // namespace gicodec::tools
