// Codes and values of light for the reference decoder (docs/native/light.md).
#pragma once

#include "native/reference_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace gicodec::reference {

using Three = std::array<Number, 3>;

struct Codes {
  Three color{}, direction{};
  Number exponent = 0, alpha = 0;
  bool operator==(const Codes&) const = default;
};
using Vertex = std::array<Codes, 6>;

struct Light {
  Three direction{}, color{};
};
[[nodiscard]] inline Number sum_of(const Three& v) { return v[0] + v[1] + v[2]; }

struct Parts {
  Number e, m;
};
[[nodiscard]] inline Number shift(Number v, Number l) {
  if (l < 0) return l < -62 ? 0 : v >> -l;
  if (v == 0) return 0;
  return width_of(v) + l > 41 ? kMax : v << l;
}
[[nodiscard]] inline Number steps(Number v, Number s) {
  if (s > 62) return 0;
  return std::min(s >= 1 ? (v + (Number{1} << (s - 1))) >> s : v << -s, Number{1} << 40);
}

/// Floats of some size: their parts, and their codes, which are in their order.
struct Floats {
  unsigned bits;
  Number fraction;  ///< bits of it
  Number top;       ///< the greatest exponent
  Number one;       ///< what a color's exponent e counts as, more than that of the top

  [[nodiscard]] Number most() const { return (top << fraction) + mask_of(unsigned(fraction)); }
  [[nodiscard]] Parts parts_of(Number f) const {
    f = std::min(f & mask_of(bits - 1), most());
    const Number unit = Number{1} << fraction;
    if (f < unit) return {1, f};
    return {f >> fraction, f % unit + unit};
  }
  [[nodiscard]] Number of(Number m, Number e) const {
    if (m == 0) return 0;
    const Number o = width_of(m) - fraction - 1, e2 = e + o;
    if (e2 > top) return most();
    const Number s = e2 < 1 ? o + 1 - e2 : o;
    return (s < 0    ? m << -s
            : s > 62 ? 0
                     : m >> s) +
           (std::max<Number>(e2, 1) - 1) * (Number{1} << fraction);
  }
  [[nodiscard]] Number code_of(Number f) const {
    return f >> (bits - 1) != 0 ? -1 - (f & mask_of(bits - 1)) : f;
  }
  [[nodiscard]] Number of_code(Number code) const {
    return code < 0 ? (-1 - code) | Number{1} << (bits - 1) : code;
  }
};
inline constexpr Floats kFloats{32, 23, 254, 12}, kHalves{16, 10, 30, 25};

[[nodiscard]] inline Number brought(Number x) {
  const Number by = std::min<Number>(half(x), 9);
  return x < 0 ? 9 - by : 9 + by;
}
[[nodiscard]] inline Number root_of(Number x) {
  auto r = static_cast<Number>(std::sqrt(static_cast<double>(x)));
  while (r * r > x) --r;
  while ((r + 1) * (r + 1) <= x) ++r;
  return r;
}
[[nodiscard]] inline unsigned over(Number x, unsigned bits) {
  return width_of(x) > bits ? width_of(x) - bits : 0;
}
[[nodiscard]] inline Number ratio_of(const Three& color, unsigned c) {
  return color[1] == 0 ? 0 : std::min<Number>((color[c] << 12) / color[1], 1000000);
}

[[nodiscard]] inline Number direction_distance(const Three& a, const Three& b) {
  Number sum = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const Number by = std::abs(a[i] - b[i]) >> 14;
    sum += by * by;
  }
  return sum >> 7;
}
[[nodiscard]] inline Number color_distance(const Three& a, const Three& b) {
  const unsigned by = over(std::max(std::ranges::max(a), std::ranges::max(b)), 20);
  Number u = 0, v = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const Number x = a[i] >> by, y = b[i] >> by;
    u += (x - y) * (x - y);
    v += x * x + y * y;
  }
  return v == 0 ? 0 : (u << 14) / v;
}

struct Unit {
  Three v{};
  Number length = 0;
};
[[nodiscard]] inline Unit unit_of(Three v, unsigned h) {
  const unsigned a = h / 2;
  const Number sigma = h % 2 == 1 ? -1 : 1;
  if (v[a] * sigma < 0) v[a] = 0;
  Number greatest = 0, squares = 0;
  for (const Number x : v) greatest = std::max(greatest, std::abs(x));
  const unsigned by = over(greatest, 30);
  for (Number& x : v) {
    x = x < 0 ? -(-x >> by) : x >> by;
    squares += x * x;
  }
  const Number length = root_of(squares);
  Unit unit;
  if (length == 0) {
    unit.v[a] = sigma * (1 << 24);
    return unit;
  }
  for (unsigned i = 0; i < 3; ++i) unit.v[i] = v[i] * (1 << 24) / length;
  unit.length = length << by;
  return unit;
}

