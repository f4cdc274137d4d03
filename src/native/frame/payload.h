// Payloads of the native backend: chunks of an update, found by a directory of their ends.
#pragma once

#include "base/memory.h"
#include "native/frame/chunk_encoder.h"
#include "native/matches/match_look.h"

#include <vector>

namespace gicodec::native {

struct PayloadSettings {
  EncodeSettings chunk;
  Grid box;  ///< probes per chunk; zero: the encoder's choice
  Threads threads = {};
};

/// The head of a payload, and the bytes of its chunks.
struct PayloadHead {
  PlaneLayout layout;
  Grid box;
  Vector<std::span<const std::byte>> chunks;
};

/// What coding payloads takes, kept for its capacity; nothing of a payload outlives its call.
struct PayloadMemory {
  Vector<Workspace> workspaces;  ///< of each thread
  ChunkLists lists;
  Vector<std::uint16_t> block_values;          ///< encoding: of one block at a time
  std::vector<std::vector<std::byte>> chunks;  ///< encoding
  LookMemory look;                             ///< encoding
  PayloadHead head;                            ///< decoding, as what follows
  Vector<Status> status;                       ///< of each chunk
  ChunkHead chunk_head;                        ///< of one chunk at a time
  Vector<PlacedBrick> held;                    ///< Update::held
};

/// Largest payload of that many probes.
[[nodiscard]] std::size_t payload_bound(const TextureDesc& desc, std::size_t probes) noexcept;
/// Appends the payload. Its bytes do not depend on `threads` or `isa`.
void encode_payload(const EncodeJob& job, const PayloadSettings& settings, Isa isa,
                    PayloadMemory& memory, std::vector<std::byte>& out);
/// Checks what a payload for that many probes holds as far as that needs no probes: its head, its
/// sizes, the heads and tables of its chunks. Takes time and memory in proportion to the bytes.
Status check_payload(const TextureDesc& desc, std::size_t probes,
                     std::span<const std::byte> payload, PayloadMemory& memory);
/// Safe on any bytes.
Status decode_payload(const DecodeJob& job, Isa isa, PayloadMemory& memory);

}  // namespace gicodec::native
