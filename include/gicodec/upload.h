// What of a texture in memory is to be copied to where a renderer samples it.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstdint>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

/// A box of records, and where its first one is in memory: what VkBufferImageCopy, the footprint of
/// D3D12's CopyTextureRegion() and glTexSubImage3D() ask for.
struct UploadBox {
  std::uint64_t offset = 0;               ///< bytes from the view's first record
  std::uint64_t row_pitch = 0;            ///< bytes
  std::uint64_t slice_pitch = 0;          ///< bytes
  std::uint32_t x = 0, y = 0, slice = 0;  ///< records
  std::uint32_t width = 0, height = 0, slices = 0;

  friend bool operator==(const UploadBox&, const UploadBox&) = default;
};

/// Replaces `out` by the boxes of these blocks, e.g. those that changed, guard bands included;
/// blocks side by side in a row are one box. `blocks`: in any order, each at most once. `view` says
/// how the texture lies in memory; where the layout is Tiling::blocks, the slices of an array
/// follow one another. Keeps the capacity of `out`. Errors: view_too_small; block_out_of_range;
/// out_of_memory.
Status upload_boxes(const TextureDesc& desc, const ConstTextureView& view,
                    std::span<const std::uint32_t> blocks, std::vector<UploadBox>& out);

}  // namespace gicodec
