#include <gicodec/container.h>

#include "base/guard.h"
#include "bitstream/container_index.h"
#include "bitstream/metadata_entries.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace gicodec {
namespace {

/// The offset from which on packets of a region of a texture are wanted.
struct Start {
  std::uint64_t key = 0, offset = 0;
};

bool by_key(const Start& start, std::uint64_t key) { return start.key < key; }

/// Bytes of packets that a distant source is told of at once, beside those of a frame: at first,
/// in the end, and at most.
constexpr std::uint64_t kFirstPlan = std::uint64_t{64} << 10;
constexpr std::uint64_t kPlan = std::uint64_t{2} << 20;
constexpr std::uint64_t kMaxPlan = std::uint64_t{16} << 20;

}  // namespace

struct ContainerReader::State {
  State(Source& source, const DecodeLimits& limits) noexcept : reader(source, limits) {}

  [[nodiscard]] bool is_selected(std::uint64_t key) const noexcept {
    return selected.empty() || std::binary_search(selected.begin(), selected.end(), key);
  }
  [[nodiscard]] bool is_wanted(const SeekEntry& packet) const noexcept {
    const std::uint64_t key = packet.key();
    if (!is_selected(key)) return false;
    const auto start = std::lower_bound(starts.begin(), starts.end(), key, by_key);
    return start == starts.end() || start->key != key || packet.offset >= start->offset;
  }
  /// True if next() passes over packets.
  [[nodiscard]] bool skips() noexcept {
    if (!starts.empty() && position > last_start) starts.clear();
    return seekable && (!selected.empty() || !starts.empty()) && position < index.end();
  }
  /// Moves past unwanted packets that the index lists, and sets `listed` to the packet at the new
  /// position, if the index lists it.
  Status follow_index(std::optional<SeekEntry>& listed);
  /// Tells a distant source which packets next() will read.
  Status plan();
  /// Of a damaged part of the index: goes on without index. False for other errors.
  bool give_up_index(Status status) noexcept;
  Status next(ContainerPacket& packet);
  Status read_next(FileEntry& entry);
  Status seek(std::uint64_t frame);
  /// Calls visit(packet, bytes) for what the index lists, without reading packets.
  template <typename Visit>
  Status for_each_listed(const Visit& visit);
  [[nodiscard]] std::vector<Start> starts_of(std::vector<SeekEntry> keyframes) const;

  EntryReader reader;
  ContainerDescription description;
  ContainerIndex index;
  MetadataEntries metadata;
  std::uint64_t position = 0;  ///< of the next entry
  std::uint64_t last_frame = 0;
  std::vector<std::uint64_t> selected;  ///< keys, ascending; empty: all
  std::vector<Start> starts;            ///< ascending by key; cleared once all are passed
  std::uint64_t last_start = 0;
  std::uint64_t planned = 0;        ///< plan() told of all packets before this offset
  std::uint64_t planned_frame = 0;  ///< the next plan reaches as far as this frame
  std::uint64_t plan_bytes = kFirstPlan;
  bool distant = false;
  bool seekable = false;
  bool finished = false;
  bool ended = false;
};

ContainerReader::ContainerReader(std::unique_ptr<State> state) noexcept
    : state_(std::move(state)) {}
ContainerReader::ContainerReader(ContainerReader&&) noexcept = default;
ContainerReader& ContainerReader::operator=(ContainerReader&&) noexcept = default;
ContainerReader::~ContainerReader() = default;

const ContainerDescription& ContainerReader::description() const noexcept {
  return state_->description;
}
bool ContainerReader::seekable() const noexcept { return state_->seekable; }
bool ContainerReader::finished() const noexcept { return state_->finished; }

