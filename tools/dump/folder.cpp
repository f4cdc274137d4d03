#include "dump/folder.h"

#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/text.h"

#include <algorithm>
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

}  // namespace

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

}  // namespace gicodec::tools
