#include <gicodec/inspect.h>

#include "base/guard.h"
#include "base/parallel.h"
#include "bitstream/container_format.h"
#include "stream/decoder_memory.h"
#include "stream/player_state.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace gicodec {
namespace {

constexpr std::uint64_t kSmallPacket = std::uint64_t{1} << 20;
/// Beyond so many regions the reader reads all packets, and the player skips unselected ones.
constexpr std::uint64_t kMostSelected = 1U << 16;

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
    auto scratch = DecoderScratch::create();
    if (!scratch) return scratch.status();
    auto state = std::make_unique<State>(options, *std::move(reader), *std::move(scratch));
    for (const TextureEntry& entry : state->entries()) state->layouts.push_back(entry.desc.layout);
    state->selected.assign(state->entries().size(), true);
    state->changed.resize(state->entries().size());
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
std::uint64_t ContainerPlayer::memory() const noexcept { return state_->held + state_->scratched; }
std::span<const ContainerPacket> ContainerPlayer::packets() const noexcept {
  return std::span(state_->packets).first(state_->count);
}

Status ContainerPlayer::select(std::span<const std::uint8_t> textures) {
  if (state_->started) return Status::out_of_order;
  return guarded([&]() -> Status {
    std::vector<bool> all(state_->entries().size(), textures.empty());
    for (const std::uint8_t texture : textures) {
      if (texture >= all.size()) return Status::unknown_texture;
      all[texture] = true;
      if (!state_->is_played(texture)) continue;
      if (const auto presence = presence_texture(description(), texture)) all[*presence] = true;
    }
    std::vector<TextureRegion> wanted;
    bool few = !textures.empty();
    for (std::size_t id = 0; few && id < all.size(); ++id) {
      if (!all[id]) continue;
      const auto texture = static_cast<std::uint8_t>(id);
      const TextureEntry& entry = state_->entries()[texture];
      const Grid& region = description().volumes[entry.volume].region;
      if (region == Grid{}) {
        wanted.push_back({texture, 0});
        continue;
      }
      // The regions of an unknown kind are unknown.
      const std::uint32_t regions =
          is_known(entry) ? regions_of(entry.desc, region).regions() : UINT32_MAX;
      few = wanted.size() + std::uint64_t{regions} <= kMostSelected;
      for (std::uint32_t r = 1; few && r <= regions; ++r) wanted.push_back({texture, r});
    }
    if (!few) wanted.clear();
    const Status status = state_->reader.select(wanted);
    if (status == Status::ok) state_->selected = std::move(all);
    return status;
  });
}

Status ContainerPlayer::set_layout(std::uint8_t texture, const Layout& layout) {
  State& s = *state_;
  if (!s.is_played(texture)) return Status::unknown_texture;
  const auto first = s.parts.lower_bound({texture, 0});
  if (first != s.parts.end() && first->first.first == texture) return Status::out_of_order;
  TextureDesc desc = s.entries()[texture].desc;
  desc.layout = layout;
  if (const Status status = validate(desc); status != Status::ok) return status;
  s.layouts[texture] = layout;
  return Status::ok;
}

Status ContainerPlayer::State::check_memory(std::uint64_t more, std::uint64_t shared) noexcept {
  const std::uint64_t limit = options.limits.max_total_bytes;
  const std::uint64_t all = held + shared + packed;
  where.memory = more <= UINT64_MAX - all ? all + more : UINT64_MAX;
  return where.memory <= limit ? Status::ok : Status::limit_exceeded;
}

Result<Decoder*> ContainerPlayer::State::part(PartId id) {
  if (const auto found = parts.find(id); found != parts.end()) return &found->second;
  const auto [texture, number] = id;
  const TextureDesc desc =
      number == 0 ? desc_of(texture)
                  : region_texture(entries()[texture].desc, region_size(texture), number - 1);
  // Includes the lists of a frame's changed blocks, which may come in two packets.
  const std::uint64_t lists = 2 * sizeof(std::uint32_t) * std::uint64_t{block_count(desc)};
  const std::uint64_t more = held_memory(desc) + lists;
  const std::uint64_t shared = std::max(scratched, scratch_memory(desc, options.threads.count));
  if (const Status room = check_memory(more, shared); room != Status::ok) return room;
  auto decoder = Decoder::create(desc, {options.limits, options.backends, options.threads, nullptr,
                                        options.isa, nullptr, scratch});
  if (!decoder) return decoder.status();
  Decoder& made = parts.emplace(id, *std::move(decoder)).first->second;
  held += more;
  scratched = shared;
  return &made;
}

void ContainerPlayer::State::note_changed(const Decoder& decoder, PartId id,
                                          bool keyframe) noexcept {
  const auto [texture, number] = id;
  const RegionGrid cut = regions(texture);
  const auto add = [&, region = number - 1](std::uint32_t block) {
    changed[id.first].push_back(id.second == 0 ? block : cut.block_of(region, block));
  };
  // A keyframe clears what it does not list.
  const std::uint32_t blocks = keyframe ? block_count(decoder.desc()) : 0;
  for (std::uint32_t block = 0; block < blocks; ++block) add(block);
  if (keyframe) return;
  for (const std::uint32_t block : decoder.updated()) add(block);
}

Status ContainerPlayer::State::apply(const ContainerPacket& packet) {
  const PartId id{packet.texture_id, packet.region};
  where = {packet.frame, TextureRegion{id.first, id.second}};
  if (!is_played(id.first)) return verify_checksum(packet.bytes);
  const auto found = part(id);
  if (!found) return found.status();
  Decoder& decoder = **found;
  if (const auto presence = presence_texture(reader.description(), id.first)) {
    const auto existing = part({*presence, id.second});
    if (!existing) return existing.status();
    const Status told = decoder.set_presence((*existing)->records());
    if (told != Status::ok) return told;
  }
  if (sought) return decoder.decode(packet.bytes);  // all blocks count as changed
  std::vector<std::uint32_t>& list = changed[id.first];
  const std::size_t most = block_count(decoder.desc());
  if (list.capacity() - list.size() < most) list.reserve(list.size() + std::max(most, list.size()));
  const Status status = decoder.decode(packet.bytes);
  if (status == Status::ok) note_changed(decoder, id, packet.keyframe);
  return status;
}

Status ContainerPlayer::State::look_ahead() {
  while (!ahead) {
    if (failed != Status::ok) return std::exchange(failed, Status::ok);
    ContainerPacket packet;
    const Status status = reader.next(packet);
    if (status != Status::ok) return status;
    if (selected[packet.texture_id]) ahead = std::move(packet);
  }
  return Status::ok;
}

Status ContainerPlayer::State::gather() {
  if (!gathering) {
    count = at = 0;
    packed = 0;
    gathering = true;
  }
  while (count == 0 || (ahead && ahead->frame == packets[0].frame)) {
    where = {ahead->frame, TextureRegion{ahead->texture_id, ahead->region}};
    if (count == packets.size()) packets.emplace_back();
    packets[count] = *std::exchange(ahead, std::nullopt);
    packed += packets[count++].bytes.size();
    if (const Status room = check_memory(0, scratched); room != Status::ok) {
      packets.clear();
      count = packed = 0;
      gathering = false;
      return room;
    }
    const Status more = look_ahead();
    if (more == Status::out_of_memory) return more;
    if (more != Status::ok) failed = more;
  }
  gathering = false;
  packets.resize(count);
  const auto order = [&](const ContainerPacket& packet) {
    const bool later =
        is_played(packet.texture_id) && presence_texture(reader.description(), packet.texture_id);
    return std::tuple(later, packet.texture_id, packet.region);
  };
  const std::span own = std::span(packets).first(count);
  std::sort(own.begin(), own.end(), [&](const ContainerPacket& a, const ContainerPacket& b) {
    return order(a) < order(b);
  });
  const auto twice = std::adjacent_find(
      own.begin(), own.end(),
      [&](const ContainerPacket& a, const ContainerPacket& b) { return order(a) == order(b); });
  if (twice == own.end()) return Status::ok;
  where.part = TextureRegion{twice->texture_id, twice->region};
  count = 0;
  return Status::corrupt;
}

void ContainerPlayer::State::settle_changed(bool all) {
  all_changed = all;
  for (std::size_t t = 0; t < changed.size(); ++t) {
    std::vector<std::uint32_t>& blocks = changed[t];
    const auto first = parts.lower_bound({static_cast<std::uint8_t>(t), 0});
    if (all && first != parts.end() && first->first.first == t) {
      blocks.resize(block_count(entries()[t].desc));
      std::iota(blocks.begin(), blocks.end(), 0U);
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  }
}

Status ContainerPlayer::State::go_on(bool decoding) {
  started = true;
  if (!begun) {
    if (const Status status = look_ahead(); status != Status::ok) {
      where = {frame, std::nullopt};
      return status;
    }
    for (auto& blocks : changed) blocks.clear();
    frame = std::max(ahead->frame, sought.value_or(0));
    begun = true;
  }
  Status status = Status::ok;
  while (status == Status::ok) {
    if (at < count && !gathering) {
      status = decoding ? apply(packets[at]) : Status::ok;
      if (status != Status::out_of_memory) ++at;
      continue;
    }
    const Status more = look_ahead();
    if (more == Status::out_of_memory) return more;
    if (gathering || (more == Status::ok && ahead->frame <= frame)) {
      if (more != Status::ok) failed = more;
      status = gather();
      continue;
    }
    // The frame is complete. An error before the sought frame is reported at once.
    const bool reached = !sought || more == Status::ok || more == Status::end ||
                         (count > 0 && packets[0].frame == frame);
    if (more != Status::ok && reached) failed = more;
    if (!reached) {
      where = {frame, std::nullopt};
      status = more;
    }
    settle_changed(sought.has_value());
    if (count > 0 && packets[0].frame != frame) count = at = 0;  // packets before the sought frame
    sought.reset();
    begun = false;
    return status;
  }
  settle_changed(false);
  return status;
}

Status ContainerPlayer::next() {
  return guarded([&] { return state_->go_on(true); });
}
Status ContainerPlayer::skip() {
  return guarded([&] { return state_->go_on(false); });
}

Status ContainerPlayer::seek(std::uint64_t frame) {
  return guarded([&]() -> Status {
    State& s = *state_;
    const Status status = s.reader.seek(frame);
    if (status != Status::ok) return status;
    s.started = true;
    s.ahead.reset();
    s.failed = Status::ok;
    s.count = s.at = 0;
    s.gathering = false;
    s.packed = 0;
    s.begun = false;
    s.sought = frame;
    // Later packets may have been applied: start from keyframes.
    s.parts.clear();
    s.held = 0;
    return Status::ok;
  });
}

}  // namespace gicodec
