// A container in memory.
#pragma once

#include <gicodec/container.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::test {

class MemorySink final : public Sink {
 public:
  Status write(std::span<const std::byte> more) override {
    if (bytes.size() + more.size() > room) return Status::io_failed;
    bytes.insert(bytes.end(), more.begin(), more.end());
    return Status::ok;
  }
  std::vector<std::byte> bytes;
  std::size_t room = SIZE_MAX;
};

}  // namespace gicodec::test
