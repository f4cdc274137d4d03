// The bytes of messages (docs/protocol.md). A message lists its fields once, for Writer and Reader.
#include <gicodec/protocol.h>

#include "base/guard.h"
#include "bitstream/message_archive.h"
#include "bitstream/region_field.h"
#include "bitstream/update_message.h"

#include <concepts>

namespace gicodec {
namespace {

constexpr std::uint32_t kMagic = 0x73636967;  // "gics"
/// Of an object: a delta, and an intra update of blocks that moved.
constexpr std::size_t kMaxTrackPackets = 2;
constexpr std::uint32_t kMaxTrackNumber = 1023;
constexpr std::uint8_t kLastReason = static_cast<std::uint8_t>(Reason::unicast_full);

/// A message to read into, or a const one to write.
template <typename T, typename M>
concept FieldsOf = std::same_as<std::remove_const_t<T>, M>;

/// A list of at most `max` items, each of `size` bytes or more.
template <typename Archive, typename List, typename Item>
void items(Archive& archive, List& list, std::size_t max, std::size_t size, Item&& item) {
  archive.count(list, max, size);
  for (auto& one : list) item(one);
}

/// An enumeration with values 0..last.
template <typename E>
void choice(Writer& writer, const E& value, std::uint8_t last) {
  writer.check(static_cast<std::uint8_t>(value) <= last);
  writer.fixed(static_cast<std::uint8_t>(value));
}
template <typename E>
void choice(Reader& reader, E& value, std::uint8_t last) {
  std::uint8_t number = 0;
  reader.fixed(number);
  reader.check(number <= last);
  value = static_cast<E>(number);
}

void flag(Writer& writer, const bool& value) { writer.fixed(std::uint8_t{value}); }
void flag(Reader& reader, bool& value) {
  std::uint8_t number = 0;
  reader.fixed(number);
  reader.check(number <= 1);
  value = number == 1;
}

void magic(Writer& writer) {
  writer.fixed(kMagic);
  writer.fixed(kProtocolVersion);
}
void magic(Reader& reader) {
  std::uint32_t found = 0;
  std::uint8_t version = 0;
  reader.fixed(found);
  reader.fixed(version);
  if (found != kMagic) reader.fail(Status::not_gicodec);
  if (version != kProtocolVersion) reader.fail(Status::unsupported_version);
}

void stream_id(Writer& writer, const StreamId& id) {
  writer.number(id.volume, kMaxVolumes - 1);
  writer.fixed(id.texture);
  writer.number(to_region_field(id.region), kMaxRegionField);
}
void stream_id(Reader& reader, StreamId& id) {
  reader.number(id.volume, kMaxVolumes - 1);
  reader.fixed(id.texture);
  std::uint64_t region = 0;
  reader.number(region, kMaxRegionField);
  id.region = from_region_field(region);
}

void mask(Writer& writer, const BlockMask& mask) {
  Vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < mask.size(); ++block) {
    if (mask[block] != 0) blocks.push_back(block);
  }
  writer.number(static_cast<std::uint32_t>(mask.size()), kMaxBlocks);
  writer.blocks(blocks, static_cast<std::uint32_t>(mask.size()));
}
void mask(Reader& reader, BlockMask& mask) {
  std::uint32_t total = 0;
  Vector<std::uint32_t> blocks;
  reader.number(total, kMaxBlocks);
  reader.blocks(blocks, total);
  if (reader.status() != Status::ok) return;
  mask.assign(total, 0);
  for (const std::uint32_t block : blocks) mask[block] = 1;
}

template <typename Archive>
void held(Archive& archive, auto& states) {
  items(archive, states, kMaxHeld, 11, [&](auto& state) {
    stream_id(archive, state.stream);
    archive.fixed(state.sequence);
    archive.fixed(state.checksum);
  });
}

template <typename Archive>
void vector3(Archive& archive, auto& position) {
  for (auto& coordinate : position) archive.real(coordinate);
}

template <typename Archive>
void grid(Archive& archive, auto& sides) {
  archive.number(sides.x);
  archive.number(sides.y);
  archive.number(sides.z);
}

template <typename Archive, FieldsOf<Hello> M>
void fields(Archive& archive, M& m) {
  magic(archive);
  archive.number(m.sync);
  archive.raw(m.ticket);
  choice(archive, m.delivery, static_cast<std::uint8_t>(Delivery::shared));
  archive.number(m.budget.blocks);
  archive.number(m.budget.bytes);
  archive.secret(m.token, kMaxToken);
  archive.number(m.generation);
  held(archive, m.held);
}

template <typename Archive, FieldsOf<Resync> M>
void fields(Archive& archive, M& m) {
  archive.number(m.sync);
  archive.number(m.generation);
  held(archive, m.held);
}

template <typename Archive, FieldsOf<Acknowledge> M>
void fields(Archive& archive, M& m) {
  archive.number(m.sync);
  archive.number(m.number);
}

template <typename Archive, FieldsOf<Viewpoint> M>
void fields(Archive& archive, M& m) {
  vector3(archive, m.eye);
  vector3(archive, m.target);
  vector3(archive, m.up);
  archive.real(m.fov_y);
  archive.real(m.aspect);
  archive.real(m.time);
  archive.check(m.fov_y > 0 && m.fov_y < 180 && m.aspect > 0);
}

template <typename Archive, FieldsOf<Subscribe> M>
void fields(Archive& archive, M& m) {
  archive.number(m.generation);
  archive.number(m.volume, kMaxVolumes - 1);
  archive.fixed(m.group);
  mask(archive, m.blocks);
}

template <typename Archive, FieldsOf<Goodbye> M>
void fields(Archive& archive, M& m) {
  choice(archive, m.reason, kLastReason);
  archive.text(m.text, kMaxText);
}

template <typename Archive>
void described(Archive& archive, auto& texture) {
  auto& layout = texture.layout;
  archive.text(texture.name, kMaxName);
  choice(archive, layout.tiling, kTilingCount - 1);
  archive.fixed(layout.pad_before);
  archive.fixed(layout.pad_after);
  grid(archive, layout.slots);
  archive.largest_error(texture.largest_error);
}

template <typename Archive>
void volume(Archive& archive, auto& volume) {
  archive.number(volume.id, kMaxVolumes - 1);
  archive.number(volume.added);
  archive.text(volume.name, kMaxName);
  archive.fixed(volume.kind);
  archive.block(volume.description, kMaxKindDescription);
  grid(archive, volume.geometry.grid);
  vector3(archive, volume.geometry.origin);
  vector3(archive, volume.geometry.spacing);
  for (auto& cells : volume.geometry.scroll) archive.signed_number(cells);
  archive.check(validate(volume.geometry) == Status::ok);
  grid(archive, volume.region);
  for (const std::uint32_t side : {volume.region.x, volume.region.y, volume.region.z}) {
    archive.check(side > 0 && side <= kMaxGridSide);
  }
  items(archive, volume.textures, kMaxVolumeTextures, 11,
        [&](auto& texture) { described(archive, texture); });
}

/// Volumes, ascending by id, none newer than the list.
template <typename Archive>
void volumes(Archive& archive, auto& m) {
  archive.number(m.generation);
  items(archive, m.volumes, kMaxVolumes, 40, [&](auto& one) { volume(archive, one); });
  std::uint32_t next = 0;
  for (const auto& one : m.volumes) {
    archive.check(one.id >= next && one.added <= m.generation);
    next = one.id + 1U;
  }
}

template <typename Archive, FieldsOf<Welcome> M>
void fields(Archive& archive, M& m) {
  magic(archive);
  archive.number(m.sync);
  archive.raw(m.ticket);
  archive.check(m.ticket != Ticket{});
  flag(archive, m.resumed);
  choice(archive, m.delivery, static_cast<std::uint8_t>(Delivery::shared));
  archive.fixed(m.epoch);
  archive.text(m.scene.name, kMaxName);
  archive.fixed(m.scene.geometry);
  volumes(archive, m);
}

template <typename Archive, FieldsOf<Volumes> M>
void fields(Archive& archive, M& m) {
  volumes(archive, m);
}

template <typename Archive>
void scrolls(Archive& archive, auto& list) {
  items(archive, list, kMaxVolumes, 3, [&](auto& scroll) {
    for (auto& cells : scroll) archive.signed_number(cells);
  });
}

template <typename Archive>
void update_head(Archive& archive, auto& m) {
  archive.number(m.sync);
  archive.number(m.number);
}

template <typename Archive>
void update_rest(Archive& archive, auto& m) {
  archive.number(m.generation);
  archive.number(m.update);
  archive.real(m.time);
  scrolls(archive, m.scrolls);
  items(archive, m.parts, kMaxBytes, 5, [&](auto& part) {
    stream_id(archive, part.stream);
    archive.fixed(part.tier);
    archive.check(part.tier <= kMaxTier);
    archive.bytes(part.packet);
  });
  items(archive, m.proofs, kMaxBytes, 11, [&](auto& proof) {
    stream_id(archive, proof.stream);
    archive.fixed(proof.hash);
  });
}

/// Runs of tracks, ascending and apart, none older than `update`.
template <typename Archive>
void track_runs(Archive& archive, auto& runs, std::uint64_t update) {
  items(archive, runs, kMaxBytes, 6, [&](auto& run) {
    stream_id(archive, run.first);
    archive.number(run.count);
    archive.number(run.age);
    archive.number(run.number, kMaxTrackNumber);
    archive.check(run.count > 0 && run.age <= update &&
                  run.first.region <= StreamId::kWholeVolume - run.count);
  });
  for (std::size_t i = 1; i < runs.size(); ++i) {
    StreamId end = runs[i - 1].first;
    end.region += runs[i - 1].count;
    archive.check(end <= runs[i].first);
  }
}

template <typename Archive, FieldsOf<TrackList> M>
void fields(Archive& archive, M& m) {
  magic(archive);
  archive.fixed(m.epoch);
  archive.number(m.update);
  archive.number(m.round);
  archive.check(m.round <= m.update);
  archive.text(m.scene.name, kMaxName);
  archive.fixed(m.scene.geometry);
  volumes(archive, m);
  track_runs(archive, m.snapshots, m.update);
}

/// How objects and ticks begin.
template <typename Archive>
void track_head(Archive& archive, auto& m) {
  archive.fixed(m.epoch);
  archive.number(m.generation);
  archive.number(m.update);
}

template <typename Archive, FieldsOf<TrackObject> M>
void fields(Archive& archive, M& m) {
  track_head(archive, m);
  archive.number(m.previous);
  archive.check(m.previous < m.update);
  archive.number(m.number, kMaxTrackNumber);
  stream_id(archive, m.stream);
  archive.check(m.stream.region != StreamId::kWholeVolume);
  items(archive, m.packets, kMaxTrackPackets, 1, [&](auto& packet) { archive.bytes(packet); });
  archive.check(!m.packets.empty());
  items(archive, m.proof, 1, 8, [&](auto& hash) { archive.fixed(hash); });
}

template <typename Archive, FieldsOf<TrackTick> M>
void fields(Archive& archive, M& m) {
  track_head(archive, m);
  archive.real(m.time);
  scrolls(archive, m.scrolls);
  archive.number(m.round);
  archive.check(m.round <= m.update);
  track_runs(archive, m.changed, m.update);
}

template <typename Archive, FieldsOf<UpdateMessage> M>
void fields(Archive& archive, M& m) {
  update_head(archive, m);
  update_rest(archive, m);
}

template <std::size_t type = 0>
Status read(std::size_t wanted, Reader& reader, AnyMessage& message) {
  if constexpr (type == std::variant_size_v<AnyMessage>) {
    return Status::corrupt;
  } else {
    if (type != wanted) return read<type + 1>(wanted, reader, message);
    fields(reader, message.emplace<type>());
    reader.check(reader.at_end());
    return reader.status();
  }
}

}  // namespace

