// measuring
#include "allocation_counter.h"
#include "support.h"

#include <gtest/gtest.h>
#include <cstdio>

namespace gicodec {
namespace {
using namespace test;

TEST(Memory, Measure) {
  const TextureDesc descs[] = {
      {Format::R8G8B8A8_UNORM, {1, 1, 1}, 1, 0, Tiling::atlas_xy_z},
      {Format::R16_SFLOAT, {64, 64, 4}, 1, 1, Tiling::atlas_xy_z},
      {Format::R16G16_SFLOAT, {3, 2, 1}, 64, 1, Tiling::atlas_xy_z},
      {Format::R16G16_SFLOAT, {8, 8, 16}, 16, 1, Tiling::atlas_xy_z},
      {Format::A2B10G10R10_UNORM_PACK32, {16, 8, 16}, 8, 1, Tiling::atlas_xy_z},
      {Format::R32G32B32A32_SFLOAT, {5, 3, 4}, 33, 0, Tiling::atlas_xy_z},
      {Format::R32G32B32A32_SFLOAT, {8, 8, 4}, 16, 1, Tiling::atlas_xy_z},
  };
  Random random(1);
  for (const auto& desc : descs) {
    const double T = double(probe_count(desc)) * core_bytes(desc);
    const double R =
        desc.border ? double(probe_count(desc)) * 4 * (block_side(desc) - 1) * texel_bytes(desc)
                    : 0;
    Texture a(desc), b(desc);
    for (auto* t : {&a, &b}) {
      for (std::uint32_t p = 0; p < probe_count(desc); ++p)
        t->set_block(p, noise(random, t->block(p).size()));
    }
    for (const auto& coding : codings()) {
      std::vector<Packet> packets(3);
      const auto enc = heap_peak_of([&] {
        auto encoder = *Encoder::create(desc, options_of(coding));
        for (int i = 0; i < 3; ++i)
          packets[i] = *encoder.encode(std::as_const(i % 2 ? a : b).view(), Selection::all());
      });
      std::size_t size = 0, largest = 0;
      for (auto& p : packets) size += p.size(), largest = std::max(largest, p.size());
      Texture out(desc);
      const auto dec = heap_peak_of([&] {
        auto decoder = *Decoder::create(desc);
        for (auto& p : packets)
          if (decoder.decode(p, out.view()) != Status::ok) std::abort();
      });
      std::printf("%-26s n %6u T %9.0f R %9.0f %s %2d: enc %10zu (T+R)*%.2f  dec %10zu *%.2f\n",
                  find_format(desc.format)->name.data(), probe_count(desc), T, R, coding.backend,
                  coding.level, enc - size, double(enc - size) / (T + R), dec,
                  double(dec) / (T + R));
    }
  }
}

}  // namespace
}  // namespace gicodec
