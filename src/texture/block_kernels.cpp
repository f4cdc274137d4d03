// Blocks of a texture ↔ records, for one instruction set (simd/dispatch.h). The two common shapes,
// 8×8 and 16×16 texels of 4 bytes, are copied by rows, all others record by record.
#include "texture/block_kernels.h"

#include "base/parts.h"
#include "texture/octahedral_rule.h"

#include <cstring>
#include <utility>

namespace gicodec::GICODEC_ISA {
namespace {

#include "simd/memory.inl"

/// A block in a texture: its first texel and the texture's row pitch.
template <typename Byte>
struct BlockAt {
  Byte* first;
  std::size_t pitch;
  Byte* texel(unsigned y, unsigned x, std::size_t bytes) const {
    return first + y * pitch + x * bytes;
  }
};

/// Texels of 4 bytes in a register.
#if defined(__AVX512F__)
constexpr unsigned kRegisterTexels = 16;
#elif defined(__AVX2__)
constexpr unsigned kRegisterTexels = 8;
#else
constexpr unsigned kRegisterTexels = 4;
#endif

/// n×n core texels of 4 bytes, n a constant: a row is one vector or a few. No object holds these
/// vectors, since it would live in memory.
template <unsigned n>
struct RowBlock {
  static constexpr unsigned kPart = n < kRegisterTexels ? n : kRegisterTexels, kParts = n / kPart;
  using Part [[gnu::vector_size(4 * kPart)]] = std::uint32_t;
  static constexpr std::size_t kRowBytes = std::size_t{4} * n;

  static Part load_part(const std::byte* row, unsigned k) {
    Part part;
    std::memcpy(&part, row + k * sizeof part, sizeof part);
    return part;
  }
  static void store_part(std::byte* row, unsigned k, Part part) {
    std::memcpy(row + k * sizeof part, &part, sizeof part);
  }
  static Part mirror(Part part) {
    return [&]<int... i>(std::integer_sequence<int, i...>) {
      return __builtin_shufflevector(part, part, int{kPart} - 1 - i...);
    }
    (std::make_integer_sequence<int, kPart>{});
  }

  /// Copies the core texels; true if the guard band does not follow the rule.
  static bool strip(BlockAt<const std::byte> block, std::byte* core) {
    Part different{};
    const auto copy_row = [&](unsigned y) {
      for (unsigned k = 0; k < kParts; ++k) {
        store_part(core + y * kRowBytes, k, load_part(block.texel(y + 1, 1, 4), k));
      }
    };
    const auto copy_and_compare_row = [&](unsigned y, unsigned band_y) {
      for (unsigned k = 0; k < kParts; ++k) {
        const Part part = load_part(block.texel(y + 1, 1, 4), k);
        store_part(core + y * kRowBytes, k, part);
        different |= load_part(block.texel(band_y, 1, 4), kParts - 1 - k) ^ mirror(part);
      }
    };
    copy_and_compare_row(0, 0);
    for (unsigned y = 1; y < n - 1; ++y) copy_row(y);
    copy_and_compare_row(n - 1, n + 1);

    // Compares a guard band texel and its core neighbour with the mirrored row's pair, swapped.
    std::uint64_t unequal = 0;
    for (unsigned y = 1; y <= n / 2; ++y) {
      for (const unsigned x : {0U, n}) {
        const auto pair = read<std::uint64_t>(block.texel(y, x, 4));
        const auto mirrored = read<std::uint64_t>(block.texel(n + 1 - y, x, 4));
        unequal |= pair ^ (mirrored << 32 | mirrored >> 32);
      }
    }
    const auto compare_corner = [&](unsigned y, unsigned x, unsigned core_y, unsigned core_x) {
      unequal |= read<std::uint32_t>(block.texel(y, x, 4)) ^
                 read<std::uint32_t>(block.texel(core_y, core_x, 4));
    };
    compare_corner(0, 0, n, n);
    compare_corner(0, n + 1, n, 1);
    compare_corner(n + 1, 0, 1, n);
    compare_corner(n + 1, n + 1, 1, 1);
    std::uint64_t halves[kPart / 2];
    std::memcpy(halves, &different, sizeof halves);
    for (const std::uint64_t half : halves) unequal |= half;
    return unequal != 0;
  }

