#include <gicodec/client.h>

#include "base/guard.h"
#include "base/parallel.h"
#include "bitstream/description.h"
#include "session/client/client_frame.h"
#include "session/client/client_limits.h"
#include "session/client/client_state.h"
#include "texture/presence.h"
#include "texture/view.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

/// The client repeats a Resync after this many messages that do not answer it.
constexpr std::uint32_t kPatience = 16;
/// Bytes of Resyncs over a connection: at most kFreeQuestions + kQuestionRatio · bytes received.
constexpr std::uint64_t kFreeQuestions = std::uint64_t{16} << 20, kQuestionRatio = 8;

/// False for unknown backends.
bool depends_on_mirror_only(std::uint8_t backend) {
  return backend <= kBackendNative && backend != kBackendHevc;
}

}  // namespace

Client::Client(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Client> Client::create(const ClientOptions& options) {
  return guarded([&]() -> Result<Client> {
    if (!is_valid(options.threads) || !is_supported(options.isa)) return Status::invalid_settings;
    if (options.token.size() > kMaxToken || options.delivery > Delivery::shared) {
      return Status::invalid_argument;
    }
    auto state = std::make_unique<State>();
    state->options = options;
    auto decoding = DecoderScratch::create();
    if (!decoding) return decoding.status();
    state->decoding = *std::move(decoding);
    return Client(std::move(state));
  });
}

Result<Message> Client::hello() {
  return guarded([&]() -> Result<Message> {
    State& s = *state_;
    ++s.sync;
    s.welcome = s.resumed = s.consistent = s.requested = s.left = false;
    s.interest.end();
    s.last_number = s.unanswered = 0;
    s.asked = s.heard = 0;
    s.replies.clear();
    Message message;
    const Status status =
        write_message(Hello{s.sync, s.ticket, s.options.delivery, s.options.budget, s.options.token,
                            s.generation, s.held()},
                      message);
    if (status != Status::ok) return status;
    return message;
  });
}

Status Client::receive(std::span<const std::byte> bytes) {
  return guarded([&]() -> Status {
    State& s = *state_;
    if (s.left) return Status::end;
    s.heard += bytes.size();
    // Servers send no lists of blocks.
    const MessageLimits limits{s.options.limits.max_packet_bytes, 0};
    const auto message = read_message(bytes, limits);
    if (!message) return message.status();
    if (const auto* welcome = std::get_if<Welcome>(&*message)) return s.take(*welcome);
    if (const auto* volumes = std::get_if<Volumes>(&*message)) return s.take(*volumes);
    if (const auto* update = std::get_if<UpdateMessage>(&*message)) {
      ++s.statistics.messages;
      s.statistics.bytes += bytes.size();
      const std::uint64_t before = s.frame.serial;
      const Status status = s.take(*update);
      const bool applied = s.consistent && s.frame.serial != before && !s.options.discard;
      if (applied && s.options.listener != nullptr)
        s.options.listener->updated(*this, update->parts);
      return status;
    }
    if (const auto* goodbye = std::get_if<Goodbye>(&*message)) {
      s.goodbye = *goodbye;
      s.ticket = {};
      s.welcome = false;
      return Status::end;
    }
    return Status::corrupt;
  });
}

bool Client::State::exists(StreamId id) const noexcept {
  const ClientVolume* const volume = frame.find(id.volume);
  if (volume == nullptr || id.texture >= volume->textures.size()) return false;
  if (options.delivery == Delivery::unicast) return id.region == StreamId::kWholeVolume;
  return id.region < regions_of(volume->textures[id.texture].desc, volume->region).regions();
}

Status Client::State::check(const UpdateMessage& update) const {
  if (update.scrolls.size() != frame.volumes.size()) return Status::corrupt;
  for (std::size_t v = 0; v < frame.volumes.size(); ++v) {
    VolumeGeometry geometry = frame.volumes[v].geometry;
    geometry.scroll = update.scrolls[v];
    if (validate(geometry) != Status::ok) return Status::corrupt;
  }
  const auto known = [&](const auto& item) { return exists(item.stream); };
  const bool all = std::all_of(update.parts.begin(), update.parts.end(), known) &&
                   std::all_of(update.proofs.begin(), update.proofs.end(), known);
  if (!all || !proofs_once(update)) return Status::corrupt;
  return update_work(update, frame) > options.limits.max_work_bytes ? Status::limit_exceeded
                                                                    : Status::ok;
}

Status Client::State::take(const UpdateMessage& update) {
  if (!welcome || update.sync != sync || update.number <= last_number ||
      update.generation < generation) {
    ++statistics.stale_messages;
    if (welcome && requested && ++unanswered % kPatience == 0) {
      return ask();
    }
    return Status::ok;
  }
  // The client has missed a Volumes message.
  if (update.generation > generation) return ask_again();
  if (const Status status = check(update); status != Status::ok) return status;
  if (update.number != last_number + 1) return ask_again();
  requested = false;
  consistent = false;
  if (!options.discard) {
    scroll(update);
    told_presence.clear();
    for (const UpdateMessage::Part& part : update.parts) {
      const Status status = apply(part);
      if (status == Status::out_of_memory || status == Status::limit_exceeded ||
          status == Status::cancelled || status == Status::backend_missing) {
        return status;
      }
      if (status != Status::ok) return ask_again();
    }
    std::sort(told_presence.begin(), told_presence.end());
    told_presence.erase(std::unique(told_presence.begin(), told_presence.end()),
                        told_presence.end());
    for (const auto& [stream, block] : told_presence) {
      if (options.cancel != nullptr && options.cancel->load(std::memory_order_relaxed)) {
        return Status::cancelled;
      }
      if (!presence_holds(stream, block)) return Status::corrupt;
    }
  }
  last_number = update.number;
  ++frame.serial;
  frame.update = update.update;
  frame.time = update.time;
  if (!options.discard) {
    bool all = true;
    for (const UpdateMessage::Proof& proof : update.proofs) all = proven(proof) && all;
    if (!all) return ask_again();
  }
  const Status said = reply(Acknowledge{sync, update.number});
  consistent = said == Status::ok;
  return said;
}

/// Marks blocks of entering planes as not received.
void Client::State::scroll(const UpdateMessage& update) {
  for (std::size_t v = 0; v < frame.volumes.size(); ++v) {
    ClientVolume& volume = frame.volumes[v];
    if (volume.geometry.scroll == update.scrolls[v]) continue;
    const auto blocks =
        entering_blocks(volume.geometry.grid, volume.geometry.scroll, update.scrolls[v]);
    for (ClientTexture& texture : volume.textures) {
      if (texture.desc.space != Space::grid || !(texture.desc.grid == volume.geometry.grid))
        continue;
      for (const std::uint32_t block : blocks) texture.changed[block] = 0;
    }
    volume.geometry.scroll = update.scrolls[v];
  }
}

Result<Chain*> Client::State::chain(StreamId id) {
  if (const auto found = chains.find(id); found != chains.end()) return &found->second;
  const ClientVolume& volume = *frame.find(id.volume);
  std::vector<std::uint32_t> blocks;
  if (id.region != StreamId::kWholeVolume) {
    blocks = regions_of(volume.textures[id.texture].desc, volume.region).blocks_of(id.region);
  }
  auto decoder =
      Decoder::create(stream_desc(volume, id), {options.limits, options.backends, options.threads,
                                                nullptr, options.isa, options.cancel, decoding});
  if (!decoder) return decoder.status();
  return &chains.emplace(id, Chain{*std::move(decoder), std::move(blocks), false}).first->second;
}

std::optional<StreamId> Client::State::presence_of(StreamId id) const {
  const ClientVolume& volume = *frame.find(id.volume);
  if (volume.textures[id.texture].desc.presence == Presence::all) return std::nullopt;
  const auto [group, first] = group_of(volume.desc, id.texture);
  id.texture = static_cast<std::uint8_t>(first + group->presence);
  return id;
}

/// Takes the presence from the stream that holds it, as of the packets applied so far.
Status Client::State::set_presence(StreamId id, Decoder& decoder) {
  const auto presence = presence_of(id);
  if (!presence) return Status::ok;
  const auto existing = chain(*presence);
  if (!existing) return existing.status();
  return decoder.set_presence((*existing)->decoder.records());
}

/// True if the presence of a block counts no records beyond the block, and records that do not
/// exist are zero. Renderers rely on both.
bool Client::State::presence_holds(const StreamId& stream, std::uint32_t block) const {
  const auto [group, first] = group_of(frame.find(stream.volume)->desc, stream.texture);
  const auto block_in = [&](const Decoder& decoder) {
    const std::size_t size = block_bytes(decoder.desc());
    return decoder.records().subspan(block * size, size);
  };
  const auto presence = block_in(chains.at(stream).decoder);
  for (std::size_t t = 0; t < group->textures.size(); ++t) {
    const TextureDesc& desc = group->textures[t].desc;
    if (desc.presence == Presence::all) continue;
    if (!BlockPresence(desc, presence).is_sound()) return false;
    const auto found =
        chains.find({stream.volume, static_cast<std::uint8_t>(first + t), stream.region});
    if (found != chains.end() && !is_clear(desc, presence, block_in(found->second.decoder))) {
      return false;
    }
  }
  return true;
}

Status Client::State::apply(const UpdateMessage::Part& part) {
  const auto found = chain(part.stream);
  if (!found) return found.status();
  Decoder& decoder = (*found)->decoder;
  if (const Status known = set_presence(part.stream, decoder); known != Status::ok) return known;
  const std::vector<std::uint32_t>& blocks = (*found)->blocks;
  ClientVolume& volume = *find_volume(frame.volumes, part.stream.volume);
  ClientTexture& texture = volume.textures[part.stream.texture];
  const auto info = peek(part.packet);
  if (info.ok() && info->lossy && texture.largest_error == 0) return Status::corrupt;
  const bool whole = blocks.empty();
  const TextureView target{texture.texels};
  places.reserve(whole ? 0 : blocks.size());
  const Status status =
      has_texels() && whole ? decoder.decode(part.packet, target) : decoder.decode(part.packet);
  if (status != Status::ok) return status;
  places.clear();
  if (!whole) {
    for (const std::uint32_t block : decoder.changed()) places.push_back(blocks[block]);
    if (has_texels())
      static_cast<void>(decoder.read(decoder.changed(), texture.desc, target, places));
  }

  const auto [group, first] = group_of(volume.desc, part.stream.texture);
  const bool is_presence = part.stream.texture - first == group->presence;
  const bool keyframe = info.ok() && is_keyframe(info->type);
  const bool by_mirror = info.ok() && depends_on_mirror_only(info->backend);
  (*found)->stateful = !by_mirror || (!keyframe && (*found)->stateful);
  for (const std::uint32_t block : decoder.changed()) {
    const std::uint32_t place = whole ? block : blocks[block];
    texture.changed[place] = decoder.received()[block] != 0 ? frame.serial + 1 : 0;
    if (is_presence) told_presence.emplace_back(part.stream, block);
  }
  ++statistics.packets;
  statistics.blocks += info->all_blocks ? block_count(decoder.desc()) : info->blocks;
  return Status::ok;
}

bool Client::State::proven(const UpdateMessage::Proof& proof) {
  ++statistics.proofs;
  const auto found = chains.find(proof.stream);
  if (found != chains.end() && found->second.decoder.state_hash() == proof.hash) return true;
  ++statistics.failed_proofs;
  chains.erase(proof.stream);
  return false;
}

/// Opens another sync point with the states that the client holds.
Status Client::State::ask_again() {
  ++sync;
  ++statistics.gaps;
  last_number = unanswered = 0;
  consistent = false;
  requested = true;
  return ask();
}

/// Sends a Resync. limit_exceeded, which ends the connection, if Resyncs take far more bytes than
/// the server sends: it is hostile then.
Status Client::State::ask() {
  Resync resync{sync, generation, held()};
  asked += resync.held.size() * sizeof(HeldState);
  if (asked > kFreeQuestions + kQuestionRatio * heard) return Status::limit_exceeded;
  return reply(resync);
}

std::vector<HeldState> Client::State::held() const {
  std::vector<HeldState> states;
  for (const auto& [id, chain] : chains) {
    if (chain.decoder.sequence() == 0) continue;
    if (states.size() == kMaxHeld) break;
    states.push_back({id, chain.decoder.sequence(), chain.decoder.checksum()});
  }
  return states;
}

Status Client::State::reply(const AnyMessage& message) {
  Message bytes;
  const Status status = write_message(message, bytes);
  if (status == Status::ok) replies.push_back(std::move(bytes));
  return status;
}

Status Client::set_viewpoint(const Viewpoint& viewpoint) {
  return state_->interest.set_viewpoint(viewpoint, state_->replies);
}

Status Client::subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                         std::uint8_t group) {
  return state_->interest.subscribe(volume, blocks, group, state_->replies);
}

