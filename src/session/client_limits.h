// What a server may cost a client, told before it costs anything.
#pragma once

#include <gicodec/client.h>
#include <gicodec/protocol.h>

#include <cstdint>

namespace gicodec {

/// Bytes of all that a client of these volumes comes to hold at its worst: `frames` of them, their
/// decoders, and what decoding takes.
[[nodiscard]] std::uint64_t client_memory(const Welcome& said, unsigned frames,
                                          unsigned threads) noexcept;

/// The texture that a stream's decoder has: the volume's, or a chunk of it.
[[nodiscard]] TextureDesc stream_desc(const ClientVolume& volume, const Grid& chunk, StreamId id);

/// Bytes of blocks that an update writes, clears or hashes; damaged packets count as nothing.
/// Precondition: its streams exist in `volumes`.
[[nodiscard]] std::uint64_t update_work(const UpdateMessage& update,
                                        const std::vector<ClientVolume>& volumes,
                                        const Grid& chunk);

/// Whether every stream has one packet and one proof at most, or a second packet that is fresh.
[[nodiscard]] bool streams_once(const UpdateMessage& update);

}  // namespace gicodec
