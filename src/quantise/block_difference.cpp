#include "quantise/block_difference.h"

#include <gicodec/error_bound.h>

#include <cstdint>
#include <cstring>

namespace gicodec {
namespace {

template <typename Word>
float changed_words(std::span<const std::byte> a, std::span<const std::byte> b) noexcept {
  std::size_t changed = 0;
  for (std::size_t at = 0; at < a.size(); at += sizeof(Word)) {
    Word x = 0, y = 0;
    std::memcpy(&x, a.data() + at, sizeof x);
    std::memcpy(&y, b.data() + at, sizeof y);
    changed += x != y ? 1 : 0;
  }
  return static_cast<float>(changed * sizeof(Word)) / static_cast<float>(a.size());
}

}  // namespace

bool differs_by_more(const TextureDesc& desc, std::span<const std::byte> given,
                     std::span<const std::byte> held, float threshold) noexcept {
  if (std::memcmp(given.data(), held.data(), given.size()) == 0) return false;
  return !(threshold > 0) || !within_error(desc.record, given, held, threshold);
}

float changed_share(const TextureDesc& desc, std::span<const std::byte> a,
                    std::span<const std::byte> b) noexcept {
  const unsigned size = desc.record.bytes;
  if (size % 8 == 0) return changed_words<std::uint64_t>(a, b);
  if (size % 4 == 0) return changed_words<std::uint32_t>(a, b);
  if (size % 2 == 0) return changed_words<std::uint16_t>(a, b);
  return changed_words<std::uint8_t>(a, b);
}

}  // namespace gicodec