Status Client::disconnect() {
  return guarded([&]() -> Status {
    State& s = *state_;
    s.replies.clear();
    if (const Status said = s.reply(Goodbye{}); said != Status::ok) return said;
    s.ticket = {};
    s.welcome = s.consistent = false;
    s.left = true;
    s.interest.end();
    return Status::ok;
  });
}

std::vector<Message> Client::take_messages() { return std::exchange(state_->replies, {}); }
bool Client::is_connected() const noexcept { return state_->welcome; }
bool Client::resumed() const noexcept { return state_->resumed; }
const ClientFrame& Client::frame() const noexcept { return state_->frame; }
bool Client::consistent() const noexcept { return state_->consistent; }

Status Client::read(std::uint16_t volume, std::uint8_t texture, std::uint64_t after_serial,
                    TextureView view) const {
  const ClientVolume* const found = state_->frame.find(volume);
  if (found == nullptr) return Status::unknown_volume;
  if (texture >= found->textures.size()) return Status::unknown_texture;
  const ClientTexture& held = found->textures[texture];
  const auto target = check_view(held.desc, view);
  if (!target) return target.status();
  return guarded([&]() -> Status {
    auto& [replaced, places] = state_->read_lists;
    const auto first = state_->chains.lower_bound({volume, texture, 0});
    for (auto it = first; it != state_->chains.end(); ++it) {
      const auto& [stream, chain] = *it;
      if (stream.volume != volume || stream.texture != texture) break;
      const bool whole = chain.blocks.empty();
      replaced.clear();
      places.clear();
      for (std::uint32_t block = 0; block < block_count(chain.decoder.desc()); ++block) {
        const std::uint32_t place = whole ? block : chain.blocks[block];
        if (held.changed[place] <= after_serial) continue;
        replaced.push_back(block);
        if (!whole) places.push_back(place);
      }
      const Status status =
          chain.decoder.read(replaced, held.desc, view, whole ? replaced : places);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  });
}

const Goodbye& Client::goodbye() const noexcept { return state_->goodbye; }
const ClientStatistics& Client::statistics() const noexcept { return state_->statistics; }

}  // namespace gicodec
