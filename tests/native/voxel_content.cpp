#include "native/voxel_content.h"

#include "quantise/component_code.h"
#include "texture/presence.h"

#include <gicodec/voxels.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

namespace gicodec::test {
namespace {

using Vector = std::array<double, 3>;
using Place = std::array<std::uint32_t, 3>;

struct Face {
  Vector color{};
  double cover = 0;
};
using Faces = std::array<Face, kVoxelDirections>;
using Level = std::map<Place, Faces>;  ///< of voxels

/// A wavy floor, seen from above and from one side; in part of it the light stays as it is.
Level surface(std::uint32_t side, unsigned frame, std::uint64_t seed) {
  Random random(seed);
  const double tint = number(random, 0.2, 1), bright = std::exp2(number(random, -14, 8));
  const double phase = number(random, 0, 6), moved = frame * number(random, 0, 0.4);
  Level level;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const std::uint32_t x = i % side, z = i / side;
    const double wave = 0.5 + 0.4 * std::sin(phase + 0.3 * x + moved * 0.3) * std::cos(0.21 * z);
    Faces faces;
    const bool shadow = std::sin(0.7 * x + phase) > 0.8;
    for (std::size_t h = 0; h < kVoxelDirections; ++h) {
      if (h == 3 || (h == 1 && x % 3 == 0)) continue;  // from below, and now and then from −x
      const double to = x < side / 2 ? 1 : 1 + 0.3 * frame;
      const double light =
          shadow ? 0
                 : bright * to / (1 + 0.02 * (x + 3.0 * double(h)) * z) * number(random, 0.9, 1.1);
      faces[h] = {{light, light * tint, light * tint * tint}, wave};
    }
    level[{x, static_cast<std::uint32_t>(wave * side), z}] = faces;
  }
  return level;
}

/// Of a direction the mean of those that are not zero.
Level coarser(const Level& level) {
  std::map<Place, std::vector<const Faces*>> under;
  for (const auto& [at, faces] : level) under[{at[0] / 2, at[1] / 2, at[2] / 2}].push_back(&faces);
  Level out;
  for (const auto& [at, all] : under) {
    Faces& mean = out[at];
    for (std::size_t h = 0; h < kVoxelDirections; ++h) {
      double lit = 0;
      for (const Faces* const faces : all) {
        const Face& face = (*faces)[h];
        mean[h].cover += face.cover / 8;
        if (face.color == Vector{}) continue;
        ++lit;
        for (unsigned i = 0; i < 3; ++i) mean[h].color[i] += face.color[i];
      }
      for (double& c : mean[h].color) c /= std::max(lit, 1.0);
    }
  }
  return out;
}

std::uint32_t half_of(double value) {
  if (!(value > 0)) return 0;
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(std::min(value, 65000.0)));
  return bits < 113U << 23 ? static_cast<std::uint32_t>(std::ldexp(value, 24))
                           : (bits >> 13) - (112U << 10);
}

void put(std::byte* record, const Record& of, const Face& face) {
  const auto set = [&](unsigned component, std::uint32_t code) {
    set_code(record, of.components[component], of.bytes, code);
  };
  if (of.format == Format::R16G16B16A16_SFLOAT) {
    for (unsigned i = 0; i < 3; ++i) set(i, half_of(face.color[i]));
    set(3, half_of(face.cover));
    return;
  }
  int exponent = 0;
  const auto code = [&](double v) { return std::floor(std::ldexp(v, 24 - exponent) + 0.5); };
  if (face.color == Vector{}) return;
  while (exponent < 31 && code(std::ranges::max(face.color)) > 511) ++exponent;
  for (unsigned i = 0; i < 3; ++i) {
    set(i, static_cast<std::uint32_t>(std::min(code(face.color[i]), 511.0)));
  }
  set(3, static_cast<std::uint32_t>(exponent));
}

/// A record of any bits, or one of the rarer kinds.
void put_noise(std::byte* record, const Record& of, Random& random) {
  if (chance(random, 4)) return;
  const bool dark = chance(random, 4), shy = chance(random, 2);
  for (unsigned c = 0; c < of.count; ++c) {
    const Component& component = of.components[c];
    if (dark && c < 3) continue;
    const std::uint32_t most = (1U << component.bits) - 1;
    const std::array codes{0U,
                           1U,
                           most,
                           most / 2,
                           most / 2 + 1,
                           0x7C00U & most,
                           0x7E00U & most,
                           0xFC01U & most,
                           pick(random, 0, most)};
    set_code(record, component, of.bytes,
             shy ? pick(random, 0, most) : codes[random() % codes.size()]);
  }
}

