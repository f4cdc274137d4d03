// The records of a chunk by an adaptive model, in either direction: one source for both.
#pragma once

#include "base/binary_coder.h"
#include "native/frame/workspace.h"

#include <span>

namespace gicodec::native {

/// What a model codes, with a BinaryEncoder or a BinaryDecoder.
template <typename Coder>
struct ChunkCoding {
  const Update& update;
  std::span<const std::uint32_t> positions;  ///< of the chunk's blocks in the update
  BlockTable records;            ///< by position; decoding: those that are known by then
  std::span<std::byte> decoded;  ///< the same, to be written; encoding: nothing
  Coder& coder;
  ModelMemory& memory;
  std::size_t most = 0;  ///< encoding: bytes that the coder's output may have
  bool palettes = true;  ///< encoding: numbers that occur may be listed

  /// The records of a block; nothing when decoding.
  [[nodiscard]] std::span<const std::byte> in(std::uint32_t position) const {
    if constexpr (Coder::kDecodes) return {};
    return records[position];
  }
  /// Where they go; nothing when encoding.
  [[nodiscard]] std::span<std::byte> out(std::uint32_t position) const {
    if constexpr (!Coder::kDecodes) return {};
    return decoded.subspan(position * update.block_bytes(), update.block_bytes());
  }
  /// What the mirror has of the block; nothing in keyframes.
  [[nodiscard]] std::span<const std::byte> previous(std::uint32_t position) const {
    if (!update.update) return {};
    return update.mirror.blocks[update.probes[position]];
  }
  /// Which records exist; nothing where all do.
  [[nodiscard]] std::span<const std::byte> presence(std::uint32_t position) const {
    if (!update.partial()) return {};
    return update.presence_of(position);
  }
  /// Whether to code another block. Models call it after each.
  [[nodiscard]] bool goes_on() const {
    if constexpr (Coder::kDecodes) {
      return !coder.overrun() && !update.cancelled();
    } else {
      return coder.size() <= most;
    }
  }
};

// Each in the folder of its name. False if encoding takes too much, or for what no encoder writes.
template <typename Coder>
bool code_records(const ChunkCoding<Coder>& chunk);
template <typename Coder>
bool code_continuous(const ChunkCoding<Coder>& chunk);
template <typename Coder>
bool code_unordered(const ChunkCoding<Coder>& chunk);
template <typename Coder>
bool code_octree(const ChunkCoding<Coder>& chunk);
template <typename Coder>
bool code_hemispheres(const ChunkCoding<Coder>& chunk);

}  // namespace gicodec::native
