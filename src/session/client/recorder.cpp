// Packets that a client applied → container. The recorder tracks the state of each stream in the
// container, and adds only packets that build on it.
#include <gicodec/recorder.h>

#include <gicodec/encoder.h>

#include "base/guard.h"
#include "bitstream/packet.h"
#include "session/client/client_state.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace gicodec {
namespace {

constexpr std::size_t kMaxOfContainer = 256;  ///< volumes, and textures
constexpr std::uint64_t kFreeSnapshots = std::uint64_t{64} << 20, kSnapshotRatio = 16;

/// The state of a stream: at the client, and its checksum in the container.
struct Recorded {
  std::uint32_t sequence = 0, checksum = 0, checksum_here = 0;
};

/// Copies a packet with another texture id and base; returns its checksum.
std::uint32_t readdress(const PacketParts& parts, std::uint8_t texture_id, std::uint32_t base,
                        Packet& out) {
  PacketHead head{.info = parts.info,
                  .index_mode = parts.index_mode,
                  .base = base,
                  .stands_for = parts.stands_for};
  head.info.texture_id = texture_id;
  out.clear();
  write_packet_head(head, parts.index, parts.guard_bands, out);
  out.insert(out.end(), parts.payload.begin(), parts.payload.end());
  return seal_packet(out);
}

}  // namespace

struct ClientRecorder::State {
  explicit State(ContainerWriter&& container) : writer(std::move(container)) {}

  struct Placed {
    std::uint64_t frame;  ///< counted from the update's first frame
    const UpdateMessage::Part* part;
  };
  Status add(const Client::State& client, std::span<const UpdateMessage::Part> packets);
  [[nodiscard]] static std::vector<Placed> place(const Client::State& client,
                                                 std::span<const UpdateMessage::Part> packets);
  Status add(const Client::State& client, const UpdateMessage::Part& part);
  Status catch_up(const Client::State& client, StreamId id);
  Status add_snapshot(const Client::State& client, StreamId id, const Chain& chain);
  Status write(StreamId id, std::span<const std::byte> packet);
  void forget_others(const Client::State& client, const std::set<StreamId>& updated);
  [[nodiscard]] bool presence_is_here(const Client::State& client, StreamId id) const {
    const auto presence = client.presence_of(id);
    return !presence || recorded.count(*presence) != 0;
  }
  [[nodiscard]] bool stands_at(StreamId id, const Decoder& decoder) const;
  /// True if the stream may have a snapshot. The first of a stream is free; further ones are
  /// limited, or a server could cause many bytes of container by few bytes of messages.
  [[nodiscard]] bool may_make_up_for(StreamId id) const {
    return begun.count(id) == 0 || repeated <= kFreeSnapshots + kSnapshotRatio * received;
  }
  [[nodiscard]] std::uint8_t texture_id(StreamId id) const {
    return static_cast<std::uint8_t>(first_texture.at(id.volume) + id.texture);
  }

  ContainerWriter writer;
  std::map<std::uint16_t, std::uint32_t> first_texture;  ///< by the volume's id
  std::uint64_t began = 0;
  std::uint32_t generation = 0;
  std::uint32_t sync = 0;  ///< of the client at the last update; if it differs, packets were lost
  std::uint64_t next_frame = 0, frame = 0;
  std::map<StreamId, Recorded> recorded;
  std::set<StreamId> waiting;
  std::set<StreamId> begun;                  ///< streams that had a snapshot
  std::uint64_t received = 0, repeated = 0;  ///< bytes of packets, and of repeated snapshots
  Packet packet;                             ///< being written
};

ClientRecorder::ClientRecorder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
ClientRecorder::ClientRecorder(ClientRecorder&&) noexcept = default;
ClientRecorder& ClientRecorder::operator=(ClientRecorder&&) noexcept = default;
ClientRecorder::~ClientRecorder() = default;

Result<ContainerDescription> ClientRecorder::describe(const Client& client) {
  return guarded([&]() -> Result<ContainerDescription> {
    const ClientOptions& options = client.state_->options;
    const ClientFrame& frame = client.frame();
    ContainerDescription made;
    made.epoch = frame.epoch;
    made.scene = frame.scene;
    if (frame.volumes.empty()) return Status::out_of_order;
    for (const ClientVolume& volume : frame.volumes) {
      const std::size_t first = made.textures.size();
      if (made.volumes.size() == kMaxOfContainer ||
          volume.textures.size() > kMaxOfContainer - first) {
        return Status::limit_exceeded;
      }
      const Status added = add_volume(made, volume.name, volume.desc, options.kinds);
      if (added != Status::ok) return added;
      VolumeEntry& entry = made.volumes.back();
      entry.geometry = volume.geometry;
      if (options.delivery == Delivery::shared) entry.region = volume.region;
      for (std::size_t t = 0; t < volume.textures.size(); ++t)
        made.textures[first + t].largest_error = volume.textures[t].largest_error;
    }
    return made;
  });
}

