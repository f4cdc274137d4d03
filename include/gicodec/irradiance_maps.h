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
  map = 0,  ///< as texels
  /// As coefficients of basis functions. How each texel blends up to 8 of them is sent once.
  bases = 1,
};

/// Texels along a side of a tile. Each tile has a mask of 32 bytes: a bit per texel, row by row,
/// lowest bit first, set if the texel lies on a surface.
inline constexpr std::uint8_t kMapTile = 16;
inline constexpr std::uint32_t kMaxMapSide = 16384;  ///< texels
/// Bases along a side of a block. The coefficients of a block should be similar.
inline constexpr std::uint8_t kMapBaseBlock = 8;
inline constexpr std::uint32_t kMaxMapBases = 65536;
inline constexpr std::uint32_t kMapBlends = 8;  ///< bases that a texel blends, at most

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

/// Kind 4. Texture groups in order:
/// - `map`: bundled tiles of "coverage" and "irradiance"; only covered texels exist in the latter;
/// - `bases`: "coefficients", a pool of blocks of 8×8 bases; then bundled tiles of "blend coverage"
///   and "blend": for each covered texel the numbers of 8 bases and their weights in 1/255;
/// - `map` and `bases`: "parameterisation", one block with a hash of what both ends derive from the
///   scene.
/// FORMAT.md, "Kinds", has the records.
extern const Kind kIrradianceMaps;

/// invalid_description if a number is out of range, or is not 0 and belongs to the other MapWay.
[[nodiscard]] Result<VolumeDesc> irradiance_map_volume(const IrradianceMapDesc& desc);
/// The inverse; `bases` is in whole blocks. invalid_description for a volume of another kind.
[[nodiscard]] Result<IrradianceMapDesc> irradiance_map_desc(const VolumeDesc& volume);

}  // namespace gicodec
