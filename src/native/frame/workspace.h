// What coding one chunk needs in memory, and the steps both directions share.
#pragma once

#include <gicodec/backend.h>

#include "base/memory.h"
#include "native/frame/chunk.h"
#include "native/matches/match_memory.h"
#include "native/models/models.h"
#include "native/planes/adaptation.h"
#include "native/planes/kernels.h"
#include "native/planes/planes.h"
#include "native/planes/reference.h"
#include "native/rows/row_chunk.h"
#include "native/tokens/token_chunk.h"
#include "texture/presence.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

namespace gicodec::native {

/// What is common to all chunks of an update.
struct Update {
  const TextureDesc& desc;
  const PlaneLayout& layout;
  const Kernels& kernels;
  const TokenKernels& tokens;
  Grid box;
  std::span<const std::uint32_t> probes;
  MirrorView mirror;
  bool update = false;    ///< not a keyframe, nor an intra update
  bool mirrored = false;  ///< neighbours outside the update are known by `mirror`
  const std::atomic<bool>* cancel = nullptr;  ///< if set and true, decoding is to end
  std::span<const std::byte> presence;        ///< of `probes`, in their order
  bool adaptive = false;                      ///< encoding: by adaptive chunks, or raw ones
  /// Of bricks, if `mirrored`: those that the mirror holds and the update does not list.
  const Vector<PlacedBrick>* held = nullptr;

  [[nodiscard]] bool neighbours() const { return model_of(desc).neighbours; }
  [[nodiscard]] unsigned width() const { return desc.block.x; }
  /// Of all slices, one after the other.
  [[nodiscard]] unsigned rows() const { return unsigned{desc.block.y} * desc.block.z; }
  [[nodiscard]] std::size_t texels() const { return record_count(desc.block); }
  [[nodiscard]] std::size_t block_bytes() const { return texels() * layout.texel_bytes; }
  [[nodiscard]] bool partial() const { return desc.presence != Presence::all; }
  [[nodiscard]] std::span<const std::byte> presence_of(std::uint32_t position) const {
    const std::size_t size = presence_bytes(desc);
    return presence.subspan(position * size, size);
  }
  [[nodiscard]] bool cancelled() const noexcept {
    return cancel != nullptr && cancel->load(std::memory_order_relaxed);
  }
  /// Of the records of those blocks that exist.
  [[nodiscard]] std::size_t present_bytes(std::span<const std::uint32_t> positions) const;
  void unpack(const std::byte* in, std::uint16_t* planes) const {
    kernels.unpack(layout, reinterpret_cast<const std::uint8_t*>(in), texels(), planes);
    if (layout.stepped) kernels.to_steps(layout, texels(), planes);
  }
  /// Uses the planes up.
  void pack(std::uint16_t* planes, std::byte* out) const {
    if (layout.stepped) kernels.from_steps(layout, texels(), planes);
    kernels.pack(layout, planes, texels(), reinterpret_cast<std::uint8_t*>(out));
  }
};

/// Head of a chunk (docs/native.md, "Chunk").
struct ChunkHead {
  unsigned lanes = 1;  ///< power of two, at most kLanes
  bool flat = false;
  bool repeats = false;                     ///< planes: texels may repeat others
  std::uint32_t coded = UINT32_MAX;         ///< planes that vary, by bit
  std::uint16_t constant[kMaxPlanes] = {};  ///< values of the others
  std::uint16_t frequent[2] = {};           ///< pairs
  TableChoice tables;
};

/// Whether decoders accept a chunk of that many probes in so few lanes, which take long.
[[nodiscard]] constexpr bool enough_lanes(unsigned lanes, std::size_t probes) noexcept {
  return lanes == kLanes || probes < std::size_t{16} * lanes;
}

/// What an encoder keeps of a group, so that nothing is searched or modelled twice.
struct Modelled {
  bool chosen = false, exact = false;
  std::uint16_t mode[2 * kLanes] = {};
  std::span<const Step> steps;  ///< under these modes, if kept
};

/// Memory of one thread, kept for its capacity.
class Workspace {
 public:
  Chunk chunk;

