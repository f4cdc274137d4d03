#include "dump/directory.h"

#include "dump/error.h"
#include "dump/file_system.h"

#include <filesystem>
#include <system_error>
#include <utility>

namespace gicodec::tools {

namespace fs = std::filesystem;

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(native_path(path), error);
  std::error_code other;
  if (fs::is_directory(native_path(path), other)) return;
  const bool there = !error || fs::exists(native_path(path), other);
  fail(Exit::io, "{}: cannot make this directory: {}", path,
       there ? "a file of this name exists; name a folder" : error.message());
}

OutputDirectory::OutputDirectory(std::string path) : path_(std::move(path)) {
  if (path_ == "-")
    fail(Exit::usage,
         "-o -: files go to a folder, not to standard output; ./- names such a folder");
  std::error_code error;
  made_ = !fs::exists(native_path(path_), error);
  make_directory(path_);
}

OutputDirectory::~OutputDirectory() {
  std::error_code not_empty;
  if (made_) fs::remove(native_path(path_), not_empty);
}

}  // namespace gicodec::tools
