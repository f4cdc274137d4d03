// Region size: the default for a volume.
#pragma once

#include <gicodec/kind.h>

namespace gicodec {

/// The default region size: 4×4×4 blocks, 8×8 of a flat grid, or a run of a pool's slots; at most
/// 192 KiB of records, or one block. Precondition: validate(volume) is ok.
[[nodiscard]] Grid usual_region(const VolumeDesc& volume) noexcept;
/// One region for all blocks, e.g. where an encoder remembers a picture.
[[nodiscard]] Grid whole_region(const VolumeDesc& volume) noexcept;

}  // namespace gicodec