  /// Builds the chunk and unpacks the mirror blocks it may refer to.
  void prepare(const Update& u, std::span<const std::uint32_t> positions, unsigned lanes,
               bool flat);
  /// Fills what the head fixes: constant blocks.
  void set_head(const Update& u);

  [[nodiscard]] std::uint16_t* current(std::uint32_t block) {
    return current_.data() + block * stride_;
  }
  [[nodiscard]] Known known(const Update& u, std::uint32_t block) const;
  /// The blocks of group `g`: active lanes, mode table rows to be filled by the caller.
  [[nodiscard]] Group group(const Update& u, std::size_t g);
  /// Brings the candidate blocks of a group into lanes: of pairs, and for repeats.
  void load_candidates(const Update& u, std::size_t g);
  /// Brings each lane's reference blocks into lanes: [plane group][lane]. Pairs have two plane
  /// groups of one plane, planes one of all.
  using LaneBlocks = std::array<const std::uint16_t*, kLanes>;
  void load_references(const Update& u, const LaneBlocks (&blocks)[2]);
  /// Some of their values: `count` from value `at` of the planes on.
  void load_reference_part(const Update& u, const LaneBlocks& blocks, std::size_t at,
                           std::size_t count);
  /// Blocks of a group ↔ lanes.
  void load_current(const Update& u, std::size_t g);
  void store_current(const Update& u, std::size_t g, const Group& group);

  /// Room for a reference block of a lane, and one more.
  [[nodiscard]] std::uint16_t* lane_block(unsigned lane) {
    return lane_blocks_.data() + lane * stride_;
  }
  [[nodiscard]] const std::uint16_t* constant_block() const { return constant_.data(); }
  [[nodiscard]] const std::uint16_t* frequent_block() const { return frequent_.data(); }
  [[nodiscard]] const std::uint16_t* zero_block() const { return zero_.data(); }
  [[nodiscard]] std::size_t stride() const { return stride_; }
  /// Planes up to the last one that is coded; those beyond never go into lanes.
  [[nodiscard]] unsigned planes() const { return planes_; }
  [[nodiscard]] std::uint16_t* cost_scratch() { return cost_scratch_.data(); }

  /// Steps of a group, at most.
  [[nodiscard]] static std::size_t steps_of_group(const Update& u) {
    return 2 + u.texels() * (u.layout.pairs ? 3 : 1 + u.layout.planes);
  }
  /// Makes room for the steps of that many groups.
  void reserve_steps(const Update& u, std::size_t groups);
  Vector<Step> steps;
  Vector<Modelled> modelled;  ///< of every group, where it is kept
  Histogram histogram;
  AdaptedTables adapted;
  Vector<std::byte> bytes;  ///< words of the chunk
  ModelMemory models;
  TokenMemory tokens;
  RowMemory rows;
  MatchMemory matches;
  ChunkHead head;  ///< of the chunk

 private:
  /// Which records of a group exist; false if all do.
  bool find_present(const Update& u, std::size_t g);

  std::size_t stride_ = 0;  ///< values from a block to the next
  unsigned planes_ = 0;
  Vector<std::uint16_t> current_, previous_;
  Vector<std::uint16_t> zero_, constant_, frequent_, lane_blocks_, cost_scratch_;
  Vector<std::uint16_t> lanes_current_, lanes_reference_, lanes_candidate_[kBlockCandidates],
      scratch_;
  Vector<Present> present_;  ///< of the group's records, if not all exist
};

/// The reference block of one lane for a mode: `count` values from value `at` of the planes on.
[[nodiscard]] const std::uint16_t* lane_reference(const Update& u, const Workspace& w,
                                                  const Known& known, const Mode& mode,
                                                  std::size_t at, std::size_t count,
                                                  std::uint16_t* room);

}  // namespace gicodec::native
