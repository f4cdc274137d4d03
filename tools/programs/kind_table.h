// The table of kinds that the programs trace and draw.
#pragma once

#include "kinds/traced_kind.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::kinds {

/// How a client draws: --max-memory and --set.
struct DrawingFlags {
  std::uint64_t memory = 4096;     ///< MiB that light may take, with its textures
  std::vector<std::string> set{};  ///< NAME=VALUE
};
/// Throws tools::Error of Exit::bad_input if the light would take more memory, of Exit::usage for
/// settings that the kind does not have.
[[nodiscard]] std::unique_ptr<VolumeLight> make_light(const TracedKind& kind,
                                                      const ddgi::RayScene& scene,
                                                      const VolumeDesc& desc,
                                                      const DrawingFlags& flags);

[[nodiscard]] std::span<const TracedKind> traced_kinds();
/// True if viewers need only some of the volume's blocks.
[[nodiscard]] bool is_culled(const FeedVolume& volume);
/// By name or by Kind::id; nullptr for a kind that is not traced.
[[nodiscard]] const TracedKind* find_traced_kind(std::string_view name);
[[nodiscard]] const TracedKind* find_traced_kind(std::uint8_t kind);

}  // namespace gicodec::kinds
