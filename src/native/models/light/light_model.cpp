#include "native/models/light/light_model.h"

#include "base/binary_coder.h"
#include "native/models/light/light_contexts.h"
#include "quantise/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr unsigned kAlphaChannel = 13;
constexpr unsigned kLitMixer = 0, kEqualMixer = 2, kHemisphereMixer = 4;

}  // namespace

void LightModel::reset(const Record& record, ValueModel& values) {
  values_ = &values;
  values_->reset();
  encoding_ = LightEncoding(record);
  last_ = {};
  any_ = false;
  same_before_ = 0;
}

/// Whether it has light.
template <typename Coder>
bool LightModel::code_lit(Coder& coder, const KnownLights& around, std::span<const std::byte> in) {
  constexpr std::uint32_t kNone = 9;
  std::uint32_t dark = 0, nearness = 0, of_dark = 0;
  for (unsigned i = 0; i < around.count; ++i) {
    const KnownLights::Neighbour& vertex = around.other[i];
    const std::uint32_t near = kNearest / vertex.distance;
    dark += vertex.dark ? 1 : 0;
    nearness += near;
    of_dark += vertex.dark ? near : 0;
  }
  const std::uint32_t share = around.count != 0 ? dark * 8 / around.count : kNone;
  const std::uint32_t weighed = nearness != 0 ? of_dark * 8 / nearness : kNone;
  const std::uint32_t previous = known_ ? 1 : 0;
  bool lit = false;
  if constexpr (!Coder::kDecodes) lit = !is_zero(in);
  return values_->flag(coder, kLitMixer + previous,
                       {{{hashed(kLit, share, previous), weighed},
                         {hashed(kLit + 1, weighed), previous},
                         {hashed(kLit + 2, around.count, dark), previous}}},
                       lit);
}

template <typename Coder>
LightOccupancy LightModel::code_occupancy(Coder& coder, const KnownLights& around,
                                          std::span<const std::byte> previous,
                                          std::span<const std::byte> in) {
  constexpr std::uint32_t kNoNeighbour = 1U << kHemispheres;
  known_ = !previous.empty();
  if (!code_lit(coder, around, in)) return {};
  LightOccupancy occupancy{true, 0};
  std::uint32_t lit = 0;
  if constexpr (!Coder::kDecodes) lit = encoding_.lit(in.data());
  const std::uint32_t before = known_ ? encoding_.lit(previous.data()) : 0;
  const KnownLights::Siblings& siblings = around.siblings;
  const std::uint32_t nearest = around.count != 0 ? around.other[0].lit : kNoNeighbour;
  const std::uint32_t to_come = siblings.children - siblings.coded;
  for (unsigned h = 0; h < kHemispheres; ++h) {
    std::uint32_t dark = 0;
    for (unsigned i = 0; i < around.count; ++i) dark += (around.other[i].lit >> h & 1) ^ 1U;
    const std::uint32_t above =
        siblings.parent.now == nullptr ? 0 : 1 + (siblings.parent.lit >> h & 1U);
    const std::uint32_t was = known_ ? 1 + (before >> h & 1) : 0;
    const bool is_lit = values_->flag(
        coder, kHemisphereMixer + was,
        {{{hashed(kLitHemisphere, dark * 4 + around.count, above, was), h},
          {hashed(kLitHemisphere + 1, nearest, occupancy.lit, was), h},
          {hashed(kLitHemisphere + 2, siblings.lit_before(h), to_come, above, h), was}}},
        (lit >> h & 1) != 0);
    if (is_lit) occupancy.lit |= static_cast<std::uint8_t>(1U << h);
  }
  return occupancy;
}

/// The coverage of voxels: equal for opposite hemispheres, and mostly full.
template <typename Coder>
void LightModel::code_alpha(Coder& coder, unsigned h, LightCodes& now) {
  const LightCodes& before = h % 2 != 0 ? last_[h - 1] : known_ ? previous_[h] : last_[h];
  const auto size = static_cast<std::uint32_t>(before.alpha);
  const std::uint32_t side = h % 2;
  const auto other = static_cast<std::uint32_t>(last_[h == 0 ? kHemispheres - 1 : h - 1].alpha);
  const std::int64_t residual = values_->number(
      coder, kAlphaChannel,
      {hashed(kAlpha, side, size), hashed(kAlpha + 1, side, other, h), hashed(kAlpha + 2, side),
       hashed(kAlpha + 3, h, size >> 6), hashed(kAlpha + 4, size, other)},
      {{{hashed(kAlphaSign, side), 0},
        {hashed(kAlphaSign + 1, size), side},
        {hashed(kAlphaSign + 2, h), 0}}},
      std::int64_t{now.alpha} - before.alpha);
  now.alpha = encoding_.color_of_bits(before.alpha + residual);
}

void LightModel::learn(unsigned h, const HemisphereLight& light) {
  light_[h] = light;
  predictors_.learn(h, light);
}

