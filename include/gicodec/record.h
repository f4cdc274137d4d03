// Records: what stands at one place of a block, e.g. a texel. Known VkFormats are presets.
#pragma once

#include <gicodec/api.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace GICODEC_API gicodec {

/// Formats of texels, with VkFormat's names and numbers; little-endian in memory.
enum class Format : std::uint32_t {
  UNDEFINED = 0,  ///< a record that the application defines
  R8_UNORM = 9,
  R8_SNORM = 10,
  R8_UINT = 13,
  R8_SRGB = 15,
  R8G8_UNORM = 16,
  R8G8_SNORM = 17,
  R8G8_UINT = 20,
  R8G8_SRGB = 22,
  R8G8B8_UNORM = 23,
  R8G8B8_SNORM = 24,
  R8G8B8_UINT = 27,
  R8G8B8_SRGB = 29,
  B8G8R8_UNORM = 30,
  B8G8R8_SRGB = 36,
  R8G8B8A8_UNORM = 37,
  R8G8B8A8_SNORM = 38,
  R8G8B8A8_UINT = 41,
  R8G8B8A8_SRGB = 43,
  B8G8R8A8_UNORM = 44,
  B8G8R8A8_SRGB = 50,
  A8B8G8R8_UNORM_PACK32 = 51,
  A8B8G8R8_SRGB_PACK32 = 57,
  A2R10G10B10_UNORM_PACK32 = 58,  ///< R in bits 20-29
  A2B10G10R10_UNORM_PACK32 = 64,  ///< R in bits 0-9; DXGI R10G10B10A2
  R16_UNORM = 70,
  R16_SNORM = 71,
  R16_UINT = 74,
  R16_SFLOAT = 76,
  R16G16_UNORM = 77,
  R16G16_SNORM = 78,
  R16G16_UINT = 81,
  R16G16_SFLOAT = 83,
  R16G16B16_UNORM = 84,
  R16G16B16_SNORM = 85,
  R16G16B16_UINT = 88,
  R16G16B16_SFLOAT = 90,
  R16G16B16A16_UNORM = 91,
  R16G16B16A16_SNORM = 92,
  R16G16B16A16_UINT = 95,
  R16G16B16A16_SFLOAT = 97,
  R32_UINT = 98,
  R32_SFLOAT = 100,
  R32G32_UINT = 101,
  R32G32_SFLOAT = 103,
  R32G32B32_UINT = 104,
  R32G32B32_SFLOAT = 106,
  R32G32B32A32_UINT = 107,
  R32G32B32A32_SFLOAT = 109,
  B10G11R11_UFLOAT_PACK32 = 122,
  E5B9G9R9_UFLOAT_PACK32 = 123,
  BC1_RGB_UNORM_BLOCK = 131,  ///< from here on a record is a compressed block of texels
  BC1_RGB_SRGB_BLOCK = 132,
  BC1_RGBA_UNORM_BLOCK = 133,
  BC1_RGBA_SRGB_BLOCK = 134,
  BC2_UNORM_BLOCK = 135,
  BC2_SRGB_BLOCK = 136,
  BC3_UNORM_BLOCK = 137,
  BC3_SRGB_BLOCK = 138,
  BC4_UNORM_BLOCK = 139,
  BC4_SNORM_BLOCK = 140,
  BC5_UNORM_BLOCK = 141,
  BC5_SNORM_BLOCK = 142,
  BC6H_UFLOAT_BLOCK = 143,
  BC6H_SFLOAT_BLOCK = 144,
  BC7_UNORM_BLOCK = 145,
  BC7_SRGB_BLOCK = 146,
  ETC2_R8G8B8_UNORM_BLOCK = 147,
  ETC2_R8G8B8_SRGB_BLOCK = 148,
  ETC2_R8G8B8A1_UNORM_BLOCK = 149,
  ETC2_R8G8B8A1_SRGB_BLOCK = 150,
  ETC2_R8G8B8A8_UNORM_BLOCK = 151,
  ETC2_R8G8B8A8_SRGB_BLOCK = 152,
  EAC_R11_UNORM_BLOCK = 153,
  EAC_R11_SNORM_BLOCK = 154,
  EAC_R11G11_UNORM_BLOCK = 155,
  EAC_R11G11_SNORM_BLOCK = 156,
  ASTC_4x4_UNORM_BLOCK = 157,
  ASTC_4x4_SRGB_BLOCK = 158,
  ASTC_5x4_UNORM_BLOCK = 159,
  ASTC_5x4_SRGB_BLOCK = 160,
  ASTC_5x5_UNORM_BLOCK = 161,
  ASTC_5x5_SRGB_BLOCK = 162,
  ASTC_6x5_UNORM_BLOCK = 163,
  ASTC_6x5_SRGB_BLOCK = 164,
  ASTC_6x6_UNORM_BLOCK = 165,
  ASTC_6x6_SRGB_BLOCK = 166,
  ASTC_8x5_UNORM_BLOCK = 167,
  ASTC_8x5_SRGB_BLOCK = 168,
  ASTC_8x6_UNORM_BLOCK = 169,
  ASTC_8x6_SRGB_BLOCK = 170,
  ASTC_8x8_UNORM_BLOCK = 171,
  ASTC_8x8_SRGB_BLOCK = 172,
  ASTC_10x5_UNORM_BLOCK = 173,
  ASTC_10x5_SRGB_BLOCK = 174,
  ASTC_10x6_UNORM_BLOCK = 175,
  ASTC_10x6_SRGB_BLOCK = 176,
  ASTC_10x8_UNORM_BLOCK = 177,
  ASTC_10x8_SRGB_BLOCK = 178,
  ASTC_10x10_UNORM_BLOCK = 179,
  ASTC_10x10_SRGB_BLOCK = 180,
  ASTC_12x10_UNORM_BLOCK = 181,
  ASTC_12x10_SRGB_BLOCK = 182,
  ASTC_12x12_UNORM_BLOCK = 183,
  ASTC_12x12_SRGB_BLOCK = 184,
  ASTC_4x4_SFLOAT_BLOCK = 1000066000,
  ASTC_5x4_SFLOAT_BLOCK = 1000066001,
  ASTC_5x5_SFLOAT_BLOCK = 1000066002,
  ASTC_6x5_SFLOAT_BLOCK = 1000066003,
  ASTC_6x6_SFLOAT_BLOCK = 1000066004,
  ASTC_8x5_SFLOAT_BLOCK = 1000066005,
  ASTC_8x6_SFLOAT_BLOCK = 1000066006,
  ASTC_8x8_SFLOAT_BLOCK = 1000066007,
  ASTC_10x5_SFLOAT_BLOCK = 1000066008,
  ASTC_10x6_SFLOAT_BLOCK = 1000066009,
  ASTC_10x8_SFLOAT_BLOCK = 1000066010,
  ASTC_10x10_SFLOAT_BLOCK = 1000066011,
  ASTC_12x10_SFLOAT_BLOCK = 1000066012,
  ASTC_12x12_SFLOAT_BLOCK = 1000066013,
};