/// Any place, mostly near the others.
void put_noise_place(std::span<std::byte> said, Random& random) {
  BrickPlace place{static_cast<std::uint8_t>(random() % 3), {}};
  for (std::uint32_t& at : place.at) at = pick(random, 0, 2);
  if (chance(random, 4)) {
    for (std::uint32_t& at : place.at) at = chance(random, 2) ? kMaxBrickSide - 1 : at;
  }
  pack_brick_place(place, said.first<kBrickPlaceBytes>());
  if (chance(random, 6)) said[7] = std::byte((pick(random, 0, 3) + 254) & 255);
  if (chance(random, 6)) said[6] |= std::byte(random() & 0xC0);
  if (chance(random, 20)) std::generate_n(said.begin(), 8, [&] { return std::byte(random()); });
}

void put_mask(std::span<std::byte> mask, Random& random) {
  const std::uint32_t one_in = pick(random, 0, 4);
  std::ranges::fill(mask, std::byte{0});
  for (std::size_t v = 0; v < mask.size() * 8 && one_in != 0; ++v) {
    if (chance(random, one_in)) mask[v / 8] |= std::byte(1U << v % 8);
  }
}

class Pool {
 public:
  Pool(const TextureDesc& desc)
      : desc_(desc),
        slots_(block_count(desc)),
        said_(presence_bytes(desc)),
        size_(block_bytes(desc)),
        out_{Bytes(slots_ * said_), Bytes(slots_ * size_)} {}

  std::span<std::byte> said(std::uint32_t slot) {
    return std::span(out_.presence).subspan(slot * said_, said_);
  }
  std::span<std::byte> records(std::uint32_t slot) {
    return std::span(out_.records).subspan(slot * size_, size_);
  }
  void put_brick(std::uint32_t slot, const BrickPlace& place, const Level& level) {
    const std::uint32_t n = desc_.block.y;
    pack_brick_place(place, said(slot).first<kBrickPlaceBytes>());
    for (std::uint32_t v = 0; v < n * n * n; ++v) {
      const auto found = level.find(
          {place.at[0] * n + v % n, place.at[1] * n + v / n % n, place.at[2] * n + v / n / n});
      if (found == level.end()) continue;
      said(slot)[8 + v / 8] |= std::byte(1U << v % 8);
      for (std::size_t h = 0; h < kVoxelDirections; ++h) {
        put(&records(slot)[(v * kVoxelDirections + h) * desc_.record.bytes], desc_.record,
            found->second[h]);
      }
    }
  }
  /// Any bytes; `still`: what does not change from frame to frame.
  void put_any(std::uint32_t slot, Random& still, Random& random) {
    put_noise_place(said(slot), chance(random, 6) ? random : still);
    put_mask(said(slot).subspan(8), chance(random, 3) ? random : still);
    for (std::size_t at = 0; at < size_; at += desc_.record.bytes) {
      Random same(still());
      std::byte* const record = &records(slot)[at];
      std::memset(record, 0, desc_.record.bytes);
      put_noise(record, desc_.record, chance(random, 2) ? random : same);
    }
    clear_absent(desc_, said(slot), records(slot));
  }
  /// Another brick at the place of one.
  void put_double(std::uint32_t slot, std::uint32_t of, Random& random) {
    std::ranges::copy(said(of), said(slot).begin());
    std::ranges::copy(records(of), records(slot).begin());
    if (chance(random, 2)) put_mask(said(slot).subspan(8), random);
    clear_absent(desc_, said(slot), records(slot));
  }
  void swap(std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    std::ranges::swap_ranges(said(a), said(b));
    std::ranges::swap_ranges(records(a), records(b));
  }
  BrickPool take() { return std::move(out_); }

 private:
  const TextureDesc& desc_;
  std::size_t slots_, said_, size_;
  BrickPool out_;
};

