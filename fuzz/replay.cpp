// Runs fuzz targets over the files of their corpora, without a fuzz engine: replay TARGET FOLDER...
// Each file is also run after a change by the target's own mutator, if it has one. A file that
// crashes is named, and the others go on.
#include "supervisor.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

using Run = int(const std::uint8_t* data, std::size_t size);
using Mutate = std::size_t(std::uint8_t* data, std::size_t size, std::size_t max_size,
                           unsigned seed);

// The targets of this build, each compiled with names of its own.
#define TARGET(name)         \
  extern "C" Run run_##name; \
  extern "C" [[gnu::weak]] Mutate mutate_##name;
#include "replay_targets.inl"
#undef TARGET

/// In place of libFuzzer's: changes a byte, and adds one if there is room.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size,
                                        std::size_t max_size) {
  if (size > 0) ++data[size * 7 / 11];
  if (size < max_size) data[size++] = 0x5A;
  return size;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRoom = 64;  ///< that a changed input may grow by

struct Target {
  std::string_view name;
  Run* run;
  Mutate* mutate;  ///< nullptr: the target has none
};
const Target kTargets[] = {
#define TARGET(name) {#name, run_##name, mutate_##name},
#include "replay_targets.inl"
#undef TARGET
};

/// From a block of just the input's size, as libFuzzer gives it.
void run(const Target& target, const std::uint8_t* data, std::size_t size) {
  const auto exact = std::make_unique<std::uint8_t[]>(size);
  std::copy_n(data, size, exact.get());
  target.run(exact.get(), size);
}

void replay(const Target& target, const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  run(target, data, bytes.size());
  if (target.mutate == nullptr) return;
  const auto changed = std::make_unique<std::uint8_t[]>(bytes.size() + kRoom);
  std::copy_n(data, bytes.size(), changed.get());
  run(target, changed.get(),
      target.mutate(changed.get(), bytes.size(), bytes.size() + kRoom,
                    static_cast<unsigned>(bytes.size())));
}

std::vector<fs::path> files_in(int count, char** names) {
  std::vector<fs::path> files;
  for (int i = 0; i < count; ++i) {
    if (fs::is_regular_file(names[i])) files.emplace_back(names[i]);
    if (!fs::is_directory(names[i])) continue;
    for (const auto& entry : fs::directory_iterator(names[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const auto* const target = std::ranges::find(kTargets, argc > 1 ? argv[1] : "", &Target::name);
  if (target == std::end(kTargets)) {
    std::fprintf(stderr, "usage: replay TARGET FOLDER...; the targets are:");
    for (const Target& one : kTargets) std::fprintf(stderr, " %s", one.name.data());
    std::fprintf(stderr, "\n");
    return 2;
  }
  const std::vector<fs::path> files = files_in(argc - 2, argv + 2);
  if (files.empty()) {
    std::fprintf(stderr, "no files to replay\n");
    return 1;
  }
  const bool good = gicodec::test::supervise(argv, [&](const auto& but, const auto& begins) {
    constexpr const char* kNothing = "an input of no bytes";
    const auto is_left = [&](const std::string& name) {
      return std::ranges::find(but, name) == but.end();
    };
    if (is_left(kNothing)) begins(kNothing), target->run(nullptr, 0);
    for (const fs::path& path : files) {
      if (is_left(path)) begins(path.string()), replay(*target, path);
    }
    return true;
  });
  std::printf("%zu files\n", files.size());
  return good ? 0 : 1;
}
