// Upload: which parts of a texture in memory a renderer copies to its GPU texture.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstdint>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

/// A box of records, and where it begins in memory: the arguments of VkBufferImageCopy, of D3D12's
/// CopyTextureRegion() and of glTexSubImage3D().
struct UploadBox {
  std::uint64_t offset = 0;               ///< bytes from the view's first record
  std::uint64_t row_pitch = 0;            ///< bytes
  std::uint64_t slice_pitch = 0;          ///< bytes
  std::uint32_t x = 0, y = 0, slice = 0;  ///< records
  std::uint32_t width = 0, height = 0, slices = 0;

  friend bool operator==(const UploadBox&, const UploadBox&) = default;
};

/// Replaces `out` by the boxes of these blocks, e.g. the changed ones, guard bands included. Joins
/// neighbours in a row into one box. `blocks`: in any order, each at most once. `view`: the texture
/// in memory; with Tiling::blocks its array slices follow one another. Keeps the capacity of `out`.
/// Errors: view_too_small; block_out_of_range; out_of_memory.
Status upload_boxes(const TextureDesc& desc, const ConstTextureView& view,
                    std::span<const std::uint32_t> blocks, std::vector<UploadBox>& out);

}  // namespace gicodec
