#include "native/tokens/prefix_code.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace gicodec::native {
namespace {

std::uint64_t load(const std::uint8_t* from) noexcept {
  std::uint64_t value = 0;
  std::memcpy(&value, from, sizeof value);
  return value;
}
void store(std::uint8_t* to, std::uint64_t value) noexcept {
  std::memcpy(to, &value, sizeof value);
}

/// Canonical codes, their first bit lowest.
std::array<std::uint16_t, kMaxTokens> codes_of(const CodeLengths& lengths,
                                               unsigned tokens) noexcept {
  std::array<std::uint32_t, kMaxLength + 1> count{}, next{};
  for (unsigned t = 0; t < tokens; ++t) ++count[lengths[t]];
  for (unsigned l = 2; l <= kMaxLength; ++l) next[l] = (next[l - 1] + count[l - 1]) << 1;
  std::array<std::uint16_t, kMaxTokens> codes{};
  for (unsigned t = 0; t < tokens; ++t) {
    const std::uint32_t code = next[lengths[t]]++;
    for (unsigned b = 0; b < lengths[t]; ++b) {
      codes[t] = static_cast<std::uint16_t>(codes[t] | (code >> b & 1) << (lengths[t] - 1 - b));
    }
  }
  return codes;
}

/// Bits of a stream that are not read yet, lowest first.
struct Bits {
  const std::uint8_t* next;
  std::uint64_t held = 0;
  unsigned count = 0;
  void fill() noexcept {
    held |= load(next) << count;
    next += (63 - count) >> 3;
    count |= 56;
  }
};

}  // namespace

CodeLengths choose_lengths(std::span<const std::uint32_t> counts, unsigned most) noexcept {
  const auto n = static_cast<unsigned>(counts.size());
  std::array<std::uint8_t, kMaxTokens> order{};
  std::iota(order.begin(), order.begin() + n, std::uint8_t{0});
  std::sort(order.begin(), order.begin() + n, [&](std::uint8_t a, std::uint8_t b) {
    return counts[a] != counts[b] ? counts[a] < counts[b] : a < b;
  });
  // Huffman's tree: leaves ascend, and so do the nodes made of the two rarest.
  std::array<std::uint64_t, 2 * kMaxTokens> weight{};
  std::array<unsigned, 2 * kMaxTokens> parent{}, depth{};
  for (unsigned i = 0; i < n; ++i) weight[i] = counts[order[i]];
  unsigned leaf = 0, node = n;
  for (unsigned end = n; end + 1 < 2 * n; ++end) {
    for (int side = 0; side < 2; ++side) {
      const bool take_leaf = leaf < n && (node >= end || weight[leaf] <= weight[node]);
      const unsigned taken = take_leaf ? leaf++ : node++;
      weight[end] += weight[taken];
      parent[taken] = end;
    }
  }
  for (unsigned i = 2 * n - 2; i-- > 0;) depth[i] = depth[parent[i]] + 1;
  // To the limit: the rarest tokens that are shorter become longer until all fit, and where there
  // is room then, the most frequent become shorter.
  const std::uint32_t room = 1U << most;
  std::uint32_t used = 0;
  for (unsigned i = 0; i < n; ++i) {
    depth[i] = std::clamp(depth[i], 1U, most);
    used += room >> depth[i];
  }
  for (unsigned i = 0; used > room; i = i + 1 < n ? i + 1 : 0) {
    while (used > room && depth[i] < most) used -= room >> ++depth[i];
  }
  for (unsigned i = n; i-- > 0;) {
    while (depth[i] > 1 && used + (room >> depth[i]) <= room) used += room >> depth[i]--;
  }
  CodeLengths lengths{};
  for (unsigned i = 0; i < n; ++i) lengths[order[i]] = static_cast<std::uint8_t>(depth[i]);
  return lengths;
}

bool is_complete(const CodeLengths& lengths, unsigned tokens) noexcept {
  std::uint32_t used = 0;
  for (unsigned t = 0; t < tokens; ++t) {
    if (lengths[t] < 1 || lengths[t] > kMaxLength) return false;
    used += 1U << (kMaxLength - lengths[t]);
  }
  return used == 1U << kMaxLength;
}

void CodeWriter::set(const CodeLengths& lengths, unsigned tokens) noexcept {
  lengths_ = lengths;
  code_ = codes_of(lengths, tokens);
  for (unsigned b = 0; b < tokens; ++b) {
    for (unsigned a = 0; a < tokens; ++a) {
      pair_[a + b * kMaxTokens] = (code_[a] | std::uint32_t{code_[b]} << lengths[a]) |
                                  static_cast<std::uint32_t>(lengths[a] + lengths[b]) << 24;
    }
  }
}

std::uint8_t* CodeWriter::write(std::span<const std::uint8_t> tokens,
                                std::uint8_t* out) const noexcept {
  std::uint64_t bits = 0;
  unsigned count = 0;
  const auto put = [&](std::uint32_t code, unsigned length) {
    bits |= std::uint64_t{code} << count;
    count += length;
  };
  const auto flush = [&] {
    store(out, bits);
    out += count >> 3;
    bits >>= count & ~7U;
    count &= 7;
  };
  std::size_t i = 0;
  for (; i + 4 <= tokens.size(); i += 4) {
    const std::uint32_t a = pair_[tokens[i] + tokens[i + 1] * kMaxTokens],
                        b = pair_[tokens[i + 2] + tokens[i + 3] * kMaxTokens];
    put(a & 0xFFFFFF, a >> 24);
    put(b & 0xFFFFFF, b >> 24);  // 7 + 4 · 11 bits in all
    flush();
  }
  for (; i < tokens.size(); ++i) put(code_[tokens[i]], lengths_[tokens[i]]);
  flush();
  return count > 0 ? out + 1 : out;
}

