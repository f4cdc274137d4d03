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
  R8_UINT = 13,
  R8G8_UNORM = 16,
  R8G8B8_SNORM = 24,
  R8G8B8A8_UNORM = 37,
  R8G8B8A8_SNORM = 38,
  R8G8B8A8_UINT = 41,
  B8G8R8A8_UNORM = 44,
  A2R10G10B10_UNORM_PACK32 = 58,  ///< R in bits 20-29
  A2B10G10R10_UNORM_PACK32 = 64,  ///< R in bits 0-9; DXGI R10G10B10A2
  R16_UNORM = 70,
  R16_UINT = 74,
  R16_SFLOAT = 76,
  R16G16_SFLOAT = 83,
  R16G16B16A16_UNORM = 91,
  R16G16B16A16_SFLOAT = 97,
  R32_UINT = 98,
  R32_SFLOAT = 100,
  R32G32_SFLOAT = 103,
  R32G32B32_SFLOAT = 106,
  R32G32B32A32_SFLOAT = 109,
  B10G11R11_UFLOAT_PACK32 = 122,
  E5B9G9R9_UFLOAT_PACK32 = 123,
  BC6H_UFLOAT_BLOCK = 143,  ///< one record is a compressed block of 4×4 texels
  BC6H_SFLOAT_BLOCK = 144,
  BC7_UNORM_BLOCK = 145,
  BC7_SRGB_BLOCK = 146,
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
};

/// Every known format, ascending by number; static storage.
[[nodiscard]] std::span<const FormatInfo> formats() noexcept;
/// nullptr if unknown.
[[nodiscard]] const FormatInfo* find_format(Format format) noexcept;
/// By VkFormat name, with or without "VK_FORMAT_"; nullptr if unknown.
[[nodiscard]] const FormatInfo* find_format(std::string_view name) noexcept;

}  // namespace gicodec
