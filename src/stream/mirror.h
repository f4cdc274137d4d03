// The mirror: what the decoder holds of a texture. Core texels of every probe, and the guard bands
// that do not follow the rule.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include "stream/stale_rings.h"
#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

class Mirror {
 public:
  explicit Mirror(const TextureDesc& desc);

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] std::span<const std::byte> cores() const noexcept { return cores_; }
  [[nodiscard]] std::span<const std::byte> core(std::uint32_t probe) const noexcept {
    return cores().subspan(probe * core_bytes_, core_bytes_);
  }
  /// The ring of a probe as it stands, stale or by the rule.
  void ring(std::uint32_t probe, std::span<std::byte> out) const;

  /// The ring of a probe if it is stale, else nothing.
  [[nodiscard]] std::span<const std::byte> stale_ring(std::uint32_t probe) const noexcept {
    const bool stale = !stale_.empty() && stale_[probe] != 0;
    return stale ? std::span(rings_).subspan(probe * ring_bytes_, ring_bytes_)
                 : std::span<const std::byte>();
  }

  /// Makes room for stale rings, if there are any. Throws bad_alloc, and nothing has changed then.
  void make_room(const StaleRings& stale);
  /// Replaces some probes. `stale` holds the rings of those of them that do not follow the rule.
  /// In a keyframe every other probe becomes zero. Cannot fail after make_room().
  void commit(bool keyframe, std::span<const std::uint32_t> probes,
              std::span<const std::byte> cores, const StaleRings& stale) noexcept;

  /// Sets the core texels of one probe.
  void set_core(std::uint32_t probe, std::span<const std::byte> core) noexcept;
  /// Replaces all stale rings.
  void set_stale(const StaleRings& stale);

  /// True if a block equals the mirror's: its core texels, and its guard band, for which `view` is
  /// looked at only if it is `stale`.
  [[nodiscard]] bool equals(const CheckedView<const std::byte>& view, std::uint32_t probe,
                            const std::byte* core, bool stale) const;
  /// Writes the blocks of some probes. Cannot fail.
  void write(Isa isa, const CheckedView<std::byte>& view,
             std::span<const std::uint32_t> probes) const noexcept;
  void write_all(Isa isa, const CheckedView<std::byte>& view) const noexcept;

 private:
  TextureDesc desc_;
  std::size_t core_bytes_, ring_bytes_;
  std::vector<std::byte> cores_;
  std::vector<std::byte> rings_;     ///< of every probe; empty before one was stale
  std::vector<std::uint8_t> stale_;  ///< whose ring is in use; likewise
};

}  // namespace gicodec
