// What `gicodec encode` takes.
#pragma once

#include "common/backend_flags.h"
#include "common/cli.h"
#include "geometry_flags.h"
#include "world_flags.h"

#include <memory>
#include <string>
#include <vector>

namespace gicodec::tools {

struct EncodeOptions {
  std::string output;
  std::vector<std::string> inputs;
  GeometryFlags geometry;
  WorldFlags world;
  BackendFlags backend;
  std::vector<std::string> max_error;
  std::string inactive, region;
  std::string jobs;
  bool resume = false;
  std::string given;  ///< the other flags
  unsigned threads = 1;
};

/// Adds the command; its options are set by Command::parse().
std::shared_ptr<const EncodeOptions> add_encode_flags(Cli& cli);
[[nodiscard]] Exit encode(const EncodeOptions& options, const Cli& cli);

}  // namespace gicodec::tools
