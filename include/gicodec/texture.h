// Textures of light probes: texel formats, the probe grid and its layout in a texture, views.
#pragma once

#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec {

/// Texel formats. Names and numbers are those of VkFormat; texels are little-endian in memory.
enum class Format : std::uint32_t {
  R8G8B8A8_UNORM = 37,
  A2R10G10B10_UNORM_PACK32 = 58,  ///< R in bits 20-29
  A2B10G10R10_UNORM_PACK32 = 64,  ///< R in bits 0-9; DXGI R10G10B10A2
  R16_SFLOAT = 76,
  R16G16_SFLOAT = 83,
  R16G16B16A16_SFLOAT = 97,
  R32_SFLOAT = 100,
  R32G32_SFLOAT = 103,
  R32G32B32A32_SFLOAT = 109,
  B10G11R11_UFLOAT_PACK32 = 122,
  E5B9G9R9_UFLOAT_PACK32 = 123,
};

/// What the bits of a component mean. The codecs never interpret them; tools do.
enum class ComponentKind : std::uint8_t { unorm, ufloat, sfloat, exponent };

/// One component of a texel: `bits` bits from bit `offset` of the little-endian texel. A component
/// never crosses a 32-bit boundary.
struct Component {
  char name = 0;  ///< 'R', 'G', 'B', 'A' or 'E'
  std::uint8_t offset = 0;
  std::uint8_t bits = 0;
  ComponentKind kind = ComponentKind::unorm;
};

struct FormatInfo {
  Format format{};
  std::string_view name;         ///< without VK_FORMAT_, e.g. "R16G16_SFLOAT"
  std::uint8_t texel_bytes = 0;  ///< 2, 4, 8 or 16
  std::uint8_t component_count = 0;
  Component components[4];  ///< in the order R, G, B, A or E

  [[nodiscard]] constexpr std::span<const Component> used() const noexcept {
    return {components, component_count};
  }
};

/// Every known format, ascending by number.
[[nodiscard]] std::span<const FormatInfo> formats() noexcept;
/// nullptr for a number that is no known format.
[[nodiscard]] const FormatInfo* find_format(Format format) noexcept;
/// By VkFormat name, with or without "VK_FORMAT_"; nullptr if unknown.
[[nodiscard]] const FormatInfo* find_format(std::string_view name) noexcept;

/// Probe grid: nx × ny × nz. Probe index = x + nx·(y + ny·z), whatever the tiling.
struct Grid {
  std::uint32_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Grid&, const Grid&) = default;
};

/// Where the block of probe (x, y, z) stands: tile column, tile row, array slice.
enum class Tiling : std::uint8_t {
  atlas_xy_z = 0,   ///< column x + nx·y, row z: the DDGI paper's atlas, G3D
  atlas_xz_y = 1,   ///< column x + nx·z, row y
  atlas_x_yz = 2,   ///< column x, row y + ny·z
  slices_xz_y = 3,  ///< column x, row z, slice y: one slice per plane of a y-up volume (RTXGI)
  slices_xy_z = 4,  ///< column x, row y, slice z: one slice per plane of a z-up volume
};
inline constexpr std::uint8_t kTilingCount = 5;

/// "atlas_xy_z" and so on; empty for a value that is no tiling.
[[nodiscard]] std::string_view to_string(Tiling tiling) noexcept;
[[nodiscard]] Result<Tiling> tiling_from_string(std::string_view name) noexcept;

inline constexpr std::uint32_t kMaxCore = 64;
inline constexpr std::uint32_t kMaxGridSide = 65535;
inline constexpr std::uint32_t kMaxProbes = 1U << 24;

/// Everything that fixes the meaning of a probe texture's bytes. A plain value.
struct TextureDesc {
  Format format{};
  Grid grid;
  std::uint16_t core = 0;    ///< core texels per block side, 1..64
  std::uint16_t border = 0;  ///< guard band width, 0 or 1
  Tiling tiling = Tiling::atlas_xy_z;

  friend constexpr bool operator==(const TextureDesc&, const TextureDesc&) = default;
};

/// Extent of the texture in texels.
struct Extent {
  std::uint32_t width = 0, height = 0, slices = 0;
  friend constexpr bool operator==(const Extent&, const Extent&) = default;
};

/// Position of a block's top left texel (guard band included).
struct BlockOrigin {
  std::uint32_t x = 0, y = 0, slice = 0;
};

/// invalid_description if a field is out of range, unsupported_format for an unknown format.
Status validate(const TextureDesc& desc) noexcept;

// The following need a desc that validate() accepts.
[[nodiscard]] std::uint32_t probe_count(const TextureDesc& desc) noexcept;
[[nodiscard]] std::uint32_t block_side(const TextureDesc& desc) noexcept;  ///< core + 2·border
[[nodiscard]] std::uint32_t texel_bytes(const TextureDesc& desc) noexcept;
[[nodiscard]] std::size_t core_bytes(const TextureDesc& desc) noexcept;  ///< core texels, one block
[[nodiscard]] Extent extent(const TextureDesc& desc) noexcept;
[[nodiscard]] std::uint64_t texture_bytes(const TextureDesc& desc) noexcept;  ///< tightly packed
/// Precondition: probe < probe_count(desc).
[[nodiscard]] BlockOrigin block_origin(const TextureDesc& desc, std::uint32_t probe) noexcept;

/// The textures of the paper (Stengel et al. §3.2): 8×8 core colour, 16×16 core visibility, each
/// with a one-texel guard band.
[[nodiscard]] constexpr TextureDesc ddgi_irradiance(
    Grid grid, Format format = Format::A2R10G10B10_UNORM_PACK32,
    Tiling tiling = Tiling::atlas_xy_z) noexcept {
  return {format, grid, 8, 1, tiling};
}
[[nodiscard]] constexpr TextureDesc ddgi_visibility(Grid grid,
                                                    Format format = Format::R16G16_SFLOAT,
                                                    Tiling tiling = Tiling::atlas_xy_z) noexcept {
  return {format, grid, 16, 1, tiling};
}

/// A texture in the caller's memory, e.g. a mapped readback buffer. Only the texels themselves are
/// touched: never the bytes between a row's end and the next pitch, never past `bytes`.
/// A pitch of 0 means tightly packed.
template <typename Byte>
struct BasicTextureView {
  std::span<Byte> bytes;
  std::size_t row_pitch = 0;    ///< bytes from a row to the next
  std::size_t slice_pitch = 0;  ///< bytes from a slice to the next
};
using TextureView = BasicTextureView<std::byte>;

struct ConstTextureView : BasicTextureView<const std::byte> {
  constexpr ConstTextureView() = default;
  constexpr ConstTextureView(std::span<const std::byte> bytes_in,  // NOLINT(*-explicit-constructor)
                             std::size_t row_pitch_in = 0, std::size_t slice_pitch_in = 0)
      : BasicTextureView{bytes_in, row_pitch_in, slice_pitch_in} {}
  constexpr ConstTextureView(const TextureView& view)  // NOLINT(google-explicit-constructor)
      : BasicTextureView{view.bytes, view.row_pitch, view.slice_pitch} {}
};

}  // namespace gicodec
