#include "dump/sequence.h"

#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/text.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <tuple>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 18;
constexpr std::size_t kMaxFiles = 10000;  ///< of a directory

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

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_separator(char c) { return c == '.' || c == '_' || c == '-'; }

/// Splits a file name; takes any number at its end for a frame's, but a side as in 1024x1024.
ParsedName parse(const fs::path& path) {
  ParsedName parsed;
  parsed.extension = path.extension().string();
  if (!parsed.extension.empty()) parsed.extension.erase(0, 1);
  const std::string stem = path.stem().string();
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

struct Input {
  std::string path;
  ParsedName parsed;
};

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

/// The known sequence that a file belongs to; null if there is none.
const Sequence* known_of(const ParsedName& parsed, const std::vector<Sequence>& known) {
  const std::string stem = parsed.name + parsed.separator + parsed.number;
  for (const Sequence& one : known) {
    if (one.extension != parsed.extension) continue;
    if (one.digits == 0 && one.name == stem) return &one;
    if (one.digits > 0 && one.name == parsed.name && one.separator == parsed.separator &&
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
  if (!padded && !options.allow_gaps && !is_run(files)) return "they are no run";
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
    line += "taken for stills, since " + why;
    if (why != kUnlike) {
      line += "; " + to_cure(Cure::frames_from, shell_word(any.name + any.separator + "#"),
                             is_run(files) ? "" : " --allow-gaps");
    }
  }
  remarks.push_back(std::move(line));
}

/// Returns numbers that are no frame's to the names.
void settle_numbers(std::vector<Input>& inputs, const NumberOptions& options,
                    std::vector<std::string>* remarks) {
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<Input*>> groups;
  for (Input& input : inputs) {
    ParsedName& parsed = input.parsed;
    if (parsed.number.empty()) continue;
    if (const Sequence* known = known_of(parsed, options.known)) {
      if (known->digits == 0) parsed.keep_number();
      continue;
    }
    if (options.stills || !options.pattern.empty()) {
      if (options.stills || !at_pattern(parsed, options.pattern)) parsed.keep_number();
      continue;
    }
    groups[{parsed.name, parsed.separator, parsed.extension}].push_back(&input);
  }
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

/// What of a directory is not read.
struct LeftOut {
  std::size_t count = 0;
  std::set<std::string> names;  ///< the first few

  void add(const std::string& name) {
    constexpr std::size_t kNamed = 4;
    ++count;
    names.insert(name);
    if (names.size() > kNamed) names.erase(std::prev(names.end()));
  }
  /// "a.txt, b.txt and 3 more".
  [[nodiscard]] std::string text() const {
    const std::string list = listed(names, [](const std::string& name) { return name; });
    return count > names.size() ? fmt::format("{} and {} more", list, count - names.size()) : list;
  }
};

/// Takes a directory's entry if it is a file that is read.
void take_entry(const fs::directory_entry& entry, std::vector<std::string>& files,
                LeftOut& left_out) {
  const std::string name = entry.path().filename().string();
  const auto kind = image_kind(name);
  std::error_code error;
  const bool folder = entry.is_directory(error);
  // Files without an extension count as EXR only if the caller names them.
  const bool image = kind && entry.path().has_extension() && !folder;
  if (name[0] == '.' && !image) return;
  const bool sidecar = entry.path().extension() == ".json";
  if (image && is_written(*kind) && name[0] != '.') {
    if (!entry.is_symlink(error) || fs::exists(entry.path(), error)) {
      files.push_back(entry.path().string());
    } else {
      left_out.add(name + " (a link to nothing)");
    }
  } else if (!sidecar) {
    left_out.add(folder ? name + "/" : name);
  }
}

std::vector<std::string> expand_directories(const std::vector<std::string>& paths,
                                            std::vector<std::string>* remarks) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    const std::size_t first = files.size();
    LeftOut left_out;
    for (const auto& entry : fs::directory_iterator(path, error)) {
      take_entry(entry, files, left_out);
      if (files.size() - first <= kMaxFiles) continue;
      fail(Exit::bad_input, "{}: has more than {} dumps; {}", path, kMaxFiles,
           to_cure(Cure::fewer_files));
    }
    if (error) fail(Exit::io, "{}: cannot be listed: {}", path, error.message());
    if (files.size() == first) {
      fail(Exit::bad_input, "{}: has no .exr, .dds, .ktx2, .raw or .bin files{}", path,
           left_out.count > 0
               ? fmt::format(", but {}; {}", left_out.text(), to_cure(Cure::name_others))
               : "");
    }
    if (left_out.count > 0 && remarks != nullptr) {
      remarks->push_back(
          fmt::format("{}: leaves out {}; {}", path, left_out.text(), to_cure(Cure::name_others)));
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

/// Settles how numbers are padded: as printf() does it, a sign takes the place of a digit.
void settle_digits(Sequence& sequence, std::span<const Input* const> files) {
  std::optional<unsigned> negative, other;
  for (const Input* file : files) {
    const unsigned digits = file->parsed.digits();
    std::optional<unsigned>& least = file->parsed.is_negative() ? negative : other;
    least = std::min(least.value_or(digits), digits);
  }
  if (!negative || !other) {
    sequence.digits = negative ? *negative : *other;
    return;
  }
  sequence.counts_sign = *negative + 1 == *other;
  sequence.digits = sequence.counts_sign ? *other : std::min(*negative, *other);
}

void settle(Sequence& sequence) {
  std::stable_sort(
      sequence.frames.begin(), sequence.frames.end(),
      [](const FrameFile& left, const FrameFile& right) { return left.frame < right.frame; });
  for (std::size_t i = 1; i < sequence.frames.size(); ++i) {
    const FrameFile& left = sequence.frames[i - 1];
    const FrameFile& right = sequence.frames[i];
    if (left.frame == right.frame) {
      fail(Exit::bad_input, "{} and {} are both frame {} of texture {}; {}", left.path, right.path,
           left.frame, sequence.name, to_cure(Cure::one_folder));
    }
  }
  for (const FrameFile& file : sequence.frames) {
    const std::string expected = sequence.file_name(file.frame);
    if (fs::path(file.path).filename() != expected) {
      fail(Exit::bad_input, "{}: frame numbers of texture {} differ in width; {}", file.path,
           sequence.name, to_cure(Cure::name_it, expected));
    }
  }
}

/// Stills beside sequences are of the first frame of these.
void settle_stills(std::vector<Sequence>& sequences) {
  std::optional<std::uint64_t> first;
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      if (sequence.digits > 0) first = std::min(first.value_or(file.frame), file.frame);
    }
  }
  for (Sequence& sequence : sequences) {
    const bool still = sequence.digits == 0 && sequence.frames.size() == 1;
    if (still) sequence.frames.front().frame = first.value_or(0);
  }
}

void refuse_gaps(const std::vector<Sequence>& sequences, Cure cure) {
  const auto frames = all_frames(sequences);
  for (const Sequence& sequence : sequences) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (sequence.digits == 0) break;  // A still has one frame beside a sequence.
      const bool hole = i > 0 && frames[i] != frames[i - 1] + 1;
      const std::uint64_t missing = hole ? frames[i - 1] + 1 : frames[i];
      if (!hole && sequence.find(missing) != nullptr) continue;
      const std::string name = sequence.file_name(missing);
      fail(Exit::bad_input, "frame {} of texture {} is missing ({}); {}", missing, sequence.name,
           (fs::path(sequence.frames.front().path).parent_path() / name).string(), to_cure(cure));
    }
  }
}

}  // namespace

