// Data format descriptors (Khronos, "Data Format Specification", basic data format descriptor).
#include "dump/ktx2_format.h"

#include "dump/sample.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace gicodec::tools {
namespace {

constexpr std::uint32_t kRgb = 1;  ///< a colour model
constexpr std::uint32_t kBt709 = 1, kLinear = 1, kSrgb = 2;
constexpr std::uint32_t kIsLinear = 0x10, kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;
constexpr std::uint32_t kAlpha = 15;
constexpr std::uint32_t kOne = 0x3F800000, kMinusOne = 0xBF800000;

struct Sample {
  std::uint32_t offset, bits, channel;
  std::uint32_t lower, upper;
};

/// Number of a channel in the colour model RGBSDA.
std::uint32_t channel_of(char component) {
  return component == 'A' ? kAlpha
                          : static_cast<std::uint32_t>(std::string_view("RGB").find(component));
}

Sample sample_of(const Component& component) {
  const std::uint32_t channel = channel_of(letter(component)), most = max_code(component);
  const Sample plain{component.offset, component.bits, channel, 0, most};
  switch (component.type) {
    case ComponentType::unorm:
      return plain;
    case ComponentType::snorm:
      return {plain.offset, plain.bits, channel | kSigned, ~(most >> 1) + 1, most >> 1};
    case ComponentType::uint:
      return {plain.offset, plain.bits, channel, 0, 1};
    case ComponentType::ufloat:
      return {plain.offset, plain.bits, channel | kFloat, 0, kOne};
    case ComponentType::sfloat:
      return {plain.offset, plain.bits, channel | kFloat | kSigned, kMinusOne, kOne};
    case ComponentType::exponent:
    case ComponentType::opaque:
      return plain;
  }
  return plain;
}

/// Samples of E5B9G9R9: for each channel a mantissa and again the exponent.
std::vector<Sample> shared_exponent_samples(const Record& record) {
  constexpr std::uint32_t kLargest = 8448, kBias = 15, kMaxExponent = 31;
  std::vector<Sample> samples;
  const Component& exponent = record.components[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const Component& mantissa = record.components[i];
    const std::uint32_t channel = channel_of(letter(mantissa));
    samples.push_back({mantissa.offset, mantissa.bits, channel, 0, kLargest});
    samples.push_back({exponent.offset, exponent.bits, channel | kExponent, kBias, kMaxExponent});
  }
  return samples;
}

/// What a family of compressed formats is made of: halves of a block, or all of it, with a channel
/// each.
struct Family {
  std::string_view prefix;
  std::uint32_t model;
  std::array<std::int8_t, 2> channels;  ///< -1: there is no second one
  bool side_by_side = true;             ///< false: both are in all bits
};
constexpr std::array<Family, 14> kFamilies{{{"BC1_RGB_", 128, {0, -1}},
                                            {"BC1_RGBA_", 128, {1, -1}},
                                            {"BC2_", 129, {15, 0}},
                                            {"BC3_", 130, {15, 0}},
                                            {"BC4_", 131, {0, -1}},
                                            {"BC5_", 132, {0, 1}},
                                            {"BC6H_", 133, {0, -1}},
                                            {"BC7_", 134, {0, -1}},
                                            {"ETC2_R8G8B8_", 161, {2, -1}},
                                            {"ETC2_R8G8B8A1_", 161, {2, 15}, false},
                                            {"ETC2_R8G8B8A8_", 161, {15, 2}},
                                            {"EAC_R11_", 161, {0, -1}},
                                            {"EAC_R11G11_", 161, {0, 1}},
                                            {"ASTC_", 162, {0, -1}}}};

bool has(Format format, std::string_view word) {
  return find_format(format)->name.find(word) != std::string_view::npos;
}

const Family& family_of(Format format) {
  return *std::ranges::find_if(kFamilies, [&](const Family& family) {
    return find_format(format)->name.starts_with(family.prefix);
  });
}

std::vector<Sample> compressed_samples(const Record& record) {
  const Family& family = family_of(record.format);
  const bool two = family.channels[1] >= 0, half = two && family.side_by_side;
  const std::uint32_t bits = 8U * record.bytes / (half ? 2 : 1);
  std::vector<Sample> samples;
  for (std::uint32_t i = 0; i < (two ? 2U : 1U); ++i) {
    const std::uint32_t channel = static_cast<unsigned char>(family.channels[i]);
    const std::uint32_t linear = channel == kAlpha && has(record.format, "SRGB") ? kIsLinear : 0;
    Sample sample{half ? i * bits : 0, bits, channel | linear, 0, UINT32_MAX};
    if (has(record.format, "SNORM")) {
      sample = {sample.offset, bits, channel | kSigned, 0x80000000, INT32_MAX};
    } else if (has(record.format, "UFLOAT")) {
      sample = {sample.offset, bits, channel | kFloat, 0, kOne};
    } else if (has(record.format, "SFLOAT")) {
      sample = {sample.offset, bits, channel | kFloat | kSigned, kMinusOne, kOne};
    }
    samples.push_back(sample);
  }
  return samples;
}

std::vector<Sample> samples_of(const Record& record) {
  if (record.format == Format::E5B9G9R9_UFLOAT_PACK32) return shared_exponent_samples(record);
  if (is_compressed(record.format)) return compressed_samples(record);
  std::vector<Sample> samples;
  for (const Component& component : record.used()) {
    Sample sample = sample_of(component);
    if (letter(component) == 'A' && has(record.format, "SRGB")) sample.channel |= kIsLinear;
    samples.push_back(sample);
  }
  // By first bit, which differs from component order in B8G8R8A8.
  std::ranges::sort(samples, {}, &Sample::offset);
  return samples;
}

}  // namespace

std::uint32_t ktx2_type_size(const Record& record) noexcept {
  if (is_compressed(record.format)) return 1;
  return has(record.format, "PACK32") ? 4 : record.bytes / record.count;
}

std::vector<std::byte> ktx2_descriptor(const Record& record) {
  constexpr std::size_t kStart = 28, kSampleBytes = 16;
  const auto samples = samples_of(record);
  const std::uint32_t model = is_compressed(record.format) ? family_of(record.format).model : kRgb;
  const std::uint32_t transfer = has(record.format, "SRGB") ? kSrgb : kLinear;
  const FormatInfo& format = *find_format(record.format);
  const std::size_t size = kStart + kSampleBytes * samples.size();
  std::vector<std::byte> bytes(size);
  const auto set = [&](std::size_t at, std::uint32_t value) { set_word(bytes, at, value); };
  set(0, static_cast<std::uint32_t>(size));
  set(8, 2 | static_cast<std::uint32_t>(size - 4) << 16);  // version, size of the block
  set(12, model | kBt709 << 8 | transfer << 16);
  set(16, (format.width - 1U) | (format.height - 1U) << 8);  // texels of a block, less 1
  set(20, record.bytes);
  std::size_t at = kStart;
  for (const Sample& sample : samples) {
    set(at, sample.offset | (sample.bits - 1) << 16 | sample.channel << 24);
    set(at + 8, sample.lower);
    set(at + 12, sample.upper);
    at += kSampleBytes;
  }
  return bytes;
}

}  // namespace gicodec::tools
