#include "native/vector_content.h"

#include "quantise/component_code.h"

#include <gicodec/irradiance_vectors.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace gicodec::test {

double number(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) / 9007199254740992.0;
}

namespace {

using Vector = std::array<double, 3>;
constexpr std::size_t kHemispheres = 6;

struct Ray {
  Vector direction, light;
};

Vector any_direction(Random& random) {
  const double z = number(random, -1, 1), turn = number(random, 0, 6.2831853);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}
std::uint32_t bits_of(double value) { return std::bit_cast<std::uint32_t>(float(value)); }

void put(std::byte* record, const Record& of, unsigned component, std::uint32_t code) {
  set_code(record, of.components[component], of.bytes, code);
}

void put_light(std::byte* record, const Record& of, const Vector& color, const Vector& direction) {
  if (of.count == kHemispheres) {  // floats
    for (unsigned i = 0; i < 3; ++i) {
      put(record, of, i, bits_of(color[i]));
      put(record, of, 3 + i, bits_of(direction[i]));
    }
    return;
  }
  int exponent = 0;
  const auto code = [&](double v) { return std::floor(std::ldexp(v, 24 - exponent) + 0.5); };
  while (exponent < 31 && code(std::ranges::max(color)) > 511) ++exponent;
  for (unsigned i = 0; i < 3; ++i) {
    put(record, of, i, static_cast<std::uint32_t>(std::min(code(color[i]), 511.0)));
    const auto turned = static_cast<int>(std::floor(127 * direction[i] + 0.5));
    put(record, of, 4 + i, static_cast<std::uint32_t>(turned) & 255);
  }
  put(record, of, 3, static_cast<std::uint32_t>(exponent));
}

/// Six hemispheres of the same light.
void put_vertex(std::byte* block, const Record& of, std::span<const Ray> rays) {
  for (unsigned h = 0; h < kHemispheres; ++h) {
    Vector sum{}, color{};
    for (const Ray& ray : rays) {
      const double along = ray.direction[h / 2] * (h % 2 == 0 ? 1 : -1);
      if (along <= 0) continue;
      const double all = ray.light[0] + ray.light[1] + ray.light[2];
      for (unsigned i = 0; i < 3; ++i) {
        sum[i] += all * ray.direction[i];
        color[i] += along * ray.light[i];
      }
    }
    const double length = std::hypot(sum[0], sum[1], sum[2]);
    const double all = color[0] + color[1] + color[2];
    if (all > 0) {
      for (double& c : color) c *= length / all;
    }
    Vector direction{};
    direction[h / 2] = h % 2 == 0 ? 1 : -1;
    if (length > 0) direction = {sum[0] / length, sum[1] / length, sum[2] / length};
    put_light(block + std::size_t{h} * of.bytes, of, color, direction);
  }
}

/// Walls are where two sines say so.
bool is_wall(const Grid& at, std::uint64_t seed, unsigned frame) {
  return std::sin(1.3 * at.x + 0.4 * at.y + double(seed % 17)) +
             std::sin(0.9 * at.z + 0.1 * frame) >
         1.1;
}

void put_lamps(std::byte* block, const Record& of, const Grid& at, unsigned frame,
               std::uint64_t seed) {
  if (is_wall(at, seed, frame)) return;
  Random random(seed);
  std::vector<Ray> rays;
  const double dark = std::exp2(number(random, -12, 8));
  for (int lamp = 0; lamp < 5; ++lamp) {
    Vector to{number(random, -2, 9) - at.x + 0.2 * frame, number(random, -2, 9) - at.y,
              number(random, -2, 9) - at.z};
    const double length = std::hypot(to[0], to[1], to[2]) + 0.01;
    Ray ray{{to[0] / length, to[1] / length, to[2] / length}, {}};
    for (double& c : ray.light) c = dark * number(random, 0.1, 1) / (1 + length * length);
    rays.push_back(ray);
  }
  for (unsigned side = 0; side < kHemispheres; ++side) {
    Ray ray{{}, {0.02 * dark, 0.03 * dark, 0.05 * dark}};
    ray.direction[side / 2] = side % 2 == 0 ? 1 : -1;
    rays.push_back(ray);
  }
  put_vertex(block, of, rays);
}

std::uint32_t edge(Random& random, const Component& component, bool dull) {
  constexpr std::array kFloats{0U,          0x80000000U, 1U,          0x807FFFFFU, 0x00800000U,
                               0x3F800000U, 0xBF800000U, 0x3F7FFFFFU, 0x7F7FFFFFU, 0xFF7FFFFFU,
                               0x7F800000U, 0xFF800000U, 0x7FC00000U, 0xFFFFFFFFU, 0x7F800001U,
                               0x4B000000U, 0x33800000U};
  if (component.bits == 32) return kFloats[random() % kFloats.size()];
  const std::uint32_t most = (1U << component.bits) - 1;
  if (component.type == ComponentType::exponent) return pick(random, 0, most);
  if (component.type == ComponentType::ufloat && dull) return 0;
  const std::array codes{0U, 1U, most / 2, most / 2 + 1, most, pick(random, 0, most)};
  return codes[random() % codes.size()];
}

}  // namespace

