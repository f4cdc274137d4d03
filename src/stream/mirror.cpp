#include "stream/mirror.h"

#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <numeric>

namespace gicodec {

Mirror::Mirror(const TextureDesc& desc)
    : desc_(desc),
      core_bytes_(core_bytes(desc)),
      ring_bytes_(ring_bytes(desc)),
      cores_(probe_count(desc) * core_bytes_, std::byte{0}) {}

void Mirror::ring(std::uint32_t probe, std::span<std::byte> out) const {
  if (const auto stale = stale_ring(probe); !stale.empty()) {
    std::ranges::copy(stale, out.begin());
  } else {
    ring_by_rule(desc_, core(probe).data(), out);
  }
}

void Mirror::make_room(const StaleRings& stale) {
  if (stale.empty() || !stale_.empty()) return;
  rings_.resize(probe_count(desc_) * ring_bytes_);
  stale_.resize(probe_count(desc_));
}

void Mirror::commit(bool keyframe, std::span<const std::uint32_t> probes,
                    std::span<const std::byte> cores, const StaleRings& stale) noexcept {
  if (keyframe) {
    std::ranges::fill(cores_, std::byte{0});
    std::ranges::fill(stale_, std::uint8_t{0});
  }
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::memcpy(cores_.data() + probes[i] * core_bytes_, cores.data() + i * core_bytes_,
                core_bytes_);
    if (!stale_.empty()) stale_[probes[i]] = 0;
  }
  for (std::size_t i = 0; i < stale.size(); ++i) {
    const std::uint32_t probe = stale.probes()[i];
    std::memcpy(rings_.data() + probe * ring_bytes_, stale.ring(i).data(), ring_bytes_);
    stale_[probe] = 1;
  }
}

void Mirror::set_stale(const StaleRings& stale) {
  make_room(stale);
  std::ranges::fill(stale_, std::uint8_t{0});
  commit(false, {}, {}, stale);
}

void Mirror::set_core(std::uint32_t probe, std::span<const std::byte> core) noexcept {
  std::memcpy(cores_.data() + probe * core_bytes_, core.data(), core_bytes_);
}

bool Mirror::equals(const CheckedView<const std::byte>& view, std::uint32_t probe,
                    const std::byte* core, bool stale) const {
  if (std::memcmp(core, cores_.data() + probe * core_bytes_, core_bytes_) != 0) return false;
  const auto held = stale_ring(probe);
  if (stale != !held.empty()) return false;
  if (!stale) return true;
  std::vector<std::byte> now(held.size());
  gather_ring(desc_, view, probe, now);
  return std::ranges::equal(now, held);
}

void Mirror::write(Isa isa, const CheckedView<std::byte>& view,
                   std::span<const std::uint32_t> probes) const noexcept {
  // Consecutive probes are consecutive in the mirror too.
  for (std::size_t i = 0; i < probes.size();) {
    std::size_t end = i + 1;
    while (end < probes.size() && probes[end] == probes[end - 1] + 1) ++end;
    reconstruct(isa, desc_, view, probes.subspan(i, end - i),
                cores().subspan(probes[i] * core_bytes_));
    i = end;
  }
  if (stale_.empty()) return;
  for (const std::uint32_t probe : probes) {
    const auto held = stale_ring(probe);
    if (!held.empty()) scatter_ring(desc_, view, probe, held);
  }
}

void Mirror::write_all(Isa isa, const CheckedView<std::byte>& view) const noexcept {
  std::array<std::uint32_t, 512> some;  // At a time: nothing is allocated.
  const std::uint32_t total = probe_count(desc_);
  for (std::uint32_t first = 0; first < total;) {
    const auto count = std::min<std::uint32_t>(some.size(), total - first);
    const auto probes = std::span(some).first(count);
    std::iota(probes.begin(), probes.end(), first);
    write(isa, view, probes);
    first += count;
  }
}

}  // namespace gicodec
