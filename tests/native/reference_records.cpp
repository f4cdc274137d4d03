#include "native/reference_records.h"

#include <algorithm>

namespace gicodec::reference {

namespace {

struct RecordPlace {
  bool exists = false, known = false, changed = false;
  Components now, previous, residual;
  explicit RecordPlace(std::size_t components)
      : now(components, 0), previous(components, 0), residual(components, 0) {}
};

bool zero(const Components& values) {
  return std::ranges::all_of(values, [](Number v) { return v == 0; });
}

class Records {
 public:
  Records(const TextureDesc& desc, BitModels& models)
      : desc_(desc),
        record_(desc.record),
        count_(record_.count),
        models_(models),
        flat_(desc.block.y == 1 && desc.block.z == 1),
        l1_(count_),
        l2_(count_),
        none_(count_),
        similar_(256, SimilarRecord(count_)),
        sum_(count_, 0),
        noise_(count_, 0),
        error_(count_, std::array<Number, 4>{}) {
    for (unsigned c = 0; c < count_ && exponent_ < 0; ++c) {
      if (kind(c) == ComponentType::exponent && bits(c) <= 5) exponent_ = static_cast<int>(c);
    }
    if (exponent_ >= 0) order_.push_back(static_cast<unsigned>(exponent_));
    std::vector<unsigned> rest(count_);
    for (unsigned c = 0; c < count_; ++c) rest[c] = c;
    if (count_ >= 3) std::swap(rest[0], rest[1]);
    for (const unsigned c : rest) {
      if (static_cast<int>(c) != exponent_) order_.push_back(c);
    }
  }

  std::vector<std::byte> block(const AdaptiveBlock& in) {
    const std::size_t columns = desc_.block.x;
    places_.assign(in.exists.size(), RecordPlace(count_));
    Number n = 0, h = 1;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      RecordPlace& here = places_[i];
      here.exists = in.exists[i];
      if (!here.exists) continue;
      if (!in.previous.empty())
        here.previous = unpacked(record_, in.previous.data() + i * record_.bytes);
      here.now = here.previous;
      here.known = !zero(here.previous);
      column_ = i % columns;
      const bool row = i >= columns;
      w_ = column_ > 0 ? &places_[i - 1] : &none_;
      n_ = row ? &places_[i - columns] : &none_;
      nw_ = row && column_ > 0 ? &places_[i - columns - 1] : &none_;
      ne_ = row && column_ + 1 < columns ? &places_[i - columns + 1] : &none_;
      ww_ = column_ > 1 ? &places_[i - 2] : &none_;
      const Number known = here.known ? 1 : 0, at = static_cast<Number>(i);
      const bool by_similar = flat_ && !in.previous.empty();
      SimilarRecord& similar = similar_[key(here.previous)];
      const Number v = flat_ ? (w_->exists && zero(w_->now) ? 1 : 0)
                             : (w_->changed ? 1 : 0) + (n_->changed ? 2 : 0);
      if (by_similar) {
        Number behind = 0;
        for (std::size_t k = i + 1; k < places_.size(); ++k) {
          const auto bytes = in.previous.begin() + static_cast<std::ptrdiff_t>(k * record_.bytes);
          if (in.exists[k] && std::any_of(bytes, bytes + record_.bytes,
                                          [](std::byte x) { return x != std::byte{0}; })) {
            ++behind;
          }
        }
        const unsigned e = count_ - 1;
        const bool must = n == 0 && behind == 0;
        const Number d = !here.known || !similar.is || must ? 0
                         : similar.changed ? 2 + std::min(7U, width_of(similar.residual[e]))
                                           : 1;
        const Number first = must ? 0 : top_of(here.previous[e], bits(e), 4),
                     second = must ? 0 : h % 4;
        const Number third = must ? 64 : std::min<Number>(at, 63);
        here.changed = models_.flag(
            known, {{H({4, known, d, must ? 1 : 0}), first},
                    {H({5, known, std::min<Number>(behind, 7), second}), std::min<Number>(n, 15)},
                    {H({6, known, third}), d}});
      } else {
        here.changed =
            models_.flag(known, {{H({1, known}), h % 16},
                                 {H({2, known, std::min<Number>(at, 63)}), std::min<Number>(n, 15)},
                                 {H({3, known, u_, v}), std::min<Number>(at, 15)}});
      }
      h = (2 * h + (here.changed ? 1 : 0)) & 0xFFFFFFFF;
      if (here.changed) {
        ++n;
        if (here.known) {
          known_record(here, h, n);
        } else {
          new_record(here, h);
        }
        l2_ = l1_;
        l1_ = here;
      }
      if (!flat_ || !here.known) continue;
      similar.is = true;
      similar.changed = here.changed;
      similar.before = similar.residual;
      for (unsigned c = 0; c < count_; ++c) {
        similar.previous[c] = here.previous[c] % 256;
        similar.residual[c] = brought_into(here.residual[c], -255, 255);
      }
    }
    u_ = 8 * n / (static_cast<Number>(places_.size()) + 1);
    std::vector<Components> values;
    for (const RecordPlace& place : places_) values.push_back(place.now);
    return packed(record_, values);
  }

