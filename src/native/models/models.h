// What native makes of the models of textures: a row of a table each. Adaptive chunks
// (docs/native.md, "Adaptive chunks"): records by models that adapt, instead of static
// tables; slow and small. Each such model is a folder of its name.
#pragma once

#include "native/models/continuous/continuous_model.h"
#include "native/models/light/light_model.h"
#include "native/models/octree/bricks.h"
#include "native/models/records/record_model.h"
#include "native/models/unordered/set_update.h"

#include <gicodec/backend.h>
#include <gicodec/status.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

struct Update;

/// When encoders take adaptive chunks.
enum class Adapts : std::uint8_t {
  never,
  if_strong,  ///< if time does not matter
  if_small,   ///< or blocks are small and there is not much of them
  always,
};

struct ModelRow {
  Model model;
  bool neighbours;  ///< the blocks at x−1, y−1 and z−1 predict; else every chunk is flat
  Adapts adapts;
  std::uint32_t chunk_records;  ///< that an adaptive chunk should have, to adapt enough
};

/// Whether adaptive chunks of a texture are rasters: of continuous textures whose texels have
/// values.
[[nodiscard]] bool takes_raster(const TextureDesc& desc) noexcept;

/// That of Model::none where records are none that the texture's model is made for.
[[nodiscard]] const ModelRow& model_of(const TextureDesc& desc) noexcept;

/// Memory of one thread, kept for its capacity.
struct ModelMemory {
  ValueModel values;  ///< of any
  SetUpdate set;
  RecordModel record;
  ContinuousModel continuous;
  LightModel light;
  Bricks bricks;
};

/// What ModelMemory takes on the heap, besides what encoding a set does.
inline constexpr std::size_t kModelMemory = 5 << 18;

/// Appends the chunk unless it would have more than `most` bytes; false then, and `out` is as it
/// was.
bool encode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& records, std::size_t most, ModelMemory& memory,
                     std::vector<std::byte>& out);
/// `bytes`: what follows the chunk's first. Safe on any bytes.
Status decode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                       std::span<const std::byte> bytes, std::span<std::byte> records,
                       ModelMemory& memory);

}  // namespace gicodec::native