Result<ContainerReader> ContainerReader::open(Source& source, const DecodeLimits& limits,
                                              std::span<const Kind* const> kinds) {
  return guarded([&]() -> Result<ContainerReader> {
    auto state = std::make_unique<State>(source, limits);
    Status status = state->reader.file_head();
    FileEntry entry;
    if (status == Status::ok) status = state->reader.read(kFileHeader, entry);
    if (status != Status::ok) return status;
    if (!entry.is(EntryType::description)) return Status::corrupt;
    status = read_description(entry.bytes, limits, kinds, state->description);
    if (status != Status::ok) return status;
    state->reader.set_rules(packet_rules(state->description));
    state->position = entry.end();
    state->metadata = MetadataEntries(entry.end());
    if (source.size()) {
      // Neither is an error yet: next() and metadata() report damage, and packets can be read in
      // order without an index.
      state->distant = state->reader.prefetch({});
      (void)state->metadata.find(state->reader);
      state->seekable = state->index.load(state->reader, state->metadata.end()) == Status::ok;
      state->finished = state->index.finished();
      if (!state->seekable) state->index = {};
    }
    return ContainerReader(std::move(state));
  });
}

bool ContainerReader::State::give_up_index(Status status) noexcept {
  const bool damaged = status == Status::corrupt || status == Status::checksum_mismatch ||
                       status == Status::limit_exceeded;
  if (!damaged) return false;
  seekable = false;
  index = {};
  return true;
}

Status ContainerReader::State::follow_index(std::optional<SeekEntry>& listed) {
  while (skips()) {
    const auto packets = index.packets_from(reader, position);
    if (!packets) return give_up_index(packets.status()) ? Status::ok : packets.status();
    const auto it = std::find_if(packets->begin(), packets->end(),
                                 [&](const SeekEntry& packet) { return is_wanted(packet); });
    if (it != packets->end()) {
      listed = *it;
      position = it->offset;
      return Status::ok;
    }
    position = packets->empty() ? index.end() : index.end_of(packets->back());
  }
  return Status::ok;
}

Status ContainerReader::State::plan() {
  if (!distant || position < planned) return Status::ok;
  std::vector<ByteRange> ranges;
  const auto add = [&](std::uint64_t offset, std::uint64_t end) {
    if (!ranges.empty() && ranges.back().offset + ranges.back().size == offset) {
      ranges.back().size += end - offset;
    } else {
      ranges.push_back({offset, end - offset});
    }
  };
  std::uint64_t bytes = 0, beyond = 0;
  std::uint64_t at = position, frame = planned_frame;
  auto first = seekable ? index.packets_from(reader, at) : ContainerIndex::Packets{};
  if (!first && !give_up_index(first.status())) return first.status();
  auto packets = first ? *first : ContainerIndex::Packets{};
  // Behind these, what other parts list goes along if they are there.
  for (bool more = true; more && !packets.empty(); packets = index.held_from(at)) {
    for (const SeekEntry& packet : packets) {
      const std::uint64_t end = index.end_of(packet);
      more = bytes < kMaxPlan &&
             (bytes == 0 || packet.frame <= frame || beyond + end - packet.offset <= plan_bytes);
      if (!more) break;
      frame = std::max(frame, bytes == 0 ? packet.frame : frame);
      at = end;
      if (!is_wanted(packet)) continue;
      add(packet.offset, at);
      bytes += at - packet.offset;
      if (packet.frame > frame) beyond += at - packet.offset;
    }
  }
  if (ranges.empty() && seekable) at = index.end();
  // What the index does not list is read entry by entry.
  const std::uint64_t total = *reader.size();
  if (at >= index.end() && at < total) add(at, std::min(total, at + kPlan));
  planned = at >= index.end() ? std::min(total, at + kPlan) : at;
  plan_bytes = std::min(2 * plan_bytes, kPlan);
  (void)reader.prefetch(ranges);
  return Status::ok;
}

/// Reads the entry at `position`; passes over metadata.
Status ContainerReader::State::read_next(FileEntry& entry) {
  if (position <= metadata.end()) {
    if (const Status status = metadata.find(reader); status != Status::ok) return status;
    position = metadata.end();
  }
  Status status = Status::ok;
  if (auto ahead = metadata.take_ahead()) {
    entry = ahead->entry;
    status = ahead->status;
  } else {
    status = reader.read(position, entry);
  }
  const bool late = status == Status::ok && entry.is(EntryType::metadata);
  return late ? Status::corrupt : status;
}

