// A texture view checked against its description: all records lie within the caller's memory.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>

namespace gicodec {

/// The grid of blocks in memory: a pool's slots may lie in rows and slices.
[[nodiscard]] constexpr Grid laid_out(const TextureDesc& desc) noexcept {
  return desc.space == Space::pool && desc.layout.slots.x != 0 ? desc.layout.slots : desc.grid;
}

template <typename Byte>
struct CheckedView {
  Byte* data = nullptr;
  std::size_t row_pitch = 0;
  std::size_t slice_pitch = 0;
  std::size_t block_pitch = 0;

  [[nodiscard]] Byte* at(const BlockOrigin& origin, std::size_t record_bytes) const noexcept {
    return data + origin.block * block_pitch +
           static_cast<std::size_t>(origin.slice) * slice_pitch +
           static_cast<std::size_t>(origin.y) * row_pitch +
           static_cast<std::size_t>(origin.x) * record_bytes;
  }
};

/// Sets `size` to the bytes that `count` items of `size` span at `pitch`, and a `pitch` of 0 to
/// `tight`. False if the pitch is below `size` or the items span more than `limit`.
[[nodiscard]] constexpr bool span_of(std::uint64_t count, std::uint64_t tight, std::uint64_t limit,
                                     std::uint64_t& pitch, std::uint64_t& size) noexcept {
  if (pitch == 0) pitch = tight;
  // Divides before it multiplies, so that huge pitches cannot wrap around.
  if (size > limit || (count > 1 && (pitch < size || pitch > (limit - size) / (count - 1)))) {
    return false;
  }
  size += (count - 1) * pitch;
  return true;
}

/// view_too_small if a pitch is too small or the last record lies outside `bytes`.
template <typename Byte>
[[nodiscard]] Result<CheckedView<Byte>> check_view(const TextureDesc& desc,
                                                   const BasicTextureView<Byte>& view) noexcept {
  const auto whole = extent(desc);
  const bool array = desc.layout.tiling == Tiling::blocks;
  const std::uint64_t blocks = array ? block_count(desc) : 1;
  const std::uint64_t slices = whole.slices / blocks;
  // clang's analyzer does not see members that a derived aggregate's constructor sets.
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
  std::uint64_t row_pitch = view.row_pitch, slice_pitch = view.slice_pitch,
                block_pitch = view.block_pitch, size = whole.width * desc.record.bytes;
  const std::uint64_t limit = view.bytes.size();
  if (row_pitch != 0 && row_pitch < size) return Status::view_too_small;
  if (!span_of(whole.height, size, limit, row_pitch, size) ||
      !span_of(slices, whole.height * row_pitch, limit, slice_pitch, size) ||
      !span_of(blocks, slices * slice_pitch, limit, block_pitch, size)) {
    return Status::view_too_small;
  }
  return CheckedView<Byte>{view.bytes.data(), static_cast<std::size_t>(row_pitch),
                           static_cast<std::size_t>(slice_pitch),
                           static_cast<std::size_t>(block_pitch)};
}

}  // namespace gicodec
