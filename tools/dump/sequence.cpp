#include "dump/sequence.h"

#include "dump/error.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 18;

struct ParsedName {
  std::string name;
  std::string number;  ///< empty if there is none
  std::string extension;
};

ParsedName parse(const fs::path& path) {
  ParsedName parsed;
  const fs::path stem = path.stem();
  parsed.extension = path.extension().string();
  if (!parsed.extension.empty()) parsed.extension.erase(0, 1);
  parsed.name = stem.string();
  const std::size_t dot = parsed.name.rfind('.');
  if (dot == std::string::npos || dot == 0) return parsed;
  const std::string number = parsed.name.substr(dot + 1);
  const bool digits = !number.empty() && number.size() <= kMaxDigits &&
                      std::all_of(number.begin(), number.end(),
                                  [](unsigned char c) { return c >= '0' && c <= '9'; });
  if (!digits) return parsed;
  parsed.number = number;
  parsed.name.erase(dot);
  return parsed;
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
      if (entry.path().extension() == ".exr" && name[0] != '.') {
        files.push_back(entry.path().string());
      }
    }
    if (error) fail(Exit::io, "{}: cannot be listed: {}", path, error.message());
    if (files.size() == first) fail(Exit::bad_input, "{}: has no .exr files", path);
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
      fail(Exit::bad_input, "{} and {} are both frame {} of texture {}", left.path, right.path,
           left.frame, sequence.name);
    }
  }
  for (const FrameFile& file : sequence.frames) {
    const auto parsed = parse(file.path);
    const std::string expected =
        sequence.digits == 0 ? "" : fmt::format("{:0{}}", file.frame, sequence.digits);
    if (parsed.number != expected) {
      fail(Exit::bad_input, "{}: frame numbers of texture {} differ in width; expected {}",
           file.path, sequence.name,
           frame_file_name(sequence.name, sequence.digits, file.frame, parsed.extension));
    }
  }
}

void refuse_gaps(const std::vector<Sequence>& sequences) {
  const auto frames = all_frames(sequences);
  for (const Sequence& sequence : sequences) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool hole = i > 0 && frames[i] != frames[i - 1] + 1;
      const std::uint64_t missing = hole ? frames[i - 1] + 1 : frames[i];
      if (!hole && sequence.find(missing) != nullptr) continue;
      fail(Exit::bad_input, "frame {} of texture {} is missing ({}); --allow-gaps accepts that",
           missing, sequence.name,
           frame_file_name(sequence.name, sequence.digits, missing, sequence.extension));
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

std::vector<Sequence> group_sequences(const std::vector<std::string>& paths, bool allow_gaps) {
  std::vector<Sequence> sequences;
  for (const std::string& path : expand_directories(paths)) {
    const ParsedName parsed = parse(path);
    auto at = std::find_if(sequences.begin(), sequences.end(),
                           [&](const Sequence& sequence) { return sequence.name == parsed.name; });
    const auto digits = static_cast<unsigned>(parsed.number.size());
    if (at == sequences.end()) {
      at = sequences.insert(at, {parsed.name, digits, parsed.extension, {}});
    }
    if (at->extension != parsed.extension) {
      fail(Exit::bad_input, "{}: texture {} has files of type .{} as well", path, parsed.name,
           at->extension);
    }
    std::uint64_t frame = 0;
    std::from_chars(parsed.number.data(), parsed.number.data() + digits, frame);
    at->digits = std::min(at->digits, digits);
    at->frames.push_back({frame, path});
  }
  for (Sequence& sequence : sequences) settle(sequence);
  if (!allow_gaps) refuse_gaps(sequences);
  return sequences;
}

std::string frame_file_name(const std::string& name, unsigned digits, std::uint64_t frame,
                            const std::string& extension) {
  std::string file = digits == 0 ? name : fmt::format("{}.{:0{}}", name, frame, digits);
  if (!extension.empty()) file += "." + extension;
  return file;
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
