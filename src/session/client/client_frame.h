// Frames of a client: lookup, changed blocks, copies.
#pragma once

#include <gicodec/client.h>

#include <cstdint>
#include <vector>

namespace gicodec {

/// Null if there is none.
[[nodiscard]] ClientVolume* find_volume(std::vector<ClientVolume>& volumes,
                                        std::uint16_t id) noexcept;

}  // namespace gicodec