Status ContainerReader::State::next(ContainerPacket& packet) {
  while (!ended) {
    std::optional<SeekEntry> listed;
    Status status = follow_index(listed);
    if (status == Status::ok) status = plan();
    if (status != Status::ok) return status;
    const bool repeatable = reader.size().has_value();
    ended = !repeatable;  // A pipe cannot repeat a partial read.
    FileEntry entry;
    status = read_next(entry);
    const bool is_packet = entry.is(EntryType::packet);
    if (status == Status::ok) {
      const bool other = listed && !(is_packet && entry.packet == *listed);
      if (other || (is_packet && entry.packet.frame < last_frame)) status = Status::corrupt;
    }
    if (status != Status::ok) {
      ended = status != Status::truncated || !repeatable;
      return status;
    }
    if (entry.is(EntryType::end)) {
      finished = ended = true;
      break;
    }
    const bool wanted = is_packet && is_wanted(entry.packet);
    if (wanted) {
      packet.bytes.assign(entry.bytes.begin(), entry.bytes.end());
      packet.frame = entry.packet.frame;
      packet.region = entry.packet.region;
      packet.texture_id = entry.packet.texture_id;
      packet.keyframe = entry.packet.keyframe;
    }
    if (seekable) index.list(entry, reader.limits());
    position = entry.end();
    if (is_packet) last_frame = entry.packet.frame;
    ended = false;
    if (wanted) return Status::ok;
  }
  return Status::end;
}

/// The last keyframe of each region of a texture. For a presence texture: the last one that is no
/// later than those of the textures that depend on it.
std::vector<Start> ContainerReader::State::starts_of(std::vector<SeekEntry> keyframes) const {
  // The last keyframe of each key comes first.
  std::sort(keyframes.begin(), keyframes.end(), [](const SeekEntry& a, const SeekEntry& b) {
    return a.key() != b.key() ? a.key() < b.key() : a.offset > b.offset;
  });
  std::vector<const SeekEntry*> chosen;
  for (const SeekEntry& one : keyframes) {
    if (chosen.empty() || chosen.back()->key() != one.key()) chosen.push_back(&one);
  }
  const auto by_its_key = [](const SeekEntry* one, std::uint64_t key) { return one->key() < key; };
  for (const SeekEntry* const one : chosen) {
    const auto presence = presence_texture(description, one->texture_id);
    if (!presence) continue;
    const std::uint64_t key = region_key(*presence, one->region);
    const auto at = std::lower_bound(chosen.begin(), chosen.end(), key, by_its_key);
    if (at == chosen.end() || (*at)->key() != key) continue;
    const SeekEntry* const last = keyframes.data() + keyframes.size();
    for (const SeekEntry* it = *at; it != last && it->key() == key; ++it) {
      *at = it;
      if (it->frame <= one->frame) break;
    }
  }
  std::vector<Start> found;
  found.reserve(chosen.size());
  for (const SeekEntry* const one : chosen) found.push_back({one->key(), one->offset});
  return found;
}

Status ContainerReader::State::seek(std::uint64_t frame) {
  if (!seekable) return Status::unknown_frame;
  if (const Status status = index.extend(reader); status != Status::ok) return status;
  const auto lists = index.packets_for(reader, frame);
  if (!lists) return give_up_index(lists.status()) ? Status::unknown_frame : lists.status();
  std::vector<SeekEntry> keyframes;
  std::optional<std::uint64_t> first;
  for (const auto& list : *lists) {
    for (const SeekEntry& packet : list) {
      if (packet.frame > frame) break;
      if (packet.frame == frame && !first) first = packet.offset;
      if (packet.keyframe && is_selected(packet.key())) keyframes.push_back(packet);
    }
  }
  if (!first) return Status::unknown_frame;
  std::vector<Start> found = starts_of(std::move(keyframes));

  position = *first;
  last_start = 0;
  for (const Start& start : found) {
    position = std::min(position, start.offset);
    last_start = std::max(last_start, start.offset);
  }
  starts = std::move(found);
  planned = 0;
  planned_frame = frame;
  plan_bytes = kFirstPlan;
  last_frame = 0;
  ended = false;
  return Status::ok;
}