 private:
  struct SimilarRecord {
    bool is = false, changed = false;
    Components previous, residual, before;
    explicit SimilarRecord(std::size_t components)
        : previous(components, 0), residual(components, 0), before(components, 0) {}
  };
  [[nodiscard]] std::size_t key(const Components& previous) const {
    Number key = 0;
    for (unsigned c = 0; c < count_; ++c) {
      if (kind(c) == ComponentType::snorm) key = (16 * key + previous[c] % 16) % 256;
    }
    return static_cast<std::size_t>(key);
  }
  [[nodiscard]] unsigned bits(unsigned c) const { return record_.components[c].bits; }
  [[nodiscard]] ComponentType kind(unsigned c) const { return record_.components[c].type; }
  [[nodiscard]] bool mantissa(unsigned c) const {
    return exponent_ >= 0 && kind(c) == ComponentType::ufloat && bits(c) < 10;
  }
  [[nodiscard]] bool linear(unsigned c) const {
    return mantissa(c) ||
           (bits(c) <= 16 && (kind(c) == ComponentType::unorm || kind(c) == ComponentType::uint));
  }
  [[nodiscard]] bool code(unsigned c) const {
    return !linear(c) && bits(c) <= 16 && kind(c) != ComponentType::opaque &&
           kind(c) != ComponentType::exponent;
  }
  [[nodiscard]] Number a(unsigned c, const Components& values) const {
    return values[c] << (mantissa(c) ? values[static_cast<std::size_t>(exponent_)] : 0);
  }

  void new_record(RecordPlace& here, Number h) {
    const Number f = column_ == 0 ? 1 : 0;
    const Components& before = column_ == 0 ? l1_.now : w_->now;
    const Components& other = !flat_ ? n_->now : column_ >= 2 ? ww_->now : l2_.now;
    Word o = 0;
    Number e = 1;
    for (unsigned c = count_; c-- > 0;) {
      const unsigned b = bits(c);
      bool found = false;
      Number value = 0;
      if (b > 8) {
        const Number candidates[3] = {l1_.now[c], (2 * l1_.now[c] - l2_.now[c]) & mask_of(b),
                                      other[c]};
        for (unsigned k = 0; k < 3 && !found; ++k) {
          bool earlier = false;
          for (unsigned i = 0; i < k; ++i) earlier = earlier || candidates[i] == candidates[k];
          if (earlier) continue;
          value = candidates[k];
          found = models_.flag(
              32 + 3 * c + k,
              {{H({80 + c, k}), e % 8}, {H({96 + c, e % 256}), k}, {H({112 + c, h % 16}), k}});
        }
      }
      if (!found) {
        const Number tb = top_of(before[c], b), to = top_of(other[c], b);
        value = models_.value(c,
                              {H({128 + c, f}), H({144 + c, tb, f}), H({160 + c, o}),
                               H({176 + c, tb, to, e % 4}), H({192 + c, tb, e, f})},
                              b);
      }
      o = H({o, top_of(value, b)});
      e = 2 * e + (value == before[c] ? 1 : 0);
      here.now[c] = value;
    }
  }

  void known_record(RecordPlace& here, Number h, Number n) {
    Number q = 1, r1 = 0, r2 = 0, k = 0, moved = 0;
    lead_ = -1;
    t_ = 0;
    const bool same_components =
        flat_ && mask_ != 0 &&
        models_.flag(2, {{7, 0}, {H({8, mask_}), 0}, {H({9, h % 8}), std::min<Number>(n, 3)}});
    for (unsigned j = 0; j < count_; ++j) {
      const unsigned c = order_[j], b = bits(c);
      const Number g = (w_->residual[c] != 0 ? 1 : 0) + (n_->residual[c] != 0 ? 2 : 0);
      const bool same =
          same_components
              ? (mask_ >> c & 1) == 0
              : models_.flag(16 + c, {{H({32 + c, q % 256}), 0},
                                      {H({48 + c, h % 8}), l1_.residual[c] != 0 ? 1 : 0},
                                      {H({64 + c, q % 256, g}), std::min<Number>(n, 3)}});
      q = 2 * q + (same ? 0 : 1);
      if (same) continue;
      moved |= Number{1} << c;
      if (flat_ && b <= 8) {
        const Number d = difference(here, c);
        here.residual[c] = with_sign(d, b);
        here.now[c] = (here.previous[c] + d) & mask_of(b);
      } else if (!flat_ || b <= 16 || !copy(here, j)) {
        number(here, c, j, k, r1, r2);
        r2 = r1;
        r1 = here.residual[c];
        ++k;
      }
    }
    mask_ = moved;
  }

