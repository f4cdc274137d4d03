// Containers that declare grids near the limits, and packets that say little: opened and decoded
// within what the programs allow.
#include "foreign_file.h"

#include "bitstream/description.h"
#include "bitstream/packet.h"
#include "common/container_input.h"
#include "common/volume_words.h"
#include "memory_sink.h"

namespace {

using namespace gicodec;
using namespace gicodec::tools;

/// Around 2^16, 2^20, 2^24 blocks or at the longest side; often beyond a limit.
TextureDesc read_desc(fuzz::Input& input) {
  const Record record = fuzz::preset(input.byte());
  const std::uint32_t sides[] = {1, 2, 16, 64, 255, 256, 257, 4096, kMaxGridSide, 17};
  const auto side = [&] { return sides[input.below(std::size(sides))]; };
  const Grid grid{side(), side(), side()};
  const std::uint8_t shape = input.byte();
  const auto core = static_cast<std::uint8_t>(1 + shape % (shape < 128 ? 4 : kMaxBlockSide));
  const auto guard_band = static_cast<std::uint8_t>(input.below(2));
  const TextureDesc desc =
      probe_texture(record, grid, core, guard_band, static_cast<Tiling>(input.below(kTilingCount)));
  return desc;
}

/// A packet of nothing but what the input says, for that texture.
Packet make_packet(fuzz::Input& input, const TextureDesc& desc, std::uint8_t texture,
                   std::uint32_t sequence) {
  PacketHead head;
  head.info.texture_id = texture;
  head.info.type = input.below(4) != 0 ? PacketType::keyframe : PacketType::delta;
  head.info.backend =
      static_cast<std::uint8_t>(input.below(3) == 2 ? kBackendNative : input.below(3));
  head.info.sequence = sequence;
  head.info.reference = is_keyframe(head.info.type) ? 0 : sequence - 1;
  head.base = description_hash(desc);
  head.index_mode = static_cast<IndexMode>(input.below(4));
  head.info.all_blocks = head.index_mode == IndexMode::all;
  head.info.blocks = input.u16() * (input.below(2) == 0 ? 1 : 255);
  const auto index =
      head.info.all_blocks ? std::span<const std::byte>{} : input.bytes(input.byte());
  Packet packet;
  write_packet_head(head, index, {}, packet);
  const auto payload = input.bytes(input.byte());
  packet.insert(packet.end(), payload.begin(), payload.end());
  seal_packet(packet);
  return packet;
}

/// Volumes of one texture each, whole or cut into regions of few blocks or many.
ContainerDescription read_description(fuzz::Input& input) {
  constexpr Grid kRegions[] = {{}, {}, {1, 1, 1}, {16, 16, 16}, {256, 1, 256}, {kMaxBlocks, 1, 1}};
  ContainerDescription description;
  const std::uint32_t volumes = 1 + input.below(8);
  for (std::uint32_t i = 0; i < volumes; ++i) {
    const NamedTexture texture{fmt::format("t{}", i), read_desc(input), {}, {}};
    const Grid region = kRegions[input.below(std::size(kRegions))];
    const auto volume = probe_volume({&texture, 1});
    if (!volume || add_volume(description, "", *volume) != Status::ok) continue;
    description.volumes.back().region = region;
  }
  return description;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMemory = 24;  // MiB
  fuzz::Input input(data, size);
  const ContainerDescription description = read_description(input);
  test::MemorySink memory;
  auto writer = ContainerWriter::create(memory, description);
  if (!writer) return 0;
  for (std::uint32_t frame = 0; frame < 16 && !input.empty(); ++frame) {
    const auto texture = static_cast<std::uint8_t>(
        input.below(static_cast<std::uint32_t>(description.textures.size())));
    const TextureEntry& entry = description.textures[texture];
    const Grid& size_of_region = description.volumes[entry.volume].region;
    const bool cut = size_of_region.x != 0;
    const std::uint32_t region =
        cut ? input.u16() % regions_of(entry.desc, size_of_region).regions()
            : StreamId::kWholeVolume;
    const TextureDesc desc = part_of(description, entry, region);
    (void)writer->add(frame, make_packet(input, desc, texture, frame + 1), region);
  }
  (void)writer->finish();
  const fuzz::MemoryFile file(memory.bytes);
  fuzz::check_cost("a great grid costs nothing", [&]() -> fuzz::Allowance {
    std::size_t frames = 0;
    fuzz::accepted([&] {
      DecoderFlags flags;
      flags.memory = kMemory;
      ContainerInput container(file.path(), flags);
      while (container.next_frame()) {
        for (const std::size_t texture : container.arrived()) (void)container.texels(texture);
        ++frames;
      }
    });
    const std::size_t limit = (std::size_t{kMemory} << 20) * 3;
    return {limit + 64 * memory.bytes.size(), limit * (frames + 2) + 1024 * memory.bytes.size()};
  });
  return 0;
}
