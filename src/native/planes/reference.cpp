#include "native/planes/reference.h"

namespace gicodec::native {
namespace {

/// (a + b + 1) / 2 of values, and of changes.
inline std::uint16_t mean(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>((a + b + 1) >> 1);
}
/// Through the unsigned mean, which machines have an instruction for.
inline std::int16_t mean_change(std::int16_t a, std::int16_t b) {
  const auto offset = [](int x) { return static_cast<std::uint16_t>(x ^ 0x8000); };
  return static_cast<std::int16_t>(offset(mean(offset(a), offset(b))));
}
inline std::int16_t change(std::uint16_t current, std::uint16_t before) {
  return static_cast<std::int16_t>(current - before);
}

}  // namespace

bool usable(const Mode& mode, const Known& known) noexcept {
  if (mode.neighbours == 0) return true;
  unsigned at_hand = 0;
  for (unsigned k = 0; k < 3; ++k) at_hand |= known.current[k] != nullptr ? 1U << k : 0;
  return (mode.neighbours & at_hand) != 0;
}

const std::uint16_t* reference_block(const Mode& mode, const Known& known, std::size_t at,
                                     std::size_t count, const std::uint16_t* constant,
                                     std::uint16_t* out) noexcept {
  const std::uint16_t* current[3] = {};
  const std::uint16_t* before[3] = {};
  unsigned n = 0;
  for (unsigned k = 0; k < 3; ++k) {
    if ((mode.neighbours >> k & 1) != 0 && known.current[k] != nullptr) {
      current[n] = known.current[k] + at;
      before[n] = known.before[k] == nullptr ? current[n] : known.before[k] + at;
      ++n;
    }
  }
  if (mode.reference == Reference::previous) return known.previous + at;
  if (mode.reference == Reference::neighbours && n > 0) {
    if (n == 1) return current[0];
    for (std::size_t t = 0; t < count; ++t) out[t] = mean(current[0][t], current[1][t]);
    if (n == 3) {
      for (std::size_t t = 0; t < count; ++t) out[t] = mean(out[t], current[2][t]);
    }
    return out;
  }
  if (mode.reference == Reference::change) {
    const std::uint16_t* previous = known.previous + at;
    if (n == 0) return previous;
    if (n == 1) {
      for (std::size_t t = 0; t < count; ++t) {
        out[t] = static_cast<std::uint16_t>(previous[t] + change(current[0][t], before[0][t]));
      }
    } else if (n == 2) {
      for (std::size_t t = 0; t < count; ++t) {
        out[t] = static_cast<std::uint16_t>(
            previous[t] +
            mean_change(change(current[0][t], before[0][t]), change(current[1][t], before[1][t])));
      }
    } else {
      for (std::size_t t = 0; t < count; ++t) {
        const auto two =
            mean_change(change(current[0][t], before[0][t]), change(current[1][t], before[1][t]));
        out[t] = static_cast<std::uint16_t>(previous[t] +
                                            mean_change(two, change(current[2][t], before[2][t])));
      }
    }
    return out;
  }
  return constant + at;
}

}  // namespace gicodec::native
