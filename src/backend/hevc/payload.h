// Layout of an HEVC payload: head, alpha section, access unit (FORMAT.md, "HEVC payload").
#pragma once

#include "backend/hevc/picture.h"

#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::hevc {

inline constexpr std::uint8_t kPayloadVersion = 1;
inline constexpr std::uint8_t kAlphaCoded = 4;  ///< 0..3: the alpha code of every texel

struct PayloadHead {
  HevcPacking packing{};
  HevcLayout layout{};
  bool lossy = false;
  std::uint8_t bit_depth = 8;
  std::uint8_t size_class = 0;
  std::uint8_t alpha = 0;
  std::uint32_t hash = 0;  ///< checksum() of the blocks as decoded
};

struct Payload {
  PayloadHead head;
  std::span<const std::byte> alpha_section;  ///< empty unless head.alpha is kAlphaCoded
  std::span<const std::byte> access_unit;
};

/// Upper bound of the bytes of a payload for such a picture with `texels` in blocks.
[[nodiscard]] std::size_t payload_bound(const PictureFormat& picture, std::size_t texels) noexcept;

void write_payload(const PayloadHead& head, std::span<const std::byte> alpha_section,
                   std::span<const std::byte> access_unit, std::vector<std::byte>& out);
/// Errors: truncated, corrupt, unsupported_version, unsupported_feature.
[[nodiscard]] Result<Payload> read_payload(std::span<const std::byte> bytes) noexcept;

/// Codes the alpha of 10-bit texels: sets head.alpha and returns the section, empty if constant.
[[nodiscard]] Result<std::vector<std::byte>> write_alpha(std::span<const std::byte> texels,
                                                         PayloadHead& head);
/// The inverse. Precondition: the texels' alpha bits are zero.
Status read_alpha(const Payload& payload, std::span<std::byte> texels);

}  // namespace gicodec::hevc
