#include <gicodec/upload.h>

#include "base/guard.h"
#include "texture/view.h"

#include <algorithm>

namespace gicodec {
namespace {

UploadRegion region_of(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                       std::uint32_t block) noexcept {
  const BlockOrigin origin = block_origin(desc, block);
  const BlockShape inside = block_inside(desc, block);
  const unsigned band = 2U * desc.guard_band;
  UploadRegion region;
  region.offset = static_cast<std::uint64_t>(view.at(origin, desc.record.bytes) - view.data);
  region.row_pitch = view.row_pitch;
  region.slice_pitch = view.slice_pitch;
  region.x = static_cast<std::uint32_t>(origin.x);
  region.y = static_cast<std::uint32_t>(origin.y);
  // block is 0 unless each block has its own slices.
  const std::uint64_t of_block = origin.block * (extent(desc).slices / block_count(desc));
  region.slice = static_cast<std::uint32_t>(origin.slice + of_block);
  region.width = inside.x + band;
  region.height = inside.y + band;
  region.slices = inside.z;
  return region;
}

/// Orders by slice, row, column.
bool before(const UploadRegion& a, const UploadRegion& b) noexcept {
  if (a.slice != b.slice) return a.slice < b.slice;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

bool continues(const UploadRegion& row, const UploadRegion& next) noexcept {
  return row.slice == next.slice && row.y == next.y && row.x + row.width == next.x &&
         row.height == next.height && row.slices == next.slices;
}

}  // namespace

Status changed_blocks(std::span<const std::uint64_t> changed, std::uint64_t since,
                      std::vector<std::uint32_t>& out) {
  return guarded([&]() -> Status {
    out.clear();
    for (std::uint32_t block = 0; block < changed.size(); ++block) {
      if (changed[block] > since) out.push_back(block);
    }
    return Status::ok;
  });
}

Status upload_regions(const TextureDesc& desc, const ConstTextureView& view,
                      std::span<const std::uint64_t> changed, std::uint64_t since,
                      std::vector<UploadRegion>& out) {
  if (const Status status = validate(desc); status != Status::ok) return status;
  if (changed.size() != block_count(desc)) return Status::mask_mismatch;
  const auto checked = check_view(desc, view);
  if (!checked) return checked.status();
  return guarded([&]() -> Status {
    out.clear();
    for (std::uint32_t block = 0; block < changed.size(); ++block) {
      if (changed[block] > since) out.push_back(region_of(desc, *checked, block));
    }
    std::sort(out.begin(), out.end(), before);
    std::size_t rows = 0;
    for (const UploadRegion& next : out) {
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
