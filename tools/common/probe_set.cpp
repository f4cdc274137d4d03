#include "probe_set.h"

#include "dump/error.h"
#include "dump/file_system.h"

#include <gicodec/texture.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

namespace gicodec::tools {

ProbeSet::ProbeSet(std::string_view text, const std::string& where) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto number = [&] {
    std::uint32_t value = 0;
    const auto parsed = std::from_chars(at, end, value);
    if (parsed.ec != std::errc{} || value >= kMaxBlocks) {
      const auto line = 1 + std::count(text.data(), at, '\n');
      fail(Exit::bad_input, "{}: line {}: expected a probe index or a range a-b", where, line);
    }
    at = parsed.ptr;
    return value;
  };
  std::vector<Range> named;
  while (at != end) {
    if (*at == '#') at = std::find(at, end, '\n');
    if (at == end) break;
    if (std::isspace(static_cast<unsigned char>(*at)) != 0 || *at == ',') {
      ++at;
      continue;
    }
    Range range{number(), 0};
    range.last = range.first;
    if (at != end && *at == '-') {
      ++at;
      range.last = number();
      if (range.last < range.first) {
        fail(Exit::bad_input, "{}: range {}-{} is reversed", where, range.first, range.last);
      }
    }
    named.push_back(range);
  }
  std::ranges::sort(named, {}, &Range::first);
  for (const Range& range : named) {
    if (!ranges_.empty() && range.first <= ranges_.back().last) {
      fail(Exit::bad_input, "{}: probe {} is named twice", where, range.first);
    }
    if (!ranges_.empty() && range.first == ranges_.back().last + 1) {
      ranges_.back().last = range.last;
    } else {
      ranges_.push_back(range);
    }
  }
}

std::string ProbeSet::text() const {
  std::string text;
  for (const Range& range : ranges_) {
    text += fmt::format("{}{}", text.empty() ? "" : ",", range.first);
    if (range.last > range.first) text += fmt::format("-{}", range.last);
  }
  return text;
}

std::uint64_t ProbeSet::size() const noexcept {
  std::uint64_t size = 0;
  for (const Range& range : ranges_) size += std::uint64_t{range.last} - range.first + 1;
  return size;
}

bool ProbeSet::contains(std::uint32_t probe) const noexcept {
  const auto at = std::ranges::lower_bound(ranges_, probe, {}, &Range::last);
  return at != ranges_.end() && at->first <= probe;
}

/// Largest file of them: ranges take less, and a device has no end.
static constexpr std::size_t kMaxInactiveBytes = std::size_t{64} << 20;

ProbeSet read_probe_set(const std::string& path) {
  std::ifstream file(native_path(path), std::ios::binary);
  std::string text;
  while (file && text.size() <= kMaxInactiveBytes) {
    constexpr std::size_t kStep = std::size_t{1} << 16;
    const std::size_t before = text.size();
    text.resize(before + kStep);
    file.read(&text[before], kStep);
    text.resize(before + static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof() && text.size() <= kMaxInactiveBytes) {
    fail(Exit::io, "{}: cannot be read: {}", path, reason(errno));
  }
  if (text.size() > kMaxInactiveBytes) {
    fail(Exit::bad_input, "{}: has more than {} bytes; name probes by ranges a-b", path,
         kMaxInactiveBytes);
  }
  return {text, path};
}

}  // namespace gicodec::tools
