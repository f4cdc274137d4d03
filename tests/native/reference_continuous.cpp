#include "native/reference_continuous.h"

#include "native/reference_raster.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

namespace gicodec::reference {
namespace {

Number plane(Number w, Number n, Number nw) {
  if (nw >= std::max(w, n)) return std::min(w, n);
  if (nw <= std::min(w, n)) return std::max(w, n);
  return w + n - nw;
}

class Rasters : RasterState {
 public:
  Rasters(const TextureDesc& desc, BitModels& models) : RasterState(desc, models) {}

  bool decode(const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
              std::vector<std::vector<std::byte>>& out) {
    lay_out(blocks, held);
    if (!forms()) return false;
    weights_.assign(channels_.size(), {32768, 32768});
    for (std::size_t t = 0; t < now_.size() && !coded_.empty(); ++t) {
      place(t);
      if (models_.source().missing() || (is_coded_[t] && !texel(t))) return false;
      if (!is_coded_[t]) pass(t);
      learn_match(t);
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      std::vector<Components> records;
      for (std::size_t r = 0; r < blocks[b].exists.size(); ++r) {
        const std::size_t t = where(blocks[b].place, r);
        Components values(channels_.size(), 0);
        for (unsigned c = 0; c < channels_.size() && is_coded_[t]; ++c) {
          values[channels_[c].component] = channels_[c].component_bits(final_ordinal(t, c));
        }
        records.push_back(values);
      }
      out.push_back(packed(desc_.record, records));
    }
    return true;
  }

 private:
  bool texel(std::size_t t) {
    if (repeat(t)) {
      pass(t);
      return true;
    }
    r1_ = r2_ = 0;
    high_ = false;
    for (unsigned k = 0; k < coded_.size(); ++k) {
      if (!channel(t, k)) return false;
    }
    return true;
  }
  void pass(std::size_t t) {
    for (const unsigned c : coded_) {
      for (unsigned g = 0; g < 10; ++g) {
        error_[t][c][g] = at_[W] == kNone ? 0 : error_[at_[W]][c][g] / 2;
      }
    }
  }

  bool repeat(std::size_t t) {
    std::vector<std::pair<Number, Texel>> candidates;
    if (update_) candidates.emplace_back(7, past_[t]);
    const std::array<Around, 4> beside{W, N, NE, NW};
    for (Number i = 0; i < 4; ++i)
      candidates.emplace_back(i + 1, now(beside[static_cast<std::size_t>(i)]));
    if (match_ != kNone) candidates.emplace_back(5, now_[match_]);
    if (deep_) candidates.emplace_back(6, now(Z));
    const auto r = [&](Around a) { return at_[a] == kNone ? Number{0} : repeats_[at_[a]]; };
    const std::array<std::pair<Around, Around>, 6> pairs{
        {{W, N}, {N, NE}, {W, NW}, {NW, N}, {W, WW}, {N, NN}}};
    Number p = 0;
    for (unsigned i = 0; i < 6; ++i)
      p += Number{equal(now(pairs[i].first), now(pairs[i].second))} << i;
    const Number length = match_ == kNone ? 0 : 1 + std::min<Number>(length_, 20);
    Number d = deep_ ? r(Z) : 0;
    if (update_) d = 2 * d + 16 + (equal(past_[t], now(W)) ? 1 : 0);
    std::vector<Texel> passed;
    for (const auto& candidate : candidates) {
      const Number c = candidate.first;
      const Texel& values = candidate.second;
      if (passed.size() == (deep_ || update_ ? 5 : 4)) break;
      if (std::ranges::any_of(passed, [&](const Texel& one) { return equal(one, values); }))
        continue;
      const Number m = match_ != kNone && equal(values, now_[match_]) ? 1 : 0;
      const auto f = static_cast<Number>(passed.size());
      const Word g = H({16, c, m, f});
      if (twice_by_hash({"source", 8 * c + f}, {"pattern", p},
                        {H({g, 17, 512 * r(W) + 64 * r(N) + 8 * r(NE) + r(NW)}), H({g, 18, p}),
                         H({g, 19, length, d}), H({g, 20, 64 * p + 8 * r(W) + r(N)}),
                         H({g, 21, 8 * r(W) + r(NE), d})})) {
        for (const unsigned channel : coded_) now_[t][channel] = values[channel];
        repeats_[t] = c;
        return true;
      }
      passed.push_back(values);
    }
    return false;
  }
  void learn_match(std::size_t t) {
    if (match_ != kNone) {
      if (equal(now_[match_], now_[t])) {
        ++length_;
        ++match_;
      } else {
        match_ = kNone;
      }
    }
    Word k = 0;
    const std::size_t back = size_[0] - 1;
    for (const std::size_t one : {t, t > 0 ? t - 1 : kNone, t >= back ? t - back : kNone}) {
      const Texel values = all(one, now_);
      for (const unsigned c : coded_) k = H({k, values[c]});
    }
    auto& seen = seen_[k * 0xC2B2AE35U >> 16];
    if (match_ == kNone && seen != 0) {
      match_ = seen;
      length_ = 1;
    }
    seen = t + 1;
  }

