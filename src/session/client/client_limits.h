// What a server may cost a client, told before it costs anything.
#pragma once

#include <gicodec/client.h>
#include <gicodec/protocol.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Bytes of all that a client of these volumes comes to hold at its worst: `frames` of them, their
/// decoders, and what decoding takes.
[[nodiscard]] std::uint64_t client_memory(const std::vector<ClientVolume>& volumes,
                                          Delivery delivery, unsigned frames,
                                          unsigned threads) noexcept;

/// Volumes as a server describes them, without contents. unknown_kind, corrupt; limit_exceeded if
/// they are beyond the limits, told before they are made.
[[nodiscard]] Result<std::vector<ClientVolume>> volumes_of(std::span<const DescribedVolume> said,
                                                           const ClientOptions& options,
                                                           unsigned frames);

/// The texture that a stream's decoder has: the volume's, or a region of it.
[[nodiscard]] TextureDesc stream_desc(const ClientVolume& volume, StreamId id) noexcept;

/// Bytes of blocks that an update writes, clears or hashes; damaged packets count as nothing.
/// Precondition: its streams exist in the frame.
[[nodiscard]] std::uint64_t update_work(const UpdateMessage& update, const ClientFrame& frame);

/// Whether every stream has one packet and one proof at most, or a second packet that is intra.
[[nodiscard]] bool streams_once(const UpdateMessage& update);

}  // namespace gicodec