Result<ClientRecorder> ClientRecorder::begin(Sink& sink, const Client& client,
                                             const ContainerDescription& description) {
  return guarded([&]() -> Result<ClientRecorder> {
    const Client::State& from = *client.state_;
    if (description.volumes.size() != from.frame.volumes.size()) return Status::invalid_argument;
    auto writer = ContainerWriter::create(sink, description, from.options.kinds);
    if (!writer) return writer.status();
    auto state = std::make_unique<State>(*std::move(writer));
    for (std::size_t v = 0; v < description.volumes.size(); ++v)
      state->first_texture[from.frame.volumes[v].id] = description.volumes[v].first_texture;
    state->began = from.frame.began;
    state->generation = from.generation;
    return ClientRecorder(std::move(state));
  });
}

bool ClientRecorder::fits(const Client& client) const noexcept {
  return client.state_->frame.began == state_->began &&
         client.state_->generation == state_->generation;
}

bool ClientRecorder::State::stands_at(StreamId id, const Decoder& decoder) const {
  const auto found = recorded.find(id);
  return found != recorded.end() && found->second.sequence == decoder.sequence() &&
         found->second.checksum == decoder.checksum();
}

/// Drops streams that moved on by packets the recorder did not get, in an update that failed.
void ClientRecorder::State::forget_others(const Client::State& client,
                                          const std::set<StreamId>& updated) {
  std::erase_if(recorded, [&](const auto& entry) {
    const auto chain = client.chains.find(entry.first);
    if (chain == client.chains.end()) return true;
    return updated.count(entry.first) == 0 && !stands_at(entry.first, chain->second.decoder);
  });
}

Status ClientRecorder::State::write(StreamId id, std::span<const std::byte> bytes) {
  return writer.add(frame, bytes, id.region);
}

/// Adds a packet if it builds on the stream's state in the container; else stops recording the
/// stream.
Status ClientRecorder::State::add(const Client::State& client, const UpdateMessage::Part& part) {
  const StreamId id = part.stream;
  const auto parts = parse_packet(part.packet);
  if (!parts) return parts.status();
  const PacketInfo& info = parts->info;
  const auto held = recorded.find(id);
  const bool follows = held != recorded.end() && info.reference == held->second.sequence &&
                       parts->base == held->second.checksum;
  if ((!is_keyframe(info.type) && !follows) || !presence_is_here(client, id)) {
    recorded.erase(id);
    return Status::ok;
  }
  const std::uint32_t base = is_keyframe(info.type) ? parts->base : held->second.checksum_here;
  const std::uint32_t after = checksum_after(*parts, part.packet);
  Recorded now{info.sequence, after, after};
  Status status = Status::ok;
  if (info.texture_id == texture_id(id) && base == parts->base) {
    status = write(id, part.packet);
  } else {
    const std::uint32_t sealed = readdress(*parts, texture_id(id), base, packet);
    if (!is_stand_in(info.type)) now.checksum_here = sealed;
    status = write(id, packet);
  }
  if (status == Status::ok) recorded[id] = now;
  return status;
}

/// Adds a snapshot of what the client holds of a stream, on which its next packets build.
Status ClientRecorder::State::add_snapshot(const Client::State& client, StreamId id,
                                           const Chain& chain) {
  const Decoder& decoder = chain.decoder;
  const TextureDesc& desc = decoder.desc();
  EncoderOptions options;
  options.texture_id = texture_id(id);
  options.settings.threads = client.options.threads;
  options.settings.isa = client.options.isa;
  auto encoder = Encoder::create(desc, options);
  if (!encoder) return encoder.status();
  if (const auto presence = client.presence_of(id)) {
    const Status status = encoder->set_presence(client.chains.at(*presence).decoder.records());
    if (status != Status::ok) return status;
  }
  std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(desc)));
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < decoder.received().size(); ++block) {
    if (decoder.received()[block] != 0) blocks.push_back(block);
  }
  Status status = decoder.read(TextureView{texels});
  if (status == Status::ok) status = encoder->encode_to(ConstTextureView(texels), blocks, packet);
  if (status != Status::ok) return status;
  const Packet keyframe = std::move(packet);
  auto parts = parse_packet(keyframe);
  if (!parts) return parts.status();
  parts->info.type = PacketType::snapshot;
  parts->info.lossy = client.frame.find(id.volume)->textures[id.texture].largest_error != 0;
  parts->info.sequence = decoder.sequence();
  parts->stands_for = decoder.checksum();
  readdress(*parts, texture_id(id), parts->base, packet);
  status = write(id, packet);
  if (status != Status::ok) return status;
  recorded[id] = {decoder.sequence(), decoder.checksum(), decoder.checksum()};
  if (!begun.insert(id).second) repeated += packet.size();
  return Status::ok;
}