  static void reconstruct(const std::byte* core, BlockAt<std::byte> block) {
    const auto texel = [&](unsigned y, unsigned x) {
      return read<std::uint32_t>(core + y * kRowBytes + std::size_t{4} * x);
    };
    const auto store_band_row = [&](unsigned y, unsigned core_y) {
      write(block.texel(y, 0, 4), texel(n - 1 - core_y, n - 1));
      for (unsigned k = 0; k < kParts; ++k) {
        store_part(block.texel(y, 1, 4), kParts - 1 - k,
                   mirror(load_part(core + core_y * kRowBytes, k)));
      }
      write(block.texel(y, n + 1, 4), texel(n - 1 - core_y, 0));
    };
    store_band_row(0, 0);
    for (unsigned y = 0; y < n; ++y) {
      write(block.texel(y + 1, 0, 4), texel(n - 1 - y, 0));
      for (unsigned k = 0; k < kParts; ++k) {
        store_part(block.texel(y + 1, 1, 4), k, load_part(core + y * kRowBytes, k));
      }
      write(block.texel(y + 1, n + 1, 4), texel(n - 1 - y, n - 1));
    }
    store_band_row(n + 1, n - 1);
  }
};

/// Any side and record size (a constant or not), with or without a guard band.
struct AnyBlock {
  template <typename Size>
  static bool strip(BlockAt<const std::byte> block, unsigned n, unsigned guard_band,
                    std::byte* core, Size size) {
    for (unsigned y = 0; y < n; ++y) {
      std::memcpy(core + y * n * size, block.texel(y + guard_band, guard_band, size), n * size);
    }
    bool different = false;
    if (guard_band != 0) {
      walk_rule(n, [&](unsigned y, unsigned x, unsigned core_y, unsigned core_x) {
        different |=
            std::memcmp(block.texel(y, x, size), core + (core_y * n + core_x) * size, size) != 0;
      });
    }
    return different;
  }

  template <typename Size>
  static void reconstruct(const std::byte* core, unsigned n, unsigned guard_band,
                          BlockAt<std::byte> block, Size size) {
    for (unsigned y = 0; y < n; ++y) {
      std::memcpy(block.texel(y + guard_band, guard_band, size), core + y * n * size, n * size);
    }
    if (guard_band != 0) {
      walk_rule(n, [&](unsigned y, unsigned x, unsigned core_y, unsigned core_x) {
        std::memcpy(block.texel(y, x, size), core + (core_y * n + core_x) * size, size);
      });
    }
  }
};

/// body(block, place) for each block of a run; `place` counts from 0.
template <typename Byte, typename Body>
void walk_run(const BlockRun<Byte>& run, Body&& body) {
  for (unsigned i = 0; i < run.count; ++i) {
    body(BlockAt<Byte>{run.first + i * run.step, run.row_pitch}, i);
  }
}

/// Calls body(size); the common record sizes are compile-time constants.
template <typename Body>
void with_size(std::size_t size, Body&& body) {
  switch (size) {
    case 1:
      return body(std::integral_constant<std::size_t, 1>());
    case 2:
      return body(std::integral_constant<std::size_t, 2>());
    case 4:
      return body(std::integral_constant<std::size_t, 4>());
    case 8:
      return body(std::integral_constant<std::size_t, 8>());
    case 16:
      return body(std::integral_constant<std::size_t, 16>());
    default:
      return body(size);
  }
}

std::uint64_t strip_run(const BlockRun<const std::byte>& run, std::byte* cores) {
  const unsigned n = run.core;
  std::uint64_t stale = 0;
  if (run.record_bytes == 4 && run.guard_band == 1 && n == 8) {
    walk_run(run, [&](BlockAt<const std::byte> block, unsigned i) {
      stale |= std::uint64_t{RowBlock<8>::strip(block, cores + i * std::size_t{256})} << i;
    });
  } else if (run.record_bytes == 4 && run.guard_band == 1 && n == 16) {
    walk_run(run, [&](BlockAt<const std::byte> block, unsigned i) {
      stale |= std::uint64_t{RowBlock<16>::strip(block, cores + i * std::size_t{1024})} << i;
    });
  } else {
    with_size(run.record_bytes, [&](auto size) {
      walk_run(run, [&](BlockAt<const std::byte> block, unsigned i) {
        std::byte* core = cores + std::size_t{i} * n * n * size;
        stale |= std::uint64_t{AnyBlock::strip(block, n, run.guard_band, core, size)} << i;
      });
    });
  }
  return stale;
}

void reconstruct_run(const std::byte* cores, const BlockRun<std::byte>& run) {
  const unsigned n = run.core;
  if (run.record_bytes == 4 && run.guard_band == 1 && n == 8) {
    walk_run(run, [&](BlockAt<std::byte> block, unsigned i) {
      RowBlock<8>::reconstruct(cores + i * std::size_t{256}, block);
    });
  } else if (run.record_bytes == 4 && run.guard_band == 1 && n == 16) {
    walk_run(run, [&](BlockAt<std::byte> block, unsigned i) {
      RowBlock<16>::reconstruct(cores + i * std::size_t{1024}, block);
    });
  } else {
    with_size(run.record_bytes, [&](auto size) {
      walk_run(run, [&](BlockAt<std::byte> block, unsigned i) {
        const std::byte* core = cores + std::size_t{i} * n * n * size;
        AnyBlock::reconstruct(core, n, run.guard_band, block, size);
      });
    });
  }
}

constexpr BlockKernels kKernels{kEncodes ? strip_run : nullptr, reconstruct_run};

}  // namespace
}  // namespace gicodec::GICODEC_ISA

namespace gicodec {
template <>
constinit const BlockKernels TableOf<BlockKernels, Isa::GICODEC_ISA>::kernels =
    GICODEC_ISA::kKernels;
}  // namespace gicodec