  using Name = std::pair<const char*, Number>;
  bool twice_by_hash(const Name& a, const Name& b, const std::array<Word, 5>& hashes) {
    std::array<F, 5> by{};
    for (std::size_t i = 0; i < 5; ++i) by[i] = {hashes[i], hashes[i] % 16};
    return twice(a, b, by);
  }
  bool twice(const Name& a, const Name& b, const std::array<F, 5>& by) {
    const auto mixer = [&](const Name& name) -> BitModels::Mixer {
      const auto [entry, added] =
          names_.try_emplace(std::string(name.first), static_cast<char>(names_.size()));
      return {'A', entry->second, name.second};
    };
    return models_.mixed_twice(mixer(a), mixer(b), by);
  }

  // Section Prediction.
  Number light(const Texel& from, unsigned c, Number exponent) const {
    const ChannelOf& channel = channels_[c];
    if (channel.mantissa) return value(from, c, exponent);
    const Number o = ordinal_at(c, from[c]);
    if (channel.is_linear()) return o;
    const bool is_signed = channel.type == ComponentType::sfloat;
    const Number bits = channel.component_bits(o);
    const bool negative = is_signed && bits >= channel.s();
    const Number m = channel.bits - 5 - (is_signed ? 1 : 0);
    const Number magnitude = negative ? bits - channel.s() : bits;
    const Number e = magnitude >> m, f = magnitude % (Number{1} << m);
    const Number x = e == 0 ? f : ((Number{1} << m) + f) << (e - 1);
    return negative ? -x : x;
  }
  Number value_of_light(Number x, unsigned c) const {
    const ChannelOf& channel = channels_[c];
    if (channel.mantissa) return x;
    Number v = 16 * std::min<Number>(x, 1 << 20);
    if (channel.is_float()) {
      const bool is_signed = channel.type == ComponentType::sfloat;
      const Number m = channel.bits - 5 - (is_signed ? 1 : 0);
      const Number d = std::max<Number>(0, Number{width_of(x)} - 1 - m);
      v = 16 * ((d << m) + (is_signed ? channel.s() : 0)) + ((16 * x) >> d);
    }
    return has_places(c) ? 16 * place_of(c, (v + 8) >> 4) : v;
  }
  std::array<Number, 10> guesses(std::size_t t, unsigned k, Texel& inputs) const {
    const unsigned c = coded_[k];
    const Number exponent = now_[t][0];
    const auto v = [&](Around a, unsigned channel) { return value(now(a), channel, exponent); };
    const auto past = [&](std::size_t at, unsigned channel) {
      return value(all(at, past_), channel, exponent);
    };
    const Number w = v(W, c), n = v(N, c), nw = v(NW, c), ne = v(NE, c), ww = v(WW, c),
                 nn = v(NN, c);
    const Number z = deep_ ? v(Z, c) : 0, zw = deep_ ? v(ZW, c) : 0, zn = deep_ ? v(ZN, c) : 0;
    const Number p = update_ ? past(t, c) : 0, pw = update_ ? past(at_[W], c) : 0,
                 pn = update_ ? past(at_[N], c) : 0;
    const Number base = update_ ? p : (w + n) >> 1;
    inputs = {w - base, n - base, nw - base, ne - base, ww - base, nn - base};
    for (const Number one : {z, zw, zn}) {
      if (size_[2] > 1) inputs.push_back(deep_ ? one - base : 0);
    }
    if (update_) inputs.insert(inputs.end(), {pw - base, pn - base});
    for (unsigned l = lead_; l < k && l < lead_ + 2; ++l) {
      const unsigned lc = coded_[l];
      const Number lead_base = update_ ? past(t, lc) : (v(W, lc) + v(N, lc)) >> 1;
      inputs.push_back(value(now_[t], lc, exponent) - lead_base);
      inputs.push_back(v(W, lc) - lead_base);
      inputs.push_back(v(update_ ? N : NW, lc) - lead_base);
      if (l == lead_) inputs.push_back(v(NE, lc) - lead_base);
    }
    Number sum = 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) sum += weights_[c][i] * inputs[i];

