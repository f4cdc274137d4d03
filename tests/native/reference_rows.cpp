#include "native/reference_adaptive.h"
#include "native/reference_context.h"
#include "native/reference_continuous.h"
#include "native/reference_raster.h"
#include "native/reference_row_tables.h"

namespace gicodec::reference {
namespace {

Number without(Number a, Number b) { return std::max<Number>(0, a - b); }

class Rows : RasterState {
 public:
  Rows(const TextureDesc& desc, BitModels& models) : RasterState(desc, models) {}

  bool decode(const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held, Bytes& in,
              std::vector<std::vector<std::byte>>& out) {
    lay_out(blocks, held);
    if (4 * blocks.size() * record_count(desc_.block) < now_.size()) return false;
    is_coded_.assign(now_.size(), true);
    if (!forms() || !models_.source().finished()) return false;
    for (unsigned c = 0; c < channels_.size(); ++c) {
      const bool copy = form_[c] == 3;
      if (channels_[c].bits > 16 && !copy && palette_[c].size() > 65535) return false;
    }
    const std::size_t whole = channels_.size();
    if (!split()) return false;
    if (coded_.empty() ? !in.at_end() : !strips(in)) return false;
    join(whole);
    for (const auto& block : blocks) {
      std::vector<Components> records;
      for (std::size_t r = 0; r < block.exists.size(); ++r) {
        Components values(channels_.size(), 0);
        for (unsigned c = 0; c < channels_.size() && block.exists[r]; ++c) {
          values[channels_[c].component] =
              channels_[c].component_bits(final_ordinal(where(block.place, r), c));
        }
        records.push_back(values);
      }
      out.push_back(packed(desc_.record, records));
    }
    return true;
  }

 private:
  /// Plain channels of more than 16 bits become high halves; their low halves are further channels.
  bool split() {
    first_low_ = static_cast<unsigned>(channels_.size());
    for (const unsigned c : std::vector(coded_)) {
      if (channels_[c].bits <= 16 || form_[c] != 0) continue;
      channels_[c].bits -= 16;
      ChannelOf low = channels_[c];
      low.bits = 16;
      coded_.push_back(static_cast<unsigned>(channels_.size()));
      channels_.push_back(low);
      high_.push_back(c);
      form_.push_back(0);
      palette_.emplace_back();
      for (auto* texels : {&now_, &past_}) {
        for (auto& texel : *texels) {
          texel.push_back(texel[c] & 65535);
          texel[c] >>= 16;
        }
      }
    }
    residual_.assign(now_.size(), Texel(channels_.size(), 0));
    return coded_.size() <= 16;
  }
  void join(std::size_t whole) {
    for (std::size_t i = 0; i < high_.size(); ++i) {
      channels_[high_[i]].bits += 16;
      for (auto& texel : now_) texel[high_[i]] = texel[high_[i]] << 16 | texel[whole + i];
    }
    channels_.resize(whole);
  }
  bool is_low(unsigned c) const { return c >= first_low_; }

  bool has_exponent() const { return shared_ && coded_[0] == 0; }
  bool nearest(unsigned c) const { return channels_[c].mantissa && palette_[c].size() > 1; }
  Number largest(unsigned c) const {
    return has_places(c) ? static_cast<Number>(palette_[c].size()) - 1
                         : mask_of(static_cast<unsigned>(channels_[c].bits));
  }
  unsigned bits(unsigned c) const {
    if (palette_[c].size() > 1) return width_of(static_cast<Number>(palette_[c].size()) - 1);
    return static_cast<unsigned>(channels_[c].bits);
  }

  bool strips(Bytes& in) {
    const std::size_t no_lows = coded_.size() - high_.size();
    const std::size_t follow = no_lows > lead_ ? no_lows - lead_ - 1 : 0;
    if (!tables_.read(in, lead_ > 0, follow, high_.size())) return false;
    errors_.assign(now_.size(), std::vector<std::array<Number, 9>>(channels_.size()));
    Lanes coder(in, static_cast<unsigned>(std::min<std::size_t>(32, size_[1])));
    const std::size_t nx = size_[0];
    for (std::size_t z = 0; z < size_[2]; ++z) {
      for (std::size_t y = 0; y < size_[1]; y += 32) {
        const std::size_t rows = std::min<std::size_t>(32, size_[1] - y);
        for (std::size_t t = 0; t < nx + 2 * (rows - 1); ++t) {
          lanes_.assign(rows, kNone);
          for (std::size_t l = 0; l < rows; ++l) {
            if (t >= 2 * l && t - 2 * l < nx) lanes_[l] = t - 2 * l + nx * (y + l + size_[1] * z);
          }
          if (!coder.valid()) return false;
          step(coder);
        }
      }
    }
    return coder.valid() && coder.finished();
  }

