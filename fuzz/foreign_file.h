// Files for what reads them by name, and what refuses them.
#pragma once

#include "cost.h"

#include "dump/error.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <string>

namespace gicodec::fuzz {

/// True unless it throws an Error of the tools, which must be one of the user's, and printable.
template <typename Body>
bool accepted(const Body& body) {
  try {
    body();
    return true;
  } catch (const tools::Error& error) {
    check(error.code() == tools::Exit::bad_input || error.code() == tools::Exit::usage,
          "a bad file is the file's fault");
    check(tools::printable(error.what()) == error.what(), "messages are printable");
    return false;
  }
}

/// A file in memory, of a name without an ending.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> bytes) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
    check(file_ >= 0 &&
              ::write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
          "there is memory for a file");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(file_); }
  [[nodiscard]] std::string path() const { return fmt::format("/proc/self/fd/{}", file_); }

 private:
  int file_;
};

}  // namespace gicodec::fuzz
