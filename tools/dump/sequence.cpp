#include "dump/sequence.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/text.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <tuple>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 18;

struct ParsedName {
  std::string name;
  std::string separator;
  std::string number;  ///< empty: none
  std::string extension;

  /// True if the number must be a frame's; a short one may belong to the name.
  [[nodiscard]] bool certain() const {
    return separator == "." || number.size() >= (separator.empty() ? 4U : 3U);
  }
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Splits a file name; takes any number at its end for a frame's.
ParsedName parse(const fs::path& path) {
  ParsedName parsed;
  parsed.extension = path.extension().string();
  if (!parsed.extension.empty()) parsed.extension.erase(0, 1);
  const std::string stem = path.stem().string();
  parsed.name = stem;
  std::size_t first = stem.size();
  while (first > 0 && is_digit(stem[first - 1])) --first;
  if (first == stem.size() || first == 0 || stem.size() - first > kMaxDigits) return parsed;
  const char before = stem[first - 1];
  const std::size_t end = before == '.' || before == '_' || before == '-' ? first - 1 : first;
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

/// Returns numbers that are no frame's to the names.
void settle_numbers(std::vector<Input>& inputs) {
  std::map<std::tuple<std::string, std::string, std::string>, std::set<std::string>> numbers;
  for (const Input& input : inputs) {
    const ParsedName& parsed = input.parsed;
    numbers[{parsed.name, parsed.separator, parsed.extension}].insert(parsed.number);
  }
  for (Input& input : inputs) {
    ParsedName& parsed = input.parsed;
    if (parsed.number.empty() || parsed.certain()) continue;
    if (numbers[{parsed.name, parsed.separator, parsed.extension}].size() > 1) continue;
    parsed.name += parsed.separator + parsed.number;
    parsed.separator.clear();
    parsed.number.clear();
  }
}

std::vector<std::string> expand_directories(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    const std::size_t first = files.size();
    for (const auto& entry : fs::directory_iterator(path, error)) {
      const std::string name = entry.path().filename().string();
      const auto kind = image_kind(name);
      // Skips files without an extension, which count as EXR only if the caller names them.
      if (kind && is_written(*kind) && entry.path().has_extension() && name[0] != '.') {
        files.push_back(entry.path().string());
      }
    }
    if (error) fail(Exit::io, "{}: cannot be listed: {}", path, error.message());
    if (files.size() == first) {
      fail(Exit::bad_input, "{}: has no .exr, .dds, .ktx2, .raw or .bin files", path);
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

void settle(Sequence& sequence) {
  std::stable_sort(
      sequence.frames.begin(), sequence.frames.end(),
      [](const FrameFile& left, const FrameFile& right) { return left.frame < right.frame; });
  for (std::size_t i = 1; i < sequence.frames.size(); ++i) {
    const FrameFile& left = sequence.frames[i - 1];
    const FrameFile& right = sequence.frames[i];
    if (left.frame == right.frame) {
      fail(Exit::bad_input,
           "{} and {} are both frame {} of texture {}; rename one of them, or give one folder at a "
           "time",
           left.path, right.path, left.frame, sequence.name);
    }
  }
  for (const FrameFile& file : sequence.frames) {
    const std::string expected = frame_file_name(sequence.name, sequence.digits, file.frame,
                                                 sequence.extension, sequence.separator);
    if (fs::path(file.path).filename() != expected) {
      fail(Exit::bad_input, "{}: frame numbers of texture {} differ in width; expected {}",
           file.path, sequence.name, expected);
    }
  }
}

void refuse_gaps(const std::vector<Sequence>& sequences, const char* cure) {
  const auto frames = all_frames(sequences);
  for (const Sequence& sequence : sequences) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (sequence.digits == 0) break;  // A still has one frame beside a sequence.
      const bool hole = i > 0 && frames[i] != frames[i - 1] + 1;
      const std::uint64_t missing = hole ? frames[i - 1] + 1 : frames[i];
      if (!hole && sequence.find(missing) != nullptr) continue;
      const std::string name = frame_file_name(sequence.name, sequence.digits, missing,
                                               sequence.extension, sequence.separator);
      fail(Exit::bad_input, "frame {} of texture {} is missing ({}); {}", missing, sequence.name,
           (fs::path(sequence.frames.front().path).parent_path() / name).string(), cure);
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

std::vector<Sequence> group_sequences(const std::vector<std::string>& paths, bool allow_gaps,
                                      const char* cure) {
  std::vector<Input> inputs;
  for (const std::string& path : expand_directories(paths)) {
    (void)require_image_kind(path);
    inputs.push_back({path, parse(path)});
  }
  settle_numbers(inputs);
  std::vector<Sequence> sequences;
  std::map<std::string, std::size_t> places;
  for (const auto& [path, parsed] : inputs) {
    const auto digits = static_cast<unsigned>(parsed.number.size());
    const auto [place, is_new] = places.emplace(parsed.name, sequences.size());
    if (is_new) {
      sequences.push_back({parsed.name, digits, parsed.extension, parsed.separator, {}});
    }
    Sequence& sequence = sequences[place->second];
    if (sequence.extension != parsed.extension) {
      fail(Exit::bad_input, "{}: texture {} has files of type .{} as well", path, parsed.name,
           sequence.extension);
    }
    if (sequence.separator != parsed.separator) {
      fail(Exit::bad_input, "{}: texture {} has {} as well; rename one of them", path, parsed.name,
           sequence.frames.front().path);
    }
    std::uint64_t frame = 0;
    std::from_chars(parsed.number.data(), parsed.number.data() + digits, frame);
    sequence.digits = std::min(sequence.digits, digits);
    sequence.frames.push_back({frame, path});
  }
  for (Sequence& sequence : sequences) settle(sequence);
  if (!allow_gaps) refuse_gaps(sequences, cure);
  return sequences;
}

std::string frame_file_name(const std::string& name, unsigned digits, std::uint64_t frame,
                            const std::string& extension, const std::string& separator) {
  std::string file = digits == 0 ? name : fmt::format("{}{}{:0{}}", name, separator, frame, digits);
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
    if (found.size() < kMany || pattern.find('#') == std::string::npos) continue;
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
