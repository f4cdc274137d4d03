#include "native/tokens/token_blocks.h"
#include "native/tokens/token_head.h"
#include "native/tokens/token_units.h"

#include "native/models/models.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec::native {
namespace {

/// Blocks by which predictions are chosen, one of so many, and texels of them.
constexpr std::size_t kSampledBlocks = 24, kSampledOf = 8, kSampledTexels = 4096;
/// Tokens from which on only every fourth block is counted.
constexpr std::size_t kManyTokens = 16384;
constexpr std::uint32_t kCountScale = 4;

/// Logarithm to base 2 in 1/256, rounded down between powers of two.
std::uint64_t log2_of(std::uint64_t n) {
  const auto whole = static_cast<unsigned>(std::bit_width(n)) - 1;
  const std::uint64_t rest = whole > 8 ? n >> (whole - 8) : n << (8 - whole);
  return whole * 256U + (rest - 256);
}

/// Never less, so that what is overwritten is not set to zeros first.
void grow(Vector<std::uint8_t>& memory, std::size_t size) {
  if (memory.size() < size) memory.resize(size);
}

using Counts = std::array<std::uint32_t, kMaxTokens>;

/// About what tokens of these counts cost, with their raw bits, in 1/256 bits.
std::uint64_t cost_of(const TokenGroup& group, const Counts& counts) {
  std::uint64_t all = 0, cost = 0;
  for (unsigned t = 0; t < group.tokens(); ++t) all += counts[t];
  for (unsigned t = 0; t < group.tokens(); ++t) {
    if (counts[t] == 0) continue;
    const unsigned raw = t > group.base() + 1U ? group.raw_bits(t - group.base()) : 0;
    cost += counts[t] * (log2_of(all) - log2_of(counts[t]) + 256U * raw);
  }
  return cost;
}

class TokenEncoder {
 public:
  TokenEncoder(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& records,
               TokenMemory& memory)
      : u_(u),
        positions_(positions),
        records_(records),
        memory_(memory),
        layout_(plane_layout(u.desc)),
        head_(head_of(u, layout_)),
        blocks_(u, positions, head_, memory) {}

  /// False if the chunk takes more than `most` bytes.
  bool encode(unsigned streams, std::size_t most, std::vector<std::byte>& out) {
    head_.streams = streams;
    find_constants();
    for (;;) {
      groups_ = token_groups(layout_, head_.coded);
      for (unsigned g = 0; g < groups_.count; ++g) choose_prediction(groups_.group[g]);
      if (make_tokens()) break;
    }
    const std::size_t begin = out.size();
    ByteWriter writer(out);
    write_token_head(layout_, head_, writer);
    for (unsigned g = 0; g < groups_.count && out.size() - begin <= most; ++g)
      write_group(g, writer);
    return out.size() - begin <= most;
  }

 private:
  static TokenHead head_of(const Update& u, const PlaneLayout& layout) {
    TokenHead head;
    head.continues = u.neighbours() && takes_raster(u.desc);
    head.refers = !u.update && u.neighbours() && !layout.pairs && !head.continues;
    return head;
  }
  [[nodiscard]] std::size_t texels() const { return blocks_.texels(); }
  [[nodiscard]] std::span<std::uint8_t> tokens_of(unsigned group) const {
    const std::size_t all = positions_.size() * texels() + kTokenSlack;
    return std::span(memory_.tokens).subspan(group * all, all);
  }

  /// Planes that are constant in the first block: make_tokens() finds out whether in all.
  void find_constants() {
    blocks_.load(0, records_, true);
    for (unsigned p = 0; p < layout_.planes; ++p) {
      const std::uint16_t* const values = blocks_.plane(p);
      head_.constant[p] = values[0];
      const bool same =
          std::all_of(values, values + texels(), [&](std::uint16_t v) { return v == values[0]; });
      if (!same || layout_.pairs) head_.coded |= 1U << p;
    }
  }
  /// False, and the planes are coded from now on, if one is not constant.
  bool check_constants() {
    std::uint32_t others = 0;
    for (unsigned p = 0; p < layout_.planes; ++p) {
      if ((head_.coded >> p & 1) != 0) continue;
      const std::uint16_t* const values = blocks_.plane(p);
      std::uint16_t differs = 0;
      for (std::size_t t = 0; t < texels(); ++t) {
        differs = static_cast<std::uint16_t>(differs | (values[t] ^ head_.constant[p]));
      }
      if (differs != 0) others |= 1U << p;
    }
    head_.coded |= others;
    return others == 0;
  }

