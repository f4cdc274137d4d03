#include "native/models/light/light_model.h"

#include "base/binary_coder.h"
#include "quantise/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

// What a context is for, the first number of its hash.
enum Role : std::uint32_t {
  kLit = 1,
  kSame = 4,
  kLitHemisphere = 7,
  kAlpha = 20,  // five
  kAlphaSign = 240,
};
constexpr unsigned kAlphaWay = 13;
constexpr unsigned kLitMixer = 0, kSameMixer = 2, kHemisphereMixer = 4;

}  // namespace

void LightModel::reset(const Record& record, ValueModel& values) {
  values_ = &values;
  values_->reset();
  form_ = LightForm(record);
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
    const KnownLights::Other& vertex = around.other[i];
    const std::uint32_t near = kNearest / vertex.distance;
    dark += vertex.dark ? 1 : 0;
    nearness += near;
    of_dark += vertex.dark ? near : 0;
  }
  const std::uint32_t share = around.count != 0 ? dark * 8 / around.count : kNone;
  const std::uint32_t weighed = nearness != 0 ? of_dark * 8 / nearness : kNone;
  const std::uint32_t past = known_ ? 1 : 0;
  bool lit = false;
  if constexpr (!Coder::kDecodes) lit = !is_zero(in);
  return values_->flag(coder, kLitMixer + past,
                       {{{hashed(kLit, share, past), weighed},
                         {hashed(kLit + 1, weighed), past},
                         {hashed(kLit + 2, around.count, dark), past}}},
                       lit);
}

template <typename Coder>
ToldLight LightModel::tell(Coder& coder, const KnownLights& around, std::span<const std::byte> past,
                           std::span<const std::byte> in) {
  constexpr std::uint32_t kNobody = 1U << kHemispheres;
  known_ = !past.empty();
  if (!code_lit(coder, around, in)) return {};
  ToldLight told{true, 0};
  std::uint32_t lit = 0;
  if constexpr (!Coder::kDecodes) lit = form_.lit(in.data());
  const std::uint32_t before = known_ ? form_.lit(past.data()) : 0;
  const KnownLights::Family& family = around.family;
  const std::uint32_t nearest = around.count != 0 ? around.other[0].lit : kNobody;
  const std::uint32_t to_come = family.children - family.coded;
  for (unsigned h = 0; h < kHemispheres; ++h) {
    std::uint32_t dark = 0;
    for (unsigned i = 0; i < around.count; ++i) dark += (around.other[i].lit >> h & 1) ^ 1U;
    const std::uint32_t above =
        family.parent.now == nullptr ? 0 : 1 + (family.parent.lit >> h & 1U);
    const std::uint32_t was = known_ ? 1 + (before >> h & 1) : 0;
    const bool is_lit = values_->flag(
        coder, kHemisphereMixer + was,
        {{{hashed(kLitHemisphere, dark * 4 + around.count, above, was), h},
          {hashed(kLitHemisphere + 1, nearest, told.lit, was), h},
          {hashed(kLitHemisphere + 2, family.lit_before(h), to_come, above, h), was}}},
        (lit >> h & 1) != 0);
    if (is_lit) told.lit |= static_cast<std::uint8_t>(1U << h);
  }
  return told;
}

/// What voxels cover: the same to and fro, and mostly all of it.
template <typename Coder>
void LightModel::code_alpha(Coder& coder, unsigned h, LightCodes& now) {
  const LightCodes& before = h % 2 != 0 ? last_[h - 1] : known_ ? past_[h] : last_[h];
  const auto size = static_cast<std::uint32_t>(before.alpha);
  const std::uint32_t side = h % 2;
  const auto other = static_cast<std::uint32_t>(last_[h == 0 ? kHemispheres - 1 : h - 1].alpha);
  const std::int64_t off = values_->number(
      coder, kAlphaWay,
      {hashed(kAlpha, side, size), hashed(kAlpha + 1, side, other, h), hashed(kAlpha + 2, side),
       hashed(kAlpha + 3, h, size >> 6), hashed(kAlpha + 4, size, other)},
      {{{hashed(kAlphaSign, side), 0},
        {hashed(kAlphaSign + 1, size), side},
        {hashed(kAlphaSign + 2, h), 0}}},
      std::int64_t{now.alpha} - before.alpha);
  now.alpha = form_.color_of_bits(before.alpha + off);
}

void LightModel::learn(unsigned h, const HemisphereLight& light) {
  light_[h] = light;
  guesses_.learn(h, light);
}

