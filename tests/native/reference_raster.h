// The raster of a chunk for the reference decoder: its texels, channels, forms and neighbours
// (docs/native/continuous.md, sections Raster to Neighbours).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"
#include "native/reference_records.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace gicodec::reference {

using Texel = std::vector<Number>;  ///< of every channel

struct ChannelOf {
  unsigned component;
  Number bits;
  ComponentType type;
  bool mantissa = false;
  [[nodiscard]] Number s() const { return Number{1} << (bits - 1); }
  [[nodiscard]] bool is_float() const {
    return (type == ComponentType::ufloat && bits >= 10) ||
           (type == ComponentType::sfloat && bits == 16);
  }
  /// The ordinal is light.
  [[nodiscard]] bool is_linear() const {
    return type == ComponentType::ufloat
               ? bits < 10
               : bits <= 16 && (type == ComponentType::unorm || type == ComponentType::uint);
  }
  [[nodiscard]] Number ordinal(Number v) const {
    if (type == ComponentType::snorm) return v ^ s();
    if (type == ComponentType::sfloat) return v < s() ? v + s() : 2 * s() - 1 - v;
    return v;
  }
  [[nodiscard]] Number component_bits(Number o) const {
    if (type == ComponentType::snorm) return o ^ s();
    if (type == ComponentType::sfloat) return o >= s() ? o - s() : 2 * s() - 1 - o;
    return o;
  }
};

class RasterState {
 protected:
  RasterState(const TextureDesc& desc, BitModels& models) : desc_(desc), models_(models) {
    const auto used = desc.record.used();
    std::optional<unsigned> exponent;
    for (unsigned c = 0; c < used.size() && !exponent; ++c) {
      if (used[c].type == ComponentType::exponent && used[c].bits <= 5) exponent = c;
    }
    shared_ = exponent.has_value();
    const auto add = [&](unsigned c) {
      const bool mantissa = shared_ && used[c].type == ComponentType::ufloat && used[c].bits < 10;
      channels_.push_back({c, used[c].bits, used[c].type, mantissa});
    };
    if (exponent) add(*exponent);
    for (unsigned i = 0; i < used.size(); ++i) {
      const unsigned c = used.size() >= 3 && i < 2 ? 1 - i : i;
      if (exponent != c) add(c);
    }
  }

  static constexpr std::size_t kNone = SIZE_MAX;
  enum Around { W, N, NW, NE, WW, NN, Z, ZW, ZN };

  std::size_t where(const std::array<std::uint32_t, 3>& block, std::size_t record) const {
    const auto& b = desc_.block;
    const std::size_t x = (block[0] - first_[0]) * b.x + record % b.x,
                      y = (block[1] - first_[1]) * b.y + record / b.x % b.y,
                      z = (block[2] - first_[2]) * b.z + record / b.x / b.y;
    return x + size_[0] * (y + size_[1] * z);
  }
  void put(const std::array<std::uint32_t, 3>& block, std::span<const std::byte> records,
           std::vector<Texel>& to) {
    for (std::size_t r = 0; r < record_count(desc_.block); ++r) {
      const auto values = unpacked(desc_.record, records.data() + r * desc_.record.bytes);
      for (unsigned c = 0; c < channels_.size(); ++c) {
        to[where(block, r)][c] = channels_[c].ordinal(values[channels_[c].component]);
      }
    }
  }
  void lay_out(const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held) {
    std::array<std::uint32_t, 3> last{};
    first_ = blocks[0].place;
    for (const auto& block : blocks) {
      for (unsigned a = 0; a < 3; ++a) {
        first_[a] = std::min(first_[a], block.place[a]);
        last[a] = std::max(last[a], block.place[a]);
      }
    }
    const std::array<unsigned, 3> sides{desc_.block.x, desc_.block.y, desc_.block.z};
    for (unsigned a = 0; a < 3; ++a) size_[a] = std::size_t{last[a] - first_[a] + 1} * sides[a];
    Texel zero;
    for (const auto& channel : channels_) zero.push_back(channel.ordinal(0));
    now_.assign(size_[0] * size_[1] * size_[2], zero);
    is_coded_.assign(now_.size(), false);
    for (const auto& [at, records] : held) {
      bool inside = true;
      for (unsigned a = 0; a < 3; ++a) inside = inside && at[a] >= first_[a] && at[a] <= last[a];
      if (inside) put(at, records, now_);
    }
    update_ = !blocks[0].previous.empty();
    if (update_) past_ = now_;
    for (const auto& block : blocks) {
      if (update_) put(block.place, block.previous, past_);
      for (std::size_t r = 0; r < block.exists.size(); ++r) {
        is_coded_[where(block.place, r)] = block.exists[r];
      }
    }
    repeats_.assign(now_.size(), 0);
    residual_.assign(now_.size(), Texel(channels_.size(), 0));
    error_.assign(now_.size(), std::vector<std::array<Number, 10>>(channels_.size()));
  }