TextureDesc vertices(Grid grid, bool floats) {
  return irradiance_vector_volume(grid, floats)->groups[0].textures[0].desc;
}

Bytes make_vertices(const TextureDesc& desc, VertexContent content, unsigned frame,
                    std::uint64_t seed) {
  const Record& record = desc.record;
  const std::size_t size = block_bytes(desc);
  Bytes out(block_count(desc) * size);
  for (std::uint32_t b = 0; b < block_count(desc); ++b) {
    const Grid at = {b % desc.grid.x, b / desc.grid.x % desc.grid.y, b / desc.grid.x / desc.grid.y};
    Random random(seed * 1000003 + frame * 977 + b);
    std::byte* const block = out.data() + b * size;
    switch (content) {
      case VertexContent::smooth:
        put_lamps(block, record, at, frame, seed);
        break;
      case VertexContent::integrated: {
        if (chance(random, 12)) break;
        std::vector<Ray> rays(pick(random, 1, 24));
        for (Ray& ray : rays) {
          ray.direction = any_direction(random);
          for (double& c : ray.light) c = std::exp2(number(random, -9, 3));
        }
        put_vertex(block, record, rays);
        break;
      }
      case VertexContent::edges:
        if (chance(random, 5)) break;
        for (std::size_t h = 0; h < kHemispheres; ++h) {
          if (chance(random, 5)) continue;
          const bool dull = chance(random, 3);
          for (unsigned c = 0; c < record.count; ++c) {
            put(block + h * record.bytes, record, c, edge(random, record.components[c], dull));
          }
        }
        break;
      case VertexContent::bits:
        std::generate_n(block, size, [&] { return static_cast<std::byte>(random()); });
        break;
    }
  }
  return out;
}

UpdateCase make_vertex_update(const TextureDesc& desc, VertexContent content, UpdateMode mode,
                              std::uint32_t one_in, std::uint64_t seed) {
  const bool keyframe = mode != UpdateMode::update, intra = mode == UpdateMode::intra;
  UpdateCase u{desc, {}, {}, {}, {}, keyframe, {}, intra};
  const std::size_t size = block_bytes(desc);
  Bytes now = make_vertices(desc, content, 1, seed);
  Random random(seed);
  if (mode != UpdateMode::keyframe) {
    u.mirror = make_vertices(desc, content, 0, seed);
    forget_some(u, random);
  }
  for (std::uint32_t b = 0; b < block_count(desc); ++b) {
    if (!chance(random, one_in)) continue;
    u.blocks.push_back(b);
    const auto block = std::span(now).subspan(b * size, size);
    for (std::size_t h = 0; h < kHemispheres && mode == UpdateMode::update && b % 2 == 0; ++h) {
      const std::size_t record = desc.record.bytes;
      if (chance(random, 2))
        std::copy_n(&u.mirror[b * size + h * record], record, &block[h * record]);
    }
    u.records.insert(u.records.end(), block.begin(), block.end());
    if (!intra) continue;
    std::generate_n(u.mirror.begin() + static_cast<std::ptrdiff_t>(b * size), size,
                    [&] { return static_cast<std::byte>(random()); });
  }
  return u;
}

}  // namespace gicodec::test
