// Dumps as what is measured, and the time of the processor.
#pragma once

#include "dump/dump.h"
#include "dump/sequence.h"

#include <ctime>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::bench {

struct Texture {
  std::string name;
  TextureDesc desc;
  std::vector<std::vector<std::byte>> frames;
};

/// All textures of dumps.
inline std::vector<Texture> read_dumps(const std::string& path) {
  std::vector<Texture> textures;
  for (const auto& sequence : tools::group_sequences({path})) {
    Texture& t = textures.emplace_back();
    t.name = sequence.name;
    for (const auto& file : sequence.frames) {
      auto dump = tools::read_dump(file.path);
      t.desc = dump.info.desc;
      t.frames.push_back(std::move(dump.texels));
    }
  }
  return textures;
}

/// Seconds of the whole process, so that hidden threads count.
inline double processor_time() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace gicodec::bench
