// What a module of the npm package has beside the library. Each object of the package has an
// instance of its own, and with it memory of its own: one that has no memory left ends alone.
#include <gicodec/c/client.h>
#include <gicodec/c/container.h>
#include <gicodec/c/encoder.h>
#include <gicodec/c/tracks.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "layout.inl"

namespace {

/// The bytes of a container as they arrive.
struct {
  std::uint8_t* bytes;
  std::size_t size, capacity, at;
} arrived;

gicodec_status read(void*, void* into, std::size_t bytes, std::size_t* got) {
  *got = std::min(bytes, arrived.size - arrived.at);
  std::memcpy(into, arrived.bytes + arrived.at, *got);
  arrived.at += *got;
  return GICODEC_OK;
}

gicodec_status seek(void*, std::uint64_t offset) {
  if (offset > arrived.size) return GICODEC_IO_FAILED;
  arrived.at = static_cast<std::size_t>(offset);
  return GICODEC_OK;
}

std::uint64_t size(void*) { return arrived.size; }

constexpr gicodec_source kSource{sizeof(gicodec_source), nullptr, read, seek, size, nullptr};

/// Bytes of a container from an offset on.
struct Piece {
  std::uint64_t offset;
  std::size_t size;
  std::uint8_t* bytes;
};

/// Ranges that are told to the caller at once.
constexpr std::size_t kMaxMissing = 256;

/// A container of which pieces are there: the caller brings those that reads miss.
struct {
  Piece* pieces;
  std::size_t count, capacity;
  std::size_t held;  ///< bytes of all pieces
  std::uint64_t size, at;
  gicodec_range missing[kMaxMissing];  ///< what is to be brought
  std::size_t missing_count;
  bool failed;  ///< a read lacked bytes
} ranges;

const Piece* piece_at(std::uint64_t offset) {
  Piece* const end = ranges.pieces + ranges.count;
  Piece* const found = std::find_if(ranges.pieces, end, [&](const Piece& piece) {
    return offset >= piece.offset && offset - piece.offset < piece.size;
  });
  return found == end ? nullptr : found;
}

/// The end of what is there, or listed as missing, at this offset; 0: neither.
std::uint64_t known_until(std::uint64_t at) {
  if (const Piece* const piece = piece_at(at)) return piece->offset + piece->size;
  for (std::size_t i = 0; i < ranges.missing_count; ++i) {
    const auto& [offset, size] = ranges.missing[i];
    if (at >= offset && at - offset < size) return offset + size;
  }
  return 0;
}

/// Lists what is missing between these offsets.
void want(std::uint64_t at, std::uint64_t end) {
  while (at < end && ranges.missing_count < kMaxMissing) {
    if (const std::uint64_t known = known_until(at)) {
      at = known;
      continue;
    }
    std::uint64_t next = end;
    for (std::size_t i = 0; i < ranges.count; ++i) {
      if (ranges.pieces[i].offset > at) next = std::min(next, ranges.pieces[i].offset);
    }
    ranges.missing[ranges.missing_count++] = {at, next - at};
    at = next;
  }
}

/// Fewer bytes than there are: the library's call answers that the container ends here, and goes on
/// when it is repeated.
gicodec_status read_ranges(void*, void* into, std::size_t bytes, std::size_t* got) {
  const auto wanted =
      static_cast<std::size_t>(std::min<std::uint64_t>(bytes, ranges.size - ranges.at));
  for (*got = 0; *got < wanted;) {
    const std::uint64_t at = ranges.at + *got;
    const Piece* const piece = piece_at(at);
    if (piece == nullptr) {
      if (!ranges.failed) want(at, ranges.at + wanted);
      ranges.failed = true;
      *got = 0;
      return GICODEC_OK;
    }
    const auto skipped = static_cast<std::size_t>(at - piece->offset);
    const std::size_t part = std::min(wanted - *got, piece->size - skipped);
    std::memcpy(static_cast<std::uint8_t*>(into) + *got, piece->bytes + skipped, part);
    *got += part;
  }
  ranges.at += wanted;
  return GICODEC_OK;
}

std::uint32_t prefetch_ranges(void*, const gicodec_range* wanted, std::size_t count) {
  for (const gicodec_range* range = wanted; range != wanted + count; ++range) {
    if (range->offset >= ranges.size) continue;
    want(range->offset, range->offset + std::min(range->size, ranges.size - range->offset));
  }
  return 1;
}

gicodec_status seek_ranges(void*, std::uint64_t offset) {
  if (offset > ranges.size) return GICODEC_IO_FAILED;
  ranges.at = offset;
  return GICODEC_OK;
}

std::uint64_t size_of_ranges(void*) { return ranges.size; }

constexpr gicodec_source kRanges{sizeof(gicodec_source), nullptr,        read_ranges, seek_ranges,
                                 size_of_ranges,         prefetch_ranges};

}  // namespace

