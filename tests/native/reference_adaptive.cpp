#include "native/reference_adaptive.h"

#include "native/reference_continuous.h"
#include "native/reference_records.h"
#include "native/reference_vectors.h"
#include "native/reference_voxels.h"

#include <algorithm>
#include <memory>

namespace gicodec::reference {
namespace {

class AdaptiveSets {
 public:
  AdaptiveSets(const TextureDesc& desc, BitModels& models)
      : record_(desc.record),
        models_(models),
        axes_(std::min<unsigned>(3, record_.count)),
        lists_(axes_),
        leaves_(3, Components(axes_, 0)),
        before_(record_.count, 0),
        before_that_(record_.count, 0),
        differences_(record_.count, 0) {}

  bool block(std::size_t n, const std::vector<std::byte>& previous, std::vector<Components>& out) {
    if (n == 0) return true;
    if (previous.empty()) return set(n, out);
    std::vector<Components> records;
    for (std::size_t at = 0; at < previous.size(); at += record_.bytes) {
      records.push_back(unpacked(record_, previous.data() + at));
    }
    if (models_.flag(2, {{3, 0}, {3, 1}, {3, 2}})) {
      out.assign(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(n));
      return true;
    }
    if (!models_.flag(3, {{4, 0}, {4, 1}, {4, 2}})) return set(n, out);
    return paired(n, records, out);
  }

 private:
  bool set(std::size_t n, std::vector<Components>& out) {
    if (n == 0) return true;
    if (!models_.flag(0, {{1, 0}, {1, 1}, {1, 2}})) {
      for (std::size_t i = 0; i < n; ++i) {
        Components values(record_.count, 0);
        others(values, 0, 0, 0);
        out.push_back(values);
      }
      return true;
    }
    std::size_t zeros = 0;
    if (models_.flag(1, {{2, 0}, {2, 1}, {2, 2}})) {
      zeros = models_.source().bypass(16);
      if (zeros < 1 || zeros > n) return false;
    }
    if (n > zeros && !bisect({static_cast<Number>(n - zeros), Components(axes_, 0),
                              std::vector<unsigned>(axes_, 0), 0, 0, 0},
                             out)) {
      return false;
    }
    out.insert(out.end(), zeros, Components(record_.count, 0));
    return true;
  }

  static bool zero(const Components& record) {
    return std::ranges::all_of(record, [](Number value) { return value == 0; });
  }
  /// Whether the place of `a` is before that of `b` in the canonical order.
  [[nodiscard]] bool before(const Components& a, const Components& b) const {
    for (unsigned level = 0; level < 32; ++level) {
      for (unsigned axis = 0; axis < axes_; ++axis) {
        if (level >= bits(axis)) continue;
        const unsigned shift = bits(axis) - 1 - level;
        const Number x = a[axis] >> shift & 1, y = b[axis] >> shift & 1;
        if (x != y) return x < y;
      }
    }
    return false;
  }

  bool paired(std::size_t n, const std::vector<Components>& mirror, std::vector<Components>& out) {
    struct Retained {
      Components record;
      bool changed;
    };
    std::vector<Retained> retained;
    for (std::size_t i = 0; i < mirror.size() && !zero(mirror[i]) && retained.size() < n; ++i) {
      if (models_.source().missing()) return false;
      const auto flag = [&](Number k) {
        return models_.flag(4 + 4 * k + states_ % 4, {{H({5 + 55 * k}), states_ % 4},
                                                      {H({6 + 55 * k, states_ % 256}), 0},
                                                      {H({7 + 55 * k, states_ % 4096}), 0}});
      };
      const bool kept = flag(0), changed = !kept && flag(1);
      states_ = (4 * states_ + (kept ? 0 : changed ? 1 : 2)) % 4096;
      if (kept || changed) retained.push_back({mirror[i], changed});
    }
    std::vector<Components> fresh;
    if (!set(n - retained.size(), fresh)) return false;
    for (Retained& one : retained) {
      if (models_.source().missing()) return false;
      if (one.changed) change(one.record);
    }
    auto next = fresh.begin();
    for (const Retained& one : retained) {
      while (next != fresh.end() && !zero(*next) && before(*next, one.record)) {
        out.push_back(*next++);
      }
      out.push_back(one.record);
    }
    out.insert(out.end(), next, fresh.end());
    return true;
  }

