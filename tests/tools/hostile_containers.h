// Containers of at most a mebibyte that are made to cost whoever reads them much.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gicodec::tools {

struct HostileContainer {
  std::string name;
  std::vector<std::byte> bytes;
  /// What the programs say to it; without words it is odd, but sound.
  std::string refusal;
  bool empty = false;  ///< it has no packets, and nothing to decode
  bool small = false;  ///< its packets take little; only files of it would be great
};

inline constexpr std::size_t kHostileBytes = std::size_t{1} << 20;

[[nodiscard]] std::vector<HostileContainer> hostile_containers();
/// A volume that is one region of as many probes as there may be, and packets of a probe each.
[[nodiscard]] std::vector<std::byte> small_packets_of_a_great_region();

}  // namespace gicodec::tools
