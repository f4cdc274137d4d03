#include "world_flags.h"

#include "dump/error.h"
#include "dump/text.h"

#include <gicodec/engines.h>

#include <fmt/format.h>

#include <algorithm>

namespace gicodec::tools {
namespace {

Place place_of(const WorldFlags& flags, const std::string& layout) {
  Place place;
  if (const EngineLayout* const engine = find_engine_layout(layout)) {
    place.layout = engine->name;
    place.axes = engine->axes;
    if (engine->metres > 0) place.metres = engine->metres;
  }
  if (!flags.axes.empty()) {
    place.axes = flags.axes;
    std::ranges::replace(place.axes, ',', ' ');
    if (!are_axes(place.axes)) {
      fail(Exit::usage,
           "--axes does not take \"{}\"; expected where +x, +y and +z point: right or left, up or "
           "down, forward or back, such as right,up,back",
           flags.axes);
    }
  }
  if (flags.metres) place.metres = flags.metres;
  if (flags.bounds.empty()) return place;
  const auto bounds = numbers_from_string(flags.bounds, ',', 6);
  bool box = bounds.has_value();
  for (std::size_t i = 0; box && i < 3; ++i) box = (*bounds)[i] < (*bounds)[i + 3];
  if (!box) {
    fail(Exit::usage,
         "--bounds does not take \"{}\"; expected the least x, y and z of the box that is lit and "
         "the greatest, such as -4,0,-4,4,3,4",
         flags.bounds);
  }
  std::ranges::copy(*bounds, place.bounds.emplace().begin());
  return place;
}

/// FRAME=TIME, FRAME=TIME:NAME or FRAME=:NAME.
FrameState state_of(const std::string& flag, std::span<const std::uint64_t> frames) {
  const std::size_t equals = flag.find('='), colon = flag.find(':');
  const std::string frame = flag.substr(0, equals);
  const std::string time =
      equals == flag.npos ? "" : flag.substr(equals + 1, std::max(colon, equals + 1) - equals - 1);
  FrameState state;
  if (colon != flag.npos) state.name = flag.substr(colon + 1);
  const auto number = numbers_from_string(frame, ',', 1);
  if (const auto value = numbers_from_string(time, ',', 1)) state.time = value->front();
  const bool clear = (time.empty() || state.time) && (state.time || !state.name.empty());
  if (equals == flag.npos || !number || !clear || !is_utf8(state.name) ||
      state.name.find('\n') != state.name.npos) {
    fail(Exit::usage,
         "--state does not take \"{}\"; expected a frame with a time, a name or both, such as "
         "4=12.5:noon, 4=12.5 or 4=:lamp",
         flag);
  }
  const auto found = std::ranges::find(frames, number->front(),
                                       [](std::uint64_t one) { return static_cast<double>(one); });
  if (found == frames.end()) {
    fail(Exit::usage, "--state {}: there is no frame {}; there are {} to {}", flag, frame,
         frames.front(), frames.back());
  }
  state.frame = *found;
  return state;
}

}  // namespace

void add_world_flags(Command& command, WorldFlags& flags) {
  const char* const group = "Where it stands in the world (kept in the container)";
  command
      .add_option("--axes", flags.axes,
                  "Where +x, +y and +z point, such as forward,right,up; --layout says it of most "
                  "engines")
      ->type_name("X,Y,Z")
      ->group(group);
  command.add_option("--unit", flags.metres, "Metres of one unit, such as 0.01")
      ->allow(in_range(1e-9, 1e9))
      ->type_name("METRES")
      ->group(group);
  command
      .add_option("--bounds", flags.bounds,
                  "The box that is lit: its least x, y and z, then its greatest")
      ->type_name("NUMBERS")
      ->group(group);
  command
      .add_option("--state", flags.states,
                  "What a frame stands for: a time, a name or both, such as 4=12.5:noon; may be "
                  "repeated")
      ->type_name("FRAME=TIME:NAME")
      ->group(group)
      ->expected(1)
      ->take_all();
}

void describe_world(const WorldFlags& flags, const std::string& layout,
                    std::span<const std::uint64_t> frames, ContainerDescription& description) {
  const Place place = place_of(flags, layout);
  for (VolumeEntry& volume : description.volumes) add_place(volume.metadata, place);
  std::vector<FrameState> states;
  for (const std::string& flag : flags.states) states.push_back(state_of(flag, frames));
  std::ranges::sort(states, {}, &FrameState::frame);
  const auto twice = std::ranges::adjacent_find(states, {}, &FrameState::frame);
  if (twice != states.end()) {
    fail(Exit::usage, "--state names frame {} twice; leave out one of them", twice->frame);
  }
  add_states(description.metadata, states);
}

}  // namespace gicodec::tools
