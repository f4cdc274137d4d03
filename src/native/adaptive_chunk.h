// Adaptive chunks (docs/native.md, "Adaptive chunks"): records by models that learn as they go,
// instead of static tables. Slow and small.
#pragma once

#include "native/bricks.h"
#include "native/light_model.h"
#include "native/record_model.h"
#include "native/set_update.h"

#include <gicodec/backend.h>
#include <gicodec/status.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

struct Update;

/// Memory of one thread, kept for its capacity.
struct AdaptiveModels {
  ValueModel values;  ///< of any
  SetUpdate set;
  RecordModel record;
  LightModel light;
  Bricks bricks;
};

/// What AdaptiveModels take on the heap, besides what encoding a set does.
inline constexpr std::size_t kAdaptiveMemory = 5 << 18;

[[nodiscard]] inline bool is_set(const TextureDesc& desc) noexcept {
  return desc.model == Model::unordered;
}
[[nodiscard]] inline bool is_bricks(const TextureDesc& desc) noexcept {
  return desc.model == Model::octree && (desc.record.format == Format::E5B9G9R9_UFLOAT_PACK32 ||
                                         desc.record.format == Format::R16G16B16A16_SFLOAT);
}
[[nodiscard]] inline bool is_vertices(const TextureDesc& desc) noexcept {
  return desc.model == Model::hemispheres;
}

/// Appends the chunk unless it would have more than `most` bytes; false then, and `out` is as it
/// was.
bool encode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& records, std::size_t most, AdaptiveModels& models,
                     std::vector<std::byte>& out);
/// `bytes`: what follows the chunk's first. Safe on any bytes.
Status decode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                       std::span<const std::byte> bytes, std::span<std::byte> records,
                       AdaptiveModels& models);

}  // namespace gicodec::native
