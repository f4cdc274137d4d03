#include "stream/mirror.h"

#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <cstring>
#include <iterator>

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

bool Mirror::equals(const CheckedView<const std::byte>& view, std::uint32_t probe) const {
  if (!core_equals(desc_, view, probe, core(probe))) return false;
  const auto it = stale_.find(probe);
  if (it == stale_.end()) return ring_follows_rule(desc_, view, probe);
  std::vector<std::byte> now(it->second.size());
  gather_ring(desc_, view, probe, now);
  return now == it->second;
}

void Mirror::write(const CheckedView<std::byte>& view,
                   std::span<const std::uint32_t> probes) const {
  for (const std::uint32_t probe : probes) {
    reconstruct(desc_, view, {&probe, 1}, core(probe));
    const auto it = stale_.find(probe);
    if (it != stale_.end()) scatter_ring(desc_, view, probe, it->second);
  }
}

void Mirror::write_all(const CheckedView<std::byte>& view) const {
  for (std::uint32_t probe = 0; probe < probe_count(desc_); ++probe) {
    reconstruct(desc_, view, {&probe, 1}, core(probe));
  }
  for (const auto& [probe, ring] : stale_) scatter_ring(desc_, view, probe, ring);
}

}  // namespace gicodec