    std::array<Number, 10> g{
        plane(w, n, nw),
        base + (sum >> 16),
        w + ne - n,
        update_ ? p
        : deep_ ? z
                : w,
        update_ ? p + ((w - pw + n - pn) >> 1) : (w + ((ne - nw) >> 1) + n) >> 1,
        deep_ ? z + w - zw : (2 * w + 2 * n + nw + ne + ww + nn) >> 3,
        deep_ ? z + n - zn : (3 * w + 3 * n - 2 * nw) >> 2,
        update_ ? p + w - pw : (w + n) >> 1,
        0,
        0};
    g[8] = g[9] = g[0];
    if (k <= lead_) return g;
    const unsigned l = coded_[lead_];
    const Number lead = value(now_[t], l, exponent);
    g[2] = g[0] + lead - plane(v(W, l), v(N, l), v(NW, l));
    g[7] = update_ ? p + lead - past(t, l) : g[7] + lead - ((v(W, l) + v(N, l)) >> 1);
    for (const unsigned one : {c, l}) {
      if (!channels_[one].is_linear() && !channels_[one].is_float()) return g;
    }
    const auto x = [&](Around a, unsigned channel) { return light(now(a), channel, exponent); };
    const Number by = light(now_[t], l, exponent);
    const auto guess = [&](Number o, Number a, Number& to) {
      if (o >= 0 && by >= 0 && a > 0) to = value_of_light(prop(o, by, a), c);
    };
    if (x(W, c) >= 0 && x(N, c) >= 0 && x(W, l) >= 0 && x(N, l) >= 0) {
      guess(x(W, c) + x(N, c), x(W, l) + x(N, l), g[8]);
    }
    if (update_) {
      guess(light(past_[t], c, exponent), light(past_[t], l, exponent), g[9]);
    } else {
      guess(plane(x(W, c), x(N, c), x(NW, c)), plane(x(W, l), x(N, l), x(NW, l)), g[9]);
    }
    return g;
  }
  Number mean(unsigned c, const std::array<Number, 10>& g) const {
    static constexpr Number T[16] = {65536, 62757, 60097, 57549, 55109, 52773, 50535, 48393,
                                     46341, 44376, 42495, 40693, 38968, 37316, 35734, 34219};
    const auto error = [&](Around a, unsigned i) {
      return at_[a] == kNone ? Number{0} : error_[at_[a]][c][i];
    };
    std::array<Number, 10> z{};
    for (unsigned i = 0; i < 10; ++i) {
      const Number y = error(W, i) + error(N, i) + error(NE, i) +
                       (error(NW, i) + error(WW, i)) / 2 + (deep_ ? error(Z, i) : 0) + 12;
      const unsigned width = width_of(y);
      z[i] = 16 * width + (width > 5 ? y >> (width - 5) : y << (5 - width)) % 16;
    }
    const Number least = *std::ranges::min_element(z);
    Number weights = 0, sum = 0;
    for (unsigned i = 0; i < 10; ++i) {
      const Number u = 3 * (z[i] - least);
      const Number weight = u >= 256 ? 0 : (T[u % 16] >> (u / 16)) * (i == 1 ? 2 : 1);
      weights += weight;
      sum += weight * (g[i] - g[0]);
    }
    return g[0] + (sum + (sum < 0 ? -(weights / 2) : weights / 2)) / weights;
  }

