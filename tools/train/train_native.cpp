// Trains the static tables of the native codec on probe dumps:
//
//   train_native OUTPUT.txt DUMPS...
//
// Each DUMPS is a directory of one sequence. Every fourth frame counts as a keyframe and, from the
// second on, each as an update of the probes that changed. Modes are chosen by an estimate that
// uses no tables, so the result does not depend on those the program was built with.
#include "train/table_writer.h"

#include "base/parallel.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"
#include "native/frame/payload.h"
#include "texture/blocks.h"
#include "texture/view.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <iterator>
#include <memory>
#include <numeric>
#include <thread>

namespace gicodec::train {
namespace {

std::vector<std::byte> all_cores(const tools::Dump& dump, std::vector<std::uint32_t>& probes) {
  probes.resize(block_count(dump.info.desc));
  std::iota(probes.begin(), probes.end(), 0U);
  std::vector<std::byte> cores(probes.size() * block_bytes(dump.info.desc));
  const auto view = check_view(dump.info.desc, ConstTextureView(dump.texels));
  if (!view) throw tools::Error(tools::Exit::bad_input, "a dump that is no texture");
  Vector<std::uint32_t> stale;
  strip(best_isa(), dump.info.desc, *view, probes, cores, stale);
  return cores;
}

constexpr unsigned kMaxNarrowBits = 11;

using Histograms = std::array<std::vector<Histogram>, kSubjects>;

void observe(const EncodeJob& job, Histograms& out) {
  const auto layout = native::plane_layout(job.desc);
  Counter counter(layout.pairs, !job.keyframe);
  native::PayloadSettings settings;
  settings.chunk.set = 0;
  settings.chunk.observe = [&](const native::Step* begin, const native::Step* end) {
    counter.add(begin, end);
  };
  native::PayloadMemory memory;
  std::vector<std::byte> payload;
  native::encode_payload(job, settings, best_isa(), memory, payload);
  counter.finish(layout.pairs || layout.plane[0].bits > kMaxNarrowBits, out);
}

void read_sequence(const tools::Sequence& sequence, Histograms& out) {
  std::vector<std::byte> before;
  for (const auto& file : sequence.frames) {
    const auto dump = tools::read_dump(file.path);
    const auto& desc = dump.info.desc;
    std::vector<std::uint32_t> probes;
    auto cores = all_cores(dump, probes);
    const std::size_t size = block_bytes(desc);
    if (file.frame % 4 == 0) observe({desc, probes, {cores.data(), size}, {}, true}, out);
    if (before.size() == cores.size()) {
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
        observe({desc, changed, {texels.data(), size}, {{before.data(), size}, received.data()}},
                out);
      }
    }
    before = std::move(cores);
  }
}

int run(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: train_native OUTPUT.txt DUMPS...\n";
    return 2;
  }
  const unsigned threads = std::thread::hardware_concurrency();
  std::vector<tools::Sequence> sequences;
  for (int i = 2; i < argc; ++i) {
    for (auto& sequence : tools::group_sequences({argv[i]})) {
      sequences.push_back(std::move(sequence));
    }
  }
  std::vector<Histograms> read(sequences.size());
  for_each_item(threads, sequences.size(),
                [&](unsigned, std::size_t i) { read_sequence(sequences[i], read[i]); });
  Histograms all;
  for (auto& histograms : read) {
    for (unsigned s = 0; s < kSubjects; ++s)
      std::ranges::move(histograms[s], std::back_inserter(all[s]));
  }
  const auto model = std::make_unique<Model>();
  fit(all, threads, *model);
  const std::string text = to_text(*model);
  tools::write_file(argv[1], std::as_bytes(std::span(text)), tools::Existing::replace);
  std::cout << fmt::format("XXH3-64 {:016x}\n", XXH3_64bits(text.data(), text.size()));
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