/// Adds a snapshot of a stream that lacks packets, if one can be made; else the stream waits.
Status ClientRecorder::State::catch_up(const Client::State& client, StreamId id) {
  const auto found = client.chains.find(id);
  waiting.erase(id);
  if (found == client.chains.end() || found->second.decoder.sequence() == 0 ||
      stands_at(id, found->second.decoder)) {
    return Status::ok;
  }
  if (!found->second.stateful && presence_is_here(client, id) && may_make_up_for(id))
    return add_snapshot(client, id, found->second);
  recorded.erase(id);
  waiting.insert(id);
  return Status::ok;
}

/// The frame of each packet. A frame has at most one packet of a stream, and presence comes before
/// the packets that depend on it.
std::vector<ClientRecorder::State::Placed> ClientRecorder::State::place(
    const Client::State& client, std::span<const UpdateMessage::Part> packets) {
  struct Last {
    std::uint64_t frame = 0;
    std::set<StreamId> streams = {};  ///< in the frame
  };
  std::map<StreamId, Last> groups;  ///< by the stream that holds the presence
  std::vector<Placed> placed;
  for (const UpdateMessage::Part& part : packets) {
    const StreamId id = part.stream, group = client.presence_of(id).value_or(id);
    Last& last = groups[group];
    if (last.streams.count(id) != 0 || (id == group && !last.streams.empty())) {
      ++last.frame;
      last.streams.clear();
    }
    last.streams.insert(id);
    placed.push_back({last.frame, &part});
  }
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) { return a.frame < b.frame; });
  return placed;
}

Status ClientRecorder::State::add(const Client::State& client,
                                  std::span<const UpdateMessage::Part> packets) {
  const bool all = sync != client.sync;
  if (packets.empty() && !all) return Status::ok;
  sync = 0;  // Until all is added: after an error the next call checks every stream.
  for (const UpdateMessage::Part& part : packets) received += part.packet.size();
  const std::vector<Placed> placed = place(client, packets);
  const std::uint64_t first = std::max(client.frame.update, next_frame);
  const std::uint64_t last = placed.empty() ? 0 : placed.back().frame;
  if (first >= UINT64_MAX - last) return Status::limit_exceeded;
  next_frame = first + last + 1;
  std::set<StreamId> streams;
  for (const UpdateMessage::Part& part : packets) streams.insert(part.stream);
  if (all) {
    forget_others(client, streams);
    waiting.clear();
    for (const auto& chain : client.chains) streams.insert(chain.first);
  }
  for (const Placed& one : placed) {
    frame = first + one.frame;
    if (const Status status = add(client, *one.part); status != Status::ok) return status;
  }
  frame = first + last;
  // Presence comes before the streams that depend on it.
  for (const bool goes_by : {false, true}) {
    for (const StreamId id : streams) {
      if (client.presence_of(id).has_value() != goes_by) continue;
      if (const Status status = catch_up(client, id); status != Status::ok) return status;
    }
  }
  sync = client.sync;
  return Status::ok;
}

Status ClientRecorder::add(const Client& client, std::span<const UpdateMessage::Part> packets) {
  if (!fits(client)) return Status::out_of_order;
  for (const UpdateMessage::Part& part : packets) {
    if (!client.state_->exists(part.stream)) return Status::unknown_texture;
  }
  return guarded([&] { return state_->add(*client.state_, packets); });
}

std::size_t ClientRecorder::waiting() const noexcept { return state_->waiting.size(); }
std::uint64_t ClientRecorder::bytes_written() const noexcept {
  return state_->writer.bytes_written();
}
Status ClientRecorder::finish() { return state_->writer.finish(); }

}  // namespace gicodec