  /// Predictions without differences to the first plane, then those with them.
  static void set_way(TokenGroup& group, unsigned way, unsigned predictions) {
    group.prediction = static_cast<TokenPrediction>(way % predictions);
    group.follows = way >= predictions;
  }
  void choose_prediction(TokenGroup& group) {
    const std::size_t n = positions_.size();
    const std::size_t sampled = std::clamp<std::size_t>(
        std::min(kSampledTexels / texels(), n / kSampledOf), 1, std::min(kSampledBlocks, n));
    std::array<Counts, 2 * kTokenPredictions> counts{};
    grow(memory_.streams, texels() + kTokenSlack);
    grow(memory_.raw, texels() * kMaxRawBytes + kRawSlack);
    const bool low = (layout_.low >> group.plane[0] & 1) != 0;
    const unsigned last = group.can_follow() && !low ? 1 : 0,
                   first = last == 1 && group.planes == kMaxGroupPlanes ? 1 : 0;
    const unsigned predictions = group.copies != 0 ? kCopyingPredictions : kTokenPredictions;
    for (std::size_t i = 0; i < sampled; ++i) {
      blocks_.load(n * i / sampled, records_, true);
      const TokenBlock block = blocks_.block(group);
      for (unsigned way = first * predictions; way < (last + 1) * predictions; ++way) {
        set_way(group, way, predictions);
        BitSink unused{memory_.raw.data(), 0, 0};
        u_.tokens.write(group, block, memory_.streams.data(), unused);
        for (std::size_t t = 0; t < texels(); ++t) ++counts[way][memory_.streams[t]];
      }
    }
    std::uint64_t least = UINT64_MAX;
    unsigned best = 0;
    for (unsigned way = first * predictions; way < (last + 1) * predictions; ++way) {
      const std::uint64_t cost = cost_of(group, counts[way]);
      if (cost < least) best = way;
      least = std::min(least, cost);
    }
    set_way(group, best, predictions);
  }

  /// Tokens and raw bits of all blocks. False if a plane turned out not to be constant.
  bool make_tokens() {
    const std::size_t n = positions_.size();
    grow(memory_.tokens, groups_.count * (n * texels() + kTokenSlack));
    const std::size_t most = n * texels() * kMaxRawBytes + kRawSlack;
    grow(memory_.raw, groups_.count * most);
    std::array<BitSink, kMaxGroups> sinks{};
    for (unsigned g = 0; g < groups_.count; ++g) sinks[g].next = memory_.raw.data() + g * most;
    for (std::size_t b = 0; b < n; ++b) {
      blocks_.load(b, records_, true);
      if (!check_constants()) return false;
      for (unsigned g = 0; g < groups_.count; ++g) {
        const TokenGroup& group = groups_.group[g];
        u_.tokens.write(group, blocks_.block(group), &tokens_of(g)[b * texels()], sinks[g]);
      }
    }
    for (unsigned g = 0; g < groups_.count; ++g) {
      const std::uint8_t* const first = memory_.raw.data() + g * most;
      raw_[g] = {first, static_cast<std::size_t>(sinks[g].next - first) + (sinks[g].count > 0)};
    }
    return true;
  }

  [[nodiscard]] Counts count(std::span<const std::uint8_t> tokens) const {
    const std::size_t step = tokens.size() >= kManyTokens ? 4 : 1;
    std::array<Counts, 4> counts{};  // so that equal tokens in a row do not wait for each other
    for (std::size_t begin = 0; begin < tokens.size(); begin += step * texels()) {
      const auto some = tokens.subspan(begin, std::min(texels(), tokens.size() - begin));
      for (std::size_t t = 0; t < some.size(); ++t) ++counts[t % 4][some[t]];
    }
    for (unsigned t = 0; t < kMaxTokens; ++t) {
      counts[0][t] = (counts[0][t] + counts[1][t] + counts[2][t] + counts[3][t]) * kCountScale + 1;
    }
    return counts[0];
  }

