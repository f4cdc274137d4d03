// What the parts of make_corpus share.
#pragma once

#include "input.h"

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace gicodec::fuzz {

using Bytes = std::vector<std::byte>;

class Corpus {
 public:
  explicit Corpus(std::filesystem::path root) : root_(std::move(root)) {}
  void add(const std::string& target, const Bytes& bytes) {
    const auto folder = root_ / target;
    std::filesystem::create_directories(folder);
    const auto name = "seed-" + std::to_string(++count_);
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

 private:
  std::filesystem::path root_;
  int count_ = 0;
};

inline void append(Bytes& to, std::span<const std::byte> more) {
  to.reserve(to.size() + more.size());
  to.insert(to.end(), more.begin(), more.end());
}

/// Payloads and round trips of native: every format, records of which some exist, maps by every
/// kind of chunk.
void add_native(Corpus& corpus, std::mt19937& random);
/// Messages, sessions and clients: those recorded in `folder`, and others.
void add_streams(Corpus& corpus, const std::filesystem::path& folder);

}  // namespace gicodec::fuzz
