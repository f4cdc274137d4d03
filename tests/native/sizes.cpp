// Sizes of native packets of the sequences in a folder:
//
//   native_sizes FOLDER               prints the table
//   native_sizes FOLDER --check FILE  compares it with a file, line by line
//
// A change of a size is a decision: build/release/tests/native/native_sizes testdata >
// tests/native/sizes.tsv writes it down.
#include "dump/dump.h"
#include "dump/sequence.h"

#include <gicodec/gicodec.h>

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace gicodec {
namespace {

namespace fs = std::filesystem;

/// Keyframe bytes, update bytes and probes of updates, tab-separated.
std::string sizes(const tools::Sequence& sequence, const std::string& preset) {
  std::optional<Encoder> encoder;
  std::uint64_t keyframe = 0, updates = 0, probes = 0;
  for (const auto& file : sequence.frames) {
    const auto dump = tools::read_dump(file.path);
    if (!encoder) {
      EncoderOptions options;
      options.backend = "native";
      options.settings.preset = preset;
      options.gop = 0;
      encoder = *Encoder::create(dump.info.desc, options);
    }
    const auto packet = *encoder->encode(ConstTextureView(dump.texels));
    const auto info = *peek(packet);
    (is_keyframe(info.type) ? keyframe : updates) += packet.size();
    if (!is_keyframe(info.type))
      probes += info.all_blocks ? block_count(dump.info.desc) : info.blocks;
  }
  return fmt::format("{}\t{}\t{}", keyframe, updates, probes);
}

std::string table(const fs::path& root) {
  std::set<fs::path> folders;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() == ".exr") folders.insert(entry.path().parent_path());
  }
  std::string text = "sequence\ttexture\tpreset\tkeyframe bytes\tupdate bytes\tprobes in updates\n";
  for (const auto& folder : folders) {
    for (const auto& sequence : tools::group_sequences({folder.string()})) {
      for (const std::string preset : {"fast", "strong"}) {
        text += fmt::format("{}\t{}\t{}\t{}\n", fs::relative(folder, root).generic_string(),
                            sequence.name, preset, sizes(sequence, preset));
      }
    }
  }
  return text;
}

int check(const std::string& text, const char* path) {
  std::ifstream file(path);
  const std::string expected{std::istreambuf_iterator<char>(file), {}};
  if (text == expected) return 0;
  fmt::print(stderr, "sizes differ from {}; now they are\n{}", path, text);
  return 1;
}

}  // namespace
}  // namespace gicodec

int main(int argc, char** argv) {
  if (argc == 2) {
    fmt::print("{}", gicodec::table(argv[1]));
    return 0;
  }
  if (argc == 4 && std::string_view(argv[2]) == "--check")
    return gicodec::check(gicodec::table(argv[1]), argv[3]);
  fmt::print(stderr, "usage: native_sizes FOLDER [--check FILE]\n");
  return 2;
}
