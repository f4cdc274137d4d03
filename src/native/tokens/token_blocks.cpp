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
      stride_((u.texels() + kLanes - 1) / kLanes * kLanes) {
  const std::size_t packed = block_stride(layout_.planes, texels_),
                    planes = layout_.planes * stride_;
  const std::size_t copied = copies_ ? kCopies * planes : 0;
  const std::size_t row = block_stride(layout_.planes, u.width());
  memory.values.resize(packed + 2 * row + 2 * planes + copied + kLanes);
  packed_ = memory.values.data();
  before_ = packed_ + packed;
  current_ = before_ + 2 * row;
  reference_ = current_ + planes;
  for (unsigned k = 0; k < kCopies; ++k) copy_[k] = reference_ + (copies_ ? k + 1 : 0) * planes;
  memory.zeros.assign(u.block_bytes(), std::byte{0});
  memory.scratch.resize(token_scratch(u.width(), stride_));
  fill_columns(u.width(), texels_, stride_, memory.columns);
  if (!refers_ && !continues_ && !copies_) return;
  memory.slots.assign(std::size_t{u.box.x} * u.box.y * u.box.z, kNoBlock);
  for (std::size_t b = 0; b < positions.size(); ++b) {
    const Grid at = place_in_box(u.desc.grid, u.box, u.probes[positions[b]]);
    memory.slots[slot_of(u.box, at)] = static_cast<std::int32_t>(b);
  }
}

/// Records of the neighbour on an axis within the box: new ones, or those of the mirror; null if
/// it is not known.
const std::byte* TokenBlocks::neighbour(std::size_t b, unsigned axis, const BlockTable& records,
                                        bool in_chunk_only) const {
  if (!u_.neighbours()) return nullptr;
  const Grid& grid = u_.desc.grid;
  const std::uint32_t block = u_.probes[positions_[b]];
  const Grid at = place_in_box(grid, u_.box, block);
  const std::uint32_t coordinate = axis == kAxisX ? at.x : axis == kAxisY ? at.y : at.z;
  if (coordinate == 0) return nullptr;
  const std::size_t step = axis == kAxisX   ? 1
                           : axis == kAxisY ? u_.box.x
                                            : std::size_t{u_.box.x} * u_.box.y;
  const std::int32_t slot = memory_.slots[slot_of(u_.box, at) - step];
  if (slot != kNoBlock) return records[positions_[static_cast<std::size_t>(slot)]].data();
  const std::uint32_t beside = block - (axis == kAxisX   ? 1
                                        : axis == kAxisY ? grid.x
                                                         : grid.x * grid.y);
  if (in_chunk_only || !u_.mirrored || !u_.mirror.is_received(beside)) return nullptr;
  return u_.mirror.blocks[beside].data();
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

/// The last row of the first slice of the block above, if that is one of the chunk.
void TokenBlocks::load_row_before(std::size_t b, const BlockTable& records) {
  const std::byte* const above = neighbour(b, kAxisY, records, true);
  has_before_ = above != nullptr;
  if (!has_before_) return;
  const std::size_t width = u_.width();
  const std::size_t at = (u_.desc.block.y - std::size_t{1}) * width * layout_.texel_bytes;
  const auto row_of = [&](const std::byte* block, std::uint16_t* out) {
    u_.kernels.unpack(layout_, reinterpret_cast<const std::uint8_t*>(block + at), width, out);
  };
  row_of(above, before_);
  if (!u_.update) return;
  std::uint16_t* const past = before_ + block_stride(layout_.planes, width);
  row_of(u_.mirror.blocks[u_.probes[positions_[b]] - u_.desc.grid.x].data(), past);
  for (std::size_t i = 0; i < layout_.planes * width; ++i) {
    before_[i] = static_cast<std::uint16_t>(before_[i] - past[i]);
  }
}

void TokenBlocks::load(std::size_t b, const BlockTable& records, bool current) {
  if (current) unpack(records[positions_[b]].data(), current_);
  const std::byte* reference = nullptr;
  if (u_.update) {
    reference = u_.mirror.blocks[u_.probes[positions_[b]]].data();
  } else if (refers_) {
    for (const unsigned axis : {kAxisZ, kAxisY, kAxisX}) {
      if (reference == nullptr) reference = neighbour(b, axis, records, true);
    }
  }
  unpack(reference != nullptr ? reference : memory_.zeros.data(), reference_);
  if (continues_) load_row_before(b, records);
  for (unsigned axis = 0; copies_ && axis < kCopies; ++axis) {
    const std::byte* const beside = neighbour(b, axis, records, false);
    unpack(beside != nullptr ? beside : memory_.zeros.data(), copy_[axis]);
  }
}

TokenBlock TokenBlocks::block(const TokenGroup& group) const {
  TokenBlock block{};
  for (unsigned i = 0; i < group.planes; ++i) {
    const std::size_t at = group.plane[i] * stride_;
    block.current[i] = current_ + at;
    block.reference[i] = reference_ + at;
    for (unsigned k = 0; k < kCopies; ++k) block.copy[k][i] = copy_[k] + at;
    block.before[i] = has_before_ ? before_ + group.plane[i] * std::size_t{u_.width()} : nullptr;
  }
  block.columns = memory_.columns.data();
  block.texels = static_cast<unsigned>(texels_);
  block.width = u_.width();
  block.stride = stride_;
  block.scratch = memory_.scratch.data();
  return block;
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
