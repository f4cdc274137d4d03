// Match chunks, from docs/native/matches.md.
#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace gicodec::reference {
namespace {

/// Which learned bit: the tree, what the tree is for, and the node.
enum Tree { kIsMatch, kIsLast, kLiteral, kWhich, kLength, kDistance, kRest };

class Source {
 public:
  explicit Source(std::span<const std::byte> stream) : in_(stream) {}

  bool bit(Tree tree, Number a, Number b, Number node) {
    Learned& l = bits_[{tree, a, b, node}];
    const bool one = in_.bit(static_cast<Word>(brought_into(l.q, 32, 65504)));
    const Number d = one ? 65535 - l.q : l.q;
    const Number step = (2 * d + 2 * l.a + 2) / (2 * l.a + 3);
    l.q += one ? step : -step;
    l.a = std::min<Number>(l.a + 1, 254);
    return one;
  }
  Number symbol(Tree tree, Number a, Number b, unsigned bits) {
    Number x = 1;
    for (unsigned i = 0; i < bits; ++i) x = 2 * x + (bit(tree, a, b, x) ? 1 : 0);
    return x - (Number{1} << bits);
  }
  /// Trees of a number: b = −1 is its width's, −2 that of the last bits, others those of widths.
  Number number(Tree tree, Number a) {
    const Number width = symbol(tree, a, -1, 5);
    if (width < 2) return width;
    auto left = static_cast<unsigned>(width - 1);
    const unsigned first = std::min(left, 4U);
    Number value = 1 << first | symbol(tree, a, width, first);
    left -= first;
    const unsigned last = left >= 4 ? 4 : 0;
    value = value << (left - last) | in_.bypass(left - last);
    if (last != 0) value = value << 4 | symbol(tree, a, -2, 4);
    return value;
  }
  Number bypass(unsigned n) { return in_.bypass(n); }
  [[nodiscard]] bool missing() const { return in_.missing(); }
  [[nodiscard]] bool finished() const { return in_.finished(); }

 private:
  struct Learned {
    Number q = 32768, a = 0;
  };
  BitSource in_;
  std::map<std::tuple<Tree, Number, Number, Number>, Learned> bits_;
};

}  // namespace

std::optional<std::vector<std::vector<std::byte>>> decode_matches(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks,
    std::span<const std::byte> stream) {
  if (desc.presence != Presence::all) return {};
  Source in(stream);
  const Number difference = in.bypass(2), planes = in.bypass(1), literals = in.bypass(2);
  const bool has_past = !blocks.empty() && !blocks[0].previous.empty();
  if (difference == 3 && !has_past) return {};
  const Number b = desc.record.bytes, w = desc.block.x;
  const Number r = Number{desc.block.x} * desc.block.y * desc.block.z;
  const auto c = static_cast<Number>(blocks.size()), n = c * r, size = n * b;

  std::vector<Number> bytes;
  const Number u = planes != 0 ? 1 : b, unit = u > 32 ? 1 : u;
  std::array<Number, 4> last{u, u * w, u * r, u * r * (planes != 0 ? c : 2)};
  int past = 0;
  while (static_cast<Number>(bytes.size()) < size) {
    if (in.missing()) return {};
    const auto at = static_cast<Number>(bytes.size());
    const Number index = std::min<Number>(planes != 0 ? at / n : at % b, 31);
    if (!in.bit(kIsMatch, past, index, 0)) {
      const Number before = bytes.empty() ? 0 : bytes.back();
      bytes.push_back(literals == 0   ? in.bypass(8)
                      : literals == 1 ? in.symbol(kLiteral, 0, 0, 8)
                      : literals == 2 ? in.symbol(kLiteral, index, 0, 8)
                                      : in.symbol(kLiteral, before, 0, 8));
      past = 0;
      continue;
    }
    Number length = 0, distance = 0;
    if (in.bit(kIsLast, past, 0, 0)) {
      const Number which = in.symbol(kWhich, 0, 0, 3);
      length = 1 + in.number(kLength, 1);
      past = 2;
      if (which > 4) return {};
      if (which == 4) {
        if (length > size - at) return {};
        bytes.resize(static_cast<std::size_t>(at + length));
        continue;
      }
      distance = last[static_cast<std::size_t>(which)];
    } else {
      length = 3 + in.number(kLength, 0);
      const Number rest = unit > 1 ? in.symbol(kRest, 0, 0, 5) : 0;
      distance = unit * in.number(kDistance, std::min<Number>(length - 3, 3)) + rest;
      past = 1;
    }
    if (distance < 1 || distance > at || length > size - at) return {};
    for (Number i = 0; i < length; ++i) {
      bytes.push_back(bytes[static_cast<std::size_t>(at + i - distance)]);
    }
    auto place =
        static_cast<std::size_t>(std::find(last.begin(), last.end(), distance) - last.begin());
    if (place == 3) continue;
    for (place = std::min<std::size_t>(place, 2); place > 0; --place) last[place] = last[place - 1];
    last[0] = distance;
  }
  if (!in.finished()) return {};

  std::vector<std::vector<std::byte>> records(blocks.size());
  for (auto& block : records) block.resize(static_cast<std::size_t>(r * b));
  const auto place = [&](Number record, Number byte) -> std::byte& {
    return records[static_cast<std::size_t>(record / r)]
                  [static_cast<std::size_t>(record % r * b + byte)];
  };
  for (Number record = 0; record < n; ++record) {
    for (Number byte = 0; byte < b; ++byte) {
      const Number i = planes != 0 ? byte * n + record : record * b + byte;
      Number reference = 0;
      const Number back = difference == 1 ? 1 : w;
      if (difference == 3) {
        const auto& previous = blocks[static_cast<std::size_t>(record / r)].previous;
        reference = static_cast<Number>(previous[static_cast<std::size_t>(record % r * b + byte)]);
      } else if (difference != 0 && record >= back) {
        reference = static_cast<Number>(place(record - back, byte));
      }
      place(record, byte) =
          static_cast<std::byte>((bytes[static_cast<std::size_t>(i)] + reference) & 255);
    }
  }
  return records;
}

}  // namespace gicodec::reference
