// Row chunks: maps and 3D textures by rows that reach over blocks, fast (docs/native/rows.md).
#pragma once

#include "native/planes/kernels.h"
#include "native/rows/row_planes.h"
#include "native/rows/row_tables.h"

#include <gicodec/backend.h>
#include <gicodec/status.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

/// First byte of the chunk.
inline constexpr std::uint8_t kRowChunk = 6;

/// Memory of one thread, kept for its capacity.
struct RowMemory {
  RowPlanes planes;
  ChannelForms forms;
  RowTables tables;
  RowPlanes past;  ///< in updates
  /// By channel: a strip's rows; those of the slice before and of the past, and each one row above.
  std::array<Vector<std::uint16_t>, kMaxComponents> lanes, slice, slice_above, past_lanes,
      past_above, above, nearest, palette, z_residuals;
  Vector<std::uint16_t> above_repeats, trail, z_repeats;
  Vector<Step> steps;
  Vector<std::byte> bytes;
  std::vector<std::byte> forms_bytes;
};

/// Appends the chunk unless it would have more than `most` bytes, or halves that are not wanted;
/// false then, and `out` is as it was.
bool encode_rows(const Update& u, std::span<const std::uint32_t> positions,
                 const BlockTable& records, RowChoice choice, std::size_t most, RowMemory& memory,
                 ValueModel& values, std::vector<std::byte>& out);
/// Checks what a chunk holds as far as that needs no blocks.
Status check_rows(const TextureDesc& desc, std::span<const std::byte> bytes);
/// `bytes`: what follows the first. Safe on any bytes.
Status decode_rows(const Update& u, std::span<const std::uint32_t> positions,
                   std::span<const std::byte> bytes, std::span<std::byte> records,
                   RowMemory& memory, ValueModel& values);

// Shared by both directions.
/// What the mirror has, as it is coded, after forms are known.
void load_past(const Update& u, std::span<const std::uint32_t> positions, RowMemory& memory);
/// The strips' channels, after forms are known.
[[nodiscard]] RowStrip prepare_strips(bool update, RowMemory& memory);
[[nodiscard]] RowClasses classes_of(const RowStrip& strip);
/// The strip that begins at row `y`; with what is known of the slice before, and of the past.
void move_to(const Kernels& kernels, RowStrip& strip, RowMemory& memory, std::size_t y);
/// Values of the strip ↔ lanes.
void load_lanes(const Kernels& kernels, RowMemory& memory, std::size_t y);
void store_lanes(const Kernels& kernels, RowMemory& memory, const RowStrip& strip, std::size_t y);

}  // namespace gicodec::native