/// Of a voxel, also by how many around it are unchanged.
std::array<FlagContext, kFlagContexts> LightModel::same_contexts(const KnownLights& around,
                                                                 unsigned h,
                                                                 std::uint32_t same) const {
  if (encoding_.directed()) {
    return {{{hashed(kEqual, h), same & 15},
             {hashed(kEqual + 1, same_before_, h), 0},
             {hashed(kEqual + 2, same, same_before_ & 3), h}}};
  }
  const std::size_t size = encoding_.bytes();
  const auto still = [&](const KnownLights::Neighbour& other) {
    return std::equal(other.now + h * size, other.now + (h + 1) * size, other.previous + h * size);
  };
  std::uint32_t count = 0;
  for (unsigned i = 0; i < around.count; ++i) count += still(around.other[i]) ? 1 : 0;
  constexpr std::uint32_t kNone = 9;
  const std::uint32_t share = around.count != 0 ? count * 8 / around.count : kNone;
  const KnownLights::Neighbour& parent = around.siblings.parent;
  const std::uint32_t above = parent.previous == nullptr ? 2 : still(parent) ? 1 : 0;
  return {{{hashed(kEqual, share, above), h},
           {hashed(kEqual + 1, same, h, above), share},
           {hashed(kEqual + 2, share, same_before_ >> h & 1), above}}};
}

template <typename Coder>
void LightModel::code(Coder& coder, const KnownLights& around, std::span<const std::byte> previous,
                      std::span<const std::byte> in, std::span<std::byte> out) {
  known_ = !previous.empty();
  if (code_lit(coder, around, in)) {
    constexpr std::uint8_t kAll = (1U << kHemispheres) - 1;
    return code(coder, {true, kAll}, around, previous, in, out);
  }
  if constexpr (Coder::kDecodes) std::fill(out.begin(), out.end(), std::byte{0});
}

template <typename Coder>
void LightModel::code(Coder& coder, LightOccupancy occupancy, const KnownLights& around,
                      std::span<const std::byte> previous, std::span<const std::byte> in,
                      std::span<std::byte> out) {
  const std::size_t size = encoding_.bytes();
  known_ = !previous.empty();
  predictors_.take(encoding_, around, previous, any_ ? &last_ : nullptr);
  const std::uint32_t was_lit = encoding_.directed() ? occupancy.lit
                                : known_             ? encoding_.lit(previous.data())
                                                     : 0U;
  std::uint32_t same = 0;
  direction_residual_ = {};
  exponent_residual_ = green_residual_ = {};
  for (unsigned h = 0; h < kHemispheres; ++h) {
    const bool lit = (occupancy.lit >> h & 1) != 0;
    LightCodes now;
    if constexpr (!Coder::kDecodes) now = encoding_.read(in.data() + h * size);
    bool is_same = false;
    if (known_) {
      previous_[h] = encoding_.read(previous.data() + h * size);
      is_same = (was_lit >> h & 1) == (lit ? 1U : 0U);
      // What has neither colours nor alpha is nothing.
      if (is_same && (lit || encoding_.alpha())) {
        is_same =
            values_->flag(coder, kEqualMixer, same_contexts(around, h, same), now == previous_[h]);
      }
      same |= is_same ? 1U << h : 0U;
    }
    if (is_same) {
      now = previous_[h];
      learn(h, encoding_.light(now, predictors_.top()));
    } else if (!lit) {
      now = {{}, 0, now.alpha, {}};
      learn(h, {});
    } else {
      code_hemisphere(coder, h, now);
    }
    if (!is_same && encoding_.alpha()) code_alpha(coder, h, now);
    last_[h] = now;
    if constexpr (Coder::kDecodes) encoding_.write(now, out.data() + h * size);
  }
  any_ = true;
  same_before_ = same;
}

template void LightModel::code(BinaryEncoder&, const KnownLights&, std::span<const std::byte>,
                               std::span<const std::byte>, std::span<std::byte>);
template void LightModel::code(BinaryDecoder&, const KnownLights&, std::span<const std::byte>,
                               std::span<const std::byte>, std::span<std::byte>);
template LightOccupancy LightModel::code_occupancy(BinaryEncoder&, const KnownLights&,
                                                   std::span<const std::byte>,
                                                   std::span<const std::byte>);
template LightOccupancy LightModel::code_occupancy(BinaryDecoder&, const KnownLights&,
                                                   std::span<const std::byte>,
                                                   std::span<const std::byte>);
template void LightModel::code(BinaryEncoder&, LightOccupancy, const KnownLights&,
                               std::span<const std::byte>, std::span<const std::byte>,
                               std::span<std::byte>);
template void LightModel::code(BinaryDecoder&, LightOccupancy, const KnownLights&,
                               std::span<const std::byte>, std::span<const std::byte>,
                               std::span<std::byte>);

}  // namespace gicodec::native