  /// Takes out units without codes, where that is worth a map. What is left, by stream.
  std::array<std::span<const std::uint8_t>, kMaxStreams> gather(unsigned g, TokenUnits& units) {
    TokenGroup& group = groups_.group[g];
    const std::size_t n = positions_.size();
    std::uint8_t* const tokens = tokens_of(g).data();
    group.sparse = units.quiet(tokens_of(g).first(n * texels()));
    if (group.sparse) units.find(tokens_of(g).first(n * texels()));
    std::array<std::span<const std::uint8_t>, kMaxStreams> streams;
    std::uint8_t* next = tokens;
    for (unsigned s = 0; s < head_.streams; ++s) {
      const std::size_t first = first_block(n, s, head_.streams),
                        last = first_block(n, s + 1, head_.streams);
      std::uint8_t* const begin = next;
      for (std::size_t b = first; b < last && group.sparse; ++b) {
        next = units.gather(b, tokens + b * texels(), next);
      }
      if (!group.sparse) next += (last - first) * texels();
      streams[s] = {begin, next};
    }
    return streams;
  }

  void write_group(unsigned g, ByteWriter& writer) {
    const TokenGroup& group = groups_.group[g];
    TokenUnits units(positions_.size(), texels(), memory_.map[0]);
    const auto tokens = gather(g, units);
    const std::size_t all = static_cast<std::size_t>(
        tokens[head_.streams - 1].data() + tokens[head_.streams - 1].size() - tokens[0].data());
    const Counts counts = count({tokens[0].data(), all});
    const unsigned most = all >= 65536 ? kMaxLength : all >= 8192 ? 10 : 8;
    const CodeLengths lengths = choose_lengths(std::span(counts).first(group.tokens()), most);
    memory_.writer.set(lengths, group.tokens());
    grow(memory_.streams, CodeWriter::bound(all) + head_.streams * 16);
    std::array<std::size_t, kMaxStreams> size{};
    std::uint8_t* next = memory_.streams.data();
    for (unsigned s = 0; s < head_.streams; ++s) {
      std::uint8_t* const stop = memory_.writer.write(tokens[s], next);
      size[s] = static_cast<std::size_t>(stop - next);
      next = stop;
    }
    writer.fixed(static_cast<std::uint8_t>(static_cast<unsigned>(group.prediction) |
                                           (group.follows ? kFollows : 0U) |
                                           (group.sparse ? kSparse : 0U)));
    write_lengths(lengths, group.tokens(), writer);
    if (group.sparse) units.write(writer);
    for (unsigned s = 0; s < head_.streams; ++s) writer.varint(size[s]);
    writer.varint(raw_[g].size());
    writer.bytes(std::as_bytes(std::span(memory_.streams.data(), next)));
    writer.bytes(std::as_bytes(raw_[g]));
  }

  const Update& u_;
  std::span<const std::uint32_t> positions_;
  const BlockTable& records_;
  TokenMemory& memory_;
  PlaneLayout layout_;
  TokenHead head_;
  TokenBlocks blocks_;
  TokenGroups groups_;
  std::array<std::span<const std::uint8_t>, kMaxGroups> raw_;
};

}  // namespace

bool takes_tokens(const TextureDesc& desc) noexcept {
  return desc.presence == Presence::all && model_of(desc).adapts != Adapts::always;
}

bool encode_tokens(const Update& u, std::span<const std::uint32_t> positions,
                   const BlockTable& records, unsigned streams, std::size_t most,
                   TokenMemory& memory, std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  if (TokenEncoder(u, positions, records, memory).encode(streams, most, out)) return true;
  out.resize(begin);
  return false;
}

}  // namespace gicodec::native
