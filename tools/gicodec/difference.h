// Differences between two textures of the same description.
#pragma once

#include "common/probe_set.h"
#include "dump/dump.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

struct ChannelDifference {
  std::string name;
  std::uint64_t texels = 0;        ///< texels that differ
  std::uint64_t max_distance = 0;  ///< codes; for floats representable values
  double squared = 0;              ///< sum of squared code distances; unorm only
};

struct FirstDifference {
  TexelPlace place;  ///< the first, by rows of the image
  Component component;
  std::uint32_t left = 0, right = 0;
};

struct Difference {
  std::uint64_t total_probes = 0, total_texels = 0;  ///< compared
  std::uint64_t probes = 0, texels = 0;              ///< different
  std::uint64_t beyond = 0;                          ///< texels beyond the bound
  std::vector<ChannelDifference> channels;
  std::optional<FirstDifference> first;
  std::optional<double> psnr;  ///< dB over R, G and B; only of unorm colour that differs

  [[nodiscard]] bool same() const noexcept { return texels == 0; }
};

/// Compares two tightly packed textures of `desc`, without the probes in `skip`. `max_error`: see
/// error_bound.h; the first difference is then the first beyond it, if any.
[[nodiscard]] Difference compare_texels(const TextureDesc& desc, std::span<const std::byte> left,
                                        std::span<const std::byte> right, const ProbeSet& skip = {},
                                        float max_error = 0);

/// Different attributes, except compression, and different channel types, one line each.
[[nodiscard]] std::vector<std::string> compare_headers(const DumpInfo& left, const DumpInfo& right);

/// "texel (12, 40), probe 33 (1, 2, 0), channel R: 512 against 513".
[[nodiscard]] std::string to_string(const FirstDifference& first, const Record& record);
[[nodiscard]] nlohmann::ordered_json to_json(const Difference& difference, const Record& record);

}  // namespace gicodec::tools