  bool exists(Around a) const {
    const bool left = x_ > 0, up = y_ > 0;
    return a == W ? left : a == N ? up : a == NW ? left && up : up && x_ + 1 < size_[0];
  }
  std::size_t beside(std::size_t t, Around a) const {
    const std::size_t nx = size_[0];
    return a == W ? t - 1 : a == N ? t - nx : a == NW ? t - nx - 1 : t - nx + 1;
  }
  void enter(std::size_t t) {
    x_ = t % size_[0];
    y_ = t / size_[0] % size_[1];
    z_ = t / size_[0] / size_[1];
  }
  /// Where the value of a neighbour comes from; kNone: it is 0.
  std::size_t source(std::size_t t, Around a) const {
    if (exists(a)) return beside(t, a);
    if (a == NW || a == NE) return source(t, N);
    if (y_ > 0) return beside(t, N);  // W in column 0
    if (x_ > 0) return beside(t, W);  // N in row 0
    return z_ > 0 ? t - size_[0] * size_[1] : kNone;
  }
  std::size_t of_slice(std::size_t t, Around a) const {
    const std::size_t before = t - size_[0] * size_[1];
    return a == Z || !exists(a) ? before : beside(before, a);
  }
  std::size_t of_past(std::size_t t, Around a) const {
    if (exists(a)) return beside(t, a);
    const Around other = a == W ? N : W;
    return exists(other) ? beside(t, other) : t;
  }
  bool same(const Texel& a, const Texel& b) const {
    return std::ranges::all_of(coded_, [&](unsigned c) { return a[c] == b[c]; });
  }
  /// Of what is 0 beyond edges.
  template <typename Of>
  Number kept(std::size_t t, Around a, const Of& of) const {
    if (exists(a)) return of(beside(t, a));
    return a == W && y_ > 0 ? of(beside(t, N)) : 0;
  }

  void step(Lanes& coder) {
    std::vector<int> context(lanes_.size(), Lanes::kInactive);
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      if (lanes_[l] != kNone) context[l] = repeat_context(lanes_[l]);
    }
    const auto symbols = coder.repeats(tables_.repeats, context);
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      if (lanes_[l] == kNone) continue;
      const std::size_t t = lanes_[l];
      enter(t);
      repeats_[t] = symbols[l] == 2 ? 0 : symbols[l] + 1;
      if (symbols[l] == 2) continue;
      const bool past = update_ && symbols[l] == 0;
      const Texel from = past ? past_[t] : all(source(t, update_ || symbols[l] == 0 ? W : N), now_);
      for (const unsigned c : coded_) {
        now_[t][c] = from[c];
        residual_[t][c] = 0;
        for (unsigned i = 0; i < 9; ++i) {
          errors_[t][c][i] = kept(t, W, [&](std::size_t at) { return errors_[at][c][i]; }) / 2;
        }
      }
    }
    std::vector<Number> first(lanes_.size(), 0), second(lanes_.size(), 0);
    for (unsigned k = 0; k < coded_.size(); ++k) {
      std::vector<Coding> coding(lanes_.size());
      std::ranges::fill(context, Lanes::kInactive);
      for (std::size_t l = 0; l < lanes_.size(); ++l) {
        if (lanes_[l] == kNone || symbols[l] != 2) continue;
        enter(lanes_[l]);
        coding[l] = predict(lanes_[l], k, first[l], second[l]);
        context[l] = static_cast<int>(coding[l].context);
      }
      const unsigned role = k <= lead_ ? 0 : is_low(coded_[k]) ? 2 : 1;
      const auto values = coder.tokens(tables_.roles[role], context);
      for (std::size_t l = 0; l < lanes_.size(); ++l) {
        if (context[l] == Lanes::kInactive) continue;
        enter(lanes_[l]);
        const Number e = residual(values[l], coding[l].flip);
        learn(lanes_[l], k, coding[l], e);
        if (k == lead_) first[l] = residual_[lanes_[l]][coded_[k]];
        if (k == lead_ + 1) second[l] = residual_[lanes_[l]][coded_[k]];
      }
    }
  }

