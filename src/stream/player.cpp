#include <gicodec/inspect.h>

#include "base/guard.h"
#include "base/parallel.h"
#include "bitstream/container_format.h"
#include "stream/player_state.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gicodec {
namespace {

constexpr std::uint64_t kSmallPacket = std::uint64_t{1} << 20;
/// Beyond so many regions the reader reads all packets, and the player skips unselected ones.
constexpr std::uint64_t kMaxSelected = 1U << 16;

std::vector<TextureDecoders::Texture> stored_textures(const ContainerDescription& description) {
  std::vector<TextureDecoders::Texture> textures;
  for (const TextureEntry& entry : description.textures) {
    const auto id = static_cast<std::uint8_t>(textures.size());
    textures.push_back(
        {entry.desc, description.volumes[entry.volume].region, presence_texture(description, id)});
  }
  return textures;
}

}  // namespace

ContainerPlayer::ContainerPlayer(std::unique_ptr<State> state) noexcept
    : state_(std::move(state)) {}
ContainerPlayer::ContainerPlayer(ContainerPlayer&&) noexcept = default;
ContainerPlayer& ContainerPlayer::operator=(ContainerPlayer&&) noexcept = default;
ContainerPlayer::~ContainerPlayer() = default;

Result<ContainerPlayer> ContainerPlayer::open(Source& source, const PlayerOptions& options) {
  return guarded([&]() -> Result<ContainerPlayer> {
    if (!is_valid(options.threads) || !is_supported(options.isa)) {
      return Status::invalid_settings;
    }
    DecodeLimits limits = options.limits;
    // Reads small packets in any case, so that an error can name their texture.
    limits.max_packet_bytes =
        std::min(limits.max_packet_bytes, std::max(limits.max_total_bytes, kSmallPacket));
    auto reader = ContainerReader::open(source, limits, options.kinds);
    if (!reader) return reader.status();
    auto decoders = TextureDecoders::create(
        stored_textures(reader->description()),
        {options.limits, options.backends, options.threads, nullptr, options.isa});
    if (!decoders) return decoders.status();
    auto state = std::make_unique<State>(*std::move(reader), *std::move(decoders));
    state->selected.assign(state->entries().size(), true);
    return ContainerPlayer(std::move(state));
  });
}

const ContainerDescription& ContainerPlayer::description() const noexcept {
  return state_->reader.description();
}
bool ContainerPlayer::seekable() const noexcept { return state_->reader.seekable(); }
bool ContainerPlayer::finished() const noexcept { return state_->reader.finished(); }
std::uint64_t ContainerPlayer::frame() const noexcept { return state_->frame; }
ContainerPlayer::Where ContainerPlayer::where() const noexcept { return state_->where; }
std::uint64_t ContainerPlayer::memory() const noexcept { return state_->decoders.memory(); }
std::span<const std::uint32_t> ContainerPlayer::changed(std::uint8_t texture) const noexcept {
  const bool there = texture < state_->decoders.size();
  return there ? state_->decoders.changed(texture) : std::span<const std::uint32_t>();
}
std::span<const ContainerPacket> ContainerPlayer::packets() const noexcept {
  return std::span(state_->packets).first(state_->packet_count);
}

Result<std::vector<std::uint64_t>> ContainerPlayer::frames() { return state_->reader.frames(); }

Result<std::vector<ListedPart>> ContainerPlayer::listed() { return state_->reader.listed(); }

Result<Metadata> ContainerPlayer::metadata(std::uint8_t texture) {
  return state_->reader.metadata(texture);
}