/// Of a voxel, also by how many around it are as they were.
std::array<FlagContext, kFlagContexts> LightModel::same_contexts(const KnownLights& around,
                                                                 unsigned h,
                                                                 std::uint32_t same) const {
  if (form_.directed()) {
    return {{{hashed(kSame, h), same & 15},
             {hashed(kSame + 1, same_before_, h), 0},
             {hashed(kSame + 2, same, same_before_ & 3), h}}};
  }
  const std::size_t size = form_.bytes();
  const auto still = [&](const KnownLights::Other& other) {
    return std::equal(other.now + h * size, other.now + (h + 1) * size, other.past + h * size);
  };
  std::uint32_t count = 0;
  for (unsigned i = 0; i < around.count; ++i) count += still(around.other[i]) ? 1 : 0;
  constexpr std::uint32_t kNone = 9;
  const std::uint32_t share = around.count != 0 ? count * 8 / around.count : kNone;
  const KnownLights::Other& parent = around.family.parent;
  const std::uint32_t above = parent.past == nullptr ? 2 : still(parent) ? 1 : 0;
  return {{{hashed(kSame, share, above), h},
           {hashed(kSame + 1, same, h, above), share},
           {hashed(kSame + 2, share, same_before_ >> h & 1), above}}};
}

template <typename Coder>
void LightModel::code(Coder& coder, const KnownLights& around, std::span<const std::byte> past,
                      std::span<const std::byte> in, std::span<std::byte> out) {
  known_ = !past.empty();
  if (code_lit(coder, around, in)) {
    constexpr std::uint8_t kAll = (1U << kHemispheres) - 1;
    return code(coder, {true, kAll}, around, past, in, out);
  }
  if constexpr (Coder::kDecodes) std::fill(out.begin(), out.end(), std::byte{0});
}

template <typename Coder>
void LightModel::code(Coder& coder, ToldLight told, const KnownLights& around,
                      std::span<const std::byte> past, std::span<const std::byte> in,
                      std::span<std::byte> out) {
  const std::size_t size = form_.bytes();
  known_ = !past.empty();
  guesses_.take(form_, around, past, any_ ? &last_ : nullptr);
  const std::uint32_t was_lit = form_.directed() ? told.lit : known_ ? form_.lit(past.data()) : 0U;
  std::uint32_t same = 0;
  off_ = {};
  off_exponent_ = off_green_ = {};
  for (unsigned h = 0; h < kHemispheres; ++h) {
    const bool lit = (told.lit >> h & 1) != 0;
    LightCodes now;
    if constexpr (!Coder::kDecodes) now = form_.read(in.data() + h * size);
    bool is_same = false;
    if (known_) {
      past_[h] = form_.read(past.data() + h * size);
      is_same = (was_lit >> h & 1) == (lit ? 1U : 0U);
      // What has neither colours nor alpha is nothing.
      if (is_same && (lit || form_.alpha())) {
        is_same = values_->flag(coder, kSameMixer, same_contexts(around, h, same), now == past_[h]);
      }
      same |= is_same ? 1U << h : 0U;
    }
    if (is_same) {
      now = past_[h];
      learn(h, form_.light(now, guesses_.top()));
    } else if (!lit) {
      now = {{}, 0, now.alpha, {}};
      learn(h, {});
    } else {
      code_hemisphere(coder, h, now);
    }
    if (!is_same && form_.alpha()) code_alpha(coder, h, now);
    last_[h] = now;
    if constexpr (Coder::kDecodes) form_.write(now, out.data() + h * size);
  }
  any_ = true;
  same_before_ = same;
}

template void LightModel::code(BinaryEncoder&, const KnownLights&, std::span<const std::byte>,
                               std::span<const std::byte>, std::span<std::byte>);
template void LightModel::code(BinaryDecoder&, const KnownLights&, std::span<const std::byte>,
                               std::span<const std::byte>, std::span<std::byte>);
template ToldLight LightModel::tell(BinaryEncoder&, const KnownLights&, std::span<const std::byte>,
                                    std::span<const std::byte>);
template ToldLight LightModel::tell(BinaryDecoder&, const KnownLights&, std::span<const std::byte>,
                                    std::span<const std::byte>);
template void LightModel::code(BinaryEncoder&, ToldLight, const KnownLights&,
                               std::span<const std::byte>, std::span<const std::byte>,
                               std::span<std::byte>);
template void LightModel::code(BinaryDecoder&, ToldLight, const KnownLights&,
                               std::span<const std::byte>, std::span<const std::byte>,
                               std::span<std::byte>);

}  // namespace gicodec::native
