#include "dump/sequence.h"

#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/folder.h"
#include "dump/frame_numbers.h"
#include "dump/text.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <span>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

/// Settles how numbers are padded: as printf() does it, a sign takes the place of a digit.
void settle_digits(FileNames& names, std::span<const Input* const> files) {
  std::optional<unsigned> negative, other;
  for (const Input* file : files) {
    const unsigned digits = file->parsed.digits();
    std::optional<unsigned>& least = file->parsed.is_negative() ? negative : other;
    least = std::min(least.value_or(digits), digits);
  }
  if (!negative || !other) {
    names.digits = negative ? *negative : *other;
    return;
  }
  names.counts_sign = *negative + 1 == *other;
  names.digits = names.counts_sign ? *other : std::min(*negative, *other);
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
    if (path_text(native_path(file.path).filename()) != expected) {
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
      if (sequence.names.digits > 0) first = std::min(first.value_or(file.frame), file.frame);
    }
  }
  for (Sequence& sequence : sequences) {
    const bool still = sequence.names.digits == 0 && sequence.frames.size() == 1;
    if (still) sequence.frames.front().frame = first.value_or(0);
  }
}

void refuse_gaps(const std::vector<Sequence>& sequences, Cure cure) {
  const auto frames = all_frames(sequences);
  for (const Sequence& sequence : sequences) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (sequence.names.digits == 0) break;  // A still has one frame beside a sequence.
      const bool hole = i > 0 && frames[i] != frames[i - 1] + 1;
      const std::uint64_t missing = hole ? frames[i - 1] + 1 : frames[i];
      if (!hole && sequence.find(missing) != nullptr) continue;
      const std::string name = sequence.file_name(missing);
      fail(Exit::bad_input, "frame {} of texture {} is missing ({}); {}", missing, sequence.name,
           path_text(native_path(sequence.frames.front().path).parent_path() / native_path(name)),
           to_cure(cure));
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

std::string FileNames::of(const std::string& name, std::uint64_t frame) const {
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

std::vector<Sequence> group_sequences(const std::vector<std::string>& paths,
                                      const NumberOptions& options, SequenceRemarks* remarks) {
  std::vector<Input> inputs;
  for (const std::string& path :
       expand_directories(paths, options.known, remarks ? &remarks->left_out : nullptr)) {
    (void)require_image_kind(path);
    inputs.push_back({path, parse_name(path)});
  }
  settle_numbers(inputs, options, remarks ? &remarks->guesses : nullptr);
  std::int64_t base = options.known.empty() ? 0 : options.known.front().names.base;
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
          {.name = parsed.name,
           .names = {.extension = parsed.extension, .separator = parsed.separator, .base = base}});
      files.emplace_back();
    }
    files[place->second].push_back(&input);
    Sequence& sequence = sequences[place->second];
    if (sequence.names.extension != parsed.extension) {
      fail(Exit::bad_input, "{}: texture {} has files of type .{} as well; {}", path, parsed.name,
           sequence.names.extension, to_cure(Cure::rename));
    }
    if (sequence.names.separator != parsed.separator) {
      fail(Exit::bad_input, "{}: texture {} has {} as well; {}", path, parsed.name,
           sequence.frames.front().path, to_cure(Cure::rename));
    }
    if (parsed.value() < base && digits > 0) {
      fail(Exit::bad_input, "{}: its number is below {}, the first there is", path, base);
    }
    const std::int64_t frame = digits == 0 ? 0 : parsed.value() - base;
    sequence.frames.push_back({static_cast<std::uint64_t>(frame), path});
  }
  for (std::size_t i = 0; i < sequences.size(); ++i) settle_digits(sequences[i].names, files[i]);
  settle_stills(sequences);
  for (Sequence& sequence : sequences) settle(sequence);
  if (!options.allow_gaps) refuse_gaps(sequences, options.cure);
  return sequences;
}

std::string texture_path(const std::string& path) {
  return path_text(native_path(path).parent_path() / native_path(parse_name(path).name));
}

bool is_separator(const std::string& text) noexcept {
  return text.empty() || (text.size() == 1 && is_separator(text[0]));
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
        found[0]->names.extension);
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
