// Structure-aware mutation: inputs taken apart into pieces whose sizes and checksums are put right
// afterwards, so that changes reach what stands behind them. A target that has pieces defines
// LLVMFuzzerCustomMutator with these.
#pragma once

#include "input.h"

#include <random>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace gicodec::fuzz {

using Bytes = std::vector<std::byte>;
using Random = std::minstd_rand;

/// True once in `n` times.
inline bool once_in(Random& random, unsigned n) { return random() / 16 % n == 0; }
inline std::size_t pick(Random& random, std::size_t size) { return random() / 16 % size; }

/// One of libFuzzer's own changes, by which the bytes may grow to `max_size`.
inline void mutate(Bytes& bytes, std::size_t max_size) {
  const std::size_t size = std::min(bytes.size(), max_size);
  bytes.resize(max_size);
  if (max_size == 0) return;
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, max_size));
}

/// A list of pieces: change(piece, room) for one, or a piece repeated, dropped or moved.
template <typename Piece, typename Change>
void mutate_list(std::vector<Piece>& pieces, Random& random, const Change& change) {
  if (pieces.empty()) return;
  const auto at = static_cast<std::ptrdiff_t>(pick(random, pieces.size()));
  const auto to = static_cast<std::ptrdiff_t>(pick(random, pieces.size()));
  switch (pick(random, 12)) {
    case 0: {
      const Piece copy = pieces[static_cast<std::size_t>(at)];
      pieces.insert(pieces.begin() + to, copy);
      break;
    }
    case 1:
      pieces.erase(pieces.begin() + at);
      break;
    case 2:
      std::swap(pieces[static_cast<std::size_t>(at)], pieces[static_cast<std::size_t>(to)]);
      break;
    default:
      change(pieces[static_cast<std::size_t>(at)]);
  }
}

/// What a mutator returns: `bytes` if they fit, else the input as it was.
inline std::size_t give(const Bytes& bytes, std::uint8_t* data, std::size_t size,
                        std::size_t max_size) {
  if (bytes.size() > max_size) return size;
  if (!bytes.empty()) std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}

/// An input of a head of fixed size and parts (Input::part()). change(head, part, room) alters the
/// bytes of a part, with that much room to grow.
template <typename Change>
std::size_t mutate_parts(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed,
                         std::size_t head_size, const Change& change) {
  struct Piece {
    Bytes bytes;
    unsigned flags;
  };
  Random random(seed);
  Input input(data, size);
  const auto front = input.bytes(head_size);
  Bytes head(front.begin(), front.end());
  std::vector<Piece> parts;
  while (!input.empty()) {
    const auto part = input.part();
    parts.push_back({Bytes(part.bytes.begin(), part.bytes.end()), part.flags});
  }
  if (parts.empty()) parts.push_back({});
  const std::size_t room = max_size > size ? max_size - size : 0;
  if (once_in(random, 10)) {
    mutate(head, head.size());
    head.resize(head_size);
  } else {
    mutate_list(parts, random, [&](Piece& part) {
      if (once_in(random, 16)) part.flags = static_cast<unsigned>(pick(random, 4));
      change(std::span<const std::byte>(head), part.bytes,
             std::min<std::size_t>(room, kMaxPart - part.bytes.size()), random);
    });
  }
  Bytes out = head;
  for (const auto& part : parts) {
    put_part(std::span(part.bytes).first(std::min<std::size_t>(part.bytes.size(), kMaxPart)),
             part.flags, out);
  }
  return give(out, data, size, max_size);
}

/// The change to a part that knows nothing of what is in it.
inline void mutate_blindly(std::span<const std::byte>, Bytes& bytes, std::size_t room, Random&) {
  mutate(bytes, bytes.size() + room);
}

}  // namespace gicodec::fuzz
