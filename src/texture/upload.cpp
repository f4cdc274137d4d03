#include <gicodec/upload.h>

#include "base/guard.h"
#include "texture/view.h"

#include <algorithm>

namespace gicodec {
namespace {

UploadBox box_of(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t block) noexcept {
  const BlockOrigin origin = block_origin(desc, block);
  const BlockShape inside = block_inside(desc, block);
  const unsigned band = 2U * desc.guard_band;
  UploadBox box;
  box.offset = static_cast<std::uint64_t>(view.at(origin, desc.record.bytes) - view.data);
  box.row_pitch = view.row_pitch;
  box.slice_pitch = view.slice_pitch;
  box.x = static_cast<std::uint32_t>(origin.x);
  box.y = static_cast<std::uint32_t>(origin.y);
  // Only where each block has slices of its own is there another one than the first.
  const std::uint64_t of_block = origin.block * (extent(desc).slices / block_count(desc));
  box.slice = static_cast<std::uint32_t>(origin.slice + of_block);
  box.width = inside.x + band;
  box.height = inside.y + band;
  box.slices = inside.z;
  return box;
}

/// Orders by slice, row, column.
bool is_before(const UploadBox& a, const UploadBox& b) noexcept {
  if (a.slice != b.slice) return a.slice < b.slice;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

bool continues(const UploadBox& row, const UploadBox& next) noexcept {
  return row.slice == next.slice && row.y == next.y && row.x + row.width == next.x &&
         row.height == next.height && row.slices == next.slices;
}

}  // namespace

Status upload_boxes(const TextureDesc& desc, const ConstTextureView& view,
                    std::span<const std::uint32_t> blocks, std::vector<UploadBox>& out) {
  if (const Status status = validate(desc); status != Status::ok) return status;
  const auto checked = check_view(desc, view);
  if (!checked) return checked.status();
  for (const std::uint32_t block : blocks) {
    if (block >= block_count(desc)) return Status::block_out_of_range;
  }
  return guarded([&]() -> Status {
    out.clear();
    for (const std::uint32_t block : blocks) out.push_back(box_of(desc, *checked, block));
    std::sort(out.begin(), out.end(), is_before);
    std::size_t rows = 0;
    for (const UploadBox& next : out) {
      if (rows > 0 && continues(out[rows - 1], next)) {
        out[rows - 1].width += next.width;
      } else {
        out[rows++] = next;
      }
    }
    out.resize(rows);
    return Status::ok;
  });
}

}  // namespace gicodec
