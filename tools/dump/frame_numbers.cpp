#include "dump/frame_numbers.h"

#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/text.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 18;

}  // namespace

ParsedName parse_name(const std::string& file) {
  const fs::path path = native_path(file);
  ParsedName parsed;
  parsed.extension = path_text(path.extension());
  if (!parsed.extension.empty()) parsed.extension.erase(0, 1);
  const std::string stem = path_text(path.stem());
  parsed.name = stem;
  std::size_t first = stem.size();
  while (first > 0 && is_digit(stem[first - 1])) --first;
  if (first == stem.size() || first == 0 || stem.size() - first > kMaxDigits) return parsed;
  if (first > 1 && (stem[first - 1] == 'x' || stem[first - 1] == 'X') && is_digit(stem[first - 2]))
    return parsed;
  // A sign stands behind a separator: foo.-003.
  if (first > 1 && stem[first - 1] == '-' && is_separator(stem[first - 2])) --first;
  const std::size_t end = is_separator(stem[first - 1]) ? first - 1 : first;
  if (end == 0) return parsed;
  parsed.name = stem.substr(0, end);
  parsed.separator = stem.substr(end, first - end);
  parsed.number = stem.substr(first);
  return parsed;
}

namespace {

/// True if `text` is what a pattern stands for, in which * is any text. Only the last star takes
/// more than it did at first, so that time is bounded by the product of both sizes.
bool matches(std::string_view text, std::string_view pattern) {
  std::size_t at = 0, next = 0;
  std::optional<std::size_t> star;
  std::size_t resume = 0;
  while (at < text.size()) {
    if (next < pattern.size() && pattern[next] == '*') {
      star = next++;
      resume = at;
    } else if (next < pattern.size() && pattern[next] == text[at]) {
      ++next, ++at;
    } else if (star) {
      next = *star + 1;
      at = ++resume;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', next) == std::string_view::npos;
}

/// True if the number of a file stands where a pattern has its #.
bool at_pattern(const ParsedName& parsed, const std::string& pattern) {
  const std::size_t first = pattern.find('#');
  if (first == std::string::npos) return false;
  const std::size_t end = std::min(pattern.find_first_not_of('#', first), pattern.size());
  const std::string_view rest = std::string_view(pattern).substr(end);
  const bool extension = rest.empty() || matches("." + parsed.extension, rest);
  return extension &&
         matches(parsed.name + parsed.separator, std::string_view(pattern).substr(0, first));
}

/// The patterns of files whose numbers are frames'. Throws for one without a #, and in the end for
/// one that no file has.
class Patterns {
 public:
  explicit Patterns(const std::vector<std::string>& patterns)
      : patterns_(patterns), found_(patterns.size()) {
    for (const std::string& pattern : patterns) {
      if (pattern.find('#') != std::string::npos) continue;
      fail(Exit::usage, "--frames-from {}: has no # where the number is, as in \"irr_#\"", pattern);
    }
  }
  bool take(const ParsedName& parsed) {
    bool any = false;
    for (std::size_t i = 0; i < patterns_.size(); ++i) {
      if (!at_pattern(parsed, patterns_[i])) continue;
      any = found_[i] = true;
    }
    return any;
  }
  void finish() const {
    const auto missed = std::ranges::find(found_, false);
    if (missed == found_.end()) return;
    fail(Exit::usage,
         "--frames-from \"{}\": no file has a number there; a frame's number is the last of a "
         "name, before the extension",
         patterns_[static_cast<std::size_t>(missed - found_.begin())]);
  }

 private:
  const std::vector<std::string>& patterns_;
  std::vector<bool> found_;
};

/// The known sequence that a file belongs to; null if there is none.
const Sequence* known_of(const ParsedName& parsed, const std::vector<Sequence>& known) {
  const std::string stem = parsed.name + parsed.separator + parsed.number;
  for (const Sequence& one : known) {
    const FileNames& names = one.names;
    const auto kind = image_kind("x." + parsed.extension);
    // What is only read comes back as EXR.
    const bool replaced = names.extension == "exr" && kind && !is_written(*kind);
    if (names.extension != parsed.extension && !replaced) continue;
    if (names.digits == 0 && one.name == stem) return &one;
    if (names.digits > 0 && one.name == parsed.name && names.separator == parsed.separator &&
        !parsed.number.empty()) {
      return &one;
    }
  }
  return nullptr;
}

/// True if all files hold the same images, of one size and format.
bool are_alike(const std::vector<const Input*>& files) {
  try {
    const auto first = read_dump_infos(files.front()->path);
    return std::ranges::all_of(files, [&](const Input* file) {
      const auto same = [](const DumpInfo& a, const DumpInfo& b) {
        return a.desc == b.desc && a.image == b.image && a.channels == b.channels;
      };
      return std::ranges::equal(first, read_dump_infos(file->path), same);
    });
  } catch (const Error&) {
    return true;  // Files that flags describe, or damaged ones, of which reading them tells.
  }
}

constexpr const char* kUnlike = "their shapes or formats differ";

bool is_run(const std::vector<const Input*>& files) {
  std::set<std::int64_t> numbers;
  for (const Input* file : files) numbers.insert(file->parsed.value());
  return static_cast<std::uint64_t>(*numbers.rbegin() - *numbers.begin()) + 1 == numbers.size();
}

/// Why numbers that files alone differ in are none of frames; empty if they are. `alone`: there are
/// other numbered files, and none of that number.
std::string why_no_frames(const std::vector<const Input*>& files, const NumberOptions& options,
                          bool alone) {
  const ParsedName& any = files.front()->parsed;
  if (any.separator == ".") return "";
  if (files.size() == 1) {
    const bool is_long = any.digits() >= (any.separator.empty() ? 4U : 3U);
    return is_long && !alone ? "" : "it is the only one";
  }
  bool padded = false;
  for (const Input* file : files) {
    const std::string& number = file->parsed.number;
    padded =
        padded || (file->parsed.digits() > 1 && number.find_first_not_of('-') == number.find('0'));
  }
  const bool named_so =
      any.separator.empty() && any.digits() < 4 && std::ranges::any_of(any.name, is_digit);
  if (named_so) return "their names have other numbers";
  if (!padded && !options.allow_gaps && !is_run(files)) return "their numbers are not consecutive";
  if (!are_alike(files)) return kUnlike;
  return "";
}

/// Says what numbers of several files were taken for, unless they stand behind a point.
void note_guess(const std::vector<const Input*>& files, const std::string& why,
                std::vector<std::string>& remarks) {
  const ParsedName& any = files.front()->parsed;
  if (any.separator == "." || files.size() == 1) return;
  std::string line = fmt::format("{} and {} more: ", files.front()->path, files.size() - 1);
  if (why.empty()) {
    line += "their numbers are taken for those of frames; " + to_cure(Cure::stills);
  } else {
    line += "each is taken for a texture of its own, since " + why;
    if (why != kUnlike) {
      line += "; " + to_cure(Cure::frames_from, shell_word(any.name + any.separator + "#"),
                             is_run(files) ? "" : " --allow-gaps");
    }
  }
  remarks.push_back(std::move(line));
}

}  // namespace

void settle_numbers(std::vector<Input>& inputs, const NumberOptions& options,
                    std::vector<std::string>* remarks) {
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<Input*>> groups;
  Patterns patterns(options.patterns);
  for (Input& input : inputs) {
    ParsedName& parsed = input.parsed;
    if (parsed.number.empty()) continue;
    if (const Sequence* known = known_of(parsed, options.known)) {
      if (known->names.digits == 0) parsed.keep_number();
      continue;
    }
    if (patterns.take(parsed)) continue;
    if (options.stills) {
      parsed.keep_number();
      continue;
    }
    groups[{parsed.name, parsed.separator, parsed.extension}].push_back(&input);
  }
  patterns.finish();
  std::map<std::int64_t, std::size_t> with_number;
  for (const auto& [key, files] : groups) {
    for (const Input* file : files) ++with_number[file->parsed.value()];
  }
  for (auto& [key, files] : groups) {
    const std::vector<const Input*> own(files.begin(), files.end());
    const bool alone = groups.size() > 1 && with_number[own.front()->parsed.value()] == 1;
    const std::string why = why_no_frames(own, options, alone);
    if (remarks != nullptr) note_guess(own, why, *remarks);
    if (why.empty()) continue;
    for (Input* file : files) file->parsed.keep_number();
  }
}

}  // namespace gicodec::tools
