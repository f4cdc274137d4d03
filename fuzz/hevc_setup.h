// A few small textures as HEVC payloads of every packing and layout.
#pragma once

#include "input.h"

#include <gicodec/hevc.h>

namespace gicodec::fuzz {

inline constexpr unsigned kHevcSetups = 32;

struct HevcSetup {
  struct Update {
    std::vector<std::uint32_t> probes;
    std::vector<std::byte> texels, payload;
  };
  TextureDesc desc;
  HevcSettings settings;
  Update updates[2];  ///< a keyframe of all probes and an update of some
};

/// `choice` is taken modulo kHevcSetups.
inline HevcSetup make_hevc_setup(unsigned choice) {
  constexpr Format kFormats[] = {Format::A2R10G10B10_UNORM_PACK32, Format::R16G16_SFLOAT,
                                 Format::R32G32B32A32_SFLOAT, Format::E5B9G9R9_UFLOAT_PACK32};
  HevcSetup setup;
  setup.desc = {kFormats[choice % 4], {3, 1, 2}, 8, 1, Tiling::atlas_xy_z};
  setup.settings.decoder = (choice & 4U) != 0 ? "ffmpeg" : "libde265";
  setup.settings.packing = (choice & 8U) != 0 ? HevcPacking::planes : HevcPacking::paper;
  setup.settings.layout = (choice & 16U) != 0 ? HevcLayout::packed : HevcLayout::atlas;
  auto encoder = HevcBackend(setup.settings).make_encoder(setup.desc, {.preset = "ultrafast"});
  check(encoder.ok(), "x265 opens");
  std::vector<std::byte> mirror(probe_count(setup.desc) * core_bytes(setup.desc));
  for (unsigned k = 0; k < 2; ++k) {
    auto& update = setup.updates[k];
    update.probes =
        k == 0 ? std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5} : std::vector<std::uint32_t>{1, 4};
    update.texels.resize(update.probes.size() * core_bytes(setup.desc));
    for (std::size_t i = 0; i < update.texels.size(); ++i) {
      update.texels[i] = std::byte(i / 32 + (i + k) % 5 * k);
    }
    check((*encoder)->encode({setup.desc, update.probes, update.texels, mirror, k == 0},
                             update.payload) == Status::ok,
          "x265 encodes");
    scatter(setup.desc, update.probes, update.texels, mirror);
  }
  return setup;
}

}  // namespace gicodec::fuzz