extern "C" {

/// Memory for that many bytes more, which the caller fills; null if there is none.
std::uint8_t* gicodec_source_grow(std::size_t bytes) {
  if (bytes > SIZE_MAX / 2 - arrived.size) return nullptr;
  const std::size_t wanted = arrived.size + bytes;
  if (wanted > arrived.capacity) {
    const std::size_t capacity = std::max(wanted, arrived.capacity + arrived.capacity / 2);
    void* const moved = std::realloc(arrived.bytes, capacity);
    if (moved == nullptr) return nullptr;
    arrived.bytes = static_cast<std::uint8_t*>(moved);
    arrived.capacity = capacity;
  }
  std::uint8_t* const free = arrived.bytes + arrived.size;
  arrived.size = wanted;
  return free;
}

/// What gicodec_player_open() takes, from its first byte on.
const gicodec_source* gicodec_source_arrived() {
  arrived.at = 0;
  return &kSource;
}

/// The same of a container of that many bytes, none of which are there.
const gicodec_source* gicodec_ranges_source(std::uint64_t size) {
  ranges.size = size;
  ranges.at = 0;
  ranges.missing_count = 0;
  ranges.failed = false;
  return &kRanges;
}

/// The container has that many bytes now, which are no fewer than before.
void gicodec_ranges_grow(std::uint64_t size) { ranges.size = size; }

/// Memory for bytes from an offset on, which the caller fills; null if there is none.
std::uint8_t* gicodec_ranges_room(std::uint64_t offset, std::size_t bytes) {
  if (ranges.count == ranges.capacity) {
    const std::size_t capacity = 16 + 2 * ranges.capacity;
    void* const moved = std::realloc(ranges.pieces, capacity * sizeof(Piece));
    if (moved == nullptr) return nullptr;
    ranges.pieces = static_cast<Piece*>(moved);
    ranges.capacity = capacity;
  }
  auto* const room = static_cast<std::uint8_t*>(std::malloc(bytes));
  if (room == nullptr) return nullptr;
  ranges.pieces[ranges.count++] = {offset, bytes, room};
  ranges.held += bytes;
  return room;
}

/// Drops all pieces if they have more bytes than that together.
void gicodec_ranges_trim(std::size_t most) {
  if (ranges.held <= most) return;
  while (ranges.count > 0) std::free(ranges.pieces[--ranges.count].bytes);
  ranges.held = 0;
}

/// What to bring, if a read lacked bytes since the last call: offset and size of each range,
/// `count` numbers together.
const std::uint64_t* gicodec_ranges_missing(std::size_t* count) {
  const bool failed = std::exchange(ranges.failed, false);
  *count = failed ? 2 * std::exchange(ranges.missing_count, 0) : 0;
  return &ranges.missing[0].offset;
}

}  // extern "C"

// The standard library's way to say that it cannot go on, without the text, which takes 20 kB.
_LIBCPP_BEGIN_NAMESPACE_STD
[[noreturn]] void __libcpp_verbose_abort(const char*, ...) { __builtin_trap(); }
_LIBCPP_END_NAMESPACE_STD
