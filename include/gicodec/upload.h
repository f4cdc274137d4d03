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
struct UploadRegion {
  std::uint64_t offset = 0;               ///< bytes from the view's first record
  std::uint64_t row_pitch = 0;            ///< bytes
  std::uint64_t slice_pitch = 0;          ///< bytes
  std::uint32_t x = 0, y = 0, slice = 0;  ///< records
  std::uint32_t width = 0, height = 0, slices = 0;

  friend bool operator==(const UploadRegion&, const UploadRegion&) = default;
};

/// Replaces `out` by the blocks that changed after `since`, ascending (ClientTexture::changed: one
/// number per block). Keeps its capacity. out_of_memory.
Status changed_blocks(std::span<const std::uint64_t> changed, std::uint64_t since,
                      std::vector<std::uint32_t>& out);

/// Replaces `out` by the boxes of the blocks that changed after `since`, guard bands included;
/// blocks side by side in a row are one box. `view` says how the texture lies in memory; where the
/// layout is Tiling::blocks, the slices of an array follow one another. Keeps the capacity of
/// `out`. Errors: view_too_small; mask_mismatch unless there is a number for each block;
/// out_of_memory.
Status upload_regions(const TextureDesc& desc, const ConstTextureView& view,
                      std::span<const std::uint64_t> changed, std::uint64_t since,
                      std::vector<UploadRegion>& out);

}  // namespace gicodec
