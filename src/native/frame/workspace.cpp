#include "native/frame/workspace.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

std::size_t round_up(std::size_t n) { return (n + 7) / 8 * 8; }

}  // namespace

std::size_t Update::present_bytes(std::span<const std::uint32_t> positions) const {
  if (!partial()) return positions.size() * block_bytes();
  std::size_t records = 0;
  for (const auto position : positions) {
    records += BlockPresence(desc, presence_of(position)).count();
  }
  return records * desc.record.bytes;
}

void Workspace::prepare(const Update& u, std::span<const std::uint32_t> positions, unsigned lanes,
                        bool flat) {
  const bool mirrored = u.mirrored && u.neighbours() && (u.layout.pairs || !flat);
  const MirrorView* const mirror = mirrored ? &u.mirror : nullptr;
  if (flat) {
    chunk.build_flat(u.desc.grid, u.box, u.probes, positions, mirror, u.update, lanes);
  } else {
    chunk.build(u.desc.grid, u.box, u.probes, positions, mirror, lanes);
  }
  const unsigned planes = u.layout.planes;
  const std::size_t values = planes * u.texels();
  stride_ = block_stride(planes, u.texels());
  const auto grow = [](Vector<std::uint16_t>& v, std::size_t n) {
    if (v.size() >= n) return;
    v = {};  // What it held is not needed, and never is there room for both.
    v.resize(n);
  };
  grow(current_, chunk.coded * stride_);
  grow(zero_, stride_);
  grow(constant_, stride_);
  grow(lane_blocks_, (kLanes + 2) * stride_);
  grow(cost_scratch_, cost_scratch_size(u.width(), planes));
  const std::size_t lane_values = (round_up(values) + 8) * kLanes;
  grow(lanes_current_, lane_values);
  grow(lanes_reference_, lane_values);
  grow(scratch_, scratch_size(u.texels(), planes, u.layout.pairs, u.layout.shared));
  if (u.partial()) present_.resize(u.texels());
  if (u.layout.pairs) {
    grow(frequent_, stride_);
    for (auto& v : lanes_candidate_) grow(v, lane_values);
  }
  if (!u.mirrored) return;
  grow(previous_, chunk.blocks.size() * stride_);
  for (std::size_t b = u.update ? 0 : chunk.coded; b < chunk.blocks.size(); ++b) {
    u.unpack(u.mirror.blocks[chunk.blocks[b].probe].data(), previous_.data() + b * stride_);
  }
}

void Workspace::set_head(const Update& u) {
  for (auto& lanes : lanes_candidate_) {
    if (head.repeats && lanes.size() < lanes_reference_.size())
      lanes.resize(lanes_reference_.size());
  }
  planes_ = u.layout.pairs ? 2 : static_cast<unsigned>(std::bit_width(head.coded));
  for (unsigned p = 0; p < u.layout.planes; ++p) {
    const bool mantissa = u.layout.shared && p + 1 < u.layout.planes;
    const auto half = u.layout.pairs || mantissa ? 0U : 1U << (u.layout.plane[p].bits - 1);
    std::fill_n(constant_.data() + p * u.texels(), u.texels(), static_cast<std::uint16_t>(half));
    if (u.layout.pairs)
      std::fill_n(frequent_.data() + p * u.texels(), u.texels(), head.frequent[p]);
  }
}

void Workspace::reserve_steps(const Update& u, std::size_t groups) {
  const std::size_t most = groups * steps_of_group(u);
  if (steps.size() < most) steps.resize(most);
}

Known Workspace::known(const Update& u, std::uint32_t block) const {
  Known k;
  if (u.update) k.previous = previous_.data() + block * stride_;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const std::int32_t n = chunk.blocks[block].neighbour[axis];
    if (n == kNoBlock) continue;
    const auto at = static_cast<std::size_t>(n) * stride_;
    const bool coded = static_cast<std::uint32_t>(n) < chunk.coded;
    k.current[axis] = (coded ? current_.data() : previous_.data()) + at;
    if (u.update) k.before[axis] = previous_.data() + at;
  }
  return k;
}

bool Workspace::find_present(const Update& u, std::size_t g) {
  std::uint32_t records = 0;
  std::fill(present_.begin(), present_.end(), Present{});
  for (std::uint32_t b = chunk.group_begin[g]; b < chunk.group_begin[g + 1]; ++b) {
    const BlockPresence presence(u.desc, u.presence_of(chunk.blocks[b].position));
    const unsigned lane = b - chunk.group_begin[g];
    const std::uint32_t count = presence.count();
    records += count;
    for (std::uint32_t t = 0, left = count; left > 0; ++t) {
      const std::uint32_t exists = presence.exists(t) ? 1 : 0;
      present_[t].here |= exists << lane;
      left -= exists;
    }
  }
  for (std::size_t t = 1; t < present_.size(); ++t) {
    present_[t].before = present_[t - 1].before | present_[t - 1].here;
  }
  return records != (chunk.group_begin[g + 1] - chunk.group_begin[g]) * u.texels();
}

