#include <gicodec/container.h>
#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/guard.h"
#include "bitstream/container_format.h"
#include "bitstream/container_metadata.h"
#include "bitstream/description.h"
#include "bitstream/index_writer.h"
#include "bitstream/packet.h"
#include "bitstream/region_field.h"

#include <optional>
#include <set>
#include <utility>

namespace gicodec {

struct ContainerWriter::State {
  Status write(std::span<const std::byte> entries) {
    const Status status = sink->write(entries);
    if (status == Status::ok) written += entries.size();
    return status;
  }
  /// Appends an index part to `out`; returns its offset in the file.
  std::uint64_t append_part(const IndexPart& part, std::vector<std::byte>& out) const {
    const std::uint64_t offset = written + out.size();
    std::vector<std::byte> body;
    write_index_part(part, offset, body);
    append_entry(EntryType::index, {}, body, out);
    return offset;
  }
  Status add(std::uint64_t frame, std::span<const std::byte> packet, std::uint32_t region);
  Status check_made_for(const PacketParts& packet, std::uint32_t region) const;

  Sink* sink = nullptr;
  std::vector<PacketRule> rules;  ///< by texture
  /// By texture; without a record if the kind is unknown.
  std::vector<TextureDesc> textures;
  std::vector<Grid> region_sizes;
  std::uint64_t written = 0;
  std::optional<IndexWriter> index;
  int last_metadata = -1;            ///< the last texture with a metadata entry
  std::uint64_t metadata_bytes = 0;  ///< of all metadata entries, unpacked
  std::uint64_t last_frame = 0;
  std::set<std::uint64_t> in_frame;  ///< keys of the packets of `last_frame`
  bool ended = false;
};

ContainerWriter::ContainerWriter(std::unique_ptr<State> state) noexcept
    : state_(std::move(state)) {}
ContainerWriter::ContainerWriter(ContainerWriter&&) noexcept = default;
ContainerWriter& ContainerWriter::operator=(ContainerWriter&&) noexcept = default;
ContainerWriter::~ContainerWriter() = default;

std::uint64_t ContainerWriter::bytes_written() const noexcept { return state_->written; }

Result<ContainerWriter> ContainerWriter::create(Sink& sink, const ContainerDescription& description,
                                                std::span<const Kind* const> kinds) {
  return guarded([&]() -> Result<ContainerWriter> {
    std::vector<std::byte> body;
    if (const Status status = write_description(description, kinds, body); status != Status::ok) {
      return status;
    }
    std::vector<std::byte> start;
    ByteWriter head(start);
    head.bytes(std::as_bytes(std::span(kMagic)));
    head.fixed(kContainerMajor);
    head.fixed(kContainerMinor);
    head.fixed(std::uint16_t{0});
    std::vector<std::byte> entry;
    append_entry(EntryType::description, {}, body, entry);
    head.bytes(entry);

    auto state = std::make_unique<State>();
    state->sink = &sink;
    state->rules = packet_rules(description);
    for (const TextureEntry& texture : description.textures) {
      state->textures.push_back(texture.desc);
      state->region_sizes.push_back(description.volumes[texture.volume].region);
    }
    state->index.emplace(description);
    if (const Status status = state->write(start); status != Status::ok) return status;
    return ContainerWriter(std::move(state));
  });
}

/// Checks a keyframe's description hash; other packets follow from a keyframe.
Status ContainerWriter::State::check_made_for(const PacketParts& packet,
                                              std::uint32_t region) const {
  const TextureDesc& whole = textures[packet.info.texture_id];
  if (!is_keyframe(packet.info.type) || whole.record.bytes == 0) return Status::ok;
  const Grid& size = region_sizes[packet.info.texture_id];
  const auto hash = description_hash(
      region == StreamId::kWholeVolume ? whole : region_texture(whole, size, region));
  return packet.base == hash ? Status::ok : Status::description_mismatch;
}

Status ContainerWriter::State::add(std::uint64_t frame, std::span<const std::byte> packet,
                                   std::uint32_t region) {
  if (ended) return Status::out_of_order;
  const auto parts = parse_packet(packet);
  if (!parts) return parts.status();
  const PacketInfo& info = parts->info;
  if (info.texture_id >= rules.size()) return Status::unknown_texture;
  const PacketRule& rule = rules[info.texture_id];
  if (!rule.has(region)) return Status::unknown_region;
  if (info.lossy && rule.lossless) return Status::description_mismatch;
  if (const Status status = check_made_for(*parts, region); status != Status::ok) return status;
  const SeekEntry entry{frame, written, region, info.texture_id, is_keyframe(info.type)};
  const bool same_frame = frame == last_frame;
  if (frame < last_frame || (same_frame && in_frame.count(entry.key()) != 0)) {
    return Status::wrong_frame;
  }
  // All allocations come before the write.
  std::set<std::uint64_t> keys{entry.key()};
  std::vector<std::byte> head, out;
  ByteWriter fields(head);
  fields.varint(frame);
  fields.varint(to_region_field(region));
  append_entry(EntryType::packet, head, packet, out);
  index->make_room(entry);
  const std::size_t packet_bytes = out.size();
  const bool due = index->is_due(1);
  const std::uint64_t part = due ? append_part(index->next_part(&entry, false), out) : 0;
  if (const Status status = write(out); status != Status::ok) return status;
  index->add(entry);
  if (due) index->close(part, out.size() - packet_bytes);
  if (same_frame) {
    in_frame.merge(keys);
  } else {
    in_frame.swap(keys);
  }
  last_frame = frame;
  return Status::ok;
}

Status ContainerWriter::add_metadata(std::uint8_t texture_id, const Metadata& metadata) {
  return guarded([&]() -> Status {
    State& state = *state_;
    if (texture_id >= state.rules.size()) return Status::unknown_texture;
    if (state.ended || !state.in_frame.empty() || texture_id <= state.last_metadata) {
      return Status::out_of_order;
    }
    if (metadata.empty()) return Status::ok;
    std::vector<std::byte> body, out;
    Status status = pack_metadata(texture_id, metadata, body);
    if (status != Status::ok) return status;
    const std::uint64_t bytes = state.metadata_bytes + read_packed_head(body)->bytes;
    if (bytes > kMaxPackedMetadata || body.size() > kMaxPackedMetadata) {
      return Status::limit_exceeded;
    }
    append_entry(EntryType::metadata, {}, body, out);
    status = state.write(out);
    if (status != Status::ok) return status;
    state.last_metadata = texture_id;
    state.metadata_bytes = bytes;
    return Status::ok;
  });
}

Status ContainerWriter::add(std::uint64_t frame, std::span<const std::byte> packet,
                            std::uint32_t region) {
  return guarded([&] { return state_->add(frame, packet, region); });
}

Status ContainerWriter::flush() {
  return guarded([&]() -> Status {
    State& state = *state_;
    if (state.ended) return Status::out_of_order;
    if (!state.index->is_worth_a_part()) return Status::ok;
    std::vector<std::byte> out;
    const std::uint64_t part = state.append_part(state.index->next_part(nullptr, false), out);
    if (const Status status = state.write(out); status != Status::ok) return status;
    state.index->close(part, out.size());
    return Status::ok;
  });
}

Status ContainerWriter::finish() {
  return guarded([&]() -> Status {
    State& state = *state_;
    if (state.ended) return Status::out_of_order;
    std::vector<std::byte> end, out;
    std::uint64_t last = state.index->last_part();
    if (!state.index->is_complete()) {
      last = state.append_part(state.index->next_part(nullptr, true), out);
    }
    ByteWriter(end).fixed(last);
    append_entry(EntryType::end, {}, end, out);
    const Status status = state.write(out);
    state.ended = status == Status::ok;
    return status;
  });
}

}  // namespace gicodec
