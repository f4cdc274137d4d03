// Limits of a client: the memory and work that a server may cost it, computed in advance.
#pragma once

#include <gicodec/client.h>
#include <gicodec/protocol.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Peak bytes of a client of these volumes: `frames` copies of them, their decoders, and working
/// memory of decoding.
[[nodiscard]] std::uint64_t client_memory(const std::vector<ClientVolume>& volumes,
                                          Delivery delivery, unsigned frames,
                                          unsigned threads) noexcept;

/// Makes the volumes that a server describes, without contents. unknown_kind, corrupt;
/// limit_exceeded, before it allocates, if they are beyond the limits.
[[nodiscard]] Result<std::vector<ClientVolume>> volumes_of(std::span<const DescribedVolume> said,
                                                           const ClientOptions& options,
                                                           unsigned frames);

/// What a publisher says of a volume, read by its kind: unknown_kind, corrupt.
[[nodiscard]] Result<VolumeDesc> volume_desc_of(const DescribedVolume& said,
                                                std::span<const Kind* const> kinds);

/// The texture of a stream's decoder: that of the volume, or a region of it.
[[nodiscard]] TextureDesc stream_desc(const ClientVolume& volume, StreamId id) noexcept;

/// Bytes of the blocks that an update writes, clears or hashes; damaged packets count as 0.
/// Precondition: its streams exist in the frame.
[[nodiscard]] std::uint64_t update_work(const UpdateMessage& update, const ClientFrame& frame);

/// True if no stream has more than one proof.
[[nodiscard]] bool proofs_once(const UpdateMessage& update);

}  // namespace gicodec
