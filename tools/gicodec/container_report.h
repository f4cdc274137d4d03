// The report of `gicodec info` about a container, as text and JSON.
#pragma once

#include "common/container_input.h"
#include "container_sums.h"
#include "payload_report.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace gicodec::tools {

struct PacketLine {
  std::uint64_t frame = 0;
  std::uint32_t region = 0;
  PacketInfo info;
  std::uint64_t bytes = 0;
  std::optional<std::uint64_t> blocks;  ///< as blocks_in()
};

struct TextureReport {
  Sums keyframes, updates, all;
  std::optional<std::uint64_t> first_frame, last_frame;
  std::set<std::uint8_t> backends;
  std::vector<PacketLine> packets;  ///< only with --packets
  PayloadReport payload;
};

struct ContainerReport {
  ContainerInput& input;
  Totals totals;
  std::vector<TextureReport> textures;
  std::optional<double> fps;
  bool metadata = false;  ///< shows what is kept of files
  bool by_index = false;  ///< says what the index lists: packets were not read
  std::string damage;     ///< the error that ended reading
};

void print_text(const ContainerReport& report);
[[nodiscard]] nlohmann::ordered_json to_json(const ContainerReport& report);

/// "native", or "backend 200".
[[nodiscard]] std::string backend_text(std::uint8_t id);

}  // namespace gicodec::tools
