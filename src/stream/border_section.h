// The guard band section of a packet: rings that do not follow the rule, as differences to the
// rings that the decoder would otherwise have (FORMAT.md, "Guard band section").
#pragma once

#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "stream/mirror.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// What both sides know before the section: in keyframes and fresh updates a ring is predicted by
/// the rule from the new core, in other updates by the mirror.
struct BorderContext {
  const Mirror& mirror;
  bool keyframe;  ///< or a fresh update
  std::span<const std::uint32_t> probes;
  std::span<const std::byte> cores;  ///< as decoded, block after block
};

/// Upper bound of the section for `stale` rings in an update of `probes` probes.
[[nodiscard]] std::size_t border_section_bound(const TextureDesc& desc, std::size_t probes,
                                               std::size_t stale) noexcept;

/// Appends the section for `stale` (probe → ring; not empty, each among context.probes).
Status write_border_section(const BorderContext& context, const StaleRings& stale,
                            std::vector<std::byte>& out);
/// What can be told of a section without the probes of its update, in time and memory of its size.
Status check_border_section(const TextureDesc& desc, std::uint32_t probes,
                            std::span<const std::byte> section) noexcept;
/// Fills `differences` for an update of these probes. Rings that turn out to follow the rule are
/// accepted.
Status read_border_section(const TextureDesc& desc, std::span<const std::uint32_t> update,
                           std::span<const std::byte> section, StaleRings& differences);
/// Turns the differences into rings, once the cores are there. Cannot fail.
void resolve_borders(const BorderContext& context, StaleRings& rings) noexcept;

}  // namespace gicodec