  bool forms() {
    auto& source = models_.source();
    const Number texels = std::ranges::count(is_coded_, true);
    form_.assign(channels_.size(), 0);
    of_.assign(channels_.size(), 0);
    palette_.assign(channels_.size(), {});
    for (unsigned c = 0; c < channels_.size(); ++c) {
      form_[c] = source.bypass(2);
      if (form_[c] >= 2) {
        of_[c] = source.bypass(4);
        if (of_[c] >= c || channels_[of_[c]].bits != channels_[c].bits) return false;
        if (form_[c] == 2 && palette_[of_[c]].empty()) return false;
        if (form_[c] == 2) palette_[c] = palette_[of_[c]];
        if (form_[c] == 3 && form_[of_[c]] == 3) return false;
      }
      if (form_[c] == 1 && !palette(c, texels)) return false;
    }
    if (shared_ && form_[0] != 0 && palette_[0].size() != 1) return false;
    for (unsigned c = 0; c < channels_.size(); ++c) {
      if (palette_[c].size() == 1) {
        for (std::size_t t = 0; t < now_.size(); ++t) {
          if (is_coded_[t]) now_[t][c] = palette_[c][0];
        }
      } else if (form_[c] != 3) {
        coded_.push_back(c);
        if (!has_places(c)) continue;
        for (auto& texel : now_) texel[c] = place_of(c, texel[c]);
        for (auto& texel : past_) texel[c] = place_of(c, texel[c]);
      }
    }
    lead_ = !coded_.empty() && shared_ && coded_[0] == 0 ? 1 : 0;
    return true;
  }
  bool palette(unsigned c, Number texels) {
    auto& source = models_.source();
    const Number count = source.bypass(24);
    if (count < 1 || count > texels) return false;
    Number o = source.bypass(static_cast<unsigned>(channels_[c].bits)), w1 = 0, w2 = 0;
    palette_[c].push_back(o);
    for (Number i = 1; i < count; ++i) {
      const Number t = top_of(o, static_cast<unsigned>(channels_[c].bits), 6);
      const Number more =
          models_.number(0, {H({1, 0}), H({2, w1}), H({3, w1, w2}), H({4, t}), H({4, t, w1})},
                         {{5, 0}, {5, 1}, {5, 2}});
      o += more + 1;
      if (more < 0 || o > mask_of(static_cast<unsigned>(channels_[c].bits)) || source.missing())
        return false;
      palette_[c].push_back(o);
      w2 = w1;
      w1 = width_of(more);
    }
    return true;
  }
  bool has_places(unsigned c) const { return palette_[c].size() > 1 && !channels_[c].mantissa; }
  Number place_of(unsigned c, Number ordinal) const {
    const auto& p = palette_[c];
    const auto at = std::ranges::lower_bound(p, ordinal) - p.begin();
    return std::min<Number>(at, static_cast<Number>(p.size()) - 1);
  }
  Number ordinal_at(unsigned c, Number value) const {
    return has_places(c) ? palette_[c][static_cast<std::size_t>(value)] : value;
  }
  Number final_ordinal(std::size_t t, unsigned c) const {
    return form_[c] == 3 ? final_ordinal(t, of_[c]) : ordinal_at(c, now_[t][c]);
  }

  /// Section Neighbours.
  void place(std::size_t t) {
    const std::size_t nx = size_[0], x = t % nx, y = t / nx % size_[1], z = t / nx / size_[1];
    const auto first_of = [](std::initializer_list<std::pair<bool, std::size_t>> choices) {
      for (const auto& [exists, at] : choices) {
        if (exists) return at;
      }
      return kNone;
    };
    deep_ = z > 0;
    at_[Z] = first_of({{deep_, t - nx * size_[1]}});
    at_[ZW] = first_of({{deep_ && x > 0, at_[Z] - 1}, {true, at_[Z]}});
    at_[ZN] = first_of({{deep_ && y > 0, at_[Z] - nx}, {true, at_[Z]}});
    at_[W] = first_of({{x > 0, t - 1}, {y > 0, t - nx}, {true, at_[Z]}});
    at_[N] = first_of({{y > 0, t - nx}, {true, at_[W]}});
    at_[NW] = first_of({{x > 0 && y > 0, t - nx - 1}, {true, at_[N]}});
    at_[NE] = first_of({{x + 1 < nx && y > 0, t - nx + 1}, {true, at_[N]}});
    at_[WW] = first_of({{x > 1, t - 2}, {true, at_[W]}});
    at_[NN] = first_of({{y > 1, t - 2 * nx}, {true, at_[N]}});
  }
  Texel all(std::size_t t, const std::vector<Texel>& from) const {
    return t == kNone ? Texel(channels_.size(), 0) : from[t];
  }
  Texel now(Around a) const { return all(at_[a], now_); }
  bool equal(const Texel& a, const Texel& b) const {
    return std::ranges::all_of(coded_, [&](unsigned c) { return a[c] == b[c]; });
  }

  /// In sixteenths, of mantissas in units of the exponent `exponent`.
  Number value(const Texel& from, unsigned c, Number exponent) const {
    const Number v = 16 * from[c];
    if (!channels_[c].mantissa) return v;
    const Number up = from[0] - exponent;
    if (up >= 0) return v << std::min<Number>(up, 8);
    const Number d = std::min<Number>(-up, 30);
    return (v + (Number{1} << (d - 1))) >> d;
  }

  const TextureDesc& desc_;
  BitModels& models_;
  std::vector<ChannelOf> channels_;
  bool shared_ = false, update_ = false, deep_ = false;
  std::array<std::uint32_t, 3> first_{};
  std::array<std::size_t, 3> size_{};
  std::vector<Texel> now_, past_, residual_;
  std::vector<bool> is_coded_;
  std::vector<Number> repeats_;
  std::vector<std::vector<std::array<Number, 10>>> error_;
  std::vector<unsigned> form_, of_, coded_;
  std::vector<std::vector<Number>> palette_;
  unsigned lead_ = 0;
  std::array<std::size_t, 9> at_{};
};

}  // namespace gicodec::reference
