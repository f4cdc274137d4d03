// The table of formats, and the validation of records.
#include <gicodec/record.h>

#include <algorithm>
#include <initializer_list>

namespace gicodec {
namespace {

constexpr Record preset(Format format, std::uint8_t bytes,
                        std::initializer_list<Component> components) {
  Record record;
  record.format = format;
  record.bytes = bytes;
  for (const Component& component : components) record.components[record.count++] = component;
  return record;
}

/// Components of the same width, one after the other.
constexpr Record row(Format format, std::string_view names, std::uint8_t bits, ComponentType kind) {
  Record record;
  record.format = format;
  for (std::size_t i = 0; i < names.size(); ++i) {
    record.components[record.count++] = {names.substr(i, 1), static_cast<std::uint16_t>(i * bits),
                                         bits, kind};
  }
  record.bytes = static_cast<std::uint8_t>(names.size() * bits / 8);
  return record;
}

constexpr auto unorm = ComponentType::unorm;
constexpr auto snorm = ComponentType::snorm;
constexpr auto uint = ComponentType::uint;
constexpr auto ufloat = ComponentType::ufloat;
constexpr auto sfloat = ComponentType::sfloat;
constexpr auto exponent = ComponentType::exponent;
constexpr auto opaque = ComponentType::opaque;

constexpr FormatInfo kFormats[] = {
    {"R8_UNORM", row(Format::R8_UNORM, "R", 8, unorm)},
    {"R8_SNORM", row(Format::R8_SNORM, "R", 8, snorm)},
    {"R8_UINT", row(Format::R8_UINT, "R", 8, uint)},
    {"R8_SRGB", row(Format::R8_SRGB, "R", 8, unorm)},
    {"R8G8_UNORM", row(Format::R8G8_UNORM, "RG", 8, unorm)},
    {"R8G8_SNORM", row(Format::R8G8_SNORM, "RG", 8, snorm)},
    {"R8G8_UINT", row(Format::R8G8_UINT, "RG", 8, uint)},
    {"R8G8_SRGB", row(Format::R8G8_SRGB, "RG", 8, unorm)},
    {"R8G8B8_UNORM", row(Format::R8G8B8_UNORM, "RGB", 8, unorm)},
    {"R8G8B8_SNORM", row(Format::R8G8B8_SNORM, "RGB", 8, snorm)},
    {"R8G8B8_UINT", row(Format::R8G8B8_UINT, "RGB", 8, uint)},
    {"R8G8B8_SRGB", row(Format::R8G8B8_SRGB, "RGB", 8, unorm)},
    {"B8G8R8_UNORM", preset(Format::B8G8R8_UNORM, 3,
                            {{"R", 16, 8, unorm}, {"G", 8, 8, unorm}, {"B", 0, 8, unorm}})},
    {"B8G8R8_SRGB",
     preset(Format::B8G8R8_SRGB, 3, {{"R", 16, 8, unorm}, {"G", 8, 8, unorm}, {"B", 0, 8, unorm}})},
    {"R8G8B8A8_UNORM", row(Format::R8G8B8A8_UNORM, "RGBA", 8, unorm)},
    {"R8G8B8A8_SNORM", row(Format::R8G8B8A8_SNORM, "RGBA", 8, snorm)},
    {"R8G8B8A8_UINT", row(Format::R8G8B8A8_UINT, "RGBA", 8, uint)},
    {"R8G8B8A8_SRGB", row(Format::R8G8B8A8_SRGB, "RGBA", 8, unorm)},
    {"B8G8R8A8_UNORM",
     preset(Format::B8G8R8A8_UNORM, 4,
            {{"R", 16, 8, unorm}, {"G", 8, 8, unorm}, {"B", 0, 8, unorm}, {"A", 24, 8, unorm}})},
    {"B8G8R8A8_SRGB",
     preset(Format::B8G8R8A8_SRGB, 4,
            {{"R", 16, 8, unorm}, {"G", 8, 8, unorm}, {"B", 0, 8, unorm}, {"A", 24, 8, unorm}})},
    {"A8B8G8R8_UNORM_PACK32", row(Format::A8B8G8R8_UNORM_PACK32, "RGBA", 8, unorm)},
    {"A8B8G8R8_SRGB_PACK32", row(Format::A8B8G8R8_SRGB_PACK32, "RGBA", 8, unorm)},
    {"A2R10G10B10_UNORM_PACK32",
     preset(
         Format::A2R10G10B10_UNORM_PACK32, 4,
         {{"R", 20, 10, unorm}, {"G", 10, 10, unorm}, {"B", 0, 10, unorm}, {"A", 30, 2, unorm}})},
    {"A2B10G10R10_UNORM_PACK32",
     preset(
         Format::A2B10G10R10_UNORM_PACK32, 4,
         {{"R", 0, 10, unorm}, {"G", 10, 10, unorm}, {"B", 20, 10, unorm}, {"A", 30, 2, unorm}})},
    {"R16_UNORM", row(Format::R16_UNORM, "R", 16, unorm)},
    {"R16_SNORM", row(Format::R16_SNORM, "R", 16, snorm)},
    {"R16_UINT", row(Format::R16_UINT, "R", 16, uint)},
    {"R16_SFLOAT", row(Format::R16_SFLOAT, "R", 16, sfloat)},
    {"R16G16_UNORM", row(Format::R16G16_UNORM, "RG", 16, unorm)},
    {"R16G16_SNORM", row(Format::R16G16_SNORM, "RG", 16, snorm)},
    {"R16G16_UINT", row(Format::R16G16_UINT, "RG", 16, uint)},
    {"R16G16_SFLOAT", row(Format::R16G16_SFLOAT, "RG", 16, sfloat)},
    {"R16G16B16_UNORM", row(Format::R16G16B16_UNORM, "RGB", 16, unorm)},
    {"R16G16B16_SNORM", row(Format::R16G16B16_SNORM, "RGB", 16, snorm)},
    {"R16G16B16_UINT", row(Format::R16G16B16_UINT, "RGB", 16, uint)},
    {"R16G16B16_SFLOAT", row(Format::R16G16B16_SFLOAT, "RGB", 16, sfloat)},
    {"R16G16B16A16_UNORM", row(Format::R16G16B16A16_UNORM, "RGBA", 16, unorm)},
    {"R16G16B16A16_SNORM", row(Format::R16G16B16A16_SNORM, "RGBA", 16, snorm)},
    {"R16G16B16A16_UINT", row(Format::R16G16B16A16_UINT, "RGBA", 16, uint)},
    {"R16G16B16A16_SFLOAT", row(Format::R16G16B16A16_SFLOAT, "RGBA", 16, sfloat)},
    {"R32_UINT", row(Format::R32_UINT, "R", 32, uint)},
    {"R32_SFLOAT", row(Format::R32_SFLOAT, "R", 32, sfloat)},
    {"R32G32_UINT", row(Format::R32G32_UINT, "RG", 32, uint)},
    {"R32G32_SFLOAT", row(Format::R32G32_SFLOAT, "RG", 32, sfloat)},
    {"R32G32B32_UINT", row(Format::R32G32B32_UINT, "RGB", 32, uint)},
    {"R32G32B32_SFLOAT", row(Format::R32G32B32_SFLOAT, "RGB", 32, sfloat)},
    {"R32G32B32A32_UINT", row(Format::R32G32B32A32_UINT, "RGBA", 32, uint)},
    {"R32G32B32A32_SFLOAT", row(Format::R32G32B32A32_SFLOAT, "RGBA", 32, sfloat)},
    {"B10G11R11_UFLOAT_PACK32",
     preset(Format::B10G11R11_UFLOAT_PACK32, 4,
            {{"R", 0, 11, ufloat}, {"G", 11, 11, ufloat}, {"B", 22, 10, ufloat}})},
    {"E5B9G9R9_UFLOAT_PACK32",
     preset(
         Format::E5B9G9R9_UFLOAT_PACK32, 4,
         {{"R", 0, 9, ufloat}, {"G", 9, 9, ufloat}, {"B", 18, 9, ufloat}, {"E", 27, 5, exponent}})},
    {"BC1_RGB_UNORM_BLOCK", row(Format::BC1_RGB_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"BC1_RGB_SRGB_BLOCK", row(Format::BC1_RGB_SRGB_BLOCK, "01", 32, opaque), 4, 4},
    {"BC1_RGBA_UNORM_BLOCK", row(Format::BC1_RGBA_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"BC1_RGBA_SRGB_BLOCK", row(Format::BC1_RGBA_SRGB_BLOCK, "01", 32, opaque), 4, 4},
    {"BC2_UNORM_BLOCK", row(Format::BC2_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC2_SRGB_BLOCK", row(Format::BC2_SRGB_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC3_UNORM_BLOCK", row(Format::BC3_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC3_SRGB_BLOCK", row(Format::BC3_SRGB_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC4_UNORM_BLOCK", row(Format::BC4_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"BC4_SNORM_BLOCK", row(Format::BC4_SNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"BC5_UNORM_BLOCK", row(Format::BC5_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC5_SNORM_BLOCK", row(Format::BC5_SNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC6H_UFLOAT_BLOCK", row(Format::BC6H_UFLOAT_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC6H_SFLOAT_BLOCK", row(Format::BC6H_SFLOAT_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC7_UNORM_BLOCK", row(Format::BC7_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"BC7_SRGB_BLOCK", row(Format::BC7_SRGB_BLOCK, "0123", 32, opaque), 4, 4},
    {"ETC2_R8G8B8_UNORM_BLOCK", row(Format::ETC2_R8G8B8_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"ETC2_R8G8B8_SRGB_BLOCK", row(Format::ETC2_R8G8B8_SRGB_BLOCK, "01", 32, opaque), 4, 4},
    {"ETC2_R8G8B8A1_UNORM_BLOCK", row(Format::ETC2_R8G8B8A1_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"ETC2_R8G8B8A1_SRGB_BLOCK", row(Format::ETC2_R8G8B8A1_SRGB_BLOCK, "01", 32, opaque), 4, 4},
    {"ETC2_R8G8B8A8_UNORM_BLOCK", row(Format::ETC2_R8G8B8A8_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"ETC2_R8G8B8A8_SRGB_BLOCK", row(Format::ETC2_R8G8B8A8_SRGB_BLOCK, "0123", 32, opaque), 4, 4},
    {"EAC_R11_UNORM_BLOCK", row(Format::EAC_R11_UNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"EAC_R11_SNORM_BLOCK", row(Format::EAC_R11_SNORM_BLOCK, "01", 32, opaque), 4, 4},
    {"EAC_R11G11_UNORM_BLOCK", row(Format::EAC_R11G11_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"EAC_R11G11_SNORM_BLOCK", row(Format::EAC_R11G11_SNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"ASTC_4x4_UNORM_BLOCK", row(Format::ASTC_4x4_UNORM_BLOCK, "0123", 32, opaque), 4, 4},
    {"ASTC_4x4_SRGB_BLOCK", row(Format::ASTC_4x4_SRGB_BLOCK, "0123", 32, opaque), 4, 4},
    {"ASTC_5x4_UNORM_BLOCK", row(Format::ASTC_5x4_UNORM_BLOCK, "0123", 32, opaque), 5, 4},
    {"ASTC_5x4_SRGB_BLOCK", row(Format::ASTC_5x4_SRGB_BLOCK, "0123", 32, opaque), 5, 4},
    {"ASTC_5x5_UNORM_BLOCK", row(Format::ASTC_5x5_UNORM_BLOCK, "0123", 32, opaque), 5, 5},
    {"ASTC_5x5_SRGB_BLOCK", row(Format::ASTC_5x5_SRGB_BLOCK, "0123", 32, opaque), 5, 5},
    {"ASTC_6x5_UNORM_BLOCK", row(Format::ASTC_6x5_UNORM_BLOCK, "0123", 32, opaque), 6, 5},
    {"ASTC_6x5_SRGB_BLOCK", row(Format::ASTC_6x5_SRGB_BLOCK, "0123", 32, opaque), 6, 5},
    {"ASTC_6x6_UNORM_BLOCK", row(Format::ASTC_6x6_UNORM_BLOCK, "0123", 32, opaque), 6, 6},
    {"ASTC_6x6_SRGB_BLOCK", row(Format::ASTC_6x6_SRGB_BLOCK, "0123", 32, opaque), 6, 6},
    {"ASTC_8x5_UNORM_BLOCK", row(Format::ASTC_8x5_UNORM_BLOCK, "0123", 32, opaque), 8, 5},
    {"ASTC_8x5_SRGB_BLOCK", row(Format::ASTC_8x5_SRGB_BLOCK, "0123", 32, opaque), 8, 5},
    {"ASTC_8x6_UNORM_BLOCK", row(Format::ASTC_8x6_UNORM_BLOCK, "0123", 32, opaque), 8, 6},
    {"ASTC_8x6_SRGB_BLOCK", row(Format::ASTC_8x6_SRGB_BLOCK, "0123", 32, opaque), 8, 6},
    {"ASTC_8x8_UNORM_BLOCK", row(Format::ASTC_8x8_UNORM_BLOCK, "0123", 32, opaque), 8, 8},
    {"ASTC_8x8_SRGB_BLOCK", row(Format::ASTC_8x8_SRGB_BLOCK, "0123", 32, opaque), 8, 8},
    {"ASTC_10x5_UNORM_BLOCK", row(Format::ASTC_10x5_UNORM_BLOCK, "0123", 32, opaque), 10, 5},
    {"ASTC_10x5_SRGB_BLOCK", row(Format::ASTC_10x5_SRGB_BLOCK, "0123", 32, opaque), 10, 5},
    {"ASTC_10x6_UNORM_BLOCK", row(Format::ASTC_10x6_UNORM_BLOCK, "0123", 32, opaque), 10, 6},
    {"ASTC_10x6_SRGB_BLOCK", row(Format::ASTC_10x6_SRGB_BLOCK, "0123", 32, opaque), 10, 6},
    {"ASTC_10x8_UNORM_BLOCK", row(Format::ASTC_10x8_UNORM_BLOCK, "0123", 32, opaque), 10, 8},
    {"ASTC_10x8_SRGB_BLOCK", row(Format::ASTC_10x8_SRGB_BLOCK, "0123", 32, opaque), 10, 8},
    {"ASTC_10x10_UNORM_BLOCK", row(Format::ASTC_10x10_UNORM_BLOCK, "0123", 32, opaque), 10, 10},
    {"ASTC_10x10_SRGB_BLOCK", row(Format::ASTC_10x10_SRGB_BLOCK, "0123", 32, opaque), 10, 10},
    {"ASTC_12x10_UNORM_BLOCK", row(Format::ASTC_12x10_UNORM_BLOCK, "0123", 32, opaque), 12, 10},
    {"ASTC_12x10_SRGB_BLOCK", row(Format::ASTC_12x10_SRGB_BLOCK, "0123", 32, opaque), 12, 10},
    {"ASTC_12x12_UNORM_BLOCK", row(Format::ASTC_12x12_UNORM_BLOCK, "0123", 32, opaque), 12, 12},
    {"ASTC_12x12_SRGB_BLOCK", row(Format::ASTC_12x12_SRGB_BLOCK, "0123", 32, opaque), 12, 12},
    {"ASTC_4x4_SFLOAT_BLOCK", row(Format::ASTC_4x4_SFLOAT_BLOCK, "0123", 32, opaque), 4, 4},
    {"ASTC_5x4_SFLOAT_BLOCK", row(Format::ASTC_5x4_SFLOAT_BLOCK, "0123", 32, opaque), 5, 4},
    {"ASTC_5x5_SFLOAT_BLOCK", row(Format::ASTC_5x5_SFLOAT_BLOCK, "0123", 32, opaque), 5, 5},
    {"ASTC_6x5_SFLOAT_BLOCK", row(Format::ASTC_6x5_SFLOAT_BLOCK, "0123", 32, opaque), 6, 5},
    {"ASTC_6x6_SFLOAT_BLOCK", row(Format::ASTC_6x6_SFLOAT_BLOCK, "0123", 32, opaque), 6, 6},
    {"ASTC_8x5_SFLOAT_BLOCK", row(Format::ASTC_8x5_SFLOAT_BLOCK, "0123", 32, opaque), 8, 5},
    {"ASTC_8x6_SFLOAT_BLOCK", row(Format::ASTC_8x6_SFLOAT_BLOCK, "0123", 32, opaque), 8, 6},
    {"ASTC_8x8_SFLOAT_BLOCK", row(Format::ASTC_8x8_SFLOAT_BLOCK, "0123", 32, opaque), 8, 8},
    {"ASTC_10x5_SFLOAT_BLOCK", row(Format::ASTC_10x5_SFLOAT_BLOCK, "0123", 32, opaque), 10, 5},
    {"ASTC_10x6_SFLOAT_BLOCK", row(Format::ASTC_10x6_SFLOAT_BLOCK, "0123", 32, opaque), 10, 6},
    {"ASTC_10x8_SFLOAT_BLOCK", row(Format::ASTC_10x8_SFLOAT_BLOCK, "0123", 32, opaque), 10, 8},
    {"ASTC_10x10_SFLOAT_BLOCK", row(Format::ASTC_10x10_SFLOAT_BLOCK, "0123", 32, opaque), 10, 10},
    {"ASTC_12x10_SFLOAT_BLOCK", row(Format::ASTC_12x10_SFLOAT_BLOCK, "0123", 32, opaque), 12, 10},
    {"ASTC_12x12_SFLOAT_BLOCK", row(Format::ASTC_12x12_SFLOAT_BLOCK, "0123", 32, opaque), 12, 12},
};

bool is_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), allowed);
}

bool fits(const Component& component, unsigned record_bits) {
  const unsigned first = component.offset, bits = component.bits;
  if (bits < 1 || bits > 32 || first % 32 + bits > 32 || first + bits > record_bits) return false;
  switch (component.type) {
    case ComponentType::sfloat:
      return bits == 16 || bits == 32;
    case ComponentType::ufloat:
      return bits <= 11;
    default:
      return static_cast<std::uint8_t>(component.type) < kComponentTypes;
  }
}

}  // namespace

Record::Record(Format preset) noexcept {
  if (const FormatInfo* info = find_format(preset)) *this = info->record;
}

Record colored_direction(bool floats) noexcept {
  const Record color(floats ? Format::R32G32B32_SFLOAT : Format::E5B9G9R9_UFLOAT_PACK32);
  const Record direction(floats ? Format::R32G32B32_SFLOAT : Format::R8G8B8_SNORM);
  Record both = color;
  both.format = Format::UNDEFINED;
  both.bytes = static_cast<std::uint8_t>(color.bytes + direction.bytes);
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const Component& axis = direction.components[i];
    both.components[both.count++] = {
        kNames[i], static_cast<std::uint16_t>(8 * color.bytes + axis.offset), axis.bits, axis.type};
  }
  return both;
}

bool is_valid(const Record& record) noexcept {
  if (record.format != Format::UNDEFINED) {
    const FormatInfo* info = find_format(record.format);
    return info != nullptr && info->record == record;
  }
  if (record.bytes < 1 || record.bytes > kMaxRecordBytes || record.count < 1 ||
      record.count > kMaxComponents) {
    return false;
  }
  std::array<std::uint8_t, kMaxRecordBytes * 8> taken{};
  const unsigned record_bits = record.bytes * 8U;
  unsigned sum = 0;
  for (std::size_t c = 0; c < kMaxComponents; ++c) {
    const Component& component = record.components[c];
    if (c >= record.count) {
      if (!(component == Component())) return false;
      continue;
    }
    if (!fits(component, record_bits) || !is_name(component.name())) return false;
    // No characters may follow the name's end: equal records have equal bytes.
    if (!(component ==
          Component(component.name(), component.offset, component.bits, component.type))) {
      return false;
    }
    for (std::size_t other = 0; other < c; ++other) {
      if (record.components[other].name() == component.name()) return false;
    }
    for (unsigned bit = component.offset; bit < component.offset + component.bits; ++bit) {
      if (taken[bit]++ != 0) return false;
    }
    sum += component.bits;
  }
  return sum == record_bits;
}

std::span<const FormatInfo> formats() noexcept { return kFormats; }

const FormatInfo* find_format(Format format) noexcept {
  const auto* const it =
      std::find_if(std::begin(kFormats), std::end(kFormats),
                   [format](const FormatInfo& info) { return info.record.format == format; });
  return it == std::end(kFormats) ? nullptr : it;
}

const FormatInfo* find_format(std::string_view name) noexcept {
  constexpr std::string_view prefix = "VK_FORMAT_";
  if (name.substr(0, prefix.size()) == prefix) name.remove_prefix(prefix.size());
  const auto* const it = std::find_if(std::begin(kFormats), std::end(kFormats),
                                      [name](const FormatInfo& info) { return info.name == name; });
  return it == std::end(kFormats) ? nullptr : it;
}

}  // namespace gicodec
