#include "native/models/continuous/texel_repeats.h"

#include "base/binary_coder.h"
#include "native/models/continuous/bit_contexts.h"
#include "native/models/continuous/raster_contexts.h"

#include <algorithm>

namespace gicodec::native {
namespace {

using Ordinals = const std::uint32_t*;

bool equal(const ChannelForms& forms, Ordinals a, Ordinals b) {
  const auto coded = forms.coded();
  return std::all_of(coded.begin(), coded.end(), [&](unsigned c) { return a[c] == b[c]; });
}

}  // namespace

void TexelRepeats::reset(const Raster& raster) {
  source_.assign(raster.texels() + 1, Source::none);
  last_seen_.assign(std::size_t{1} << kMatchBits, 0);
  match_ = 0;
  match_length_ = 0;
  by_source_.fill({});
  by_pattern_.fill({});
}

template <typename Coder>
bool TexelRepeats::code(Coder& coder, CounterTable& counters, Raster& raster,
                        const ChannelForms& forms, const Place& p) {
  struct Candidate {
    Source source;
    Ordinals ordinals;
  };
  std::array<Candidate, kSources> candidate;
  std::size_t candidates = 0;
  const auto add = [&](Source source, Ordinals ordinals) {
    candidate[candidates++] = {source, ordinals};
  };
  const auto at = [&](std::size_t texel) { return Ordinals{raster.now(texel)}; };
  const Ordinals past = raster.has_past() ? Ordinals{raster.past(p.here)} : nullptr;
  const Ordinals match = match_length_ > 0 ? at(match_) : nullptr;
  if (past != nullptr) add(Source::past, past);
  add(Source::w, at(p.w));
  add(Source::n, at(p.n));
  add(Source::ne, at(p.ne));
  add(Source::nw, at(p.nw));
  if (match != nullptr) add(Source::match, match);
  if (p.deep) add(Source::z, at(p.z));

  const auto alike = [&](std::size_t a, std::size_t b) {
    return equal(forms, at(a), at(b)) ? 1U : 0U;
  };
  const std::uint32_t pattern = alike(p.w, p.n) | alike(p.n, p.ne) << 1 | alike(p.w, p.nw) << 2 |
                                alike(p.nw, p.n) << 3 | alike(p.w, p.ww) << 4 |
                                alike(p.n, p.nn) << 5;
  const auto source_of = [this](std::size_t texel) {
    return static_cast<std::uint32_t>(source_[texel]);
  };
  const std::uint32_t w = source_of(p.w), n = source_of(p.n), ne = source_of(p.ne),
                      nw = source_of(p.nw);
  const std::uint32_t length = match != nullptr ? 1 + std::min(match_length_, kLongMatch) : 0;
  std::uint32_t deep = p.deep ? source_of(p.z) : 0;
  if (past != nullptr) deep = 2 * deep + (equal(forms, past, at(p.w)) ? 17 : 16);

  std::array<Ordinals, kMostFlags> passed{};
  const std::uint32_t most = p.deep || past != nullptr ? kMostFlags : kMostFlags - 1;
  std::uint32_t flags = 0;
  for (std::size_t k = 0; k < candidates && flags < most; ++k) {
    const Ordinals ordinals = candidate[k].ordinals;
    const auto source = static_cast<std::uint32_t>(candidate[k].source);
    if (std::any_of(passed.begin(), passed.begin() + flags,
                    [&](Ordinals one) { return equal(forms, one, ordinals); })) {
      continue;
    }
    const std::uint32_t matches = match != nullptr && equal(forms, ordinals, match) ? 1 : 0;
    const std::uint32_t base = hashed(kRepeat, source, matches, flags);
    const ValueContexts context{hashed(base, kRepeatAround, 512 * w + 64 * n + 8 * ne + nw),
                                hashed(base, kRepeatPattern, pattern),
                                hashed(base, kRepeatMatch, length, deep),
                                hashed(base, kRepeatBoth, 64 * pattern + 8 * w + n),
                                hashed(base, kRepeatDeep, 8 * w + ne, deep)};
    bool is = false;
    if constexpr (!Coder::kDecodes) is = equal(forms, at(p.here), ordinals);
    is = code_bit(coder, counters_of(counters, context), by_source_[kSources * source + flags],
                  by_pattern_[pattern], is);
    if (is) {
      if constexpr (Coder::kDecodes) {
        for (const unsigned c : forms.coded()) raster.now(p.here)[c] = ordinals[c];
      }
      source_[p.here] = candidate[k].source;
      return true;
    }
    passed[flags++] = ordinals;
  }
  return false;
}

void TexelRepeats::learn(const Raster& raster, const ChannelForms& forms, const Place& p) {
  if (match_length_ > 0) {
    if (equal(forms, raster.now(match_), raster.now(p.here))) {
      ++match_length_;
      ++match_;
    } else {
      match_length_ = 0;
    }
  }
  std::uint32_t& seen = last_seen_[hash_around(raster, forms, p)];
  if (match_length_ == 0 && seen != 0) {
    match_ = seen;
    match_length_ = 1;
  }
  seen = static_cast<std::uint32_t>(p.here + 1);
}

/// Of the texel, the one before it and the one above the next.
std::uint32_t TexelRepeats::hash_around(const Raster& raster, const ChannelForms& forms,
                                        const Place& p) const {
  const std::size_t row = raster.size().x;
  const std::size_t above = p.here >= row ? p.here + 1 - row : 0;
  std::uint32_t hash = 0;
  for (const std::size_t texel : {p.here, p.here - 1, above}) {
    for (const unsigned c : forms.coded()) hash = hashed(hash, raster.now(texel)[c]);
  }
  return hash * kBucketFactor >> (32 - kMatchBits);
}

template bool TexelRepeats::code(BinaryEncoder&, CounterTable&, Raster&, const ChannelForms&,
                                 const Place&);
template bool TexelRepeats::code(BinaryDecoder&, CounterTable&, Raster&, const ChannelForms&,
                                 const Place&);

}  // namespace gicodec::native