  int repeat_context(std::size_t t) {
    enter(t);
    const auto v = [&](Around a) { return all(source(t, a), now_); };
    const auto r = [&](Around a) {
      return kept(t, a, [&](std::size_t at) { return repeats_[at]; });
    };
    const auto one = [](bool is, Number n) { return is ? n : 0; };
    Number p = 0;
    if (update_) {
      p = one(same(v(W), past_[of_past(t, W)]), 1) + one(same(v(N), past_[of_past(t, N)]), 2) +
          one(same(past_[t], v(W)), 4);
    } else if (same(v(W), v(N))) {
      p = one(same(v(NW), v(N)), 1) + one(same(v(N), v(NE)), 2);
    } else {
      p = 4 + one(same(v(NW), v(N)), 1) + one(same(v(NW), v(W)), 2) + one(same(v(N), v(NE)), 3);
    }
    const Number third = z_ > 0 ? repeats_[of_slice(t, Z)] : r(NE);
    return static_cast<int>(18 * p + 6 * r(W) + 2 * r(N) + std::min<Number>(third, 1));
  }

  struct Coding {
    Number context = 0, prediction = 0;
    bool flip = false;
    std::vector<Number> guesses, parts;
  };
  Number in_units(const Texel& from, unsigned c, Number exponent) const {
    if (!channels_[c].mantissa || !has_exponent()) return from[c];
    const Number up = from[0] - exponent;
    if (up >= 0) return from[c] << std::min<Number>(up, 6);
    const Number d = std::min<Number>(-up, 12);
    return (from[c] + (Number{1} << (d - 1))) >> d;
  }
  Coding predict(std::size_t t, unsigned k, Number e0, Number e1) {
    const unsigned c = coded_[k];
    const Number most = largest(c), exponent = has_exponent() ? now_[t][0] : 0;
    const auto v = [&](Around a) { return in_units(all(source(t, a), now_), c, exponent); };
    const auto past = [&](std::size_t at) { return in_units(past_[at], c, exponent); };
    const auto changed = [&](Number a, Number u, Number d) {
      return std::min(without(std::min<Number>(a + u, 65535), d), most);
    };
    const Number w = v(W), n = v(N), nw = v(NW), ne = v(NE);
    Coding coding;
    auto& g = coding.guesses;
    const bool deep = z_ > 0;
    if (update_) {
      const Number p = past(t), pw = past(of_past(t, W)), pn = past(of_past(t, N));
      g = {p, changed(p, without(w, pw) / 2 + without(n, pn) / 2,
                      without(pw, w) / 2 + without(pn, n) / 2)};
    }
    if (is_low(c)) {
      if (update_) g[1] = (g[0] + w - past(of_past(t, W))) & 65535;
      g.push_back((w + n - nw) & 65535);
      g.push_back(w);
    } else {
      g.push_back(nw >= std::max(w, n)   ? std::min(w, n)
                  : nw <= std::min(w, n) ? std::max(w, n)
                                         : w + n - nw);
      g.push_back(changed(w, without(ne / 2, nw / 2), without(nw / 2, ne / 2)));
    }
    if (deep) {
      const auto z = [&](Around a) { return in_units(now_[of_slice(t, a)], c, exponent); };
      g.push_back(z(Z));
      if (!update_ && is_low(c)) {
        g.push_back((z(Z) + w - z(W)) & 65535);
        g.push_back((z(Z) + n - z(N)) & 65535);
      } else if (!update_) {
        g.push_back(changed(z(Z), without(w, z(W)), without(z(W), w)));
        g.push_back(changed(z(Z), without(n, z(N)), without(z(N), n)));
      }
    }
    const auto errors = [&](unsigned i) {
      const auto at = [&](Around a) {
        return kept(t, a, [&](std::size_t one) { return errors_[one][c][i]; });
      };
      return 2 * (at(W) + at(N)) + at(NW) + at(NE);
    };
    Number least = errors(0) - errors(0) / 4, base = g[0];
    for (unsigned i = 1; i < g.size(); ++i) {
      if (errors(i) >= least) continue;
      least = errors(i);
      base = g[i];
    }
    base = std::min(base, most);
    coding.prediction = base;
    if (k > lead_ && !is_low(c)) {
      const Number e = std::max<Number>(e0, -32767), u = std::max<Number>(e, 0),
                   d = std::max<Number>(-e, 0);
      coding.parts = {base, changed(base, u / 2, d / 2), changed(base, u, d),
                      changed(base, 2 * u, 2 * d)};
      least = errors(5);
      for (unsigned i = 1; i < 4; ++i) {
        if (errors(5 + i) >= least) continue;
        least = errors(5 + i);
        coding.prediction = coding.parts[i];
      }
    }
    contexts(t, k, e0, e1, coding);
    return coding;
  }

