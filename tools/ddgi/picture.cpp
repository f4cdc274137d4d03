#include "picture.h"

#include "dump/error.h"
#include "dump/file.h"
#include "dump/image.h"

#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <bit>
#include <limits>

namespace gicodec::ddgi {
namespace {

/// Narkowicz's fit of the ACES curve.
float film(float x) {
  return saturate(x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F));
}

std::array<std::uint8_t, 3> displayed(Vec3 c, float exposure) {
  const Vec3 e = c * exposure;
  return {linear_to_srgb(film(e.x)), linear_to_srgb(film(e.y)), linear_to_srgb(film(e.z))};
}

bool same_bits(Vec3 a, Vec3 b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return bits(a.x) == bits(b.x) && bits(a.y) == bits(b.y) && bits(a.z) == bits(b.z);
}

void write_exr(const std::string& path, const Picture& picture, tools::Existing existing) {
  std::vector<Imf::Rgba> rgba;
  rgba.reserve(picture.pixels.size());
  for (const Vec3 c : picture.pixels) rgba.emplace_back(c.x, c.y, c.z, 1.0F);
  const auto w = static_cast<int>(picture.width), h = static_cast<int>(picture.height);
  Imf::StdOSStream stream;
  try {
    Imf::RgbaOutputFile file(stream, Imf::Header(w, h), Imf::WRITE_RGB);
    file.setFrameBuffer(rgba.data(), 1, picture.width);
    file.writePixels(h);
  } catch (const std::exception& error) {
    tools::fail(tools::Exit::internal, "{}: {}", path, error.what());
  }
  const std::string bytes = stream.str();
  tools::write_file(path, std::as_bytes(std::span(bytes)), existing);
}

}  // namespace

void check_picture_name(const std::string& path) {
  if (!path.ends_with(".png") && !path.ends_with(".exr")) {
    tools::fail(tools::Exit::usage, "{}: pictures are written as .png or .exr; name the file so",
                path);
  }
}

void write_picture(const std::string& path, const Picture& picture, float exposure,
                   tools::Existing existing) {
  check_picture_name(path);
  if (path.ends_with(".exr")) return write_exr(path, picture, existing);
  std::vector<std::uint8_t> rgb;
  rgb.reserve(picture.pixels.size() * 3);
  for (const Vec3 c : picture.pixels) {
    const auto p = displayed(c, exposure);
    rgb.insert(rgb.end(), p.begin(), p.end());
  }
  tools::write_png(path, picture.width, picture.height, 3, rgb, existing);
}

PictureDifference compare(const Picture& a, const Picture& b, float exposure) {
  PictureDifference result;
  double squared = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3 p = a.pixels[i], q = b.pixels[i];
    if (same_bits(p, q)) continue;
    ++result.differing;
    const Vec3 d = max(p - q, q - p);
    result.largest = std::max({result.largest, d.x, d.y, d.z});
    const auto s = displayed(p, exposure), t = displayed(q, exposure);
    for (std::size_t c = 0; c < 3; ++c) squared += (s[c] - t[c]) * (s[c] - t[c]);
  }
  const double mean = squared / (3.0 * static_cast<double>(a.pixels.size()));
  result.psnr =
      mean > 0 ? 10 * std::log10(255.0 * 255.0 / mean) : std::numeric_limits<double>::infinity();
  return result;
}

Picture difference(const Picture& a, const Picture& b, float gain) {
  Picture out = a;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    out.pixels[i] = max(a.pixels[i] - b.pixels[i], b.pixels[i] - a.pixels[i]) * gain;
  }
  return out;
}

}  // namespace gicodec::ddgi
