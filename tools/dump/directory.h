// Folders for results.
#pragma once

#include <string>

namespace gicodec::tools {

/// Makes a directory and its parents. Throws Error of Exit::io on failure.
void make_directory(const std::string& path);

/// make_directory() for results. The destructor removes an empty directory that it made.
class OutputDirectory {
 public:
  explicit OutputDirectory(std::string path);
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;
  ~OutputDirectory();

 private:
  std::string path_;
  bool made_ = false;
};

}  // namespace gicodec::tools