/// How the bits of a component are read. For error bounds, thresholds and tools only.
enum class ComponentType : std::uint8_t {
  unorm = 0,
  snorm = 1,
  uint = 2,
  ufloat = 3,    ///< of 10 or 11 bits; with fewer bits a mantissa under a shared exponent
  sfloat = 4,    ///< of 16 or 32 bits
  exponent = 5,  ///< shared by the record's mantissas
  opaque = 6,    ///< bits without a numeric meaning
};
inline constexpr std::uint8_t kComponentTypes = 7;

/// `bits` bits from bit `offset` on, of the little-endian record. Within one aligned 32-bit word.
struct Component {
  static constexpr std::size_t kMaxName = 8;

  constexpr Component() noexcept = default;
  /// Precondition: the name has at most kMaxName characters.
  constexpr Component(std::string_view label, std::uint16_t offset_in, std::uint8_t bits_in,
                      ComponentType type_in) noexcept
      : offset(offset_in), bits(bits_in), type(type_in) {
    for (std::size_t i = 0; i < label.size() && i < kMaxName; ++i) characters[i] = label[i];
  }
  [[nodiscard]] constexpr std::string_view name() const noexcept {
    std::size_t size = 0;
    while (size < kMaxName && characters[size] != 0) ++size;
    return {characters.data(), size};
  }
  friend constexpr bool operator==(const Component&, const Component&) = default;

  std::array<char, kMaxName> characters{};  ///< A-Z, a-z, 0-9 and _, then zeros
  std::uint16_t offset = 0;
  std::uint8_t bits = 0;  ///< 1..32
  ComponentType type = ComponentType::unorm;
};

inline constexpr std::size_t kMaxComponents = 16;
inline constexpr std::size_t kMaxRecordBytes = 64;

/// The components of a record. A plain value. Every bit belongs to exactly one component.
struct Record {
  constexpr Record() noexcept = default;
  /// The record of a known format. For any other number `bytes` is 0, which is not valid.
  Record(Format preset) noexcept;  // NOLINT(google-explicit-constructor)

  [[nodiscard]] constexpr std::span<const Component> used() const noexcept {
    return std::span(components).first(count);
  }
  friend constexpr bool operator==(const Record&, const Record&) = default;

  Format format = Format::UNDEFINED;
  std::uint8_t bytes = 0;  ///< 1..kMaxRecordBytes
  std::uint8_t count = 0;  ///< components, 1..kMaxComponents
  std::array<Component, kMaxComponents> components{};
};

/// A colour, then the direction it comes from. Floats: 2 × R32G32B32_SFLOAT, 24 bytes. Otherwise
/// E5B9G9R9_UFLOAT_PACK32 and R8G8B8_SNORM, 7 bytes.
[[nodiscard]] Record colored_direction(bool floats) noexcept;

/// True if sizes, names and bits keep the rules above, and a record with a format is that format's.
[[nodiscard]] bool is_valid(const Record& record) noexcept;

struct FormatInfo {
  std::string_view name;  ///< without VK_FORMAT_, e.g. "R16G16_SFLOAT"
  Record record;
  std::uint8_t width = 1, height = 1;  ///< texels of a record: more than 1 for compressed blocks
};

/// Every known format, ascending by number; static storage.
[[nodiscard]] std::span<const FormatInfo> formats() noexcept;
/// nullptr if unknown.
[[nodiscard]] const FormatInfo* find_format(Format format) noexcept;
/// By VkFormat name, with or without "VK_FORMAT_"; nullptr if unknown.
[[nodiscard]] const FormatInfo* find_format(std::string_view name) noexcept;

}  // namespace gicodec
