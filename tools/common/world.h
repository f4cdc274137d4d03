// Where volumes stand in the world, and which states of it a container's frames are: keys of
// metadata that other programs read (FORMAT.md, "Keys").
#pragma once

#include <gicodec/container.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// What the metadata of a volume says of its place; empty where it says nothing.
struct Place {
  std::string layout;            ///< EngineLayout::name
  std::string axes;              ///< "right up back": where +x, +y and +z point
  std::optional<double> metres;  ///< of a unit
  /// Least x, y, z and greatest of the box that the volume lights, in units along its axes.
  std::optional<std::array<double, 6>> bounds;
};

/// A frame with a time, a name or both.
struct FrameState {
  std::uint64_t frame = 0;
  std::optional<double> time;
  std::string name;
};

/// True for three of right, left, up, down, forward and back, one of each pair, a space between.
[[nodiscard]] bool are_axes(std::string_view text) noexcept;
/// Precondition: are_axes().
[[nodiscard]] bool is_right_handed(std::string_view axes) noexcept;
/// Numbers with `separator` between; nullopt unless there are `count`, all finite.
[[nodiscard]] std::optional<std::vector<double>> numbers_from_string(std::string_view text,
                                                                     char separator,
                                                                     std::size_t count);

void add_place(Metadata& metadata, const Place& place);
/// Values that are not as FORMAT.md says are left out.
[[nodiscard]] Place place_of(const Metadata& metadata);
void add_states(Metadata& metadata, const std::vector<FrameState>& states);
/// Lines that are not as FORMAT.md says are left out.
[[nodiscard]] std::vector<FrameState> states_of(const Metadata& metadata);

}  // namespace gicodec::tools