  void contexts(std::size_t t, unsigned k, Number e0, Number e1, Coding& coding) {
    const unsigned c = coded_[k];
    const auto around = [&](Around a) {
      return static_cast<int>(kept(t, a, [&](std::size_t at) { return residual_[at][c]; }));
    };
    // As texels of one row, for the functions of planes.
    const std::vector<int> four{around(W), around(N), around(NW), around(NE)};
    Local local = local_context(four, reference::Around{0, 1, 2, 3});
    if (z_ > 0) {
      const int z = static_cast<int>(std::abs(residual_[of_slice(t, Z)][c]));
      local.energy = capped(local.energy - local.energy / 4 + z + z / 2);
    }
    const bool deep = bits(c) > 11;
    coding.flip = local.flip;
    if (is_low(c)) {
      const bool missed = residual_[t][high_[c - first_low_]] != 0;
      coding.context = 16 * local.sign + magnitude(local.energy, true) + (missed ? 64 : 0);
      return;
    }
    if (k <= lead_) {
      coding.context = 16 * local.sign + magnitude(local.energy, deep) + (k > 0 ? 64 : 0);
      return;
    }
    const bool later = k > lead_ + 1;
    const Number beside =
        later ? (std::min<Number>(std::abs(e0) + std::abs(e1) + 1, 65535)) / 2 : std::abs(e0);
    const auto sgn = [](Number e) { return e < 0 ? -1 : e > 0 ? 1 : 0; };
    const int votes = later ? sgn(e0) + sgn(e1) : 2 * sgn(e0);
    const Number twice = std::min<Number>(2 * beside, 65535);
    const int size =
        magnitude(capped(static_cast<int>(local.energy - local.energy / 4 + twice)), deep);
    coding.context = 16 * local.sign + size;
    if (votes != 0) {
      coding.flip = votes < 0;
      const bool balanced = word(four[0] + four[1]) == 0;
      coding.context = 64 + 32 * (std::abs(votes) - 1) + (balanced ? 0 : 16) + size;
    }
    if (later) coding.context += 128;
  }

  void learn(std::size_t t, unsigned k, const Coding& coding, Number read) {
    const unsigned c = coded_[k];
    const Number e = with_sign(read, bits(c));
    residual_[t][c] = e;
    if (nearest(c)) {
      const auto off = [&](std::size_t i) { return std::abs(palette_[c][i] - coding.prediction); };
      std::size_t place = 0;
      for (std::size_t i = 1; i < palette_[c].size(); ++i) {
        if (off(i) < off(place)) place = i;
      }
      const Number at = (static_cast<Number>(place) + e) & mask_of(bits(c));
      now_[t][c] = palette_[c][static_cast<std::size_t>(
          std::min<Number>(at, static_cast<Number>(palette_[c].size()) - 1))];
    } else {
      now_[t][c] = std::min((coding.prediction + e) & mask_of(bits(c)), largest(c));
    }
    for (unsigned i = 0; i < coding.guesses.size(); ++i) {
      const Number d = coding.guesses[i] - now_[t][c];
      errors_[t][c][i] = std::min<Number>(5461, std::abs(is_low(c) ? with_sign(d & 65535, 16) : d));
    }
    for (unsigned i = 0; i < coding.parts.size(); ++i)
      errors_[t][c][5 + i] = std::min<Number>(5461, std::abs(coding.parts[i] - now_[t][c]));
  }

  RowTables tables_;
  std::vector<unsigned> high_;  ///< by low half: the channel of its high half
  unsigned first_low_ = 0;
  std::vector<std::size_t> lanes_;
  std::size_t x_ = 0, y_ = 0, z_ = 0;
  std::vector<std::vector<std::array<Number, 9>>> errors_;  ///< of guesses, then of parts
};

}  // namespace

std::optional<std::vector<std::vector<std::byte>>> decode_rows(
    const TextureDesc& desc, const std::array<std::uint32_t, 3>& box,
    const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
    std::span<const std::byte> bytes) {
  if (!is_raster(desc) || !may_be_rows(desc, box)) return {};
  Bytes in(bytes);
  std::uint64_t size = 0;
  for (unsigned shift = 0, byte = 128; byte >= 128; shift += 7) {
    byte = in.u8();
    if (in.failed() || shift > 28 || (shift > 0 && byte == 0)) return {};
    size |= std::uint64_t{byte & 127} << shift;
  }
  BitSource source(in.take(size));
  if (in.failed()) return {};
  BitModels models(source);
  std::vector<std::vector<std::byte>> out;
  if (!Rows(desc, models).decode(blocks, held, in, out)) return {};
  return out;
}

}  // namespace gicodec::reference