/// Records, their codes and values. With directions or without, of vertices and voxels.
class Scale {
 public:
  explicit Scale(const Record& record)
      : record_(record),
        directed_(record.count > 4),
        floats_(record.components[3].type != ComponentType::exponent),
        color_(directed_ ? kFloats : kHalves) {}

  [[nodiscard]] bool floats() const { return floats_; }
  /// The vertex's top.
  void set_top(Number t) { top_ = t != 0 ? t : !floats_ ? 16 : directed_ ? 127 : 15; }
  [[nodiscard]] Number top() const { return top_; }

  [[nodiscard]] Vertex vertex_of(const std::vector<std::byte>& bytes, std::size_t at = 0) const {
    Vertex out;
    for (std::size_t h = 0; h < 6; ++h) {
      const Components values = unpacked(record_, bytes.data() + (at + h) * record_.bytes);
      for (std::size_t i = 0; i < 3; ++i) {
        out[h].color[i] = floats_ ? color_.code_of(values[i]) : values[i];
        if (!directed_) continue;
        const Number v = values[(floats_ ? 3 : 4) + i];
        out[h].direction[i] = floats_ ? color_.code_of(v) : with_sign(v, 8);
      }
      if (!floats_) out[h].exponent = values[3];
      if (floats_ && !directed_) out[h].alpha = color_.code_of(values[3]);
    }
    return out;
  }
  [[nodiscard]] std::vector<std::byte> bytes_of(const Vertex& vertex) const {
    std::vector<Components> all;
    for (const Codes& codes : vertex) {
      Components values;
      for (const Number c : codes.color) values.push_back(floats_ ? color_.of_code(c) : c);
      if (!floats_) values.push_back(codes.exponent);
      if (floats_ && !directed_) values.push_back(color_.of_code(codes.alpha));
      for (const Number c : codes.direction) {
        if (directed_) values.push_back(floats_ ? color_.of_code(c) : c & 255);
      }
      all.push_back(values);
    }
    return packed(record_, all);
  }

  [[nodiscard]] Number coordinate_value(Number code) const {
    if (!directed_) return 0;
    if (!floats_) return 132104 * code;
    const Parts p = kFloats.parts_of(kFloats.of_code(code));
    const Number v = std::min<Number>(shift(p.m, p.e - 126), 1 << 25);
    return code < 0 ? -v : v;
  }
  [[nodiscard]] Number color_value(Number code, Number exponent) const {
    if (!floats_) return shift(code, exponent - top_ + 27);
    if (code < 1) return 0;
    const Parts p = color_.parts_of(code);
    return shift(p.m, p.e - top_ + color_.one);
  }
  /// What a mantissa of 1 or the next code of green adds.
  [[nodiscard]] Number step_of(const Codes& codes) const {
    if (!floats_) return color_value(1, codes.exponent);
    return color_value(codes.color[1] + 1, 0) - color_value(codes.color[1], 0);
  }
  [[nodiscard]] Light light_of(const Codes& codes) const {
    Light light;
    for (unsigned i = 0; i < 3; ++i) {
      light.direction[i] = coordinate_value(codes.direction[i]);
      light.color[i] = color_value(codes.color[i], codes.exponent);
    }
    return light;
  }
  [[nodiscard]] Number top_of(const Codes& codes) const {
    if (!floats_) return codes.color != Three{} ? codes.exponent : 0;
    Number top = 0;
    for (const Number code : codes.color) {
      if (code > 0) top = std::max(top, color_.parts_of(code).e);
    }
    return top;
  }
  [[nodiscard]] Number top_of(const Vertex& vertex) const {
    Number top = 0;
    for (const Codes& codes : vertex) top = std::max(top, top_of(codes));
    return top;
  }
  struct Next {
    Number code, quarter;
  };
  [[nodiscard]] Next next_coordinate(Number v) const {
    if (floats_) {
      const Number f = kFloats.of(std::abs(v), 126);
      return {kFloats.code_of(v < 0 ? f | Number{1} << 31 : f), 0};
    }
    const Number n = (127 * v + (1 << 23)) >> 22;
    return {brought_into(n >> 2, -127, 127), n & 3};
  }
  [[nodiscard]] Number next_color(Number v, Number exponent) const {
    if (floats_) return color_.of(v, top_ - color_.one);
    return std::min<Number>(steps(v, exponent - top_ + 27), 511);
  }
  [[nodiscard]] Number coordinate_code(Number x) const { return with_sign(x, floats_ ? 32 : 8); }
  [[nodiscard]] Number color_code(Number x) const {
    return floats_ ? with_sign(x, color_.bits) : x & 511;
  }

 private:
  const Record& record_;
  bool directed_, floats_;
  Floats color_;
  Number top_ = 0;
};

}  // namespace gicodec::reference
