// A few small textures as HEVC payloads of every packing and layout.
#pragma once

#include "input.h"

#include "bitstream/description.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"

#include <gicodec/hevc.h>

#include <map>

namespace gicodec::fuzz {

inline constexpr unsigned kHevcSetups = 32;

struct HevcSetup {
  struct Update {
    std::vector<std::uint32_t> blocks;
    std::vector<std::byte> records, payload;
  };
  TextureDesc desc;
  HevcSettings settings;
  Update updates[2];  ///< a keyframe of all blocks and an update of some
};

/// `choice` is taken modulo kHevcSetups.
inline HevcSetup make_hevc_setup(unsigned choice) {
  constexpr Format kFormats[] = {Format::A2R10G10B10_UNORM_PACK32, Format::R16G16_SFLOAT,
                                 Format::R32G32B32A32_SFLOAT, Format::E5B9G9R9_UFLOAT_PACK32};
  HevcSetup setup;
  setup.desc = probe_texture(kFormats[choice % 4], {3, 1, 2}, 8);
  setup.settings.decoder = (choice & 4U) != 0 ? "ffmpeg" : "libde265";
  setup.settings.packing = (choice & 8U) != 0 ? HevcPacking::planes : HevcPacking::paper;
  setup.settings.layout = (choice & 16U) != 0 ? HevcLayout::packed : HevcLayout::atlas;
  auto encoder = HevcBackend(setup.settings).make_encoder(setup.desc, {.preset = "ultrafast"});
  check(encoder.ok(), "x265 opens");
  const std::size_t block = block_bytes(setup.desc);
  std::vector<std::byte> mirror(block_count(setup.desc) * block);
  for (unsigned k = 0; k < 2; ++k) {
    auto& update = setup.updates[k];
    update.blocks =
        k == 0 ? std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5} : std::vector<std::uint32_t>{1, 4};
    update.records.resize(update.blocks.size() * block_bytes(setup.desc));
    for (std::size_t i = 0; i < update.records.size(); ++i) {
      update.records[i] = std::byte(i / 32 + (i + k) % 5 * k);
    }
    check((*encoder)->encode({setup.desc,
                              update.blocks,
                              {update.records.data(), block},
                              {{mirror.data(), block}},
                              k == 0},
                             update.payload) == Status::ok,
          "x265 encodes");
    scatter(setup.desc, update.blocks, update.records, mirror);
  }
  return setup;
}

/// Made once for each choice, since opening an encoder takes longer than all the rest.
inline const HevcSetup& setup_of(unsigned choice) {
  static std::map<unsigned, HevcSetup> made;
  const auto [at, added] = made.try_emplace(choice % kHevcSetups);
  if (added) at->second = make_hevc_setup(choice);
  return at->second;
}

/// The setup's keyframe (0) or update (1) as the first or second packet of a stream; what the
/// update builds on is to be put right.
inline Packet packet_of(const HevcSetup& setup, unsigned k) {
  const auto& update = setup.updates[k];
  PacketHead head = PacketChain{kBackendHevc, 0, k, 0}.next(
      description_hash(setup.desc), k == 0 ? PacketType::keyframe : PacketType::delta);
  Packet index, packet;
  head.index_mode = encode_index_buffer(update.blocks, block_count(setup.desc), index);
  head.info.blocks = static_cast<std::uint32_t>(update.blocks.size());
  write_packet_head(head, index, {}, packet);
  packet.insert(packet.end(), update.payload.begin(), update.payload.end());
  seal_packet(packet);
  return packet;
}

}  // namespace gicodec::fuzz
