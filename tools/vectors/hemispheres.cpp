#include "hemispheres.h"

#include "ddgi/texels.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace gicodec::vectors {
namespace {

constexpr float kMinLight = 1e-30F;
constexpr float kLargest = 1e30F;  // of what is loaded, so that sums stay finite

std::byte snorm(float value) {
  const float code = std::floor(std::clamp(value, -1.0F, 1.0F) * 127.0F + 0.5F);
  return static_cast<std::byte>(static_cast<std::int8_t>(code));
}
float from_snorm(std::byte code) {
  return static_cast<float>(std::max<int>(static_cast<std::int8_t>(code), -127)) / 127.0F;
}

Vec3 sound(Vec3 v, float least, float most) {
  const auto one = [least, most](float x) {
    return std::isfinite(x) ? std::clamp(x, least, most) : 0.0F;
  };
  return {one(v.x), one(v.y), one(v.z)};
}

}  // namespace

DirectedColor compress(const Vectors& vectors, std::size_t hemisphere) {
  const Vec3 axis = axis_of(hemisphere);
  // Squares of very small or large light would be none, or not finite.
  const Vec3 sum = vectors.red + vectors.green + vectors.blue;
  const float largest = std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)});
  if (!(largest > kMinLight)) return {axis, {}};
  const Vec3 direction = normalize(sum / largest);
  const float along = dot(direction, axis);
  if (!(along > 0)) return {axis, {}};
  return {direction, max(vectors.along(axis) / along, {})};
}

void VectorCode::store(std::byte* record, const DirectedColor& value) const {
  if (floats_) {
    std::memcpy(record, &value.color, sizeof value.color);
    std::memcpy(record + sizeof value.color, &value.direction, sizeof value.direction);
    return;
  }
  const std::uint32_t color = ddgi::to_shared_exponent(value.color);
  std::memcpy(record, &color, sizeof color);
  record[4] = snorm(value.direction.x);
  record[5] = snorm(value.direction.y);
  record[6] = snorm(value.direction.z);
}

DirectedColor VectorCode::load(const std::byte* record) const {
  if (floats_) {
    DirectedColor value;
    std::memcpy(&value.color, record, sizeof value.color);
    std::memcpy(&value.direction, record + sizeof value.color, sizeof value.direction);
    return {sound(value.direction, -1, 1), sound(value.color, 0, kLargest)};
  }
  std::uint32_t color = 0;
  std::memcpy(&color, record, sizeof color);
  return {{from_snorm(record[4]), from_snorm(record[5]), from_snorm(record[6])},
          ddgi::from_shared_exponent(color)};
}

}  // namespace gicodec::vectors