  bool channel(std::size_t t, unsigned k) {
    const unsigned c = coded_[k];
    Texel x;
    const auto g = guesses(t, k, x);
    const Number most = has_places(c) ? static_cast<Number>(palette_[c].size()) - 1
                                      : mask_of(static_cast<unsigned>(channels_[c].bits));
    Number residual = 0;
    const Number m = brought_into(mean(c, g), 0, 16 * most);
    if (!residual_of(t, k, g, m, most, residual)) return false;
    const Number v = 16 * now_[t][c], h = std::max<Number>(0, channels_[c].bits - 16);
    residual_[t][c] = brought_into(residual, -INT32_MAX, INT32_MAX);
    for (unsigned i = 0; i < 10; ++i)
      error_[t][c][i] = std::min<Number>(65535, std::abs(g[i] - v) >> h);
    const auto brought = [&](Number one) { return brought_into(one >> h, -(1 << 20), 1 << 20); };
    Number p = 256;
    for (Number& one : x) {
      one = brought(one);
      p += one * one;
    }
    const Number q = brought(v - g[1]) * 1000 * (Number{1} << 28) / p;
    for (std::size_t i = 0; i < x.size(); ++i) {
      Number& weight = weights_[c][i];
      weight = brought_into(weight + ((q * x[i] + (1 << 27)) >> 28), -(1 << 19), 1 << 19);
    }
    return true;
  }

