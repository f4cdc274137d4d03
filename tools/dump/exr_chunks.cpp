#include "dump/exr_chunks.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/exr_types.h"
#include "dump/texture_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <span>

namespace gicodec::tools {
namespace {

/// Numbers of compressions.
constexpr std::uint8_t kNone = 0, kRle = 1, kZip = 3;

/// Texels of an image, from..to inclusive.
struct Window {
  std::int64_t x0, y0, x1, y1;
};

std::uint64_t bytes_of(const ExrPart& part, const Window& window) {
  std::uint64_t bytes = 0;
  for (const ExrChannel& channel : part.channels) {
    const auto columns = exr_samples(window.x0, window.x1, channel.x_sampling),
               rows = exr_samples(window.y0, window.y1, channel.y_sampling);
    bytes += static_cast<std::uint64_t>(columns * rows) * sample_bytes(channel.type);
  }
  return bytes;
}

/// What runs unpack to: as many copies of a byte, or bytes as they are.
std::uint64_t unpacked_runs(std::span<const std::byte> packed) {
  std::uint64_t bytes = 0;
  while (!packed.empty()) {
    const unsigned head = std::to_integer<unsigned>(packed[0]);
    const bool plain = head > 127;
    const std::size_t count = plain ? 256 - head : head + 1, taken = plain ? count + 1 : 2;
    bytes += count;
    packed = packed.subspan(std::min(taken, packed.size()));
  }
  return bytes;
}

/// What a zlib stream unpacks to, as far as `wanted`; nothing if it is damaged.
std::optional<std::uint64_t> unpacked_zlib(std::span<const std::byte> packed,
                                           std::uint64_t wanted) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  std::array<Bytef, 16384> room{};
  // zlib does not write to its input.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  int status = Z_OK;
  std::uint64_t bytes = 0;
  while (status == Z_OK && bytes < wanted) {
    stream.next_out = room.data();
    stream.avail_out = static_cast<uInt>(room.size());
    status = inflate(&stream, Z_NO_FLUSH);
    bytes += room.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END || bytes >= wanted ? std::optional(bytes) : std::nullopt;
}

class ChunkWalk {
 public:
  ChunkWalk(const std::string& path, const std::vector<ExrPart>& parts,
            const std::vector<ExrImage>& images)
      : file_(path), parts_(parts), read_(parts.size()) {
    for (const ExrImage& image : images) read_[image.info.place.part] = true;
  }

  void run() {
    const ExrPart& last = parts_.back();
    const std::uint64_t end = last.places + 8 * last.chunk_count();
    if (end > file_.size()) return;
    std::vector<std::uint64_t> places((end - parts_.front().places) / 8);
    file_.read(parts_.front().places, std::as_writable_bytes(std::span(places)));
    if (std::ranges::count(places, 0U) == 0) {
      for (const std::uint64_t place : places) static_cast<void>(check(place));
      return;
    }
    // OpenEXR looks for them, one behind the other.
    std::optional<std::uint64_t> next = end;
    for (std::size_t i = 0; i < places.size() && next; ++i) next = check(*next);
  }

 private:
  /// Nothing beyond the end.
  template <typename T>
  std::optional<T> number(std::uint64_t at) {
    if (at > file_.size() || file_.size() - at < sizeof(T)) return std::nullopt;
    T value{};
    file_.read(at, std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  /// Checks the chunk there; where it ends, if there is one.
  std::optional<std::uint64_t> check(std::uint64_t at) {
    std::size_t index = 0;
    if (parts_.front().in_several) {
      const auto said = number<std::uint32_t>(at);
      if (!said || *said >= parts_.size()) return std::nullopt;
      index = *said;
      at += sizeof *said;
    }
    const ExrPart& part = parts_[index];
    std::array<std::int32_t, 4> place{};
    const std::size_t numbers = part.tiled ? 4 : 1;
    for (std::size_t i = 0; i < numbers; ++i, at += 4) {
      const auto said = number<std::int32_t>(at);
      if (!said) return std::nullopt;
      place[i] = *said;
    }
    const auto size = number<std::uint32_t>(at);
    if (!size || *size > file_.size() - at - 4) return std::nullopt;
    const auto window = part.tiled ? tile(part, place) : lines(part, place[0]);
    if (window && read_[index] &&
        unpacked(part, at + 4, *size, bytes_of(part, *window)) < bytes_of(part, *window))
      fail_short(index, *window, *size);
    return at + 4 + *size;
  }

  /// What so many bytes there unpack to, as far as `wanted`, which is also what damage counts as
  /// that OpenEXR notices.
  std::uint64_t unpacked(const ExrPart& part, std::uint64_t at, std::uint32_t size,
                         std::uint64_t wanted) {
    if (size >= wanted) return size;  // as it is
    if (part.compression == kNone || size == 0) return size;
    if (part.compression > kZip) return wanted;
    packed_.resize(size);
    file_.read(at, packed_);
    return part.compression == kRle ? unpacked_runs(packed_)
                                    : unpacked_zlib(packed_, wanted).value_or(wanted);
  }

  static std::optional<Window> lines(const ExrPart& part, std::int64_t y) {
    const std::int64_t last = std::int64_t{part.y} + part.height - 1;
    if (y < part.y || y > last) return std::nullopt;
    return Window{part.x, y, std::int64_t{part.x} + part.width - 1,
                  std::min(y + part.chunk_lines() - 1, last)};
  }

  static std::optional<Window> tile(const ExrPart& part, const std::array<std::int32_t, 4>& place) {
    const auto [x, y, level, also] = place;
    if (level < 0 || level != also || static_cast<std::uint32_t>(level) >= part.levels)
      return std::nullopt;
    const Grid size = part.level_size(static_cast<std::uint32_t>(level));
    const std::int64_t x0 = std::int64_t{x} * part.tile.x, y0 = std::int64_t{y} * part.tile.y;
    if (x < 0 || y < 0 || x0 >= size.x || y0 >= size.y) return std::nullopt;
    return Window{x0, y0, std::min<std::int64_t>(x0 + part.tile.x, size.x) - 1,
                  std::min<std::int64_t>(y0 + part.tile.y, size.y) - 1};
  }

  [[noreturn]] void fail_short(std::size_t part, const Window& window, std::uint32_t size) const {
    fail(Exit::bad_input,
         "{}: {}is damaged: the {} bytes of texels ({}, {}) to ({}, {}) hold fewer than all "
         "samples; {}",
         file_.path(), parts_.size() > 1 ? fmt::format("part {} ", part) : "", size, window.x0,
         window.y0, window.x1, window.y1, to_cure(Cure::get_again));
  }

  TextureFile file_;
  const std::vector<ExrPart>& parts_;
  std::vector<bool> read_;  ///< parts that are
  std::vector<std::byte> packed_;
};

}  // namespace

void check_exr_chunks(const std::string& path, const std::vector<ExrPart>& parts,
                      const std::vector<ExrImage>& images) {
  ChunkWalk(path, parts, images).run();
}

}  // namespace gicodec::tools
