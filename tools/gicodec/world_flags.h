// Flags that say where volumes stand in the world, and which states of it frames are.
#pragma once

#include "common/command_line.h"
#include "common/world.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

struct WorldFlags {
  std::string axes, bounds;
  std::optional<double> metres;
  std::vector<std::string> states;
};

void add_world_flags(Command& command, WorldFlags& flags);
/// Adds what the flags, and an engine's layout, say to the metadata. Throws Error of Exit::usage
/// for an invalid value, and for a state of a frame that is not there.
void describe_world(const WorldFlags& flags, const std::string& layout,
                    std::span<const std::uint64_t> frames, ContainerDescription& description);

}  // namespace gicodec::tools
