// Versions of the library and of the formats. They are independent: a new library may write an old
// format, and a format's version changes only when older decoders could not read the new bytes.
#pragma once

#include <gicodec/api.h>

#include <cstdint>
#include <string_view>

namespace GICODEC_API gicodec {

inline constexpr std::uint32_t kVersionMajor = 0;
inline constexpr std::uint32_t kVersionMinor = 1;
inline constexpr std::uint32_t kVersionPatch = 0;
inline constexpr std::string_view kVersionString = "0.1.0";

/// Version of the packet layout, the low nibble of a packet's first byte (FORMAT.md, "Packet").
inline constexpr std::uint8_t kPacketVersion = 1;
/// Version of containers; readers accept any minor of their major (FORMAT.md, "Container").
inline constexpr std::uint8_t kContainerMajor = 1;
inline constexpr std::uint8_t kContainerMinor = 0;

}  // namespace gicodec
