#include <gicodec/container.h>

#include "base/guard.h"
#include "bitstream/container_index.h"
#include "bitstream/metadata_entries.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gicodec {
namespace {

/// The offset from which on packets of a region of a texture are wanted.
struct Start {
  std::uint64_t key = 0, offset = 0;
};

bool by_key(const Start& start, std::uint64_t key) { return start.key < key; }

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
  /// Moves past unwanted packets that the index lists. Returns the packet at the new position, if
  /// the index lists it.
  std::optional<SeekEntry> follow_index();
  /// The first packet that the index lists at the position or behind it.
  [[nodiscard]] std::vector<SeekEntry>::const_iterator next_listed() const noexcept {
    const auto& packets = index.packets();
    return std::lower_bound(
        packets.begin(), packets.end(), position,
        [](const SeekEntry& packet, std::uint64_t offset) { return packet.offset < offset; });
  }
  std::optional<std::uint64_t> next_frame();
  Status next(ContainerPacket& packet);
  Status read_next(FileEntry& entry);
  Status seek(std::uint64_t frame);
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
      (void)state->metadata.find(state->reader);
      state->seekable = state->index.load(state->reader, state->metadata.end()) == Status::ok;
      state->finished = state->index.finished();
      if (!state->seekable) state->index = {};
    }
    return ContainerReader(std::move(state));
  });
}

std::optional<SeekEntry> ContainerReader::State::follow_index() {
  if (!starts.empty() && position > last_start) starts.clear();
  const bool all = selected.empty() && starts.empty();
  if (!seekable || all || position >= index.end()) return std::nullopt;
  const auto& packets = index.packets();
  const auto it = std::find_if(next_listed(), packets.end(),
                               [&](const SeekEntry& packet) { return is_wanted(packet); });
  position = it == packets.end() ? index.end() : it->offset;
  if (it == packets.end()) return std::nullopt;
  return *it;
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

std::optional<std::uint64_t> ContainerReader::State::next_frame() {
  if (ended || !seekable) return std::nullopt;
  if (const auto listed = follow_index()) return listed->frame;
  const auto at = next_listed();
  if (at == index.packets().end() || at->offset != position) return std::nullopt;
  return at->frame;
}

Status ContainerReader::State::next(ContainerPacket& packet) {
  while (!ended) {
    const auto listed = follow_index();
    const bool repeatable = reader.size().has_value();
    ended = !repeatable;  // A pipe cannot repeat a partial read.
    FileEntry entry;
    Status status = read_next(entry);
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
  const auto& packets = index.packets();
  const auto first = std::lower_bound(
      packets.begin(), packets.end(), frame,
      [](const SeekEntry& packet, std::uint64_t wanted) { return packet.frame < wanted; });
  if (first == packets.end() || first->frame != frame) return Status::unknown_frame;
  const auto end = std::upper_bound(
      first, packets.end(), frame,
      [](std::uint64_t wanted, const SeekEntry& packet) { return wanted < packet.frame; });

  const auto counts = [&](const SeekEntry& packet) {
    return packet.keyframe && is_selected(packet.key());
  };
  std::vector<SeekEntry> keyframes;
  keyframes.reserve(static_cast<std::size_t>(std::count_if(packets.begin(), end, counts)));
  std::copy_if(packets.begin(), end, std::back_inserter(keyframes), counts);
  std::vector<Start> found = starts_of(std::move(keyframes));

  position = first->offset;
  last_start = 0;
  for (const Start& start : found) {
    position = std::min(position, start.offset);
    last_start = std::max(last_start, start.offset);
  }
  starts = std::move(found);
  last_frame = 0;
  ended = false;
  return Status::ok;
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

std::optional<std::uint64_t> ContainerReader::next_frame() noexcept { return state_->next_frame(); }

Status ContainerReader::next(ContainerPacket& packet) {
  return guarded([&] { return state_->next(packet); });
}

Status ContainerReader::seek(std::uint64_t frame) {
  return guarded([&] { return state_->seek(frame); });
}

Result<std::vector<std::uint64_t>> ContainerReader::frames() {
  return guarded([&]() -> Result<std::vector<std::uint64_t>> {
    if (!state_->seekable) return Status::unknown_frame;
    const Status status = state_->index.extend(state_->reader);
    if (status != Status::ok) return status;
    std::vector<std::uint64_t> frames;
    for (const SeekEntry& packet : state_->index.packets()) {
      if (frames.empty() || frames.back() != packet.frame) frames.push_back(packet.frame);
    }
    return frames;
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
    return Status::ok;
  });
}

}  // namespace gicodec
