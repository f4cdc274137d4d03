// Block-linear texels of some probes → packet. The mirror is read, not changed.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/packet.h>

#include "bitstream/packet.h"
#include "stream/mirror.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Blocks as strip() gives them, and the guard bands that do not follow the rule.
struct Update {
  std::span<const std::uint32_t> probes;  ///< ascending, unique
  std::span<std::byte> cores;             ///< a lossy backend replaces them by what is decoded
  const StaleRings& stale;                ///< only of `probes`
};

/// Holds the scratch memory of its calls.
class UpdateWriter {
 public:
  /// Replaces `out` by the packet. Of `head`, the caller sets backend, texture id, sequence,
  /// reference and keyframe in `info`, and the base.
  Status write(const Mirror& mirror, BackendEncoder& backend, PacketHead head, const Update& update,
               Packet& out);

 private:
  std::vector<std::byte> index_, borders_, payload_;
};

/// Upper bound of a packet of that many probes.
[[nodiscard]] std::size_t update_bound(const TextureDesc& desc, const BackendEncoder& backend,
                                       std::size_t probes) noexcept;

}  // namespace gicodec
