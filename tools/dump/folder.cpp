#include "dump/folder.h"

#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/frame_numbers.h"
#include "dump/text.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <set>
#include <system_error>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 10000;  ///< of a directory

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
};

/// What a directory holds. Hidden files are not looked at.
struct Contents {
  std::vector<std::string> files;     ///< that are read
  std::vector<std::string> sidecars;  ///< .json files, of raw files or not
  LeftOut named_only;                 ///< is read if it is named
  LeftOut others;
};

void take_entry(const std::string& folder, const std::string& name,
                const std::vector<Sequence>& known, Contents& contents) {
  if (name[0] == '.') return;
  const fs::path entry = native_path(folder) / native_path(name);
  const std::string path = path_text(entry);
  const auto kind = image_kind(name);
  std::error_code error;
  if (fs::is_directory(entry, error)) return contents.named_only.add(name + "/");
  // Files without an extension count as EXR only if the caller names them.
  const bool image = kind && entry.has_extension();
  const bool leads_nowhere = fs::is_symlink(entry, error) && !fs::exists(entry, error);
  if (image && leads_nowhere) return contents.others.add(name + " (a link to nothing)");
  const auto is_known = [&] {
    const ParsedName parsed = parse_name(name);
    const std::string stem = path_text(entry.stem());
    return std::ranges::any_of(known, [&](const Sequence& one) {
      return one.name == (one.names.digits == 0 ? stem : parsed.name);
    });
  };
  if (image && (is_written(*kind) || is_known())) {
    contents.files.push_back(path);
  } else if (image) {
    contents.named_only.add(name);
  } else if (entry.extension() == ".json") {
    contents.sidecars.push_back(path);
  } else {
    contents.others.add(name);
  }
}

/// The sidecars that describe raw files.
std::set<std::string> sidecars_of(const std::vector<std::string>& files) {
  std::set<std::string> sidecars;
  for (const std::string& path : files) {
    if (image_kind(path) != ImageKind::raw) continue;
    std::string own = raw_sidecar_path(path, false);
    std::error_code error;
    sidecars.insert(fs::exists(native_path(own), error) ? std::move(own)
                                                        : raw_sidecar_path(path, true));
  }
  return sidecars;
}

Contents contents_of(const std::string& path, const std::vector<Sequence>& known) {
  Contents contents;
  const auto names = names_in(path);
  if (!names) fail(Exit::io, "{}: cannot be listed: {}", path, reason(errno));
  for (const std::string& name : *names) {
    take_entry(path, name, known, contents);
    if (contents.files.size() <= kMaxFiles) continue;
    fail(Exit::bad_input, "{}: has more than {} dumps; {}", path, kMaxFiles,
         to_cure(Cure::fewer_files));
  }
  std::ranges::sort(contents.files);
  const auto described = sidecars_of(contents.files);
  for (const std::string& sidecar : contents.sidecars) {
    if (!described.contains(sidecar)) {
      contents.others.add(path_text(native_path(sidecar).filename()));
    }
  }
  return contents;
}

/// "b.png and sub/; name them to take them", and what is no dump.
std::string left_out_text(const Contents& contents) {
  std::string text;
  if (contents.named_only.count > 0) {
    text = fmt::format("{}; {}", listed(contents.named_only.names, contents.named_only.count),
                       to_cure(Cure::name_others));
  }
  if (contents.others.count > 0) {
    text += fmt::format("{}{}, which {} no dump{}", text.empty() ? "" : "; and ",
                        listed(contents.others.names, contents.others.count),
                        contents.others.count == 1 ? "is" : "are",
                        contents.others.count == 1 ? "" : "s");
  }
  return text;
}

}  // namespace

std::vector<std::string> expand_directories(const std::vector<std::string>& paths,
                                            const std::vector<Sequence>& known,
                                            std::vector<std::string>* remarks) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::is_directory(native_path(path), error)) {
      files.push_back(path);
      continue;
    }
    const Contents contents = contents_of(path, known);
    const std::string left_out = left_out_text(contents);
    if (contents.files.empty()) {
      fail(Exit::bad_input, "{}: has no .exr, .dds, .ktx2, .raw or .bin files{}{}", path,
           left_out.empty() ? "" : ", but ", left_out);
    }
    if (!left_out.empty() && remarks != nullptr) {
      remarks->push_back(fmt::format("{}: leaves out {}", path, left_out));
    }
    files.insert(files.end(), contents.files.begin(), contents.files.end());
  }
  // Shells name sidecars as well, and a folder beside its files names these twice.
  const auto sidecars = sidecars_of(files);
  std::set<std::string> seen;
  std::erase_if(files, [&](const std::string& path) {
    return sidecars.contains(path) ||
           !seen.insert(path_text(native_path(path).lexically_normal())).second;
  });
  return files;
}

}  // namespace gicodec::tools
