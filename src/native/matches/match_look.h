// Whether match chunks may be worth the time of fast.
#pragma once

#include "base/memory.h"

#include <gicodec/backend.h>

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// Bytes of which nothing can be saved that matters.
inline constexpr std::size_t kTooFew = 72;

/// Kept for its capacity.
struct LookMemory {
  /// A word of a record, and where it is; a word of 0: none.
  struct Seen {
    std::uint64_t word = 0;
    std::size_t record = 0;
  };
  Vector<Seen> seen;           ///< by hash
  Vector<std::uint8_t> times;  ///< that values occur: by difference, byte of a record, and value
};

/// Whether they may have fewer than `size` bytes: looks at some records, in microseconds.
/// `thorough`: what is searched for thoroughly takes less than what the look expects.
[[nodiscard]] bool may_match(const EncodeJob& job, std::size_t size, bool thorough,
                             LookMemory& memory);

}  // namespace gicodec::native
