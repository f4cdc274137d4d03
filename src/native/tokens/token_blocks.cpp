#include "native/tokens/token_blocks.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

/// By texel: all bits set from column 1, 2, 4, … on.
void fill_columns(std::size_t width, std::size_t texels, std::size_t stride,
                  Vector<std::uint16_t>& columns) {
  const auto steps = static_cast<std::size_t>(std::bit_width(width - 1));
  columns.assign(std::max<std::size_t>(steps, 1) * stride, 0);
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t t = 0; t < texels; ++t) {
      columns[step * stride + t] = t % width >> step != 0 ? 0xFFFF : 0;
    }
  }
}

}  // namespace

TokenBlocks::TokenBlocks(const Update& u, std::span<const std::uint32_t> positions,
                         const TokenHead& head, TokenMemory& memory)
    : u_(u),
      positions_(positions),
      memory_(memory),
      layout_(plane_layout(u.desc)),
      refers_(head.refers),
      continues_(head.continues),
      copies_(layout_.pairs),
      texels_(u.texels()),
      stride_((u.texels() + kLanes - 1) / kLanes * kLanes),
      size_(layout_.planes * stride_),
      slots_(kept(positions.size())) {
  const std::size_t packed = block_stride(layout_.planes, texels_);
  const std::size_t row = block_stride(layout_.planes, u.width());
  constexpr std::size_t kRooms = 1 + kCopies;  // of the reference, and of neighbours
  memory.values.resize(packed + 2 * row + (1 + kRooms + slots_) * size_ + kLanes);
  packed_ = memory.values.data();
  before_ = packed_ + packed;
  zeros_ = before_ + 2 * row;
  room_ = zeros_ + size_;
  ring_ = room_ + kRooms * size_;
  current_ = ring_;
  reference_ = zeros_;
  std::fill_n(zeros_, size_, std::uint16_t{0});
  memory.held.assign(slots_, SIZE_MAX);
  memory.scratch.resize(token_scratch(u.width(), stride_));
  fill_columns(u.width(), texels_, stride_, memory.columns);
  if (!refers_ && !continues_ && !copies_) return;
  memory.slots.assign(std::size_t{u.box.x} * u.box.y * u.box.z, kNoBlock);
  for (std::size_t b = 0; b < positions.size(); ++b) {
    const Grid at = place_in_box(u.desc.grid, u.box, u.probes[positions[b]]);
    memory.slots[slot_of(u.box, at)] = static_cast<std::int32_t>(b);
  }
}

/// Places of the box from a block to its neighbour.
std::size_t TokenBlocks::step(unsigned axis) const {
  return axis == kAxisX ? 1 : axis == kAxisY ? u_.box.x : std::size_t{u_.box.x} * u_.box.y;
}

/// Blocks to keep of so many: as far back as the farthest neighbour may be.
std::size_t TokenBlocks::kept(std::size_t blocks) const {
  if (!refers_ && !continues_ && !copies_) return 1;
  const bool rows_alone = !refers_ && !copies_;
  return std::min(blocks, 1 + step(u_.box.z > 1 && !rows_alone ? kAxisZ : kAxisY));
}

/// Where in the chunk the loaded block's neighbour is; kNoBlock if it is none of its blocks.
std::int32_t TokenBlocks::place_of(unsigned axis) const {
  const std::uint32_t coordinate = axis == kAxisX ? at_.x : axis == kAxisY ? at_.y : at_.z;
  if (coordinate == 0 || !u_.neighbours()) return kNoBlock;
  return memory_.slots[slot_of(u_.box, at_) - step(axis)];
}

/// Planes of a block of the chunk: those that are kept, or in `room`.
const std::uint16_t* TokenBlocks::values(std::size_t place, const BlockTable& records,
                                         std::uint16_t* room) {
  if (memory_.held[place % slots_] == place) return slot(place);
  unpack(records[positions_[place]].data(), room);
  return room;
}

/// Planes of a neighbour: new ones, or those of the mirror; zeros if it is not known.
const std::uint16_t* TokenBlocks::copied(std::size_t b, unsigned axis, const BlockTable& records) {
  std::uint16_t* const room = room_ + (1 + axis) * size_;
  const std::int32_t place = place_of(axis);
  if (place != kNoBlock) return values(static_cast<std::size_t>(place), records, room);
  const std::uint32_t coordinate = axis == kAxisX ? at_.x : axis == kAxisY ? at_.y : at_.z;
  if (coordinate == 0 || !u_.neighbours() || !u_.mirrored) return zeros_;
  const Grid& grid = u_.desc.grid;
  const std::uint32_t beside = u_.probes[positions_[b]] - (axis == kAxisX   ? 1
                                                           : axis == kAxisY ? grid.x
                                                                            : grid.x * grid.y);
  if (!u_.mirror.is_received(beside)) return zeros_;
  unpack(u_.mirror.blocks[beside].data(), room);
  return room;
}

