// Data format descriptors (Khronos, "Data Format Specification", basic data format descriptor).
#include "dump/ktx2_format.h"

#include "dump/sample.h"
#include "dump/texture_file.h"

#include <string_view>

namespace gicodec::tools {
namespace {

constexpr std::uint32_t kRgb = 1, kBc6h = 133, kBc7 = 134;  // colour models
constexpr std::uint32_t kBt709 = 1, kLinear = 1, kSrgb = 2;
constexpr std::uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;
constexpr std::uint32_t kOne = 0x3F800000, kMinusOne = 0xBF800000;

struct Sample {
  std::uint32_t offset, bits, channel;
  std::uint32_t lower, upper;
};

/// Number of a channel in the colour model RGBSDA.
std::uint32_t channel_of(char component) {
  return component == 'A' ? 15
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

std::vector<Sample> samples_of(const Record& record) {
  const std::uint32_t bits = 8U * record.bytes;
  switch (record.format) {
    case Format::E5B9G9R9_UFLOAT_PACK32:
      return shared_exponent_samples(record);
    case Format::BC6H_UFLOAT_BLOCK:
      return {{0, bits, kFloat, 0, kOne}};
    case Format::BC6H_SFLOAT_BLOCK:
      return {{0, bits, kFloat | kSigned, kMinusOne, kOne}};
    case Format::BC7_UNORM_BLOCK:
    case Format::BC7_SRGB_BLOCK:
      return {{0, bits, 0, 0, UINT32_MAX}};
    default:
      break;
  }
  std::vector<Sample> samples;
  for (const Component& component : record.used()) samples.push_back(sample_of(component));
  // By first bit, which differs from component order in B8G8R8A8.
  std::ranges::sort(samples, {}, &Sample::offset);
  return samples;
}

bool is_packed(Format format) { return find_format(format)->name.ends_with("PACK32"); }

}  // namespace

std::uint32_t ktx2_type_size(const Record& record) noexcept {
  if (texels_of_record(record.format) > 1) return 1;
  return is_packed(record.format) ? 4 : record.bytes / record.count;
}

std::vector<std::byte> ktx2_descriptor(const Record& record) {
  constexpr std::size_t kStart = 28, kSampleBytes = 16;
  const auto samples = samples_of(record);
  const bool blocks = texels_of_record(record.format) > 1;
  const bool bc6h =
      record.format == Format::BC6H_UFLOAT_BLOCK || record.format == Format::BC6H_SFLOAT_BLOCK;
  const std::uint32_t model = !blocks ? kRgb : bc6h ? kBc6h : kBc7;
  const std::uint32_t transfer = record.format == Format::BC7_SRGB_BLOCK ? kSrgb : kLinear;
  const std::size_t size = kStart + kSampleBytes * samples.size();
  std::vector<std::byte> bytes(size);
  const auto set = [&](std::size_t at, std::uint32_t value) { set_word(bytes, at, value); };
  set(0, static_cast<std::uint32_t>(size));
  set(8, 2 | static_cast<std::uint32_t>(size - 4) << 16);  // version, size of the block
  set(12, model | kBt709 << 8 | transfer << 16);
  set(16, blocks ? 0x0303 : 0);  // texels of a block along x and y, less 1
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
