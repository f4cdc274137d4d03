#include "quantise/coding_cost.h"

#include "quantise/component_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace gicodec {

CodingCost::CodingCost(const Record& record, std::uint32_t width)
    : record_(record), width_(width), counts_(record.count) {}

void CodingCost::clear() noexcept {
  records_ = 0;
  for (auto& counts : counts_) counts = {};
}

void CodingCost::Counts::add(std::int64_t number) noexcept {
  if (std::abs(number) <= kNear) {
    ++of[static_cast<std::size_t>(number + kNear)];
    return;
  }
  const auto length =
      static_cast<int>(std::bit_width(static_cast<std::uint64_t>(std::abs(number))));
  const auto far = static_cast<std::size_t>(std::min(length, kLengths));
  ++of[std::size_t{2} * kNear + far];
  rest += static_cast<std::uint64_t>(length);  // One less, and the sign.
}

double CodingCost::Counts::bits(double all) const noexcept {
  double sum = static_cast<double>(rest);
  for (const double count : of) {
    if (count > 0) sum += count * std::log2(all / count);
  }
  return sum;
}

void CodingCost::add(std::span<const std::byte> records, std::span<const std::byte> held,
                     std::span<const std::uint32_t> steps) noexcept {
  const std::size_t bytes = record_.bytes, row = width_ * bytes;
  for (std::size_t i = 0; i < record_.count; ++i) {
    const auto number = [&](std::size_t c, std::size_t at) {
      const Component& component = record_.components[c];
      const std::int64_t code = ordered(code_of(&records[at], component, bytes), component);
      const std::int64_t was =
          held.empty() ? 0 : ordered(code_of(&held[at], component, bytes), component);
      return (code - was) / std::int64_t{steps[c]};
    };
    auto& [plain, left, above, plane, before] = counts_[i];
    std::int64_t west = 0, north_west = 0;
    for (std::size_t at = 0; at < records.size(); at += bytes) {
      if (at % row == 0) west = north_west = 0;
      const std::int64_t here = number(i, at), north = at < row ? 0 : number(i, at - row);
      plain.add(here);
      left.add(here - (at % row == 0 ? north : west));
      above.add(here - (at < row ? west : north));
      plane.add(here - (at < row ? west : at % row == 0 ? north : west + north - north_west));
      before.add(i == 0 ? here : here - number(i - 1, at));
      west = here;
      north_west = north;
    }
  }
  records_ += records.size() / bytes;
}

double CodingCost::bits() const noexcept {
  double sum = 0;
  for (const auto& predictions : counts_) {
    double least = predictions[0].bits(static_cast<double>(records_));
    for (const Counts& counts : predictions) {
      least = std::min(least, counts.bits(static_cast<double>(records_)));
    }
    sum += least;
  }
  return sum;
}

}  // namespace gicodec
