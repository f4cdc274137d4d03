#include "preview_picture.h"

#include "cli.h"
#include "dump/error.h"
#include "dump/image.h"
#include "record_picture.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gicodec::tools {
namespace {

constexpr double kColourGamma = 5;
constexpr double kMiddleGrey = 0.18;
/// A texel takes 16 bytes of memory while the picture is made.
constexpr std::uint64_t kMaxPreviewTexels = std::uint64_t{1} << 26;

/// Checks for an interrupt every 65,536 texels: pictures take seconds.
void check_now_and_then(std::size_t texel) {
  constexpr std::size_t kTexels = std::size_t{1} << 16;
  if (texel % kTexels == 0) check_interrupt();
}

/// The value of a component, without a shared exponent. Signed integers, e.g. of directions, map to
/// 0..1, so that negative ones are not black.
float value_of(const Component& component, std::uint32_t code) {
  const auto share = [&](std::uint32_t of) {
    return static_cast<float>(of) / static_cast<float>(max_code(component));
  };
  if (component.bits == 9) return static_cast<float>(code);
  if (component.type == ComponentType::uint) return share(code);
  if (component.type == ComponentType::snorm) return share(code ^ 1U << (component.bits - 1));
  return std::bit_cast<float>(to_sample(SampleType::float32, component, code));
}

/// Values of the first `channels` components of every texel.
std::vector<float> values_of(const Dump& dump, std::size_t channels) {
  const Record& record = dump.info.desc.record;
  const std::size_t count = dump.texels.size() / record.bytes;
  std::vector<float> values(count * channels);
  for (std::size_t i = 0; i < count; ++i) {
    check_now_and_then(i);
    const std::byte* texel = &dump.texels[i * record.bytes];
    float scale = 1;
    for (const Component& component : record.used()) {
      if (component.type != ComponentType::exponent) continue;
      const auto exponent = load_component(texel, record.bytes, component);
      scale = std::ldexp(1.0F, static_cast<int>(exponent) - 24);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      const Component& component = record.components[c];
      const auto code = load_component(texel, record.bytes, component);
      values[i * channels + c] = scale * value_of(component, code);
    }
  }
  return values;
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

double to_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// The scale that brings the logarithmic mean of all values but black to middle grey.
double automatic_scale(const std::vector<float>& values, double gamma) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    check_now_and_then(i / 3);
    const double luminance = 0.2126 * std::pow(values[i], gamma) +
                             0.7152 * std::pow(values[i + 1], gamma) +
                             0.0722 * std::pow(values[i + 2], gamma);
    if (!std::isfinite(luminance) || luminance <= 1e-9) continue;
    sum += std::log(luminance);
    ++count;
  }
  return count == 0 ? 1 : kMiddleGrey / std::exp(sum / static_cast<double>(count));
}

std::vector<std::uint8_t> colour_pixels(const Dump& dump, const PreviewTuning& tuning) {
  const std::vector<float> values = values_of(dump, 3);
  const bool codes = dump.info.desc.record.components[0].type == ComponentType::unorm;
  std::vector<std::uint8_t> pixels(values.size());
  if (codes && dump.info.desc.record.components[0].bits != 10 && !tuning.gamma &&
      !tuning.exposure) {
    // A picture already.
    for (std::size_t i = 0; i < values.size(); ++i) pixels[i] = to_byte(values[i]);
    return pixels;
  }
  const double gamma = tuning.gamma.value_or(codes ? kColourGamma : 1);
  const double scale =
      tuning.exposure ? std::exp2(*tuning.exposure) : automatic_scale(values, gamma);
  for (std::size_t i = 0; i < values.size(); ++i) {
    check_now_and_then(i);
    const double value = scale * std::pow(std::max(0.0F, values[i]), gamma);
    const double mapped = std::isfinite(value) ? value / (1 + value) : 1;
    pixels[i] = to_byte(to_srgb(mapped));
  }
  return pixels;
}

std::vector<std::uint8_t> distance_pixels(const Dump& dump, const PreviewTuning& tuning) {
  const std::vector<float> values = values_of(dump, 1);
  float farthest = 0;
  for (const float value : values) {
    if (std::isfinite(value)) farthest = std::max(farthest, value);
  }
  const double white = tuning.max_distance.value_or(farthest > 0 ? farthest : 1);
  std::vector<std::uint8_t> pixels(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    pixels[i] = std::isnan(values[i]) ? 0 : to_byte(values[i] / white);
  }
  return pixels;
}

void check_size(const std::string& path, std::uint64_t width, std::uint64_t height) {
  if (width * height > kMaxPreviewTexels) {
    fail(
        Exit::bad_input,
        "{}: {}x{} texels are too many for a picture, which has {} at most; \"gicodec crop\" makes "
        "smaller dumps",
        path, width, height, kMaxPreviewTexels);
  }
  check_png_size(path, width, height);
}

void write_records(const std::string& path, const Dump& dump, Existing existing) {
  const RecordPicture size = record_picture_size(dump.info.desc);
  check_size(path, size.width, size.height);
  const RecordPicture picture = record_picture(dump);
  write_png(path, static_cast<std::uint32_t>(picture.width),
            static_cast<std::uint32_t>(picture.height), picture.channels, picture.pixels, existing,
            check_interrupt);
}

/// Arranges a pool's blocks, one below the other in `strip`, in columns that make it about square.
RecordPicture in_columns(const RecordPicture& strip, std::uint64_t block_height) {
  const std::uint64_t blocks = strip.height / block_height;
  const double side = std::sqrt(static_cast<double>(strip.width * strip.height));
  const auto columns =
      static_cast<std::uint64_t>(std::ceil(side / static_cast<double>(strip.width)));
  const std::uint64_t rows = (blocks + columns - 1) / columns * block_height;
  RecordPicture picture;
  picture.width = columns * strip.width, picture.height = rows, picture.channels = strip.channels;
  picture.pixels.resize(picture.width * rows * picture.channels);
  const std::uint64_t bytes = strip.width * strip.channels;
  for (std::uint64_t y = 0; y < strip.height; ++y) {
    std::copy_n(&strip.pixels[y * bytes], bytes,
                &picture.pixels[(y % rows * columns + y / rows) * bytes]);
  }
  return picture;
}

}  // namespace

void write_preview(const std::string& path, const Dump& dump, const PreviewTuning& tuning,
                   Existing existing) {
  const Record& record = dump.info.desc.record;
  if (record.format == Format::UNDEFINED) return write_records(path, dump, existing);
  if (record.components[0].type == ComponentType::opaque) {
    fail(
        Exit::bad_input,
        "{}: no picture is made of compressed blocks, {}; \"gicodec decode\" gives back files that "
        "viewers of textures show",
        path, find_format(record.format)->name);
  }
  const bool colour = record.count >= 3;
  const Extent size = image_extent(dump.info.desc);
  check_size(path, size.width, size.height);
  RecordPicture picture;
  picture.width = size.width, picture.height = size.height, picture.channels = colour ? 3 : 1;
  picture.pixels = colour ? colour_pixels(dump, tuning) : distance_pixels(dump, tuning);
  check_interrupt();
  const TextureDesc& desc = dump.info.desc;
  if (desc.grid.x > 1 && desc.grid.x == block_count(desc) && size.width == desc.block.x)
    picture = in_columns(picture, desc.block.y);
  write_png(path, static_cast<std::uint32_t>(picture.width),
            static_cast<std::uint32_t>(picture.height), picture.channels, picture.pixels, existing,
            check_interrupt);
}

}  // namespace gicodec::tools