  void change(Components& record) {
    Number q = 1;
    for (unsigned c = axes_; c < record_.count; ++c) {
      const Number previous = record[c], last = differences_[c];
      const bool same = models_.flag(
          176 + c, {{H({230 + c}), 0}, {H({246 + c, q % 256}), 0}, {H({262 + c, last}), 0}});
      q = 2 * q + (same ? 0 : 1);
      if (same) continue;
      const Number z = models_.value(16 + c,
                                     {H({278 + c, 0}), H({294 + c, last}), H({310 + c, previous}),
                                      H({326 + c, previous, last}), H({342 + c, q})},
                                     bits(c));
      const Number difference = z % 2 == 0 ? z / 2 : -((z + 1) / 2);
      record[c] = (previous + difference) & mask_of(bits(c));
      differences_[c] = z;
    }
  }

  struct Node {
    Number n;
    Components place;
    std::vector<unsigned> known;
    unsigned shared, next, history;
  };

  [[nodiscard]] unsigned bits(unsigned axis) const { return record_.components[axis].bits; }
  [[nodiscard]] bool begins(Number coordinate, const Node& node, unsigned a) const {
    const unsigned unknown = 32 - node.known[a];
    return coordinate >> unknown == node.place[a] >> unknown;
  }
  [[nodiscard]] Number side(std::size_t leaf, unsigned a, Number p, unsigned k) const {
    const Number x = leaves_[leaf][a];
    return x < p ? 0 : 1 + std::min<Number>(2, (x - p) >> (31 - k));
  }
  void put(unsigned a, Number coordinate) {
    auto& list = lists_[a];
    const auto at = std::ranges::find(list, coordinate);
    if (at != list.end()) {
      list.erase(at);
    } else if (list.size() == 12) {
      list.pop_back();
    }
    list.insert(list.begin(), coordinate);
  }

  bool bisect(Node node, std::vector<Components>& out) {
    if (models_.source().missing()) return false;
    int axis = -1;
    for (unsigned i = 0; i < axes_ && axis < 0; ++i) {
      const unsigned a = (node.next + i) % axes_;
      if ((node.shared >> a & 1) == 0 && node.known[a] < bits(a)) axis = static_cast<int>(a);
    }
    if (node.n == 1 || axis < 0) return leaf(node, out);
    const auto a = static_cast<unsigned>(axis);
    const unsigned k = node.known[a];
    const Number c = node.n < 8 ? node.n : 8 + std::min(7U, width_of(node.n) - 4);
    const Number match =
        std::ranges::any_of(lists_[a], [&](Number x) { return begins(x, node, a); }) ? 1 : 0;
    if (models_.flag(16 + 16 * a + c, {{H({10 + a, k}), c},
                                       {H({13 + a, 2 * node.shared + match}), c},
                                       {H({16 + a, node.history}), match}})) {
      if (!coordinate(node, a)) put(a, node.place[a]);
      node.shared |= 1U << a;
      return bisect(node, out);
    }
    const unsigned w = width_of(node.n), d = w > 6 ? w - 6 : 0;
    const Number t = node.n >> d;
    const Number s = 4 * side(0, a, node.place[a], k) + side(1, a, node.place[a], k);
    Number m = 1;
    for (unsigned b = d; b < w; ++b) {
      const bool bit = models_.flag({'c', d > 0 ? 63 : t, std::min<Number>(m, 15)},
                                    {{H({40, d, t, s, m >> 4}), m % 16},
                                     {H({41, d, t, std::min(k, 8U), m >> 4}), m % 16},
                                     {H({42, d, t, node.history, m >> 4}), m % 16}});
      m = 2 * m + (bit ? 1 : 0);
    }
    const Number l = ((m - (Number{1} << (w - d))) << d) + models_.source().bypass(d);
    if (l > node.n) return false;
    Node low = node;
    low.known[a] = k + 1;
    low.next = (a + 1) % axes_;
    low.history = (4 * node.history + (l == 0 ? 1 : l == node.n ? 2 : 3)) % 64;
    Node high = low;
    low.n = l;
    high.n = node.n - l;
    high.place[a] += Number{1} << (31 - k);
    return (low.n == 0 || bisect(low, out)) && (high.n == 0 || bisect(high, out));
  }

