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
      cores_(probe_count(desc) * core_bytes_, std::byte{0}) {}

void Mirror::ring(std::uint32_t probe, std::span<std::byte> out) const {
  if (const auto it = stale_.find(probe); it != stale_.end()) {
    std::ranges::copy(it->second, out.begin());
  } else {
    ring_by_rule(desc_, core(probe).data(), out);
  }
}

void Mirror::commit(bool keyframe, std::span<const std::uint32_t> probes,
                    std::span<const std::byte> cores, StaleRings&& stale) noexcept {
  if (keyframe) {
    std::ranges::fill(cores_, std::byte{0});
    stale_.clear();
  }
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::memcpy(cores_.data() + probes[i] * core_bytes_, cores.data() + i * core_bytes_,
                core_bytes_);
    if (!stale_.empty()) stale_.erase(probes[i]);
  }
  stale_.merge(stale);  // Moves nodes: no allocation.
}

void Mirror::set_core(std::uint32_t probe, std::span<const std::byte> core) noexcept {
  std::memcpy(cores_.data() + probe * core_bytes_, core.data(), core_bytes_);
}

bool Mirror::equals(const CheckedView<const std::byte>& view, std::uint32_t probe,
                    const std::byte* core, bool stale) const {
  if (std::memcmp(core, cores_.data() + probe * core_bytes_, core_bytes_) != 0) return false;
  const auto it = stale_.find(probe);
  if (stale != (it != stale_.end())) return false;
  if (!stale) return true;
  std::vector<std::byte> now(it->second.size());
  gather_ring(desc_, view, probe, now);
  return now == it->second;
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
    const auto it = stale_.find(probe);
    if (it != stale_.end()) scatter_ring(desc_, view, probe, it->second);
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