const FrameFile* Sequence::find(std::uint64_t frame) const noexcept {
  const auto at = std::lower_bound(
      frames.begin(), frames.end(), frame,
      [](const FrameFile& file, std::uint64_t wanted) { return file.frame < wanted; });
  return at != frames.end() && at->frame == frame ? &*at : nullptr;
}

std::string Sequence::file_name(std::uint64_t frame) const {
  return frame_file_name(name, digits, frame, extension, separator, base, counts_sign);
}

std::vector<Sequence> group_sequences(const std::vector<std::string>& paths,
                                      const NumberOptions& options,
                                      std::vector<std::string>* remarks) {
  if (!options.pattern.empty() && options.pattern.find('#') == std::string::npos) {
    fail(Exit::usage, "--frames-from {}: has no # where the number is, as in \"irr_#\"",
         options.pattern);
  }
  if (!options.pattern.empty() && options.stills) {
    fail(Exit::usage, "--stills and --frames-from exclude each other");
  }
  std::vector<Input> inputs;
  for (const std::string& path : expand_directories(paths, remarks)) {
    (void)require_image_kind(path);
    inputs.push_back({path, parse(path)});
  }
  settle_numbers(inputs, options, remarks);
  const auto is_numbered = [](const Input& input) { return !input.parsed.number.empty(); };
  if (!options.pattern.empty() && std::ranges::none_of(inputs, is_numbered)) {
    fail(
        Exit::usage,
        "--frames-from \"{}\": no file has a number there; a frame's number is the last of a name, "
        "before the extension",
        options.pattern);
  }
  std::int64_t base = options.known.empty() ? 0 : options.known.front().base;
  for (const Input& input : inputs) {
    if (options.known.empty()) base = std::min(base, input.parsed.value());
  }
  std::vector<Sequence> sequences;
  std::map<std::string, std::size_t> places;
  std::vector<std::vector<const Input*>> files;
  for (const Input& input : inputs) {
    const auto& [path, parsed] = input;
    const unsigned digits = parsed.digits();
    const auto [place, is_new] = places.emplace(parsed.name, sequences.size());
    if (is_new) {
      sequences.push_back(
          {parsed.name, digits, parsed.extension, parsed.separator, base, false, {}});
      files.emplace_back();
    }
    files[place->second].push_back(&input);
    Sequence& sequence = sequences[place->second];
    if (sequence.extension != parsed.extension) {
      fail(Exit::bad_input, "{}: texture {} has files of type .{} as well; {}", path, parsed.name,
           sequence.extension, to_cure(Cure::rename));
    }
    if (sequence.separator != parsed.separator) {
      fail(Exit::bad_input, "{}: texture {} has {} as well; {}", path, parsed.name,
           sequence.frames.front().path, to_cure(Cure::rename));
    }
    if (parsed.value() < base && digits > 0) {
      fail(Exit::bad_input, "{}: its number is below {}, the first there is", path, base);
    }
    const std::int64_t frame = digits == 0 ? 0 : parsed.value() - base;
    sequence.frames.push_back({static_cast<std::uint64_t>(frame), path});
  }
  for (std::size_t i = 0; i < sequences.size(); ++i) settle_digits(sequences[i], files[i]);
  settle_stills(sequences);
  for (Sequence& sequence : sequences) settle(sequence);
  if (!options.allow_gaps) refuse_gaps(sequences, options.cure);
  return sequences;
}

