// Wrote the golden files, once: make_golden FOLDER. Kept to show how; not part of any test.
#include "golden/make_golden.h"

#include "bitstream/region_field.h"
#include "golden/hashes.h"
#include "golden/map_golden.h"
#include "golden/native_golden.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace gicodec::golden {
namespace {

using test::Bytes;
using test::MemorySink;

std::filesystem::path folder;

/// A container, frame by frame, each texture painted by `paint`.
template <typename Paint, typename Select>
Bytes container_of(const ContainerDescription& description, const EncoderOptions& common,
                   std::uint32_t frames, std::uint32_t step, Paint&& paint, Select&& select) {
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  std::vector<Encoder> encoders;
  for (const TextureEntry& texture : description.textures) {
    EncoderOptions options = common;
    options.texture_id = static_cast<std::uint8_t>(encoders.size());
    encoders.push_back(*Encoder::create(texture.desc, options));
  }
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < encoders.size(); ++i) {
      test::Texture texture(description.textures[i].desc);
      paint(texture, frame);
      const auto packet =
          *encoders[i].encode(std::as_const(texture).view(), select(texture.desc(), frame));
      must(writer.add(frame * step, packet));
    }
  }
  must(writer.finish());
  return sink.bytes;
}

/// Packets of every texture and region in turn; an index part after the second frame.
void volumes() {
  const auto description = volumes_description();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  std::map<std::uint64_t, Encoder> encoders;
  for (std::uint32_t frame = 0; frame < kVolumesFrames; ++frame) {
    for (std::uint8_t id = 0; id < description.textures.size(); ++id) {
      const std::uint32_t regions = volumes_regions(description, id);
      for (std::uint32_t i = 0; i < std::max(regions, 1U); ++i) {
        const std::uint32_t region = regions == 0 ? StreamId::kWholeVolume : i;
        const TextureDesc desc = volumes_texture(description, id, region);
        EncoderOptions options;
        options.backend = "lz4";
        options.gop = 3;
        options.texture_id = id;
        auto& encoder =
            encoders.try_emplace(region_key(id, region), *Encoder::create(desc, options))
                .first->second;
        test::Texture texture(desc);
        paint(texture, volumes_step(frame, region));
        must(writer.add(frame, *encoder.encode(std::as_const(texture).view()), region));
      }
    }
    if (frame == 1) must(writer.flush());
  }
  must(writer.finish());
  save("volumes.gic", sink.bytes);
}

void blocks() {
  for (const auto& [name, desc] : block_textures()) {
    auto encoder = *Encoder::create(desc, {.backend = "zstd"});
    if (desc.presence != Presence::all) must(encoder.set_presence(block_presence(desc)));
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
      test::Texture texture(desc);
      paint(texture, frame);
      save("blocks_" + std::string(name) + "_" + std::to_string(frame + 1) + ".packet",
           *encoder.encode(std::as_const(texture).view()));
    }
  }
}

/// The native presets on some textures: all blocks, some, all.
template <typename Paint>
Bytes native_sequence(const ContainerDescription& description, const std::string& preset,
                      Paint&& paint) {
  EncoderOptions options;
  options.backend = "native";
  options.settings.preset = preset;
  std::vector<std::uint32_t> some;
  return container_of(description, options, kNativeFrames, 1, paint,
                      [&](const TextureDesc& desc, std::uint32_t frame) {
                        some = native_selection(desc);
                        return frame == 1 ? Selection(some) : Selection::all();
                      });
}

/// What every decoder makes of the containers, in the order of their names.
void save_hashes() {
  std::set<std::filesystem::path> containers;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".gic") containers.insert(entry.path());
  }
  std::string lines;
  for (const auto& path : containers) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    lines += lines_of(path.filename().string(), std::as_bytes(std::span(bytes)));
  }
  save("hashes.txt", std::as_bytes(std::span(lines)));
}

}  // namespace

void must(Status status) {
  if (status != Status::ok) std::abort();
}

void save(const std::string& name, std::span<const std::byte> bytes) {
  std::ofstream(folder / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

Bytes sequence(std::string_view backend, std::uint32_t frames, std::size_t most) {
  auto textures = sequence_textures();
  textures.resize(std::min(most, textures.size()));
  EncoderOptions options;
  options.backend = backend;
  options.gop = 3;
  return container_of(probe_description(textures, {{"golden", std::string(backend)}}), options,
                      frames, 10, paint,
                      [](const TextureDesc&, std::uint32_t) { return Selection::changed(); });
}

Packet index_packet(std::string_view mode, std::string_view backend) {
  const auto desc = index_desc();
  test::Texture texture(desc);
  const auto blocks = index_blocks(mode);
  for (const auto block : blocks) {
    for (auto& byte : texture.record(block, 0, 0)) byte = static_cast<std::byte>(block + 1);
  }
  auto encoder = *Encoder::create(desc, {.backend = backend});
  return *encoder.encode(std::as_const(texture).view(), blocks);
}

}  // namespace gicodec::golden

int main(int argc, char** argv) {
  using namespace gicodec::golden;
  if (argc != 2) return 2;
  folder = argv[1];
  for (const char* backend : {"raw", "lz4", "zstd", "native"}) {
    save(std::string("sequence_") + backend + ".gic", sequence(backend, kFrames, SIZE_MAX));
  }
  for (const auto mode : kIndexModes)
    save("index_" + std::string(mode) + ".packet", index_packet(mode));
  for (const std::string preset : {"fast", "strong", "turbo"}) {
    const auto description =
        gicodec::test::probe_description(native_textures(), {{"golden", "native " + preset}});
    save("native_" + preset + ".gic", native_sequence(description, preset, paint_native));
  }
  for (const std::string preset : {"fast", "strong"}) {
    save("maps_" + preset + ".gic", native_sequence(maps_description(), preset, paint_map));
  }
  volumes();
  blocks();
  save_damaged_packets();
  save_damaged_containers();
  save_hashes();
  return 0;
}
