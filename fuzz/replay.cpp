// Runs a fuzz target over the files of its corpus, without a fuzz engine: replay_NAME FOLDER...
// Each file is also run after a change by the target's own mutator, if it has one.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" [[gnu::weak]] std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                             std::size_t max_size, unsigned seed);

/// In place of libFuzzer's: changes a byte, and adds one if there is room.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size,
                                        std::size_t max_size) {
  if (size > 0) ++data[size * 7 / 11];
  if (size < max_size) data[size++] = 0x5A;
  return size;
}

namespace {

constexpr std::size_t kRoom = 64;  ///< that a changed input may grow by

/// From a block of just the input's size, as libFuzzer gives it.
void run(const std::uint8_t* data, std::size_t size) {
  const auto exact = std::make_unique<std::uint8_t[]>(size);
  std::copy_n(data, size, exact.get());
  LLVMFuzzerTestOneInput(exact.get(), size);
}

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    if (fs::is_regular_file(argv[i])) files.emplace_back(argv[i]);
    if (!fs::is_directory(argv[i])) continue;
    for (const auto& entry : fs::directory_iterator(argv[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  if (files.empty()) {
    std::fprintf(stderr, "no files to replay\n");
    return 1;
  }
  LLVMFuzzerTestOneInput(nullptr, 0);
  for (const auto& path : files) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    run(data, bytes.size());
    if (LLVMFuzzerCustomMutator == nullptr) continue;
    const auto changed = std::make_unique<std::uint8_t[]>(bytes.size() + kRoom);
    std::copy_n(data, bytes.size(), changed.get());
    run(changed.get(), LLVMFuzzerCustomMutator(changed.get(), bytes.size(), bytes.size() + kRoom,
                                               static_cast<unsigned>(bytes.size())));
  }
  std::printf("%zu files\n", files.size());
  return 0;
}
