// Bytes that OpenEXR reads as a file.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace gicodec::tools {

class MemoryIn final : public Imf::IStream {
 public:
  explicit MemoryIn(std::string_view bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char into[], int size) override {
    if (size < 0 || bytes_.size() - position_ < static_cast<std::size_t>(size)) {
      throw std::runtime_error("unexpected end");
    }
    std::memcpy(into, bytes_.data() + position_, static_cast<std::size_t>(size));
    position_ += static_cast<std::size_t>(size);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    position_ = std::min(static_cast<std::size_t>(position), bytes_.size());
  }
  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

}  // namespace gicodec::tools
