#include "native/tokens/token_units.h"

#include <algorithm>
#include <cstring>

namespace gicodec::native {
namespace {

bool is_zero(const std::uint8_t* tokens, std::size_t size) noexcept {
  std::uint64_t half[2] = {};
  if (size == kUnit) {
    std::memcpy(half, tokens, kUnit);
  } else {
    std::memcpy(half, tokens, size);
  }
  return (half[0] | half[1]) == 0;
}

}  // namespace

bool TokenUnits::quiet(std::span<const std::uint8_t> tokens) const noexcept {
  constexpr std::size_t kWorth = 6;  // a unit without codes in so many is worth the time of a map
  constexpr std::size_t kSampled = 64;
  const std::size_t blocks = tokens.size() / texels_, step = blocks / kSampled | 1;
  std::size_t seen = 0, found = 0;
  for (std::size_t block = 0; block < blocks; block += step) {
    for (std::size_t u = 0; u < units_; ++u, ++seen) {
      found += is_zero(&tokens[block * texels_ + u * kUnit], size_of(u)) ? 1 : 0;
    }
  }
  return found * kWorth > seen;
}

void TokenUnits::find(std::span<const std::uint8_t> tokens) {
  map_.assign((count_ + 7) / 8, 0);
  std::size_t unit = 0;
  for (std::size_t begin = 0; unit < count_; begin += texels_) {
    for (std::size_t u = 0; u < units_; ++u, ++unit) {
      if (is_zero(&tokens[begin + u * kUnit], size_of(u))) continue;
      map_[unit / 8] = static_cast<std::uint8_t>(map_[unit / 8] | 1U << unit % 8);
    }
  }
}

std::size_t TokenUnits::coded(std::size_t first, std::size_t last) const noexcept {
  std::size_t tokens = 0;
  for (std::size_t block = first; block < last; ++block) {
    for (std::size_t u = 0; u < units_; ++u) {
      if (is_coded(block * units_ + u)) tokens += size_of(u);
    }
  }
  return tokens;
}

std::uint8_t* TokenUnits::gather(std::size_t block, const std::uint8_t* tokens,
                                 std::uint8_t* out) const noexcept {
  for (std::size_t u = 0; u < units_; ++u, tokens += kUnit) {
    if (!is_coded(block * units_ + u)) continue;
    std::memmove(out, tokens, size_of(u));
    out += size_of(u);
  }
  return out;
}

const std::uint8_t* TokenUnits::scatter(std::size_t block, const std::uint8_t* tokens,
                                        std::uint8_t* out) const noexcept {
  for (std::size_t u = 0; u < units_; ++u, out += kUnit) {
    if (is_coded(block * units_ + u)) {
      std::memcpy(out, tokens, kUnit);
      tokens += size_of(u);
    } else {
      std::memset(out, 0, kUnit);
    }
  }
  return tokens;
}

void TokenUnits::write(ByteWriter& writer) const {
  const auto kept =
      std::count_if(map_.begin(), map_.end(), [](std::uint8_t eight) { return eight != 0; });
  writer.varint((map_.size() + 7) / 8 + static_cast<std::size_t>(kept));
  for (std::size_t begin = 0; begin < map_.size(); begin += 8) {
    const std::size_t end = std::min(begin + 8, map_.size());
    unsigned used = 0;
    for (std::size_t i = begin; i < end; ++i) used |= map_[i] != 0 ? 1U << (i - begin) : 0;
    writer.fixed(static_cast<std::uint8_t>(used));
    for (std::size_t i = begin; i < end; ++i) {
      if (map_[i] != 0) writer.fixed(map_[i]);
    }
  }
}

bool TokenUnits::read(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  map_.assign((count_ + 7) / 8, 0);
  for (std::size_t begin = 0; begin < map_.size() && reader.ok(); begin += 8) {
    const std::size_t end = std::min(begin + 8, map_.size());
    const unsigned used = reader.fixed<std::uint8_t>();
    if (used >> (end - begin) != 0) reader.fail(Status::corrupt);
    for (std::size_t i = begin; i < end && reader.ok(); ++i) {
      if ((used >> (i - begin) & 1) == 0) continue;
      map_[i] = reader.fixed<std::uint8_t>();
      if (map_[i] == 0) reader.fail(Status::corrupt);
    }
  }
  if (count_ % 8 != 0 && !map_.empty() && map_.back() >> count_ % 8 != 0)
    reader.fail(Status::corrupt);
  return reader.ok() && reader.rest().empty();
}

}  // namespace gicodec::native