Group Workspace::group(const Update& u, std::size_t g) {
  Group group{};
  const unsigned n = chunk.group_begin[g + 1] - chunk.group_begin[g];
  group.active = n == kLanes ? 0xFFFFFFFFU : (1U << n) - 1;
  if (u.partial() && find_present(u, g)) {
    group.present = present_.data();
    group.active = present_.back().before | present_.back().here;
  }
  group.width = u.width();
  group.rows = u.rows();
  group.planes = u.layout.planes;
  group.update = u.update;
  for (unsigned p = 0; p < u.layout.planes; ++p) {
    group.bits[p] = u.layout.plane[p].bits;
  }
  group.coded = head.coded;
  group.low = u.layout.low;
  group.shared = u.layout.shared;
  group.repeats = head.repeats;
  group.frequent[0] = head.frequent[0];
  group.frequent[1] = head.frequent[1];
  group.reference = lanes_reference_.data();
  for (unsigned k = 0; k < kBlockCandidates; ++k) group.candidate[k] = lanes_candidate_[k].data();
  group.current = lanes_current_.data();
  group.scratch = scratch_.data();
  return group;
}

void Workspace::load_candidates(const Update& u, std::size_t g) {
  LaneBlocks blocks[kBlockCandidates];
  for (auto& b : blocks) b.fill(u.layout.pairs ? frequent_block() : zero_block());
  for (std::uint32_t b = chunk.group_begin[g]; b < chunk.group_begin[g + 1]; ++b) {
    const unsigned lane = b - chunk.group_begin[g];
    const Known k = known(u, b);
    if (k.previous != nullptr) blocks[0][lane] = k.previous;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (k.current[axis] != nullptr) blocks[1 + axis][lane] = k.current[axis];
    }
  }
  for (unsigned k = 0; k < kBlockCandidates; ++k) {
    u.kernels.to_lanes(blocks[k].data(), round_up(planes_ * u.texels()),
                       lanes_candidate_[k].data());
  }
}

void Workspace::load_references(const Update& u, const LaneBlocks (&blocks)[2]) {
  if (!u.layout.pairs) {
    u.kernels.to_lanes(blocks[0].data(), round_up(planes_ * u.texels()), lanes_reference_.data());
    return;
  }
  for (unsigned p = 0; p < 2; ++p) {
    u.kernels.to_lanes(blocks[p].data(), round_up(u.texels()),
                       lanes_reference_.data() + p * u.texels() * kLanes);
  }
}

void Workspace::load_reference_part(const Update& u, const LaneBlocks& blocks, std::size_t at,
                                    std::size_t count) {
  u.kernels.to_lanes(blocks.data(), round_up(count), lanes_reference_.data() + at * kLanes);
}

void Workspace::load_current(const Update& u, std::size_t g) {
  LaneBlocks blocks;
  blocks.fill(zero_block());
  for (std::uint32_t b = chunk.group_begin[g]; b < chunk.group_begin[g + 1]; ++b) {
    blocks[b - chunk.group_begin[g]] = current(b);
  }
  u.kernels.to_lanes(blocks.data(), round_up(planes_ * u.texels()), lanes_current_.data());
}

void Workspace::store_current(const Update& u, std::size_t g, const Group& group) {
  std::array<std::uint16_t*, kLanes> blocks;
  blocks.fill(lane_block(kLanes));  // inactive lanes go nowhere
  for (std::uint32_t b = chunk.group_begin[g]; b < chunk.group_begin[g + 1]; ++b) {
    blocks[b - chunk.group_begin[g]] = current(b);
  }
  u.kernels.from_lanes(lanes_current_.data(), round_up(planes_ * u.texels()), blocks.data());
  for (unsigned p = 0; p < u.layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0) continue;
    for (std::uint32_t b = chunk.group_begin[g]; b < chunk.group_begin[g + 1]; ++b) {
      std::uint16_t* const values = current(b) + p * u.texels();
      std::fill_n(values, u.texels(), head.constant[p]);
      if (group.present == nullptr) continue;
      for (std::size_t t = 0; t < u.texels(); ++t) {
        if ((group.present[t].here >> (b - chunk.group_begin[g]) & 1) == 0) values[t] = 0;
      }
    }
  }
}

const std::uint16_t* lane_reference(const Update& u, const Workspace& w, const Known& known,
                                    const Mode& mode, std::size_t at, std::size_t count,
                                    std::uint16_t* room) {
  const bool frequent = u.layout.pairs && (mode.reference == Reference::frequent ||
                                           mode.reference == Reference::neighbours);
  return reference_block(mode, known, at, count, frequent ? w.frequent_block() : w.constant_block(),
                         room);
}

}  // namespace gicodec::native
