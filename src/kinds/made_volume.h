// What kinds have in common whose volumes are made from a few numbers.
#pragma once

#include <gicodec/kind.h>

#include "base/bytes.h"
#include "base/guard.h"
#include "bitstream/description.h"

#include <vector>

namespace gicodec {

/// Appends the numbers that `write` writes, if the volume is the one that is made from them.
template <typename Write>
Status write_made(const VolumeDesc& volume, const Result<VolumeDesc>& made,
                  std::vector<std::byte>& out, const Write& write) {
  if (!made) return made.status();
  if (!same_but_layout(*made, volume)) return Status::invalid_description;
  if (const Status status = validate(volume); status != Status::ok) return status;
  return guarded([&]() -> Status {
    ByteWriter writer(out);
    write(writer);
    return Status::ok;
  });
}

/// The volume that is made from numbers as read; corrupt if they make none.
inline Result<VolumeDesc> read_made(Result<VolumeDesc> made) {
  if (!made) return status_of_read(made.status());
  return made;
}

}  // namespace gicodec