// A message is its type (index in AnyMessage, from 1 on) and its fields.

static void write_type(Writer& writer, const AnyMessage& message) {
  writer.fixed(static_cast<std::uint8_t>(message.index() + 1));
}

Status write_message(const AnyMessage& message, Message& out) {
  return guarded([&]() -> Status {
    out.clear();
    Writer writer(out);
    write_type(writer, message);
    std::visit([&](const auto& one) { fields(writer, one); }, message);
    return writer.status();
  });
}

Status write_update_head(const UpdateMessage& update, Message& out) {
  return guarded([&]() -> Status {
    Writer writer(out);
    write_type(writer, UpdateMessage{});
    update_head(writer, update);
    return writer.status();
  });
}

Status write_update_rest(const UpdateMessage& update, Message& out) {
  return guarded([&]() -> Status {
    Writer writer(out);
    update_rest(writer, update);
    return writer.status();
  });
}

Result<Message> OutgoingMessage::joined() const {
  return guarded([&]() -> Result<Message> {
    Message all;
    all.reserve(size());
    for (const auto piece : pieces()) all.insert(all.end(), piece.begin(), piece.end());
    return all;
  });
}

Result<AnyMessage> read_message(std::span<const std::byte> bytes, const MessageLimits& limits) {
  return guarded([&]() -> Result<AnyMessage> {
    if (bytes.size() > limits.max_bytes) return Status::limit_exceeded;
    if (bytes.empty()) return Status::truncated;
    Reader reader(bytes.subspan(1), limits);
    AnyMessage message;
    const Status status = read(std::to_integer<std::size_t>(bytes[0]) - 1, reader, message);
    if (status != Status::ok) return status;
    return message;
  });
}

}  // namespace gicodec