  /// True if it is of the list.
  bool coordinate(Node& node, unsigned a) {
    const unsigned k = node.known[a], b = bits(a);
    const bool one = node.n == 1;
    const unsigned leaf = one ? 3 : 0;
    Number r = 0;
    const auto list = lists_[a];
    for (std::size_t i = 0; i < list.size() && r < 4; ++i) {
      if (!begins(list[i], node, a)) continue;
      if (models_.flag(64 + (one ? 16 : 0) + 4 * r + a,
                       {{H({20 + leaf + a, 0}), r},
                        {H({26 + leaf + a, b - k}), r},
                        {H({32 + leaf + a, static_cast<Number>(i), node.shared}), r}})) {
        node.place[a] = list[i];
        put(a, list[i]);
        return true;
      }
      ++r;
    }
    Number p = node.place[a];
    unsigned known = k;
    for (unsigned j = 0; one && j < 3 && known < b; ++j, ++known) {
      const Number s0 = side(0, a, p, known), s1 = side(1, a, p, known), s2 = side(2, a, p, known);
      if (models_.flag(128 + 8 * a + j, {{H({50 + a, j, node.shared}), 4 * s0 + s1},
                                         {H({53 + a, j, s0}), 4 * s1 + s2},
                                         {H({56 + a, j, known}), s0}})) {
        p += Number{1} << (31 - known);
      }
    }
    p += Number{models_.source().bypass(b - known)} << (32 - b);
    node.place[a] = p;
    return false;
  }

  bool leaf(Node node, std::vector<Components>& out) {
    for (unsigned a = 0; a < axes_; ++a) {
      if ((node.shared >> a & 1) != 0 || node.known[a] == bits(a)) continue;
      if (coordinate(node, a)) node.shared |= 1U << a;
    }
    Word plane = 0;
    Number cell = 0;
    for (unsigned a = 0; a < axes_; ++a) {
      if ((node.shared >> a & 1) != 0) plane = H({plane, a, node.place[a]});
      cell = cell * 8 + (node.place[a] >> 29);
    }
    leaves_.insert(leaves_.begin(), node.place);
    leaves_.pop_back();
    for (Number i = 0; i < node.n; ++i) {
      if (models_.source().missing()) return false;
      Components values(record_.count, 0);
      for (unsigned a = 0; a < axes_; ++a) values[a] = node.place[a] >> (32 - bits(a));
      others(values, axes_, plane, cell);
      out.push_back(values);
    }
    return true;
  }

  void others(Components& values, unsigned first, Word plane, Number cell) {
    const auto highest = [&](unsigned c, Number value, unsigned most) {
      return bits(c) > most ? value >> (bits(c) - most) : value;
    };
    for (unsigned c = first; c < record_.count; ++c) {
      const Number before = before_[c];
      const Number o = c >= first + 1 ? highest(c - 1, values[c - 1], 12) : 0;
      const Number o2 = c >= first + 2 ? highest(c - 2, values[c - 2], 12) : 0;
      const Number f = c >= first + 1 ? highest(c - 1, values[c - 1], 4) : 0;
      if (bits(c) > 16 && models_.flag(160 + c, {{100 + c, before == before_that_[c] ? 1 : 0},
                                                 {H({116 + c, f}), 0},
                                                 {H({132 + c, plane}), 0}})) {
        values[c] = before;
      } else {
        values[c] = models_.value(
            c,
            {H({150 + c, 0}), H({166 + c, o, o2}), H({182 + c, highest(c, before, 9)}),
             H({198 + c, plane, f}), H({214 + c, cell, f})},
            bits(c));
      }
      before_that_[c] = before;
      before_[c] = values[c];
    }
  }

  const gicodec::Record& record_;
  BitModels& models_;
  unsigned axes_;
  std::vector<std::vector<Number>> lists_;
  std::vector<Components> leaves_;
  Components before_, before_that_;
  Number states_ = 0;
  Components differences_;
};

}  // namespace

std::optional<std::vector<std::vector<std::byte>>> decode_adaptive(
    const TextureDesc& desc, const std::array<std::uint32_t, 3>& box,
    const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
    const std::vector<HeldBrick>& bricks, std::span<const std::byte> stream) {
  BitSource source(stream);
  BitModels models(source);
  std::vector<std::vector<std::byte>> out;
  if (desc.model == Model::unordered) {
    AdaptiveSets sets(desc, models);
    for (const AdaptiveBlock& block : blocks) {
      std::vector<Components> records;
      const auto n = static_cast<std::size_t>(std::ranges::count(block.exists, true));
      if (!sets.block(n, block.previous, records) || source.missing()) return {};
      records.resize(block.exists.size(), Components(desc.record.count, 0));
      out.push_back(packed(desc.record, records));
    }
  } else if (is_voxels(desc)) {
    out = decode_voxels(desc, blocks, bricks, models);
  } else if (desc.model == Model::hemispheres) {
    out = decode_vectors(desc, blocks, held, models);
  } else if (is_raster(desc)) {
    out = decode_continuous(desc, box, blocks, held, models);
    if (out.empty()) return {};
  } else {
    out = decode_records(desc, blocks, models);
  }
  if (!source.finished()) return {};
  return out;
}

}  // namespace gicodec::reference