template <typename Visit>
Status ContainerReader::State::for_each_listed(const Visit& visit) {
  if (!seekable) return Status::unknown_frame;
  Status status = index.extend(reader);
  if (status == Status::ok) status = index.for_each(reader, visit);
  return give_up_index(status) ? Status::unknown_frame : status;
}

Result<Metadata> ContainerReader::metadata(std::uint8_t texture_id) {
  return guarded([&]() -> Result<Metadata> {
    State& state = *state_;
    if (texture_id >= state.description.textures.size()) return Status::unknown_texture;
    if (const Status status = state.metadata.find(state.reader); status != Status::ok) {
      return status;
    }
    return state.metadata.read(state.reader, texture_id);
  });
}

std::optional<std::uint64_t> ContainerReader::next_frame() noexcept {
  State& state = *state_;
  if (state.ended || !state.seekable) return std::nullopt;
  const bool skips = state.skips();
  for (std::uint64_t at = state.position;;) {
    const auto packets = state.index.held_from(at);
    if (packets.empty()) return state.index.least_frame(at);
    if (!skips && packets.front().offset != at && !state.index.is_part(at)) return std::nullopt;
    const auto it = std::find_if(packets.begin(), packets.end(), [&](const SeekEntry& packet) {
      return !skips || state.is_wanted(packet);
    });
    if (it != packets.end()) return it->frame;
    at = state.index.end_of(packets.back());
  }
}

Status ContainerReader::next(ContainerPacket& packet) {
  return guarded([&] { return state_->next(packet); });
}

Status ContainerReader::seek(std::uint64_t frame) {
  return guarded([&] { return state_->seek(frame); });
}

Result<std::vector<std::uint64_t>> ContainerReader::frames() {
  return guarded([&]() -> Result<std::vector<std::uint64_t>> {
    std::vector<std::uint64_t> frames;
    const Status status = state_->for_each_listed([&](const SeekEntry& packet, std::uint64_t) {
      if (frames.empty() || frames.back() != packet.frame) frames.push_back(packet.frame);
    });
    if (status != Status::ok) return status;
    return frames;
  });
}

Result<std::vector<ListedPart>> ContainerReader::listed() {
  return guarded([&]() -> Result<std::vector<ListedPart>> {
    std::map<std::uint64_t, ListedPart> parts;
    const Status status =
        state_->for_each_listed([&](const SeekEntry& packet, std::uint64_t bytes) {
          ListedPart& part = parts[packet.key()];
          if (part.packets++ == 0) {
            part.part = {packet.texture_id, packet.region};
            part.first_frame = packet.frame;
          }
          part.last_frame = packet.frame;
          part.bytes += bytes;
          if (!packet.keyframe) return;
          ++part.keyframes;
          part.keyframe_bytes += bytes;
        });
    if (status != Status::ok) return status;
    std::vector<ListedPart> list;
    list.reserve(parts.size());
    for (const auto& [key, part] : parts) list.push_back(part);
    return list;
  });
}

Status ContainerReader::select(std::span<const TextureRegion> wanted) {
  return guarded([&]() -> Status {
    const auto rules = state_->reader.rules();
    std::vector<std::uint64_t> keys;
    keys.reserve(wanted.size());
    for (const auto& [texture_id, region] : wanted) {
      if (texture_id >= rules.size()) return Status::unknown_texture;
      if (!rules[texture_id].has(region)) return Status::unknown_region;
      keys.push_back(region_key(texture_id, region));
    }
    std::sort(keys.begin(), keys.end());
    state_->selected = std::move(keys);
    state_->starts.clear();
    state_->index.everything();
    state_->planned = 0;
    return Status::ok;
  });
}

}  // namespace gicodec
