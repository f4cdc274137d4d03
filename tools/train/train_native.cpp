// Trains the static tables of the native codec on probe dumps:
//
//   train_native OUTPUT.cpp DUMPS...
//
// Each DUMPS is a directory of one sequence. Every frame counts as a keyframe and, from the second
// on, as an update of the probes that changed. Modes are chosen by an estimate that uses no tables,
// so the result does not depend on those the program was built with.
#include "train/table_writer.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"
#include "native/payload.h"
#include "texture/blocks.h"
#include "texture/view.h"

#include <cstring>
#include <iostream>
#include <numeric>

namespace gicodec::train {
namespace {

std::vector<std::byte> all_cores(const tools::Dump& dump, std::vector<std::uint32_t>& probes) {
  probes.resize(block_count(dump.info.desc));
  std::iota(probes.begin(), probes.end(), 0U);
  std::vector<std::byte> cores(probes.size() * block_bytes(dump.info.desc));
  const auto view = check_view(dump.info.desc, ConstTextureView(dump.texels));
  if (!view) throw tools::Error(tools::Exit::bad_input, "a dump that is no texture");
  std::vector<std::uint32_t> stale;
  strip(best_isa(), dump.info.desc, *view, probes, cores, stale);
  return cores;
}

void observe(const EncodeJob& job, Histogram& histogram) {
  native::PayloadSettings settings;
  settings.chunk.set = 0;
  settings.chunk.observe = [&](const native::Step* begin, const native::Step* end) {
    histogram.add(begin, end);
  };
  std::vector<native::Workspace> workspaces;
  std::vector<std::byte> payload;
  native::encode_payload(job, settings, best_isa(), workspaces, payload);
}

/// Keyframes go to kinds[0], updates to kinds[1].
void read_sequence(const tools::Sequence& sequence, Kind* kinds) {
  std::vector<std::byte> before;
  for (const auto& file : sequence.frames) {
    const auto dump = tools::read_dump(file.path);
    std::vector<std::uint32_t> probes;
    auto cores = all_cores(dump, probes);
    const auto& desc = dump.info.desc;
    if (file.frame % 4 == 0) {
      observe({desc, probes, {cores.data(), block_bytes(desc)}, {}, true},
              kinds[0].sources.emplace_back());
    }
    if (before.size() == cores.size()) {
      const std::size_t size = block_bytes(desc);
      std::vector<std::uint32_t> changed;
      std::vector<std::byte> texels;
      for (const auto p : probes) {
        const std::byte* block = cores.data() + p * size;
        if (std::memcmp(block, before.data() + p * size, size) == 0) continue;
        changed.push_back(p);
        texels.insert(texels.end(), block, block + size);
      }
      const std::vector<std::uint8_t> received(block_count(desc), 1);
      if (!changed.empty()) {
        observe(
            {desc, changed, {texels.data(), size}, {{before.data(), size}, received.data()}, false},
            kinds[1].sources.emplace_back());
      }
    }
    before = std::move(cores);
  }
}

int run(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: train_native OUTPUT.cpp DUMPS...\n";
    return 2;
  }
  std::vector<Kind> kinds(4);  // planes and pairs, keyframes and updates
  for (std::size_t k = 0; k < kinds.size(); ++k) kinds[k].update = k % 2 != 0;
  for (int i = 2; i < argc; ++i) {
    for (const auto& sequence : tools::group_sequences({argv[i]})) {
      std::cerr << argv[i] << ": " << sequence.name << '\n';
      const auto desc = tools::read_dump_info(sequence.frames.front().path).desc;
      read_sequence(sequence, &kinds[desc.record.format == Format::R16G16_SFLOAT ? 2 : 0]);
    }
  }
  const std::string source = to_source(fit(kinds));
  tools::write_file(argv[1], std::as_bytes(std::span(source)), tools::Existing::replace);
  return 0;
}

}  // namespace
}  // namespace gicodec::train

int main(int argc, char** argv) {
  try {
    return gicodec::train::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "train_native: " << error.what() << '\n';
    return 1;
  }
}