/// Bricks of all levels, in any order, that there are in some frame.
void put_octree(Pool& pool, const TextureDesc& desc, unsigned frame, std::uint64_t seed) {
  const std::uint32_t n = desc.block.y;
  Random random(seed);
  const unsigned levels = pick(random, 2, 4);
  const std::uint32_t side = n * (n == 8 ? 2 : 4);
  std::vector<std::pair<std::uint64_t, BrickPlace>> all;
  std::vector<Level> now;
  for (unsigned f = 0; f < 2; ++f) {
    Level level = surface(side, f == 0 ? 0 : frame, seed);
    for (unsigned l = 0; l < levels; ++l) {
      for (const auto& [at, faces] : level) {
        const BrickPlace place{static_cast<std::uint8_t>(l), {at[0] / n, at[1] / n, at[2] / n}};
        all.emplace_back((morton_key(place.at) * 8 + l + seed) * 0x9E3779B97F4A7C15U, place);
      }
      Level next = coarser(level);
      if (f == 1) now.push_back(std::move(level));
      level = std::move(next);
    }
  }
  std::ranges::sort(all, {}, [](const auto& one) { return one.first; });
  const auto end = std::unique(all.begin(), all.end());
  std::uint32_t slot = 0;
  for (auto one = all.begin(); one != end && slot < block_count(desc); ++one, ++slot) {
    pool.put_brick(slot, one->second, now[one->second.level]);
  }
}

}  // namespace

TextureDesc voxels(std::uint32_t bricks, std::uint8_t side, bool halves) {
  TextureDesc desc =
      pool_texture(halves ? Format::R16G16B16A16_SFLOAT : Format::E5B9G9R9_UFLOAT_PACK32, bricks,
                   {static_cast<std::uint8_t>(kVoxelDirections * side), side, side});
  desc.presence = Presence::brick;
  desc.model = Model::octree;
  return desc;
}

BrickPool make_voxels(const TextureDesc& desc, VoxelContent content, unsigned frame,
                      std::uint64_t seed) {
  Pool pool(desc);
  const std::uint32_t slots = block_count(desc);
  if (content != VoxelContent::bits) put_octree(pool, desc, frame, seed);
  Random random(seed * 977 + frame);
  for (std::uint32_t slot = 0; slot < slots && content != VoxelContent::octree; ++slot) {
    Random still(seed * 1000003 + slot);
    if (content == VoxelContent::bits || chance(still, 4)) pool.put_any(slot, still, random);
    if (chance(still, 8)) pool.put_double(slot, pick(still, 0, slots - 1), still);
  }
  for (std::uint32_t i = 0; i < frame * slots / 8; ++i) {
    pool.swap(pick(random, 0, slots - 1), pick(random, 0, slots - 1));
  }
  return pool.take();
}

UpdateCase make_voxel_update(const TextureDesc& desc, VoxelContent content, UpdateMode mode,
                             std::uint32_t one_in, std::uint64_t seed) {
  const bool keyframe = mode != UpdateMode::update, intra = mode == UpdateMode::intra;
  UpdateCase u{desc, {}, {}, {}, {}, keyframe, {}, intra};
  const std::size_t size = block_bytes(desc), said = presence_bytes(desc);
  Random random(seed);
  if (mode != UpdateMode::keyframe) {
    BrickPool previous = make_voxels(desc, content, 0, seed);
    u.mirror = std::move(previous.records);
    u.mirror_presence = std::move(previous.presence);
    forget_some(u, random);
  }
  const BrickPool now = make_voxels(desc, content, 1, seed);
  const auto append = [](Bytes& to, const Bytes& from, std::size_t at, std::size_t bytes) {
    const auto some = std::span(from).subspan(at * bytes, bytes);
    to.insert(to.end(), some.begin(), some.end());
  };
  for (std::uint32_t b = 0; b < block_count(desc); ++b) {
    if (!chance(random, one_in)) continue;
    u.blocks.push_back(b);
    append(u.records, now.records, b, size);
    append(u.presence, now.presence, b, said);
    if (!intra) continue;
    const auto any = [&] { return std::byte(random()); };
    std::generate_n(&u.mirror[b * size], size, any);
    std::generate_n(&u.mirror_presence[b * said], said, any);
  }
  return u;
}

}  // namespace gicodec::test