std::string frame_file_name(const std::string& name, unsigned digits, std::uint64_t frame,
                            const std::string& extension, const std::string& separator,
                            std::int64_t base, bool counts_sign) {
  std::string file = name;
  if (digits > 0) {
    const std::uint64_t below = 0 - static_cast<std::uint64_t>(base);
    const bool negative = frame < below;
    file += fmt::format("{}{}{:0{}}", separator, negative ? "-" : "",
                        negative ? below - frame : frame - below,
                        digits - (negative && counts_sign ? 1 : 0));
  }
  if (!extension.empty()) file += "." + extension;
  return file;
}

std::string texture_path(const std::string& path) {
  return (fs::path(path).parent_path() / parse(path).name).string();
}

bool is_separator(const std::string& text) noexcept {
  return text.empty() || text == "." || text == "_" || text == "-";
}

std::string question_of(const std::vector<Sequence>& sequences) {
  constexpr std::size_t kMany = 3;
  std::map<std::string, std::vector<const Sequence*>> alike;
  for (const Sequence& sequence : sequences) {
    if (sequence.frames.size() > 1) continue;
    std::string pattern;
    for (const char c : sequence.name) {
      if (!is_digit(c)) pattern += c;
      if (is_digit(c) && !pattern.ends_with('#')) pattern += '#';
    }
    alike[pattern].push_back(&sequence);
  }
  for (const auto& [pattern, found] : alike) {
    // A number that is last was looked at, and is said.
    const bool last = pattern.size() > 1 && pattern.ends_with('#');
    if (found.size() < kMany || last || pattern.find('#') == std::string::npos) continue;
    return fmt::format(
        "{} textures of one frame differ only in a number, such as {} and {}; if these are frames "
        "of one texture, put the number last: NAME.FFFF.{}",
        found.size(), found[0]->frames.front().path, found[1]->frames.front().path,
        found[0]->extension);
  }
  return "";
}

std::vector<std::uint64_t> all_frames(const std::vector<Sequence>& sequences) {
  std::vector<std::uint64_t> frames;
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) frames.push_back(file.frame);
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

}  // namespace gicodec::tools
