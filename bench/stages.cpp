// Strip, transforms and their inverses; bytes per second count records, as does memcpy's.
#include "transform/byte_planes.h"
#include "transform/yuv444p16.h"
#include "transform/yuv444p8.h"
#include "volume.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace gicodec::bench {
namespace {

enum class Kind : std::int64_t { colour, visibility };

TextureDesc desc_of(const benchmark::State& state) {
  return static_cast<Kind>(state.range(0)) == Kind::colour ? ddgi_irradiance(kGrid)
                                                           : ddgi_visibility(kGrid);
}

/// One volume with everything the stages read and write.
struct Fixture {
  explicit Fixture(const benchmark::State& state)
      : desc(desc_of(state)),
        blocks(all_blocks(desc)),
        texture(make_texture(desc, 1)),
        records(make_records(desc, 1)),
        out(records.size()),
        previous(make_records(desc, 2)),
        planes(3 * (records.size() / 2 + 64)) {}

  void finish(benchmark::State& state) const {
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(records.size()));
    state.SetLabel(desc.record.format == Format::R16G16_SFLOAT ? "visibility" : "colour");
  }

  TextureDesc desc;
  std::vector<std::uint32_t> blocks;
  Vector<std::uint32_t> stale;
  std::vector<std::byte> texture, records, out, previous, planes;
};

/// The paper's planes of a whole volume; a row of the core atlas is what one block row of the grid
/// gives, here simply the block-linear texels.
template <typename Sample>
Planes<Sample> planes_of(Fixture& f, std::size_t total, std::size_t first, std::size_t count) {
  auto* at = reinterpret_cast<Sample*>(f.planes.data()) + first;
  return {{at, count}, {at + total, count}, {at + 2 * total, count}};
}
Planes<std::uint16_t> planes16(Fixture& f, std::size_t texels_at, std::size_t bytes) {
  return planes_of<std::uint16_t>(f, f.records.size() / 4, texels_at / 4, bytes / 4);
}
Planes<std::uint8_t> planes8(Fixture& f, std::size_t texels_at, std::size_t bytes) {
  return planes_of<std::uint8_t>(f, yuv444p8_width(f.records.size()), texels_at / 3,
                                 yuv444p8_width(bytes));
}

/// `at` is the offset of `texels` in the volume's core texels.
void forward_paper(Fixture& f, std::span<const std::byte> texels, std::size_t at = 0) {
  if (is_a2rgb10(f.desc.record.format)) {
    to_yuv444p16(best_isa(), f.desc.record.format, SampleAlignment::high, texels,
                 planes16(f, at, texels.size()));
  } else {
    to_yuv444p8(best_isa(), texels, planes8(f, at, texels.size()));
  }
}
void inverse_paper(Fixture& f, std::span<std::byte> texels, std::size_t at = 0) {
  bool sound;
  if (is_a2rgb10(f.desc.record.format)) {
    const auto p = planes16(f, at, texels.size());
    sound = from_yuv444p16(best_isa(), f.desc.record.format, SampleAlignment::high, {p.y, p.u, p.v},
                           texels);
  } else {
    const auto p = planes8(f, at, texels.size());
    sound = from_yuv444p8(best_isa(), {p.y, p.u, p.v}, texels);
  }
  benchmark::DoNotOptimize(sound);
}

/// Runs `body(fixture)` as a benchmark.
template <typename Body>
void stage(benchmark::State& state, Body&& body) {
  Fixture f(state);
  forward_paper(f, f.records);
  for (auto _ : state) {
    body(f);
    benchmark::ClobberMemory();
  }
  f.finish(state);
}

void BM_memcpy(benchmark::State& state) {
  stage(state, [](Fixture& f) { std::memcpy(f.out.data(), f.records.data(), f.records.size()); });
}
void BM_strip(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    f.stale.clear();
    strip(best_isa(), f.desc, *check_view<const std::byte>(f.desc, ConstTextureView(f.texture)),
          f.blocks, f.out, f.stale);
  });
}
void BM_reconstruct(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    reconstruct(best_isa(), f.desc, *check_view<std::byte>(f.desc, {f.texture}), f.blocks,
                f.records);
  });
}
void BM_paper_forward(benchmark::State& state) {
  stage(state, [](Fixture& f) { forward_paper(f, f.records); });
}
void BM_paper_inverse(benchmark::State& state) {
  stage(state, [](Fixture& f) { inverse_paper(f, f.out); });
}
void BM_byte_planes_forward(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    to_byte_planes(best_isa(), f.desc.record, f.records, f.previous, f.out);
  });
}
void BM_byte_planes_inverse(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    from_byte_planes(best_isa(), f.desc.record, f.out, f.previous, f.records);
  });
}
/// body(blocks, records) for tiles of blocks whose texels stay in a nearby cache.
template <typename Body>
void each_tile(Fixture& f, Body&& body) {
  constexpr std::size_t kTileBytes = 49152;  // a multiple of 3 as well as of a block
  const std::size_t tile = kTileBytes / block_bytes(f.desc);
  for (std::size_t i = 0; i < f.blocks.size(); i += tile) {
    const std::size_t count = std::min(tile, f.blocks.size() - i);
    body(std::span<const std::uint32_t>(f.blocks).subspan(i, count),
         std::span(f.out).first(count * block_bytes(f.desc)), i * block_bytes(f.desc));
  }
}
void BM_strip_and_paper_forward(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    f.stale.clear();
    const auto view = *check_view<const std::byte>(f.desc, ConstTextureView(f.texture));
    each_tile(f, [&](auto blocks, auto records, std::size_t at) {
      strip(best_isa(), f.desc, view, blocks, records, f.stale);
      forward_paper(f, records, at);
    });
  });
}
void BM_paper_inverse_and_reconstruct(benchmark::State& state) {
  stage(state, [](Fixture& f) {
    const auto view = *check_view<std::byte>(f.desc, {f.texture});
    each_tile(f, [&](auto blocks, auto records, std::size_t at) {
      inverse_paper(f, records, at);
      reconstruct(best_isa(), f.desc, view, blocks, records);
    });
  });
}

BENCHMARK(BM_memcpy)->DenseRange(0, 1);
BENCHMARK(BM_strip)->DenseRange(0, 1);
BENCHMARK(BM_paper_forward)->DenseRange(0, 1);
BENCHMARK(BM_strip_and_paper_forward)->DenseRange(0, 1);
BENCHMARK(BM_paper_inverse)->DenseRange(0, 1);
BENCHMARK(BM_reconstruct)->DenseRange(0, 1);
BENCHMARK(BM_paper_inverse_and_reconstruct)->DenseRange(0, 1);
BENCHMARK(BM_byte_planes_forward)->DenseRange(0, 1);
BENCHMARK(BM_byte_planes_inverse)->DenseRange(0, 1);

}  // namespace
}  // namespace gicodec::bench
