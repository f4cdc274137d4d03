#include "quantise/error_grid.h"

#include <gicodec/error_bound.h>

#include "quantise/component_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gicodec {
namespace {

/// Components that mean something only under the same exponent.
bool share_exponent(const Record& record) noexcept {
  const auto used = record.used();
  return std::any_of(used.begin(), used.end(),
                     [](const auto& c) { return c.type == ComponentType::exponent; });
}

/// What is held, moved by as much as what it was made of.
std::uint32_t followed(const Component& component, std::uint32_t code, std::uint32_t held,
                       std::uint32_t given) noexcept {
  const std::int64_t off =
      std::int64_t{ordered(held, component)} - std::int64_t{ordered(given, component)};
  const auto to =
      std::clamp<std::int64_t>(ordered(code, component) + off, 0, largest_code(component));
  return ordered(static_cast<std::uint32_t>(to), component);
}

}  // namespace

bool valid_error(float max_error) noexcept { return std::isfinite(max_error) && max_error >= 0; }

std::uint32_t error_units(const Component& component, float max_error) noexcept {
  if (component.type == ComponentType::opaque || component.type == ComponentType::exponent)
    return 0;
  double units = std::floor(max_error);
  if (max_error < 1) {
    units = is_float(component)
                ? std::floor(std::ldexp(max_error, static_cast<int>(mantissa_bits(component))))
                : 0;
  }
  const std::uint32_t most = largest_code(component) / 4;
  return static_cast<std::uint32_t>(std::min(units, static_cast<double>(most)));
}

bool allows_error(const Record& record, float max_error) noexcept {
  const auto used = record.used();
  return std::any_of(used.begin(), used.end(),
                     [=](const auto& c) { return error_units(c, max_error) > 0; });
}

float both_errors(float first, float second) noexcept {
  if (first == 0 || second == 0) return std::max(first, second);
  return first >= 1 && second >= 1 ? first + second : std::numeric_limits<float>::infinity();
}

bool within_error(const Record& record, std::span<const std::byte> given,
                  std::span<const std::byte> decoded, float max_error) noexcept {
  for (const Component& component : record.used()) {
    const std::uint32_t error = error_units(component, max_error);
    for (std::size_t at = 0; at < given.size(); at += record.bytes) {
      if (!near_enough(component, code_of(given.data() + at, component, record.bytes),
                       code_of(decoded.data() + at, component, record.bytes), error)) {
        return false;
      }
    }
  }
  return true;
}

ErrorGrid::ErrorGrid(const Record& record, float max_error) noexcept : record_(record) {
  for (std::size_t i = 0; i < record.count; ++i) {
    const Component& component = record.components[i];
    Axis& axis = axes_[i];
    axis.error = error_units(component, max_error);
    if (axis.error == 0) continue;
    exact_ = false;
    axis.is_float = is_float(component);
    axis.sign = axis.is_float ? sign_bit(component) : 0;
    axis.largest = axis.is_float ? infinity_code(component) - 1 : largest_code(component);
    // Steps of 2·E + 1 make the fewest values, lower ones leave room to stay at what is held: noise
    // that is not much larger than the bound costs nothing then. Those of floats and of two's
    // complement have to divide the sign's place too.
    axis.capped = !axis.is_float && component.type != ComponentType::snorm;
    axis.step =
        axis.capped ? axis.error + (axis.error + 1) / 2 + 1 : std::bit_floor(2 * axis.error + 1);
    if (component.bits <= 16) axis.inverse = (std::uint64_t{1} << 32) / axis.step + 1;
  }
}

/// To the nearest multiple, as far as there is one near enough.
inline std::uint32_t ErrorGrid::moved(const Axis& axis, std::uint32_t code) noexcept {
  const std::uint32_t sign = code & axis.sign, magnitude = code & ~axis.sign;
  if (axis.is_float && (magnitude == 0 || magnitude > axis.largest)) return code;
  const std::uint32_t over =
      axis.inverse != 0
          ? magnitude - axis.step * static_cast<std::uint32_t>(magnitude * axis.inverse >> 32)
          : magnitude % axis.step;
  if (over <= axis.step / 2) return sign | (magnitude - over);
  if (axis.largest - magnitude >= axis.step - over) return sign | (magnitude + axis.step - over);
  if (axis.capped) return axis.largest;
  return over <= axis.error ? sign | (magnitude - over) : code;
}

void ErrorGrid::apply(std::span<std::byte> records, std::span<const std::byte> held,
                      std::span<const std::byte> given) const noexcept {
  const bool shared = share_exponent(record_);
  const std::size_t bytes = record_.bytes;
  for (std::size_t at = 0; at < records.size(); at += bytes) {
    std::byte* const record = records.data() + at;
    const std::byte* const before = held.empty() ? nullptr : held.data() + at;
    bool comparable = before != nullptr;
    for (std::size_t i = 0; i < record_.count && shared && comparable; ++i) {
      const Component& c = record_.components[i];
      comparable = c.type != ComponentType::exponent ||
                   code_of(record, c, bytes) == code_of(before, c, bytes);
    }
    for (std::size_t i = 0; i < record_.count; ++i) {
      const Component& component = record_.components[i];
      const Axis& axis = axes_[i];
      if (axis.error == 0) continue;
      const std::uint32_t code = code_of(record, component, bytes);
      std::uint32_t kept = comparable ? code_of(before, component, bytes) : 0;
      if (comparable && !given.empty()) {
        kept = followed(component, code, kept, code_of(given.data() + at, component, bytes));
      }
      if (comparable && near_enough(component, code, kept, axis.error)) {
        set_code(record, component, bytes, kept);
      } else {
        set_code(record, component, bytes,
                 ordered(moved(axis, ordered(code, component)), component));
      }
    }
  }
}

bool ErrorGrid::holds(std::span<const std::byte> records) const noexcept {
  for (std::size_t i = 0; i < record_.count; ++i) {
    if (axes_[i].error == 0) continue;
    const Component& component = record_.components[i];
    for (std::size_t at = 0; at < records.size(); at += record_.bytes) {
      const std::uint32_t code =
          ordered(code_of(records.data() + at, component, record_.bytes), component);
      if (moved(axes_[i], code) != code) return false;
    }
  }
  return true;
}

std::array<std::uint32_t, kMaxComponents> ErrorGrid::steps() const noexcept {
  std::array<std::uint32_t, kMaxComponents> steps{};
  std::transform(axes_.begin(), axes_.end(), steps.begin(), [](const Axis& a) { return a.step; });
  return steps;
}

}  // namespace gicodec