Status ContainerPlayer::select(std::span<const std::uint8_t> textures) {
  if (state_->started) return Status::out_of_order;
  return guarded([&]() -> Status {
    std::vector<TextureRegion> wanted;
    std::vector<bool> all(state_->entries().size(), textures.empty());
    bool few = !textures.empty();
    for (const std::uint8_t texture : textures) {
      if (texture >= all.size()) return Status::unknown_texture;
      all[texture] = true;
      const TextureEntry& entry = state_->entries()[texture];
      const Grid& region = description().volumes[entry.volume].region;
      if (region == Grid{}) {
        wanted.push_back({texture});
        continue;
      }
      // The regions of an unknown kind are unknown.
      const std::uint32_t regions =
          is_known(entry) ? regions_of(entry.desc, region).regions() : UINT32_MAX;
      few = few && wanted.size() + std::uint64_t{regions} <= kMaxSelected;
      for (std::uint32_t r = 0; few && r < regions; ++r) wanted.push_back({texture, r});
    }
    if (few) return state_->select(std::move(wanted));
    for (std::size_t id = 0; id < all.size(); ++id) {
      const auto texture = static_cast<std::uint8_t>(id);
      if (!all[id] || !state_->is_played(texture)) continue;
      if (const auto presence = presence_texture(description(), texture)) all[*presence] = true;
    }
    const Status status = state_->reader.select({});
    if (status == Status::ok) state_->selected = std::move(all);
    return status;
  });
}

Status ContainerPlayer::select(std::span<const TextureRegion> parts) {
  if (state_->started) return Status::out_of_order;
  return guarded([&] { return state_->select({parts.begin(), parts.end()}); });
}

/// Selects parts and those of the textures that say which of their records exist.
Status ContainerPlayer::State::select(std::vector<TextureRegion> parts) {
  std::vector<bool> textures(entries().size(), parts.empty());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto [texture, region] = parts[i];
    if (texture >= textures.size()) return Status::unknown_texture;
    textures[texture] = true;
    if (!is_played(texture)) continue;
    const auto presence = presence_texture(reader.description(), texture);
    if (presence) parts.push_back({*presence, region});
  }
  const Status status = reader.select(parts);
  if (status == Status::ok) selected = std::move(textures);
  return status;
}

Status ContainerPlayer::set_layout(std::uint8_t texture, const Layout& layout) {
  State& s = *state_;
  if (!s.is_played(texture)) return Status::unknown_texture;
  return s.decoders.set_layout(texture, layout);
}

Status ContainerPlayer::State::apply(const ContainerPacket& packet) {
  where = {packet.frame, TextureRegion{packet.texture_id, packet.region}};
  if (!is_played(packet.texture_id)) return verify_checksum(packet.bytes);
  const Status status = decoders.decode(packet.texture_id, packet.region, packet.bytes);
  where.memory = decoders.needed();
  return status;
}

Status ContainerPlayer::State::read_ahead() {
  while (!next_packet) {
    if (postponed != Status::ok) return std::exchange(postponed, Status::ok);
    ContainerPacket packet;
    const Status status = reader.next(packet);
    if (status != Status::ok) return status;
    if (selected[packet.texture_id]) next_packet = std::move(packet);
  }
  return Status::ok;
}

Status ContainerPlayer::State::read_ahead_within(std::uint64_t within) {
  if (!next_packet && postponed == Status::ok) {
    const auto listed = reader.next_frame();
    if (listed && *listed > within) return Status::ok;
  }
  return read_ahead();
}

