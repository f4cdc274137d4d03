#include "native/adaptive_chunk.h"

#include "base/binary_coder.h"
#include "native/chunk_head.h"
#include "native/vertex_neighbours.h"
#include "native/workspace.h"
#include "payload/set_order.h"

#include <cstring>

namespace gicodec::native {
namespace {

/// Runs body(position, vertices around, mirror block or nothing) for every vertex. `records`:
/// those before it are there.
template <typename Body>
bool for_each_vertex(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& records, const Body& body) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    auto past = u.update ? u.mirror.blocks[u.probes[positions[i]]] : std::span<const std::byte>();
    if (is_zero(past)) past = {};
    const KnownLights around = known_around(u, positions, i, records, !past.empty());
    if (!body(positions[i], around, past)) return false;
  }
  return true;
}

/// Runs begin(position) for every brick; then, for each family of its voxels, tell(position, offset
/// in the block, lights around, mirror's light or nothing) for each of them, and body() with the
/// same and what was told for those with light. `records`: those before it are there.
template <typename Begin, typename Tell, typename Body>
bool for_each_voxel(const Update& u, std::span<const std::uint32_t> positions,
                    const BlockTable& records, Bricks& bricks, const Begin& begin, const Tell& tell,
                    const Body& body) {
  constexpr unsigned kFamily = KnownLights::kChildren;
  struct Member {
    std::span<const std::byte> past;
    KnownLights around;
    ToldLight told;
  };
  std::array<Member, kFamily> family;
  bricks.reset(u, positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t position = bricks.enter(u, records, i);
    if (!begin(position)) return false;
    for (unsigned first = 0; first < bricks.voxels(); first += kFamily) {
      for (unsigned m = first; m < first + kFamily; ++m) {
        Member& one = family[m - first];
        one.told = {};
        if (!bricks.exists(m)) continue;
        one.past = bricks.past(m);
        if (is_zero(one.past)) one.past = {};
        one.around = bricks.around(m, !one.past.empty());
        one.told = tell(position, bricks.offset(m), one.around, one.past);
        bricks.tell(m, one.told);
      }
      for (unsigned m = first; m < first + kFamily; ++m) {
        Member& one = family[m - first];
        if (!one.told.any) continue;
        one.around.family = bricks.family(m);
        body(position, bricks.offset(m), one.around, one.past, one.told);
      }
    }
  }
  return true;
}

/// Runs body(position, mirror block, presence) for every block.
template <typename Body>
bool for_each_block(const Update& u, std::span<const std::uint32_t> positions, const Body& body) {
  for (const std::uint32_t position : positions) {
    const auto past = u.update ? u.mirror.blocks[u.probes[position]] : std::span<const std::byte>();
    const auto presence = u.partial() ? u.presence_of(position) : std::span<const std::byte>();
    if (!body(position, past, presence)) return false;
  }
  return true;
}

}  // namespace

bool encode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& records, std::size_t most, AdaptiveModels& models,
                     std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  out.push_back(std::byte{kAdaptiveChunk});
  BinaryEncoder coder(out);
  const auto fits = [&] { return out.size() - begin <= most; };
  bool within = true;
  if (is_set(u.desc)) {
    models.set.reset(models.values);
    within = for_each_block(u, positions, [&](std::uint32_t position, auto past, auto presence) {
      const auto block = records[position];
      const std::size_t present =
          BlockPresence(u.desc, presence).count() * std::size_t{u.desc.record.bytes};
      models.set.encode(coder, u.desc.record, past, block.first(present));
      return fits();
    });
  } else if (is_bricks(u.desc)) {
    models.light.reset(u.desc.record, models.values);
    const std::size_t size = kVoxelDirections * std::size_t{u.desc.record.bytes};
    within = for_each_voxel(
        u, positions, records, models.bricks, [&](std::uint32_t) { return fits(); },
        [&](std::uint32_t position, std::size_t at, const auto& around, auto past) {
          return models.light.tell(coder, around, past, records[position].subspan(at, size));
        },
        [&](std::uint32_t position, std::size_t at, const auto& around, auto past, auto told) {
          models.light.code(coder, told, around, past, records[position].subspan(at, size), {});
        });
  } else if (is_vertices(u.desc)) {
    models.light.reset(u.desc.record, models.values);
    within = for_each_vertex(u, positions, records,
                             [&](std::uint32_t position, const auto& around, auto past) {
                               models.light.code(coder, around, past, records[position], {});
                               return fits();
                             });
  } else {
    models.record.reset(u.desc, u.update, models.values);
    within = for_each_block(u, positions, [&](std::uint32_t position, auto past, auto presence) {
      models.record.encode(coder, records[position], past, presence);
      return fits();
    });
  }
  coder.finish();
  if (within && fits()) return true;
  out.resize(begin);
  return false;
}

Status decode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                       std::span<const std::byte> bytes, std::span<std::byte> records,
                       AdaptiveModels& models) {
  const std::size_t size = u.block_bytes();
  BinaryDecoder coder(bytes);
  bool sound = true;
  if (is_set(u.desc)) {
    models.set.reset(models.values);
    sound = for_each_block(u, positions, [&](std::uint32_t position, auto past, auto presence) {
      const auto block = records.subspan(position * size, size);
      const std::size_t present =
          BlockPresence(u.desc, presence).count() * std::size_t{u.desc.record.bytes};
      std::memset(block.data() + present, 0, size - present);
      return models.set.decode(coder, u.desc.record, past, block.first(present)) &&
             !coder.overrun() && !u.cancelled();
    });
  } else if (is_bricks(u.desc)) {
    models.light.reset(u.desc.record, models.values);
    const BlockTable decoded{records.data(), size};
    const std::size_t voxel = kVoxelDirections * std::size_t{u.desc.record.bytes};
    sound = for_each_voxel(
        u, positions, decoded, models.bricks,
        [&](std::uint32_t position) {
          std::memset(records.data() + position * size, 0, size);
          return !coder.overrun() && !u.cancelled();
        },
        [&](std::uint32_t, std::size_t, const auto& around, auto past) {
          return models.light.tell(coder, around, past, {});
        },
        [&](std::uint32_t position, std::size_t at, const auto& around, auto past, auto told) {
          models.light.code(coder, told, around, past, {},
                            records.subspan(position * size + at, voxel));
        });
  } else if (is_vertices(u.desc)) {
    models.light.reset(u.desc.record, models.values);
    const BlockTable decoded{records.data(), size};
    sound = for_each_vertex(
        u, positions, decoded, [&](std::uint32_t position, const auto& around, auto past) {
          models.light.code(coder, around, past, {}, records.subspan(position * size, size));
          return !coder.overrun() && !u.cancelled();
        });
  } else {
    models.record.reset(u.desc, u.update, models.values);
    sound = for_each_block(u, positions, [&](std::uint32_t position, auto past, auto presence) {
      models.record.decode(coder, records.subspan(position * size, size), past, presence);
      return !coder.overrun() && !u.cancelled();
    });
  }
  if (u.cancelled()) return Status::cancelled;
  if (coder.overrun()) return Status::truncated;
  return sound && coder.ended() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec::native