  bool copy(RecordPlace& here, unsigned j) {
    const unsigned c = order_[j], b = bits(c);
    std::vector<Number> passed = {here.previous[c]};
    const auto is = [&](Number candidate, Number from, unsigned a) {
      if (std::ranges::find(passed, candidate) != passed.end()) return false;
      passed.push_back(candidate);
      const bool match = models_.flag(
          208 + c,
          {{H({496 + c, from, a}), 0}, {H({10, from, t_}), 0}, {H({11, from, t_}), s_ % 4}});
      s_ = (2 * s_ + (match ? 1 : 0)) % 4;
      if (from == 0) t_ = match ? 1 : 2;
      if (match) here.now[c] = candidate;
      return match;
    };
    if (l1_.exists && is(l1_.now[c], 0, c)) return true;
    for (unsigned i = j; i-- > 0;) {
      const unsigned a = order_[i];
      if (bits(a) != b || here.now[a] == here.previous[a]) continue;
      if (is(here.now[a], 1, a)) return true;
      if (kind(c) == ComponentType::sfloat && is(here.now[a] ^ Number{1} << (b - 1), 2, a)) {
        return true;
      }
    }
    return false;
  }

  Number difference(const RecordPlace& here, unsigned c) {
    const unsigned b = bits(c);
    const SimilarRecord& similar = similar_[key(here.previous)];
    const Number p = here.previous[c], r = similar.residual[c], l = l1_.residual[c],
                 x = p - similar.previous[c];
    const Number w = similar.is ? 1 + sign(r) : 0;
    const Number gap = similar.is ? 1 + (x >= 0 ? 4 : 0) + std::min<Number>(3, width_of(x) / 2) : 0;
    const Number y = models_.flag(80 + c, {{H({400 + c, w}), 4 * sign(l) + sign(w_->residual[c])},
                                           {H({416 + c, top_of(p, b, 4)}), w},
                                           {H({432 + c, w, gap}), std::min(7U, width_of(r))}})
                         ? 1
                         : 0;
    const auto size = [y](Number by, Number unit) {
      return by != 0 && (by < 0) == (y == 1) ? 1 + std::abs(by) / unit : 0;
    };
    const Number f = !similar.is ? 102 : r == 0 ? 100 : size(r, 4) == 0 ? 101 : size(r, 4);
    const unsigned all = b - 1, high = std::min(4U, all), rest = all - high;
    const Number v =
        models_.value(16 + c,
                      {H({208 + c, size(similar.before[c], 8), y}), H({224 + c, f, gap, y}),
                       H({240 + c, p >> 2, y}), H({256 + c, f >> 1, size(l, 8) >> 1, y}),
                       H({272 + c, p >> 5, f >> 1, y})},
                      high);
    const Number by = v << rest;
    const Number at = ((y == 1 ? p - by : p + by) & mask_of(b)) >> rest;
    Number m = 1;
    for (unsigned i = 0; i < rest; ++i) {
      m = 2 * m + (models_.flag(95 + 7 * c + m, {{H({448 + c, v, p % 4, y}), m},
                                                 {H({464 + c, at, p % 4, y}), m},
                                                 {H({480 + c, at >> 4, p % 4, y}), m}})
                       ? 1
                       : 0);
    }
    const Number magnitude = by + m - (Number{1} << rest);
    return y == 1 ? -magnitude - 1 : magnitude;
  }

  std::array<Number, 4> predictions(unsigned c, const RecordPlace& here) const {
    const Number g0 = a(c, here.previous);
    std::array<Number, 4> g = {g0, g0, g0, g0};
    if (!linear(c) && !code(c)) return g;
    Number s = 0, t = 0, m = 0;
    const std::pair<const RecordPlace*, Number> around[] = {{w_, 2}, {n_, 2}, {nw_, 1}, {ne_, 1}};
    for (const auto& [place, weight] : around) {
      if (!place->known) continue;
      s += weight * a(c, place->now);
      t += weight * a(c, place->previous);
      m += weight;
    }
    if (linear(c)) {
      if (t + g0 != 0) g[1] = prop(g0, s + g0, t + g0);
    } else {
      g[1] = brought_into(g0 + (s - t) / (m + 1), 0, kMax);
    }
    g[2] = g[1];
    if (lead_ < 0) return g;
    g[2] = linear(c) ? prop(g[1], lead_now_, lead_prediction_)
                     : brought_into(g[1] + lead_now_ - lead_prediction_, 0, kMax);
    const Number of_lead = sum_[static_cast<std::size_t>(lead_)];
    if (of_lead != 0) {
      const Number by = prop(std::abs(lead_change_), sum_[c], of_lead);
      g[3] = brought_into(lead_change_ < 0 ? g0 - by : g0 + by, 0, kMax);
    }
    return g;
  }