Status ContainerPlayer::State::gather() {
  if (!gathering) {
    packet_count = applied = 0;
    packet_bytes = 0;
    gathering = true;
  }
  while (packet_count == 0 || (next_packet && next_packet->frame == packets[0].frame)) {
    where = {next_packet->frame, TextureRegion{next_packet->texture_id, next_packet->region}};
    if (packet_count == packets.size()) packets.emplace_back();
    packets[packet_count] = *std::exchange(next_packet, std::nullopt);
    packet_bytes += packets[packet_count++].bytes.size();
    const Status room = decoders.set_callers_bytes(packet_bytes);
    where.memory = decoders.needed();
    if (room != Status::ok) {
      packets.clear();
      packet_count = packet_bytes = 0;
      gathering = false;
      return room;
    }
    const Status more = read_ahead_within(packets[0].frame);
    if (is_repeated(more)) return more;
    if (more != Status::ok) postponed = more;
  }
  gathering = false;
  packets.resize(packet_count);
  const auto order = [&](const ContainerPacket& packet) {
    const bool later =
        is_played(packet.texture_id) && presence_texture(reader.description(), packet.texture_id);
    return std::tuple(later, packet.texture_id, packet.region);
  };
  const std::span own = std::span(packets).first(packet_count);
  std::sort(own.begin(), own.end(), [&](const ContainerPacket& a, const ContainerPacket& b) {
    return order(a) < order(b);
  });
  const auto twice = std::adjacent_find(
      own.begin(), own.end(),
      [&](const ContainerPacket& a, const ContainerPacket& b) { return order(a) == order(b); });
  if (twice == own.end()) return Status::ok;
  where.part = TextureRegion{twice->texture_id, twice->region};
  packet_count = 0;
  return Status::corrupt;
}

Status ContainerPlayer::State::advance(bool decoding) {
  started = true;
  if (!in_frame) {
    if (const Status status = read_ahead(); status != Status::ok) {
      where = {frame, std::nullopt};
      return status;
    }
    decoders.begin_changes(!sought);  // After seek() all blocks count as changed.
    frame = std::max(next_packet->frame, sought.value_or(0));
    in_frame = true;
  }
  Status status = Status::ok;
  while (status == Status::ok) {
    if (applied < packet_count && !gathering) {
      status = decoding ? apply(packets[applied]) : Status::ok;
      if (status != Status::out_of_memory) ++applied;
      continue;
    }
    const Status more = read_ahead_within(frame);
    if (is_repeated(more)) return more;
    if (gathering || (next_packet && next_packet->frame <= frame)) {
      if (more != Status::ok) postponed = more;
      status = gather();
      continue;
    }
    // The frame is complete. An error before the sought frame is reported at once.
    const bool reached = !sought || more == Status::ok || more == Status::end ||
                         (packet_count > 0 && packets[0].frame == frame);
    if (more != Status::ok && reached) postponed = more;
    if (!reached) {
      where = {frame, std::nullopt};
      status = more;
    }
    all_changed = sought.has_value();
    decoders.settle_changes(all_changed);
    if (packet_count > 0 && packets[0].frame != frame)
      packet_count = applied = 0;  // Those are of earlier frames.
    sought.reset();
    in_frame = false;
    return status;
  }
  all_changed = false;
  decoders.settle_changes(false);
  return status;
}

void ContainerPlayer::set_growing(bool growing) noexcept { state_->growing = growing; }

Status ContainerPlayer::next() {
  return guarded([&] { return state_->advance(true); });
}
Status ContainerPlayer::skip() {
  return guarded([&] { return state_->advance(false); });
}

Status ContainerPlayer::read(std::uint8_t texture, TextureView view) const {
  if (!state_->is_played(texture)) return Status::unknown_texture;
  return guarded([&] { return state_->decoders.read(texture, view); });
}

Status ContainerPlayer::read_changed(std::uint8_t texture, TextureView view) const {
  if (!state_->is_played(texture)) return Status::unknown_texture;
  if (state_->all_changed) return read(texture, view);
  return guarded([&] { return state_->decoders.read(texture, view, changed(texture)); });
}

Status ContainerPlayer::seek(std::uint64_t frame) {
  return guarded([&]() -> Status {
    State& s = *state_;
    const Status status = s.reader.seek(frame);
    if (status != Status::ok) return status;
    s.started = true;
    s.next_packet.reset();
    s.postponed = Status::ok;
    s.packet_count = s.applied = 0;
    s.gathering = false;
    s.packet_bytes = 0;
    s.in_frame = false;
    s.sought = frame;
    // Decoders may hold later frames.
    s.decoders.clear();
    return Status::ok;
  });
}

}  // namespace gicodec
