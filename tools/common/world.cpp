#include "world.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kLayout = "gicodec:layout";
constexpr const char* kAxes = "gicodec:axes";
constexpr const char* kUnit = "gicodec:unit";
constexpr const char* kBounds = "gicodec:bounds";
constexpr const char* kStates = "gicodec:states";

/// Each direction beside its opposite.
constexpr std::array<std::string_view, 6> kDirections = {"right", "left",    "up",
                                                         "down",  "forward", "back"};

/// Indices in kDirections; nullopt unless they are three axes.
std::optional<std::array<std::size_t, 3>> directions(std::string_view text) noexcept {
  std::array<std::size_t, 3> found{};
  std::array<bool, 3> pairs{};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::string_view word = text.substr(0, text.find(' '));
    const auto place = std::ranges::find(kDirections, word);
    if (place == kDirections.end()) return std::nullopt;
    found[i] = static_cast<std::size_t>(place - kDirections.begin());
    if (std::exchange(pairs[found[i] / 2], true)) return std::nullopt;
    const bool more = word.size() < text.size();
    if (more == (i + 1 == found.size())) return std::nullopt;
    text.remove_prefix(more ? word.size() + 1 : word.size());
  }
  return found;
}

template <typename T>
std::optional<T> number(std::string_view text) {
  T value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
  return value;
}

std::optional<double> finite(std::string_view text) {
  const auto value = number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Text up to a separator, which it takes away, too.
std::string_view next(std::string_view& text, char separator) {
  const std::string_view item = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(text.size(), item.size() + 1));
  return item;
}

std::optional<FrameState> state_of(std::string_view line) {
  const auto frame = number<std::uint64_t>(next(line, ' '));
  const std::string_view time = next(line, ' ');
  if (!frame) return std::nullopt;
  FrameState state{*frame, finite(time), std::string(line)};
  if (!state.time && time != "-") return std::nullopt;
  return state;
}

}  // namespace

bool are_axes(std::string_view text) noexcept { return directions(text).has_value(); }

bool is_right_handed(std::string_view axes) noexcept {
  // An even permutation of (right, up, back), or an odd one with an odd number of opposites.
  const auto found = directions(axes).value_or(std::array<std::size_t, 3>{0, 2, 5});
  bool right = true;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t pair = found[i] / 2;
    if (found[i] % 2 != (pair == 2 ? 1U : 0U)) right = !right;
    for (std::size_t j = 0; j < i; ++j) {
      if (found[j] / 2 > pair) right = !right;
    }
  }
  return right;
}

std::optional<std::vector<double>> numbers_from_string(std::string_view text, char separator,
                                                       std::size_t count) {
  std::vector<double> numbers;
  while (!text.empty() && numbers.size() < count) {
    const auto value = finite(next(text, separator));
    if (!value) return std::nullopt;
    numbers.push_back(*value);
  }
  if (!text.empty() || numbers.size() != count) return std::nullopt;
  return numbers;
}

void add_place(Metadata& metadata, const Place& place) {
  if (!place.layout.empty()) metadata.emplace_back(kLayout, place.layout);
  if (!place.axes.empty()) metadata.emplace_back(kAxes, place.axes);
  if (place.metres) metadata.emplace_back(kUnit, fmt::format("{}", *place.metres));
  if (place.bounds)
    metadata.emplace_back(kBounds, fmt::format("{}", fmt::join(*place.bounds, " ")));
}

Place place_of(const Metadata& metadata) {
  const auto text = [&](const char* name) {
    const std::string* const value = find_metadata(metadata, name);
    return value == nullptr ? std::string() : *value;
  };
  Place place{text(kLayout), text(kAxes), finite(text(kUnit)), {}};
  if (!are_axes(place.axes)) place.axes.clear();
  if (place.metres && *place.metres <= 0) place.metres.reset();
  if (const auto bounds = numbers_from_string(text(kBounds), ' ', 6)) {
    std::ranges::copy(*bounds, place.bounds.emplace().begin());
  }
  return place;
}

void add_states(Metadata& metadata, const std::vector<FrameState>& states) {
  std::string text;
  for (const FrameState& state : states) {
    text += fmt::format("{}{} {} {}", text.empty() ? "" : "\n", state.frame,
                        state.time ? fmt::format("{}", *state.time) : "-", state.name);
  }
  if (!text.empty()) metadata.emplace_back(kStates, text);
}

std::vector<FrameState> states_of(const Metadata& metadata) {
  std::vector<FrameState> states;
  const std::string* const value = find_metadata(metadata, kStates);
  if (value == nullptr) return states;
  for (std::string_view text = *value; !text.empty();) {
    if (auto state = state_of(next(text, '\n'))) states.push_back(std::move(*state));
  }
  return states;
}

}  // namespace gicodec::tools
