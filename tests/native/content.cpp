#include "native/content.h"

#include <algorithm>
#include <cmath>

namespace gicodec::test {
namespace {

/// A component's value in 0..1 for a smooth scene.
double wave(const Grid& probe, std::size_t texel, unsigned component, unsigned frame) {
  const double t = static_cast<double>(texel);
  return 0.5 + 0.4 * std::sin(0.3 * probe.x + 0.5 * probe.y + 0.7 * probe.z + 0.11 * t +
                              0.9 * component + 0.02 * frame);
}

std::uint64_t value(Content content, const Component& c, unsigned index, const Grid& probe,
                    std::size_t texel, unsigned frame, Random& random) {
  const double top = std::pow(2.0, c.bits) - 1;
  const auto full = static_cast<std::uint64_t>(top);
  const double w = wave(probe, texel, index, frame);
  switch (content) {
    case Content::smooth:
      return static_cast<std::uint64_t>(top * std::floor(w * 200) / 200);
    case Content::noisy:
      return static_cast<std::uint64_t>(
          top * std::clamp(w + (static_cast<double>(random() % 64) - 32) / 1000, 0.0, 1.0));
    case Content::white:
      return random() & full;
    case Content::constant:
      return full / 3;
    case Content::extremes:
      return random() % 2 == 0 ? 0 : full;
    case Content::alternating:
      return (probe.x + probe.y + probe.z + texel + frame) % 2 == 0 ? full : random() & full;
  }
  return 0;
}

}  // namespace

Bytes make_cores(const TextureDesc& desc, Content content, unsigned frame, std::uint64_t seed) {
  const FormatInfo& format = *find_format(desc.format);
  const std::size_t texels = std::size_t{desc.core} * desc.core;
  Bytes out(probe_count(desc) * texels * format.texel_bytes);
  Random random(seed + frame * 977);
  std::byte* texel = out.data();
  for (std::uint32_t p = 0; p < probe_count(desc); ++p) {
    const Grid at = {p % desc.grid.x, p / desc.grid.x % desc.grid.y, p / desc.grid.x / desc.grid.y};
    for (std::size_t t = 0; t < texels; ++t, texel += format.texel_bytes) {
      for (unsigned c = 0; c < format.component_count; ++c) {
        const Component& component = format.components[c];
        const auto v = value(content, component, c, at, t, frame, random);
        for (unsigned b = 0; b < component.bits; ++b) {
          const unsigned bit = component.offset + b;
          if ((v >> b & 1) != 0) texel[bit / 8] |= std::byte(1U << bit % 8);
        }
      }
    }
  }
  return out;
}

UpdateCase make_update(const TextureDesc& desc, Content content, bool keyframe,
                       std::uint32_t one_in, std::uint64_t seed) {
  UpdateCase u{desc, {}, {}, {}, keyframe};
  const Bytes now = make_cores(desc, content, 1, seed);
  if (!keyframe) u.mirror = make_cores(desc, content, 0, seed);
  Random random(seed);
  for (std::uint32_t p = 0; p < probe_count(desc); ++p) {
    if (!chance(random, one_in)) continue;
    u.probes.push_back(p);
    const auto block = std::span(now).subspan(p * core_bytes(desc), core_bytes(desc));
    u.texels.insert(u.texels.end(), block.begin(), block.end());
  }
  return u;
}

Bytes encode(UpdateCase& update, const native::PayloadSettings& settings, Isa isa) {
  std::vector<native::Workspace> workspaces;
  Bytes out;
  native::encode_payload(update.encode_job(), settings, isa, workspaces, out);
  return out;
}

TextureDesc any_desc(Random& random) {
  TextureDesc desc;
  desc.format = formats()[pick(random, 0, static_cast<std::uint32_t>(formats().size()) - 1)].format;
  desc.grid = {pick(random, 1, 7), pick(random, 1, 5), pick(random, 1, 6)};
  desc.core =
      static_cast<std::uint16_t>(chance(random, 4) ? pick(random, 1, 17) : pick(random, 1, 9));
  desc.border = static_cast<std::uint16_t>(pick(random, 0, 1));
  return desc;
}

}  // namespace gicodec::test
