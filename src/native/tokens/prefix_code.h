// Prefix codes of tokens: up to six tokens by a look-up when decoding, two when encoding
// (docs/native/tokens.md, "Codes", "Streams").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

inline constexpr unsigned kMaxTokens = 64;  ///< of a group
inline constexpr unsigned kMaxLength = 11;  ///< bits of a code
/// Streams are decoded so many at a time, and there are that many times a power of two.
inline constexpr unsigned kStreamsAtOnce = 4, kMaxStreams = 64;
/// Tokens that decoding may write beyond the last of a stream.
inline constexpr std::size_t kTokenSlack = 64;

/// Bits of each token's code.
using CodeLengths = std::array<std::uint8_t, kMaxTokens>;

/// Lengths of a complete code by counts, all of them above 0; at most `most` bits each.
[[nodiscard]] CodeLengths choose_lengths(std::span<const std::uint32_t> counts,
                                         unsigned most) noexcept;
/// Whether so many tokens have lengths from 1 to kMaxLength that make a complete code.
[[nodiscard]] bool is_complete(const CodeLengths& lengths, unsigned tokens) noexcept;

/// The codes of two tokens, the first in the low bits; from bit 24 on their length.
class CodeWriter {
 public:
  void set(const CodeLengths& lengths, unsigned tokens) noexcept;
  /// Most bytes of a stream, with what is written beyond it.
  [[nodiscard]] static constexpr std::size_t bound(std::size_t tokens) noexcept {
    return (tokens * kMaxLength + 7) / 8 + 16;
  }
  /// Returns the stream's end.
  std::uint8_t* write(std::span<const std::uint8_t> tokens, std::uint8_t* out) const noexcept;

 private:
  std::array<std::uint32_t, std::size_t{kMaxTokens} * kMaxTokens> pair_;
  std::array<std::uint16_t, kMaxTokens> code_;
  CodeLengths lengths_;
};

/// A stream of tokens and where they go, with room for kTokenSlack more.
struct TokenStream {
  std::span<const std::byte> bytes;
  std::span<std::uint8_t> tokens;
};

class CodeReader {
 public:
  /// Precondition: is_complete().
  void set(const CodeLengths& lengths, unsigned tokens) noexcept;
  /// False unless every stream ends with its last token, and bits of 0.
  [[nodiscard]] bool read(std::span<const TokenStream, kStreamsAtOnce> streams) const noexcept;

 private:
  std::array<std::uint64_t, 1U << kMaxLength> several_;  ///< tokens, and from bit 48 on bits, count
  std::array<std::uint8_t, 1U << kMaxLength> one_;
  CodeLengths lengths_;
  unsigned bits_ = 0;  ///< of an index
};

}  // namespace gicodec::native
