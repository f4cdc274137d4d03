#include "native/reference_voxels.h"

#include "native/reference_lights.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <span>

namespace gicodec::reference {
namespace {

using Three32 = std::array<int, 3>;
constexpr int kMaxSide = 1 << 18;

struct Place {
  unsigned level = 0;
  Three32 at{};
  auto operator<=>(const Place&) const = default;
};
std::uint64_t key_of(const std::vector<std::byte>& presence) {
  std::uint64_t all = 0;
  for (unsigned i = 0; i < 8; ++i) all |= std::uint64_t(presence[i]) << 8 * i;
  return all & ((std::uint64_t{1} << 54) - 1);
}
/// Every third bit, from the first on.
int third_bits(std::uint64_t key) {
  int out = 0;
  for (unsigned i = 0; i < 18; ++i) out |= static_cast<int>(key >> 3 * i & 1) << i;
  return out;
}
Place place_of(const std::vector<std::byte>& presence) {
  const std::uint64_t key = key_of(presence);
  return {static_cast<unsigned>(presence[7]),
          {third_bits(key), third_bits(key >> 1), third_bits(key >> 2)}};
}
bool is_named(const std::vector<std::byte>& presence, unsigned voxel) {
  return (static_cast<unsigned>(presence[8 + voxel / 8]) >> voxel % 8 & 1) != 0;
}

/// Bits of i, j and k in turn.
unsigned morton(const Three32& v) {
  unsigned out = 0;
  for (unsigned bit = 0; bit < 3; ++bit) {
    for (unsigned a = 0; a < 3; ++a) out |= unsigned(v[a] >> bit & 1) << (3 * bit + a);
  }
  return out;
}
int squared(const Three32& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }
Three32 sum_of(const Three32& a, const Three32& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Three32 halves_of(const Three32& v) { return {v[0] / 2, v[1] / 2, v[2] / 2}; }

std::vector<Three32> voxels_around() {
  std::vector<Three32> all;
  for (int at = 0; at < 27; ++at) {
    if (at != 13) all.push_back({at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1});
  }
  std::ranges::stable_sort(all, {}, squared);
  return all;
}

bool is_lit(const Codes& codes) { return codes.color != Three{} || codes.exponent != 0; }

class Voxels : Lights {
 public:
  Voxels(const TextureDesc& desc, const std::vector<HeldBrick>& held, BitModels& models)
      : Lights(desc.record, models), n_side_(desc.block.y), around_(voxels_around()) {
    predictors_.dark_too = false;
    for (const HeldBrick& one : held) {
      const auto mask = std::span(one.presence).subspan(8);
      if (std::ranges::all_of(mask, [](std::byte b) { return b == std::byte{0}; })) continue;
      Brick brick = empty_brick(one.presence);
      for (unsigned v = 0; v < brick.voxels.size(); ++v) {
        brick.voxels[v].now = scale_.vertex_of(one.records, records_at(v));
        brick.voxels[v].done = brick.voxels[v].exists;
      }
      held_.emplace(brick.place, std::move(brick));
    }
    for (int v = 0; v < n_side_ * n_side_ * n_side_; ++v) {
      order_.push_back({v % n_side_, v / n_side_ % n_side_, v / n_side_ / n_side_});
    }
    std::ranges::sort(order_, {}, morton);
  }

  std::vector<std::byte> block(const AdaptiveBlock& in) {
    brick_ = empty_brick(in.presence);
    if (!in.previous_presence.empty() &&
        std::ranges::equal(std::span(in.previous_presence).first(8),
                           std::span(in.presence).first(8))) {
      for (unsigned v = 0; v < brick_.voxels.size(); ++v) {
        if (!is_named(in.previous_presence, v)) continue;
        brick_.voxels[v].had = true;
        brick_.voxels[v].before = scale_.vertex_of(in.previous, records_at(v));
      }
    }
    for (auto first = order_.begin(); first != order_.end(); first += 8) {
      siblings_.clear();
      for (const Three32& at : std::span(first, 8)) {
        if (brick_.voxels[number_of(at)].exists) siblings_.push_back(at);
      }
      for (const Three32& at : siblings_) code_occupancy(at, brick_.voxels[number_of(at)]);
      for (const Three32& at : siblings_) {
        Voxel& voxel = brick_.voxels[number_of(at)];
        if (*voxel.occupancy_zero) continue;
        code(at, voxel);
        voxel.now = now_;
      }
      for (const Three32& at : siblings_) {
        Voxel& voxel = brick_.voxels[number_of(at)];
        voxel.occupancy_zero.reset();
        voxel.occupancy_lit.reset();
      }
      if (models_.source().missing()) return {};
    }
    for (Voxel& voxel : brick_.voxels) voxel.done = voxel.exists;
    std::vector<std::byte> out;
    for (const Voxel& voxel : brick_.voxels) {
      const auto bytes = scale_.bytes_of(voxel.now);
      out.insert(out.end(), bytes.begin(), bytes.end());
    }
    coded_.emplace(brick_.place, brick_);
    return out;
  }

 private:
  struct Voxel : Known {
    bool exists = false, done = false;
    bool had = false;  ///< there is a previous voxel
    std::optional<std::array<bool, 6>> occupancy_lit;
    [[nodiscard]] bool lit(unsigned h) const {
      return occupancy_lit ? (*occupancy_lit)[h] : is_lit(now[h]);
    }
    [[nodiscard]] bool has_previous() const { return before != Vertex{}; }
  };
  struct Brick {
    Place place;
    std::vector<Voxel> voxels;
  };

  [[nodiscard]] unsigned number_of(const Three32& at) const {
    return static_cast<unsigned>(at[0] + n_side_ * (at[1] + n_side_ * at[2]));
  }
  /// Records are in rows along x, six of a voxel, so that voxels follow each other.
  [[nodiscard]] static std::size_t records_at(unsigned voxel) { return std::size_t{6} * voxel; }
  [[nodiscard]] Brick empty_brick(const std::vector<std::byte>& presence) const {
    Brick brick{place_of(presence), {}};
    brick.voxels.resize(static_cast<std::size_t>(n_side_ * n_side_ * n_side_));
    for (unsigned v = 0; v < brick.voxels.size(); ++v) {
      brick.voxels[v].exists = is_named(presence, v);
    }
    return brick;
  }
  [[nodiscard]] const Brick* brick_at(const Place& place) const {
    if (std::ranges::any_of(place.at, [](int c) { return c < 0 || c >= kMaxSide; })) return {};
    if (const auto at = coded_.find(place); at != coded_.end()) return &at->second;
    const auto at = held_.find(place);
    return at == held_.end() ? nullptr : &at->second;
  }

  void find_neighbours(const Three32& at) {
    near_.clear();
    for (const Three32& by : around_) {
      Three32 there = sum_of(at, by);
      Place place = brick_.place;
      for (unsigned a = 0; a < 3; ++a) {
        const int beyond = there[a] < 0 ? -1 : there[a] >= n_side_ ? 1 : 0;
        place.at[a] += beyond;
        there[a] -= beyond * n_side_;
      }
      const Brick* const brick = place == brick_.place ? &brick_ : brick_at(place);
      if (brick == nullptr) continue;
      const Voxel& voxel = brick->voxels[number_of(there)];
      const bool earlier = brick == &brick_ ? morton(there) < morton(at) : voxel.done;
      if (!voxel.exists || !earlier || (has_previous_ && !voxel.had)) continue;
      near_.push_back({squared(by), &voxel});
      if (near_.size() == 3) break;
    }
  }
  void find_parent(const Three32& at) {
    Place place = brick_.place;
    place.level = (place.level + 1) % 256;
    place.at = halves_of(place.at);
    Three32 there{};
    for (unsigned a = 0; a < 3; ++a) there[a] = (brick_.place.at[a] % 2 * n_side_ + at[a]) / 2;
    const Brick* const brick = brick_at(place);
    parent_ = brick == nullptr ? nullptr : &brick->voxels[number_of(there)];
    if (parent_ != nullptr && !parent_->exists) parent_ = nullptr;
  }
  void split_siblings(const Three32& at) {
    earlier_.clear();
    others_.clear();
    for (const Three32& other : siblings_) {
      (morton(other) < morton(at) ? earlier_ : others_).push_back(&brick_.voxels[number_of(other)]);
    }
  }
  static Number lit_of(const std::vector<const Voxel*>& voxels, unsigned h) {
    return std::ranges::count_if(voxels, [h](const Voxel* v) { return v->lit(h); });
  }

  /// The occupancy of a voxel, which comes before the light of its siblings.
  void code_occupancy(const Three32& at, Voxel& voxel) {
    has_previous_ = voxel.has_previous();
    find_neighbours(at);
    find_parent(at);
    split_siblings(at);
    voxel.occupancy_zero = !has_light();
    voxel.occupancy_lit.emplace();
    if (*voxel.occupancy_zero) return;
    const auto to_come = static_cast<Number>(others_.size()), v = static_cast<Number>(near_.size());
    const auto as_voxel = [](const Near& n) { return static_cast<const Voxel*>(n.vertex); };
    Number b = 64, m = 0;
    if (v > 0) b = 0;
    for (unsigned h = 0; v > 0 && h < 6; ++h) b += as_voxel(near_[0])->lit(h) ? 1 << h : 0;
    for (unsigned h = 0; h < 6; ++h) {
      const Number p = !has_previous_ ? 0 : is_lit(voxel.before[h]) ? 2 : 1;
      const Number a = parent_ == nullptr ? 0 : parent_->lit(h) ? 2 : 1;
      const Number v0 =
          std::ranges::count_if(near_, [&](const Near& n) { return !as_voxel(n)->lit(h); });
      const bool lit = models_.flag(static_cast<unsigned>(4 + p),
                                    {{H({7, 4 * v0 + v, a, p}), h},
                                     {H({8, b, m, p}), h},
                                     {H({9, lit_of(earlier_, h), to_come, a, h}), p}});
      (*voxel.occupancy_lit)[h] = lit;
      m += lit ? 1 << h : 0;
    }
  }

  /// What the voxels before leave of the parent's.
  template <class Of>
  [[nodiscard]] std::array<Light, 6> rest(Of of) const {
    std::array<Light, 6> out{};
    for (unsigned h = 0; h < 6; ++h) {
      const Three p = scale_.light_of(of(*parent_)[h]).color;
      const Number left = lit_of(others_, h);
      for (unsigned i = 0; i < 3 && left > 0; ++i) {
        Number sum = left * p[i];
        for (const Voxel* one : earlier_) {
          if (one->lit(h)) sum += p[i] - scale_.light_of(of(*one)[h]).color[i];
        }
        out[h].color[i] = brought_into(sum / left, 0, kMax);
      }
    }
    return out;
  }
  void add_rest_predictor(const Voxel& voxel) {
    Predictor one{static_cast<Number>(others_.size())};
    one.nearness = 1 << 14;
    one.lights = rest_ = rest([](const Voxel& of) -> const Vertex& { return of.now; });
    if (has_previous_ && parent_->had &&
        std::ranges::all_of(earlier_, [](const Voxel* v) { return v->had; })) {
      const auto old = rest([](const Voxel& of) -> const Vertex& { return of.before; });
      for (unsigned h = 0; h < 6; ++h) {
        one.lights[h] = moved(scale_.light_of(voxel.before[h]), one.lights[h], old[h]);
      }
    }
    predictors_.all.push_back(one);
  }

  void code(const Three32& at, const Voxel& voxel) {
    has_previous_ = voxel.has_previous();
    now_ = {};
    find_neighbours(at);
    find_parent(at);
    split_siblings(at);
    predict(voxel.before, parent_ == nullptr, parent_ == nullptr ? 0 : scale_.top_of(parent_->now));
    if (parent_ != nullptr) add_rest_predictor(voxel);
    residuals_ = {};
    lights_ = {};
    same_ = 0;
    for (unsigned h = 0; h < 6; ++h) {
      hemisphere(h, voxel);
      lights_[h] = scale_.light_of(now_[h]);
      compare(h);
    }
    masks_ = has_previous_ ? same_ : 0;
    last_ = now_;
    had_light_ = true;
  }

  void hemisphere(unsigned h, const Voxel& voxel) {
    const Vertex& previous = voxel.before;
    const bool lit = voxel.lit(h), by_green = has_previous_ && is_lit(previous[h]) == lit;
    if (by_green && ((!lit && !scale_.floats()) || is_same(h))) {
      now_[h] = previous[h];
      same_ |= Number{1} << h;
      return;
    }
    if (lit) {
      predictors_.weigh([](const Predictor&) { return Number{0}; }, h);
      spread_of_predictors(h);
      complete(h);
      color(h);
    }
    if (scale_.floats()) alpha(h, previous);
  }
  void complete(unsigned h) {
    completed_.reset();
    if (parent_ != nullptr && lit_of(others_, h) == 1) {
      completed_ = {rest_[h].color, 1 + lit_of(earlier_, h), scale_.step_of(parent_->now[h])};
    }
    closes_ = completed_.has_value();
    b_ = 0;
  }
  bool is_same(unsigned h) {
    const auto v = static_cast<Number>(near_.size());
    const Number as_previous = std::ranges::count_if(
        near_, [&](const Near& n) { return n.vertex->now[h] == n.vertex->before[h]; });
    const Number y = v == 0 ? 9 : 8 * as_previous / v;
    const Number a = parent_ == nullptr || !parent_->had     ? 2
                     : parent_->now[h] == parent_->before[h] ? 1
                                                             : 0;
    return models_.flag(
        2, {{H({4, y, a}), h}, {H({5, same_, h, a}), y}, {H({6, y, masks_ >> h & 1}), a}});
  }
  void alpha(unsigned h, const Vertex& previous) {
    const Number before = h % 2 == 1      ? now_[h - 1].alpha
                          : has_previous_ ? previous[h].alpha
                                          : last_[h].alpha;
    const Number o = h == 0 ? last_[5].alpha : now_[h - 1].alpha;
    const Number s = h % 2, coarse = Number{static_cast<Word>(before)} / 64;
    const Number by = models_.number(
        13,
        {H({20, s, before}), H({21, s, o, h}), H({22, s}), H({23, h, coarse}), H({24, before, o})},
        {{H({240, s}), 0}, {H({241, before}), s}, {H({242, h}), 0}});
    now_[h].alpha = scale_.color_code(before + by);
  }

  int n_side_;
  std::vector<Three32> around_, order_;
  std::map<Place, Brick> coded_, held_;
  Number masks_ = 0;  ///< which hemispheres of the last voxel with light were the same

  Brick brick_;  ///< the one that is coded

  // Of a voxel.
  const Voxel* parent_ = nullptr;
  std::vector<Three32> siblings_;
  std::vector<const Voxel*> earlier_, others_;  ///< of its siblings; itself among the others
  std::array<Light, 6> rest_{};
  Number same_ = 0;
};

}  // namespace

bool is_voxels(const TextureDesc& desc) {
  return desc.model == Model::octree && (desc.record.format == Format::E5B9G9R9_UFLOAT_PACK32 ||
                                         desc.record.format == Format::R16G16B16A16_SFLOAT);
}

std::vector<std::vector<std::byte>> decode_voxels(const TextureDesc& desc,
                                                  const std::vector<AdaptiveBlock>& blocks,
                                                  const std::vector<HeldBrick>& held,
                                                  BitModels& models) {
  std::vector<std::size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const auto &x = blocks[a].presence, &y = blocks[b].presence;
    return x[7] != y[7] ? x[7] > y[7] : key_of(x) < key_of(y);
  });
  Voxels voxels(desc, held, models);
  std::vector<std::vector<std::byte>> out(blocks.size());
  for (const std::size_t i : order) {
    out[i] = voxels.block(blocks[i]);
    if (models.source().missing()) return {};
  }
  return out;
}

}  // namespace gicodec::reference
