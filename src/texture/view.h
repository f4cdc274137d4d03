// A texture view that was checked against its description: every texel of every block can be
// addressed without leaving the caller's memory.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>

namespace gicodec {

template <typename Byte>
struct CheckedView {
  Byte* data = nullptr;
  std::size_t row_pitch = 0;
  std::size_t slice_pitch = 0;

  [[nodiscard]] Byte* at(BlockOrigin origin, std::size_t bytes_per_texel) const noexcept {
    return data + origin.slice * slice_pitch + origin.y * row_pitch + origin.x * bytes_per_texel;
  }
};

/// view_too_small if a pitch is smaller than what it spans or the last texel is outside `bytes`.
template <typename Byte>
[[nodiscard]] Result<CheckedView<Byte>> check_view(const TextureDesc& desc,
                                                   const BasicTextureView<Byte>& view) noexcept {
  const auto size = extent(desc);
  const std::uint64_t row = std::uint64_t{size.width} * texel_bytes(desc);
  // The analyzer loses sight of members that a derived aggregate's constructor sets.
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
  const std::uint64_t row_pitch = view.row_pitch == 0 ? row : view.row_pitch;
  const std::uint64_t limit = view.bytes.size();
  // Each step divides before it multiplies, so that huge pitches cannot wrap around.
  if (row_pitch < row || row > limit) return Status::view_too_small;
  if (size.height > 1 && row_pitch > (limit - row) / (size.height - 1)) {
    return Status::view_too_small;
  }
  const std::uint64_t slice = (size.height - 1) * row_pitch + row;
  const std::uint64_t slice_pitch =
      view.slice_pitch == 0 ? size.height * row_pitch : view.slice_pitch;
  if (size.slices > 1 &&
      (slice_pitch < slice || slice_pitch > (limit - slice) / (size.slices - 1))) {
    return Status::view_too_small;
  }
  return CheckedView<Byte>{view.bytes.data(), static_cast<std::size_t>(row_pitch),
                           static_cast<std::size_t>(slice_pitch)};
}

}  // namespace gicodec
