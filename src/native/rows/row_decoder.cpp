#include "native/frame/workspace.h"
#include "native/rows/row_chunk.h"

#include "base/binary_coder.h"
#include "base/bytes.h"

#include <algorithm>
#include <cstring>

namespace gicodec::native {
namespace {

/// States of the lanes, then words to the end.
Status read_words(const RowPlanes& planes, ByteReader& reader, Vector<std::byte>& room, Input& in) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    const auto state = l < planes.rows_of_slice() ? reader.fixed<std::uint32_t>() : kStateLow;
    if (reader.ok() && state < kStateLow) return Status::corrupt;
    in.high[l] = static_cast<std::uint16_t>(state >> 16);
    in.low[l] = static_cast<std::uint16_t>(state);
  }
  if (!reader.ok()) return reader.status();
  const auto words = reader.rest();
  if (words.size() % 2 != 0) return Status::corrupt;
  room.resize(words.size() + kSlack + kMaxTexelBytes);
  if (!words.empty()) std::memcpy(room.data(), words.data(), words.size());
  std::memset(room.data() + words.size(), 0, room.size() - words.size());
  in.next = reinterpret_cast<const std::uint8_t*>(room.data());
  in.end = in.next + words.size();
  return Status::ok;
}

Status decode_strips(const Update& u, ByteReader& reader, RowMemory& memory) {
  RowStrip strip = prepare_strips(u.update, memory);
  memory.tables.read(classes_of(strip), reader);
  if (!reader.ok()) return reader.status();
  Input in{};
  if (const Status read = read_words(memory.planes, reader, memory.bytes, in); read != Status::ok)
    return read;
  for (std::size_t y = 0; y < memory.planes.rows(); y += strip.rows) {
    if (u.cancelled()) return Status::cancelled;
    move_to(u.kernels, strip, memory, y);
    if (!u.kernels.decode_rows(strip, memory.tables.tables(), in)) return Status::truncated;
    store_lanes(u.kernels, memory, strip, y);
  }
  const bool ended =
      std::all_of(std::begin(in.high), std::end(in.high), [](auto x) { return x == 1; }) &&
      std::all_of(std::begin(in.low), std::end(in.low), [](auto x) { return x == 0; });
  return ended && in.next == in.end ? Status::ok : Status::corrupt;
}

}  // namespace

Status check_rows(const TextureDesc& desc, std::span<const std::byte> bytes) {
  if (!takes_rows(desc)) return Status::corrupt;
  ByteReader reader(bytes);
  const std::uint64_t size = reader.varint();
  if (!reader.ok()) return reader.status();
  return size <= reader.rest().size() ? Status::ok : Status::truncated;
}

Status decode_rows(const Update& u, std::span<const std::uint32_t> positions,
                   std::span<const std::byte> bytes, std::span<std::byte> records,
                   RowMemory& memory, ValueModel& values) {
  if (!takes_rows(u.desc) || !fits_rows(u.desc, u.box) || !fills_rows(u, positions))
    return Status::corrupt;
  RowPlanes& planes = memory.planes;
  ByteReader reader(bytes);
  const std::uint64_t size = reader.varint();
  if (!reader.ok()) return reader.status();
  if (size > reader.rest().size()) return Status::truncated;
  planes.lay_out(u, positions, false);
  values.reset();
  BinaryDecoder coder(reader.rest().first(static_cast<std::size_t>(size)));
  if (!memory.forms.code(coder, planes.channels(), planes.texels(), values) || !coder.ended())
    return Status::corrupt;
  for (unsigned c = 0; c < planes.channels().count; ++c) {
    const auto& form = memory.forms[c];
    const bool wide = planes.channels().channel[c].bits() > 16;
    if (wide && form.palette.size() > UINT16_MAX) return Status::corrupt;
  }
  if (!planes.list_coded(memory.forms)) return Status::corrupt;
  ByteReader rest(reader.rest().subspan(static_cast<std::size_t>(size)));
  if (!planes.coded().empty()) {
    if (u.update) load_past(u, positions, memory);
    if (const Status status = decode_strips(u, rest, memory); status != Status::ok) return status;
  } else if (!rest.rest().empty()) {
    return Status::corrupt;
  }
  planes.from_planes(memory.forms);
  planes.to_bits();
  const std::size_t block = u.block_bytes();
  for (const auto position : positions) {
    planes.store(u, position, records.subspan(position * block, block));
  }
  return Status::ok;
}

}  // namespace gicodec::native
