// The number of a region in containers and messages: 0 for the whole volume, else 1 + what
// RegionGrid counts.
#pragma once

#include <gicodec/delivery.h>
#include <gicodec/texture.h>

#include <cstdint>

namespace gicodec {

inline constexpr std::uint64_t kMaxRegionField = kMaxBlocks;

[[nodiscard]] constexpr std::uint64_t to_region_field(std::uint32_t region) noexcept {
  return region == StreamId::kWholeVolume ? 0 : std::uint64_t{region} + 1;
}
/// Precondition: field <= kMaxRegionField.
[[nodiscard]] constexpr std::uint32_t from_region_field(std::uint64_t field) noexcept {
  return field == 0 ? StreamId::kWholeVolume : static_cast<std::uint32_t>(field - 1);
}

}  // namespace gicodec