  // Section Residuals.
  bool residual_of(std::size_t t, unsigned k, const std::array<Number, 10>& g, Number mean,
                   Number most, Number& residual) {
    const unsigned c = coded_[k];
    const bool nearest = palette_[c].size() > 1 && channels_[c].mantissa;
    const auto place = [&](Number prediction) {
      const Number o = (prediction + 8) >> 4;
      if (!nearest) return o;
      const Number within = brought_into(o, 0, mask_of(static_cast<unsigned>(channels_[c].bits)));
      Number best = 0;
      for (std::size_t i = 1; i < palette_[c].size(); ++i) {
        const auto off = [&](std::size_t j) { return std::abs(palette_[c][j] - within); };
        if (off(i) < off(static_cast<std::size_t>(best))) best = static_cast<Number>(i);
      }
      return best;
    };
    const Number p = place(mean),
                 last = nearest ? static_cast<Number>(palette_[c].size()) - 1 : most;
    const auto r = [&](Around a) { return at_[a] == kNone ? Number{0} : residual_[at_[a]][c]; };
    Number energy = 2 * (std::abs(r(W)) + std::abs(r(N))) + std::abs(r(NW)) + std::abs(r(NE));
    if (deep_) energy = (2 * energy + 6 * std::abs(r(Z))) / 3;
    const Number e = half(energy);
    Number spread = 0;
    for (const Number one : g)
      spread += nearest ? 16 * std::abs(place(one) - p) : std::abs(one - 16 * p);
    const Number exponent = now_[t][0];
    const auto v = [&](Around a) { return value(now(a), c, exponent); };
    const auto past = [&](Around a) { return value(all(at_[a], past_), c, exponent); };
    const Number y =
        (update_ ? std::abs(v(W) - past(W)) + std::abs(v(N) - past(N))
                 : std::abs(v(W) - v(NW)) + std::abs(v(N) - v(NW)) + std::abs(v(N) - v(NE))) >>
        4;
    const Number dw = place(v(W)) - p, dn = place(v(N)) - p;
    const auto near = [](Number d) { return brought_into(d, -31, 31) + 31; };
    const Number i = !channels_[c].mantissa ? 0 : high_ ? 1 : 2;
    const Word h1 = H({32, c, near(dw), near(dn)}), h2 = H({48, c, p}), h3 = H({64, c, 4 * e + i}),
               h4 = H({80, c, half(spread >> 4), e / 2}),
               h5 = H({96, c, half(y), half(r1_), sign(r1_)});
    Number w = 0;
    while (w < width_of(last)) {
      std::array<F, 5> by{};
      const std::array<Word, 5> h{h1, h2, h3, h4, h5};
      for (std::size_t j = 0; j < 5; ++j) by[j] = {H({h[j], w - w % 16}), w % 16};
      if (!twice({"width", 32 * k + w}, {"energy", 32 * e + w}, by)) break;
      ++w;
    }
    residual = 0;
    if (w > 0) {
      const Number o = 16 * (nearest ? palette_[c][static_cast<std::size_t>(p)] : p),
                   above = mean - o;
      const Number f = above < -4  ? 0
                       : above < 0 ? 1
                       : above < 4 ? 2
                                   : 3,
                   u = std::min<Number>(w, 4);
      const Number G = 9 * sign(g[0] - mean) + 3 * sign(g[1] - mean) + sign(g[2] - mean);
      const bool s = twice_by_hash({"sign", 32 * k + w - 1}, {"fraction", f},
                                   {H({h1, 100 + u}), H({h2, 100 + u}),
                                    H({112, c, 4 * (3 * sign(r(W)) + sign(r(N))) + f, u}),
                                    H({128, c, 3 * sign(r1_) + sign(r2_) + 9 * G, u}),
                                    H({144, c, 3 * sign(dw) + sign(dn) + 9 * (half(r1_) / 2), u})});
      Number m = 1, left = w - 1;
      for (Number n = 0; n < 3 && left > 0; ++n, --left) {
        const Number key = 110 + (s ? 1 : 0);
        const bool bit = twice(
            {"digit", 3 * (32 * k + w - 1) + n}, {"digit of width", 3 * (w - 1) + n},
            std::array<F, 5>{F{H({160, c, s ? 1 : 0, w}), m}, F{H({h1, key, w}), m},
                             F{H({h2, key, w}), m}, F{H({h3, key, w}), m}, F{H({h4, key, w}), m}});
        m = 2 * m + (bit ? 1 : 0);
      }
      m = (m << left) | models_.source().bypass(static_cast<unsigned>(left));
      residual = s ? -m : m;
    }
    const Number at = p + residual;
    if (at < 0 || at > last) return false;
    now_[t][c] = nearest ? palette_[c][static_cast<std::size_t>(at)] : at;
    high_ = high_ || (channels_[c].mantissa && now_[t][c] >= channels_[c].s());
    r2_ = r1_;
    r1_ = residual;
    return true;
  }

  bool high_ = false;
  std::vector<std::array<Number, 18>> weights_;
  std::map<Word, std::size_t> seen_;
  std::size_t match_ = kNone;
  Number length_ = 0, r1_ = 0, r2_ = 0;
  std::map<std::string, char, std::less<>> names_;
};

}  // namespace

std::vector<std::vector<std::byte>> decode_continuous(const TextureDesc& desc,
                                                      const std::array<std::uint32_t, 3>& box,
                                                      const std::vector<AdaptiveBlock>& blocks,
                                                      const HeldBlocks& held, BitModels& models) {
  if (!may_be_raster(desc, box)) return {};
  std::vector<std::vector<std::byte>> out;
  if (!Rasters(desc, models).decode(blocks, held, out)) return {};
  return out;
}

}  // namespace gicodec::reference
