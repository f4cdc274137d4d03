// Containers that declare grids near the limits, and packets that say little: opened and decoded
// within what the programs allow.
#include "foreign_file.h"

#include "bitstream/packet.h"
#include "gicodec/container_input.h"
#include "memory_sink.h"

namespace {

using namespace gicodec;
using namespace gicodec::tools;

/// Around 2^16, 2^20, 2^24 probes or at the longest side; often beyond a limit.
TextureDesc read_desc(fuzz::Input& input) {
  TextureDesc desc;
  desc.format = formats()[input.below(static_cast<std::uint32_t>(formats().size()))].format;
  const std::uint32_t sides[] = {1, 2, 16, 64, 255, 256, 257, 4096, kMaxGridSide, 17};
  const auto side = [&] { return sides[input.below(std::size(sides))]; };
  desc.grid = {side(), side(), side()};
  const std::uint8_t shape = input.byte();
  desc.core = static_cast<std::uint16_t>(1 + shape % (shape < 128 ? 4 : kMaxCore));
  desc.border = static_cast<std::uint16_t>(input.below(2));
  desc.tiling = static_cast<Tiling>(input.below(kTilingCount));
  return desc;
}

/// A packet of nothing but what the input says, for that texture.
Packet make_packet(fuzz::Input& input, const TextureDesc& desc, std::uint8_t texture,
                   std::uint32_t sequence) {
  PacketHead head;
  head.info.texture_id = texture;
  head.info.keyframe = input.below(4) != 0;
  head.info.backend =
      static_cast<std::uint8_t>(input.below(3) == 2 ? kBackendNative : input.below(3));
  head.info.sequence = sequence;
  head.info.reference = head.info.keyframe ? 0 : sequence - 1;
  head.base = description_hash(desc);
  head.index_mode = static_cast<IndexMode>(input.below(4));
  head.info.all_probes = head.index_mode == IndexMode::all;
  head.info.probes = input.u16() * (input.below(2) == 0 ? 1 : 255);
  const auto index =
      head.info.all_probes ? std::span<const std::byte>{} : input.bytes(input.byte());
  Packet packet;
  write_packet_head(head, index, {}, packet);
  const auto payload = input.bytes(input.byte());
  packet.insert(packet.end(), payload.begin(), payload.end());
  seal_packet(packet);
  return packet;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMemory = 24;  // MiB
  fuzz::Input input(data, size);
  ContainerDescription description;
  const std::uint32_t textures = 1 + input.below(8);
  for (std::uint32_t i = 0; i < textures; ++i) {
    const TextureDesc desc = read_desc(input);
    if (validate(desc) != Status::ok || texture_bytes(desc) > DecodeLimits{}.max_texture_bytes) {
      continue;
    }
    description.textures.push_back({fmt::format("t{}", i), desc, {}});
  }
  test::MemorySink memory;
  auto writer = ContainerWriter::create(memory, description);
  if (!writer) return 0;
  for (std::uint32_t frame = 0; frame < 16 && !input.empty(); ++frame) {
    const auto texture = static_cast<std::uint8_t>(
        input.below(static_cast<std::uint32_t>(description.textures.size())));
    (void)writer->add(frame,
                      make_packet(input, description.textures[texture].desc, texture, frame + 1));
  }
  (void)writer->finish();
  const fuzz::MemoryFile file(memory.bytes);
  fuzz::check_cost("a great grid costs nothing", [&]() -> fuzz::Allowance {
    std::size_t frames = 0;
    fuzz::accepted([&] {
      ContainerInput container(file.path());
      DecoderFlags flags;
      flags.memory = kMemory;
      TextureStates states(container, flags);
      std::uint64_t frame = 0;
      std::vector<ContainerPacket> packets;
      while (container.next_frame(frame, packets)) {
        for (const ContainerPacket& packet : packets) states.apply(packet);
        ++frames;
      }
    });
    const std::size_t limit = (std::size_t{kMemory} << 20) * 3;
    return {limit + 64 * memory.bytes.size(), limit * (frames + 2) + 1024 * memory.bytes.size()};
  });
  return 0;
}
