// Irradiance maps (Crassin et al. §4.2): indirect light in texture light maps over a unique
// parameterisation of a scene.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindIrradianceMaps = 4;

/// How a map is streamed.
enum class MapWay : std::uint8_t {
  map = 0,    ///< its texels
  bases = 1,  ///< coefficients of basis functions, and once how each texel blends up to 8 of them
};

/// Texels along a side of a tile. A tile says by a mask of 32 bytes which of its texels lie on a
/// surface, row by row, lowest bit first.
inline constexpr std::uint8_t kMapTile = 16;
inline constexpr std::uint32_t kMaxMapSide = 16384;
/// Bases along a side of a block of coefficients, which should be alike.
inline constexpr std::uint8_t kMapBaseBlock = 8;
inline constexpr std::uint32_t kMaxMapBases = 65536;
inline constexpr std::uint32_t kMapBlends = 8;  ///< bases of a texel

struct IrradianceMapDesc {
  /// Texels, 1..kMaxMapSide.
  std::uint32_t width = 1024, height = 1024;
  MapWay way = MapWay::map;
  /// Of texels or coefficients: E5B9G9R9_UFLOAT_PACK32, B10G11R11_UFLOAT_PACK32,
  /// R16G16B16A16_SFLOAT or A2B10G10R10_UNORM_PACK32.
  Format format = Format::E5B9G9R9_UFLOAT_PACK32;
  std::uint32_t bases = 0;  ///< MapWay::bases: 1..kMaxMapBases, rounded up to whole blocks

  friend bool operator==(const IrradianceMapDesc&, const IrradianceMapDesc&) = default;
};

/// Kind 4. Sets in order:
/// - `map`: tiles of "coverage" and "irradiance", together, the latter of texels that are covered;
/// - `bases`: "coefficients", a pool of blocks of 8×8 bases; then tiles of "blend coverage" and
///   "blend", together: of each covered texel the numbers of 8 bases and their weights, of 255;
/// - last of both ways, of one block: "parameterisation", the hash of what both ends derive from
/// the
///   scene.
/// Their records are in FORMAT.md, "Kinds".
extern const Kind kIrradianceMaps;

/// invalid_description for numbers out of range, and for those of another way that are not 0.
[[nodiscard]] Result<VolumeDesc> irradiance_map_volume(const IrradianceMapDesc& desc);
/// What such a volume was made of, bases in whole blocks. invalid_description for any other.
[[nodiscard]] Result<IrradianceMapDesc> irradiance_map_desc(const VolumeDesc& volume);

}  // namespace gicodec