  void number(RecordPlace& here, unsigned c, unsigned j, Number k, Number r1, Number r2) {
    const unsigned b = bits(c);
    const std::array<Number, 4> g = predictions(c, here);
    const Number e = mantissa(c) ? here.now[static_cast<std::size_t>(exponent_)] : 0;
    std::array<Number, 4> values{};
    std::size_t best = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      values[i] = std::min((g[i] + ((Number{1} << e) >> 1)) >> e, mask_of(b));
      if (error_[c][i] < error_[c][best]) best = i;
    }
    const Number p = values[best];
    const auto size = [c](const RecordPlace* place) { return std::abs(place->residual[c]); };
    const Number energy = 2 * (size(w_) + size(n_)) + size(nw_) + size(ne_);
    const Number y = (w_->known ? 1 : 0) + (n_->known ? 2 : 0);
    const Number z = p == 0 ? 0 : 4 * width_of(p) + ((4 * p) >> (width_of(p) - 1)) % 4;
    const Number x =
        mantissa(c)
            ? brought_into(e - here.previous[static_cast<std::size_t>(exponent_)], -3, 3) + 3
            : 0;
    const Number last = l1_.residual[c];
    const Word s1 = H({368 + c, 3 * sign(w_->residual[c]) + sign(n_->residual[c])});
    const Word s2 = H({384 + c, x});
    const Number i1 = sign(last), i2 = 3 * sign(r1) + sign(r2);
    const Number d =
        models_.number(c,
                       {H({288 + c, half(energy), y}), H({304 + c, width_of(r1), width_of(r2), k}),
                        H({320 + c, half(energy / 2), width_of(r1), std::min(j, 3U)}),
                        H({336 + c, z, x}), H({352 + c, half(noise_[c]), width_of(last)})},
                       {{s1, i1}, {s2, i2}, {H({s1, s2, i1}), i2}});
    const Number value = (p + d) & mask_of(b);
    here.now[c] = value;
    here.residual[c] = with_sign(d, b);
    for (std::size_t i = 0; i < 4; ++i) {
      const Number error = 64 * std::min<Number>(std::abs(values[i] - value), 4095);
      error_[c][i] += (error - error_[c][i]) >> 4;
    }
    noise_[c] += (16 * std::min<Number>(std::abs(d), 1 << 20) - noise_[c]) >> 4;
    const Number change = a(c, here.now) - a(c, here.previous);
    sum_[c] += std::abs(change) - (sum_[c] >> 4);
    if (lead_ < 0 && (linear(c) || code(c))) {
      lead_ = static_cast<int>(c);
      lead_now_ = a(c, here.now);
      lead_prediction_ = std::max<Number>(g[1], 1);
      lead_change_ = change;
    }
  }

  const TextureDesc& desc_;
  const Record& record_;
  unsigned count_;
  BitModels& models_;
  bool flat_;
  int exponent_ = -1;
  std::vector<unsigned> order_;
  RecordPlace l1_, l2_, none_;
  std::vector<SimilarRecord> similar_;
  Number mask_ = 0, s_ = 1, t_ = 0;
  Components sum_, noise_;
  std::vector<std::array<Number, 4>> error_;
  Number u_ = 0;

  std::vector<RecordPlace> places_;
  std::size_t column_ = 0;
  const RecordPlace *w_ = nullptr, *n_ = nullptr, *nw_ = nullptr, *ne_ = nullptr, *ww_ = nullptr;
  int lead_ = -1;
  Number lead_now_ = 0, lead_prediction_ = 0, lead_change_ = 0;
};

}  // namespace

std::vector<std::vector<std::byte>> decode_records(const TextureDesc& desc,
                                                   const std::vector<AdaptiveBlock>& blocks,
                                                   BitModels& models) {
  Records records(desc, models);
  std::vector<std::vector<std::byte>> out;
  for (const AdaptiveBlock& block : blocks) {
    out.push_back(records.block(block));
    if (models.source().missing()) return {};
  }
  return out;
}

}  // namespace gicodec::reference
