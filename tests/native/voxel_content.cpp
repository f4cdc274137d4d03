#include "native/voxel_content.h"

#include <gicodec/voxels.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace gicodec::test {
namespace {

constexpr std::uint32_t kHalfOfOne = 0x3C00, kExponent = 16;

/// Light of one direction by steps of 0 to 511 from one exponent; three zeros are dark.
using Steps = std::array<std::uint32_t, 3>;

void put(const TextureDesc& desc, const Steps& steps, std::byte* record) {
  const bool dark = steps == Steps{};
  if (desc.record.format == Format::E5B9G9R9_UFLOAT_PACK32) {
    const std::uint32_t bits =
        dark ? 0 : steps[0] | steps[1] << 9 | steps[2] << 18 | kExponent << 27;
    std::memcpy(record, &bits, sizeof bits);
    return;
  }
  std::array<std::uint16_t, 4> halves{0, 0, 0, kHalfOfOne};
  for (std::size_t c = 0; c < 3 && !dark; ++c) {
    halves[c] = static_cast<std::uint16_t>(kHalfOfOne + 2 * steps[c]);
  }
  std::memcpy(record, halves.data(), sizeof halves);
}

class Frame {
 public:
  Frame(const TextureDesc& desc, unsigned frame, std::uint64_t seed)
      : desc_(desc), side_(desc.block.y), frame_(frame), seed_(seed) {
    const std::uint32_t slots = block_count(desc);
    out_.presence.resize(slots * presence_bytes(desc));
    out_.records.resize(slots * block_bytes(desc));
    // Slot 0 has the parents of the eight bricks of the first slots; others stand anywhere.
    for (std::uint32_t slot = 1; slot < slots; ++slot) fine(slot);
    coarse();
  }
  [[nodiscard]] VoxelFrame take() { return std::move(out_); }

 private:
  [[nodiscard]] Random random_of(std::uint64_t what, std::uint64_t number) const {
    return Random(seed_ * 1000003 + what * 10007 + number);
  }
  [[nodiscard]] std::span<std::byte> presence(std::uint32_t slot) {
    return std::span(out_.presence).subspan(slot * presence_bytes(desc_), presence_bytes(desc_));
  }
  void put_voxel(std::uint32_t slot, std::uint32_t voxel, const std::array<Steps, 6>& light) {
    presence(slot)[8 + voxel / 8] |= static_cast<std::byte>(1U << voxel % 8);
    for (std::size_t h = 0; h < 6; ++h) {
      const std::size_t record = std::size_t{voxel} * 6 + h;
      put(desc_, light[h], &out_.records[slot * block_bytes(desc_) + record * desc_.record.bytes]);
    }
  }

  void fine(std::uint32_t slot) {
    // Now and then a brick moves.
    Random moves = random_of(slot, frame_ / 3);
    const std::uint32_t key = chance(moves, 6) ? pick(moves, 0, 63) : slot - 1;
    const std::array<std::uint32_t, 3> at{(key & 1) | (key >> 2 & 2),
                                          (key >> 1 & 1) | (key >> 3 & 2),
                                          (key >> 2 & 1) | (key >> 4 & 2)};
    pack_brick_place({0, at}, presence(slot).first<kBrickPlaceBytes>());
    Random random = random_of(slot, 77);
    Random changes = random_of(slot, 100 + frame_);
    for (std::uint32_t z = 0; z < side_; ++z) {
      for (std::uint32_t y = 0; y < side_; ++y) {
        for (std::uint32_t x = 0; x < side_; ++x) {
          const bool exists = chance(random, 3), flickers = chance(changes, 40);
          std::array<Steps, 6> light{};
          for (std::size_t h = 0; h < 6; ++h) {
            const bool dark = chance(random, 4), changed = chance(changes, 3);
            for (std::size_t c = 0; c < 3; ++c) {
              const std::uint32_t steps = 40 + 9 * x + 5 * y + 3 * z + 30 * (slot % 8) +
                                          20 * static_cast<std::uint32_t>(h + c) +
                                          pick(random, 0, 6);
              light[h][c] = dark ? 0 : steps + (changed ? frame_ + pick(changes, 0, 2) : 0);
            }
          }
          if (exists == flickers) continue;
          put_voxel(slot, x + side_ * (y + side_ * z), light);
          if (key < 8) add(at, {x, y, z}, light);
        }
      }
    }
  }

  void add(const std::array<std::uint32_t, 3>& brick, const std::array<std::uint32_t, 3>& voxel,
           const std::array<Steps, 6>& light) {
    std::array<std::uint32_t, 3> above{};
    for (std::size_t i = 0; i < 3; ++i) above[i] = (brick[i] * side_ + voxel[i]) / 2;
    Sum& sum = sums_[above[0] + side_ * (above[1] + side_ * above[2])];
    sum.any = true;
    for (std::size_t h = 0; h < 6; ++h) {
      if (light[h] == Steps{}) continue;
      ++sum.lit[h];
      for (std::size_t c = 0; c < 3; ++c) sum.steps[h][c] += light[h][c];
    }
  }
  void coarse() {
    pack_brick_place({1, {0, 0, 0}}, presence(0).first<kBrickPlaceBytes>());
    for (std::uint32_t voxel = 0; voxel < side_ * side_ * side_; ++voxel) {
      Sum& sum = sums_[voxel];
      if (!sum.any) continue;
      for (std::size_t h = 0; h < 6; ++h) {
        for (std::uint32_t& c : sum.steps[h]) {
          c = sum.lit[h] == 0 ? 0 : (c + sum.lit[h] / 2) / sum.lit[h];
        }
      }
      put_voxel(0, voxel, sum.steps);
    }
  }

  struct Sum {
    bool any = false;
    std::array<Steps, 6> steps{};
    std::array<std::uint32_t, 6> lit{};
  };
  const TextureDesc& desc_;
  std::uint32_t side_;
  unsigned frame_;
  std::uint64_t seed_;
  std::array<Sum, 512> sums_{};
  VoxelFrame out_;
};

}  // namespace

TextureDesc voxels(std::uint32_t slots, std::uint8_t side, bool halves) {
  TextureDesc desc =
      pool_texture(halves ? Format::R16G16B16A16_SFLOAT : Format::E5B9G9R9_UFLOAT_PACK32, slots,
                   {static_cast<std::uint8_t>(kVoxelDirections * side), side, side});
  desc.presence = Presence::brick;
  desc.prediction.relation = Relation::octree;
  return desc;
}

VoxelFrame make_voxels(const TextureDesc& desc, unsigned frame, std::uint64_t seed) {
  return Frame(desc, frame, seed).take();
}

}  // namespace gicodec::test