/// Planes at strides of whole vectors.
void TokenBlocks::unpack(const std::byte* records, std::uint16_t* planes) {
  const auto* const from = reinterpret_cast<const std::uint8_t*>(records);
  if (stride_ == texels_) return u_.kernels.unpack(layout_, from, texels_, planes);
  u_.kernels.unpack(layout_, from, texels_, packed_);
  for (unsigned p = 0; p < layout_.planes; ++p) {
    std::copy_n(packed_ + p * texels_, texels_, planes + p * stride_);
  }
}

/// Differences of the last row of the first slice of the block above, if that is one of the chunk.
void TokenBlocks::load_row_before(std::size_t b, const BlockTable& records) {
  const std::int32_t above = place_of(kAxisY);
  has_before_ = above != kNoBlock;
  if (!has_before_) return;
  const std::size_t width = u_.width(), first = (u_.desc.block.y - std::size_t{1}) * width;
  const std::uint16_t* const planes =
      values(static_cast<std::size_t>(above), records, room_ + size_);
  for (unsigned p = 0; p < layout_.planes; ++p) {
    std::copy_n(planes + p * stride_ + first, width, before_ + p * width);
  }
  if (!u_.update) return;
  std::uint16_t* const past = before_ + block_stride(layout_.planes, width);
  const std::byte* const mirror =
      u_.mirror.blocks[u_.probes[positions_[b]] - u_.desc.grid.x].data();
  u_.kernels.unpack(layout_,
                    reinterpret_cast<const std::uint8_t*>(mirror + first * layout_.texel_bytes),
                    width, past);
  for (std::size_t i = 0; i < layout_.planes * width; ++i) {
    before_[i] = static_cast<std::uint16_t>(before_[i] - past[i]);
  }
}

void TokenBlocks::load(std::size_t b, const BlockTable& records, bool current) {
  current_ = slot(b);
  memory_.held[b % slots_] = b;
  if (refers_ || continues_ || copies_)
    at_ = place_in_box(u_.desc.grid, u_.box, u_.probes[positions_[b]]);
  if (current) unpack(records[positions_[b]].data(), current_);
  if (u_.update) {
    unpack(u_.mirror.blocks[u_.probes[positions_[b]]].data(), room_);
    reference_ = room_;
  } else if (refers_) {
    reference_ = zeros_;
    for (const unsigned axis : {kAxisX, kAxisY, kAxisZ}) {
      const std::int32_t place = place_of(axis);
      if (place != kNoBlock) reference_ = values(static_cast<std::size_t>(place), records, room_);
    }
  }
  if (continues_) load_row_before(b, records);
  for (unsigned axis = 0; copies_ && axis < kCopies; ++axis) copy_[axis] = copied(b, axis, records);
}

TokenBlock TokenBlocks::block(const TokenGroup& group) const {
  TokenBlock block;
  for (unsigned i = 0; i < group.planes; ++i) {
    const std::size_t at = group.plane[i] * stride_;
    block.current[i] = current_ + at;
    block.reference[i] = reference_ + at;
    for (unsigned k = 0; copies_ && k < kCopies; ++k) block.copy[k][i] = copy_[k] + at;
    block.before[i] = has_before_ ? before_ + group.plane[i] * std::size_t{u_.width()} : nullptr;
  }
  block.columns = memory_.columns.data();
  block.texels = static_cast<unsigned>(texels_);
  block.width = u_.width();
  block.stride = stride_;
  block.scratch = memory_.scratch.data();
  return block;
}

void TokenBlocks::fill(unsigned p, std::uint16_t value) {
  for (std::size_t s = 0; s < slots_; ++s) std::fill_n(slot(s) + p * stride_, texels_, value);
}

void TokenBlocks::store(std::byte* out) {
  std::uint16_t* planes = current_;
  if (stride_ != texels_) {
    planes = packed_;
    for (unsigned p = 0; p < layout_.planes; ++p) {
      std::copy_n(current_ + p * stride_, texels_, planes + p * texels_);
    }
  }
  u_.kernels.pack(layout_, planes, texels_, reinterpret_cast<std::uint8_t*>(out));
}

}  // namespace gicodec::native