void CodeReader::set(const CodeLengths& lengths, unsigned tokens) noexcept {
  lengths_ = lengths;
  bits_ = *std::max_element(lengths.begin(), lengths.begin() + tokens);
  const auto codes = codes_of(lengths, tokens);
  for (unsigned t = 0; t < tokens; ++t) {
    for (unsigned v = codes[t]; v < 1U << bits_; v += 1U << lengths[t]) {
      one_[v] = static_cast<std::uint8_t>(t);
    }
  }
  constexpr unsigned kMost = 6;
  for (unsigned v = 0; v < 1U << bits_; ++v) {
    unsigned token = one_[v], bits = lengths[token], count = 1;
    std::uint64_t entry = token;
    while (count < kMost) {
      token = one_[v >> bits];
      if (bits + lengths[token] > bits_) break;
      entry |= std::uint64_t{token} << (8 * count++);
      bits += lengths[token];
    }
    several_[v] = entry | std::uint64_t{bits} << 48 | std::uint64_t{count} << 56;
  }
}

bool CodeReader::read(std::span<const TokenStream, kStreamsAtOnce> streams) const noexcept {
  // Look-ups between two fills, which leave 56 bits; tokens that they give, and one that is written
  // beyond them.
  constexpr unsigned kLookups = 56 / kMaxLength;
  constexpr std::ptrdiff_t kStep = 6 * kLookups + 8, kReadAhead = 16;
  const std::size_t mask = (std::size_t{1} << bits_) - 1;
  std::array<Bits, kStreamsAtOnce> in{};
  std::array<std::uint8_t*, kStreamsAtOnce> out{};
  const auto begin = [&](unsigned k) {
    return reinterpret_cast<const std::uint8_t*>(streams[k].bytes.data());
  };
  // Whether another step neither reads nor writes beyond the stream's ends.
  const auto has_step = [&](unsigned k) {
    const std::uint8_t* const end = begin(k) + streams[k].bytes.size();
    std::uint8_t* const last = streams[k].tokens.data() + streams[k].tokens.size();
    return end - in[k].next >= kReadAhead && last - out[k] >= kStep;
  };
  const auto look_up = [&](Bits& bits, std::uint8_t*& to) {
    const std::uint64_t entry = several_[static_cast<std::size_t>(bits.held) & mask];
    store(to, entry);
    to += entry >> 56;
    const auto taken = static_cast<unsigned>(entry >> 48 & 0xFF);
    bits.held >>= taken;
    bits.count -= taken;
  };
  for (unsigned k = 0; k < kStreamsAtOnce; ++k) {
    in[k].next = begin(k);
    out[k] = streams[k].tokens.data();
  }
  {
    // In registers of their own.
    auto [in0, in1, in2, in3] = in;
    auto [out0, out1, out2, out3] = out;
    std::array<const std::uint8_t*, kStreamsAtOnce> stop{};
    std::array<std::uint8_t*, kStreamsAtOnce> full{};
    bool any = true;
    for (unsigned k = 0; k < kStreamsAtOnce; ++k) any = any && has_step(k);
    for (unsigned k = 0; any && k < kStreamsAtOnce; ++k) {
      stop[k] = begin(k) + streams[k].bytes.size() - kReadAhead;
      full[k] = streams[k].tokens.data() + streams[k].tokens.size() - kStep;
    }
    while (any) {
      in0.fill(), in1.fill(), in2.fill(), in3.fill();
      for (unsigned i = 0; i < kLookups; ++i) {
        look_up(in0, out0);
        look_up(in1, out1);
        look_up(in2, out2);
        look_up(in3, out3);
      }
      any = in0.next <= stop[0] && in1.next <= stop[1] && in2.next <= stop[2] &&
            in3.next <= stop[3] && out0 <= full[0] && out1 <= full[1] && out2 <= full[2] &&
            out3 <= full[3];
    }
    in = {in0, in1, in2, in3};
    out = {out0, out1, out2, out3};
  }
  bool whole = true;
  for (unsigned k = 0; k < kStreamsAtOnce; ++k) {
    while (has_step(k)) {
      in[k].fill();
      for (unsigned i = 0; i < kLookups; ++i) look_up(in[k], out[k]);
    }
    // One by one, with zeros beyond the end.
    const std::size_t size = streams[k].bytes.size();
    std::size_t at = static_cast<std::size_t>(in[k].next - begin(k)) * 8 - in[k].count;
    std::uint8_t* const last = streams[k].tokens.data() + streams[k].tokens.size();
    while (out[k] < last && at <= 8 * size) {
      std::array<std::uint8_t, 8> rest{};
      const std::size_t byte = at >> 3;
      if (byte < size)
        std::memcpy(rest.data(), begin(k) + byte, std::min<std::size_t>(8, size - byte));
      const std::uint64_t bits = load(rest.data()) >> (at & 7);
      const std::uint8_t token = one_[static_cast<std::size_t>(bits) & mask];
      *out[k]++ = token;
      at += lengths_[token];
    }
    const bool padded =
        at <= 8 * size && 8 * size - at < 8 &&
        (at == 8 * size || std::to_integer<unsigned>(streams[k].bytes[size - 1]) >> (at & 7) == 0);
    whole = whole && out[k] == last && padded;
  }
  return whole;
}

}  // namespace gicodec::native
