// A client within the limits of a real one, and what it may cost: memory at a time by what its
// session says, work as bytes ever allocated by what its messages bring.
#pragma once

#include "packets.h"

#include "session/client/client_limits.h"

#include <map>
#include <optional>
#include <utility>

namespace gicodec::fuzz {

/// What a client of a game may spend: volumes of some 16,000 blocks fit, those of a million do not.
inline constexpr DecodeLimits kClientLimits{.max_texture_bytes = std::uint64_t{16} << 20,
                                            .max_packet_bytes = std::uint64_t{16} << 20,
                                            .max_total_bytes = std::uint64_t{64} << 20,
                                            .max_work_bytes = std::uint64_t{32} << 20};
inline constexpr MessageLimits kClientMessages{.max_bytes = kClientLimits.max_packet_bytes};

/// What the server knows of the client from its replies, to say what it would take next.
struct ClientView {
  Delivery delivery{};
  std::uint32_t sync = 0, number = 0, generation = 0;
  std::map<StreamId, StreamState> states = {};

  void keep(std::uint32_t new_sync, std::span<const HeldState> held) {
    sync = new_sync;
    number = 0;
    states.clear();
    for (const auto& state : held) states[state.stream] = {state.sequence, state.checksum};
  }
  void note(StreamId stream, std::span<const std::byte> packet) {
    const auto parts = parse_packet(packet);
    if (!parts) return;
    states[stream] = {parts->info.sequence, checksum_after(*parts, packet)};
  }
};

class WatchedClient {
 public:
  explicit WatchedClient(Delivery delivery) {
    view_.delivery = delivery;
    options_.limits = kClientLimits;
    options_.delivery = delivery;
    spend(0, [&] { client_.emplace(*Client::create(options_)); });
  }

  const Message& hello() {
    spend(0, [&] { hello_ = *client_->hello(); });
    const auto said = std::get<Hello>(*read_message(hello_));
    view_.keep(said.sync, said.held);
    return hello_;
  }

  Status receive(std::span<const std::byte> bytes) {
    const auto read = read_message(bytes, kClientMessages);
    const auto* welcome = read.ok() ? std::get_if<Welcome>(&*read) : nullptr;
    const auto* update = read.ok() ? std::get_if<UpdateMessage>(&*read) : nullptr;
    const auto* volumes = read.ok() ? std::get_if<Volumes>(&*read) : nullptr;
    if (volumes != nullptr && (!client_->is_connected() || volumes->generation <= view_.generation))
      volumes = nullptr;
    if (welcome != nullptr && (client_->is_connected() || welcome->sync != view_.sync))
      welcome = nullptr;
    const std::uint64_t serial = frame().serial, marked = replaced_since(serial);
    const std::uint64_t work = update != nullptr ? worth(*update) : 0;
    if (welcome != nullptr) begin(welcome->volumes, !welcome->resumed);
    if (volumes != nullptr) begin(volumes->volumes, false);
    Status status = Status::ok;
    // Items of lists take up to eight times their least bytes: read, and again as what becomes of
    // them.
    spend(24 * bytes.size(), [&] { status = client_->receive(bytes); });
    if (ending_ > 0 && status != Status::ok) session_ = ending_;
    if (welcome != nullptr && status == Status::ok) view_.generation = welcome->generation;
    if (volumes != nullptr && status == Status::ok) view_.generation = volumes->generation;
    ending_ = last_frame_ = 0;
    check(status != Status::out_of_memory && status != Status::invalid_argument,
          "what it may not have it does not ask for");
    check(status == Status::ok || frame().serial == serial, "errors end nothing");
    check(frame().serial == serial || work <= kClientLimits.max_work_bytes, "work is limited");
    // Of a message that failed in the middle some are marked for the next frame already.
    check(replaced_since(serial) <= marked + work,
          "no blocks are touched but those that count as work");
    answer(update);
    return status;
  }

  /// A message as a server would say it next, as far as it is one; with its packets as they stand
  /// or put right too.
  [[nodiscard]] Bytes put_right(std::span<const std::byte> bytes, bool packets) const {
    Bytes out(bytes.begin(), bytes.end());
    auto read = read_message(bytes, kClientMessages);
    if (!read) return out;
    std::vector<Bytes> made;
    if (auto* welcome = std::get_if<Welcome>(&*read)) {
      welcome->sync = view_.sync;
      welcome->delivery = view_.delivery;
    } else if (auto* volumes = std::get_if<Volumes>(&*read)) {
      volumes->generation = view_.generation + 1;
    } else if (auto* update = std::get_if<UpdateMessage>(&*read)) {
      update->sync = view_.sync;
      update->number = view_.number + 1;
      update->generation = view_.generation;
      ClientView then = view_;
      made.reserve(update->parts.size());
      for (auto& [stream, tier, packet] : update->parts) {
        if (!packets || !exists(stream)) continue;
        made.emplace_back(packet.begin(), packet.end());
        fuzz::put_right(made.back(), desc_of(stream), then.states[stream]);
        packet = made.back();
        then.note(stream, packet);
      }
    }
    Message written;
    return write_message(*read, written) == Status::ok ? written : out;
  }
  [[nodiscard]] const ClientFrame& frame() const { return client_->frame(); }
  [[nodiscard]] bool consistent() const { return client_->consistent(); }
  /// Since the last call.
  [[nodiscard]] std::vector<Message> replies() { return std::exchange(said_, {}); }

 private:
  /// Of a state that is listed in a Hello or Resync, and of what a list that grew leaves behind.
  static constexpr std::size_t kPerState = 128, kReplies = 4096;

  /// A call of the client, which may take `more` while it lasts.
  template <typename Body>
  void spend(std::size_t more, const Body& body) {
    const std::size_t before = test::heap_bytes();
    const Allowance cost = cost_of(body);
    // client_memory() counts what is stored; allocations are up to a fifth larger.
    const auto may_hold =
        static_cast<std::size_t>(std::max(session_, ending_) + last_frame_) * 6 / 5 + kContexts;
    more += kPerState * listed_ + kReplies;
    earned_ += more;
    check_within("a client costs what its session and its messages are worth",
                 {held_ + cost.memory, spent_ + cost.work}, {may_hold + more, earned_});
    spent_ += cost.work;
    held_ += test::heap_bytes() - before;  // Wraps where it got less.
  }

  /// The frame of the last session goes when that of the next one is there, volumes that go do so
  /// before others come. Decoders and their scratch come by and by, what grows twice.
  void begin(std::span<const DescribedVolume> said, bool anew) {
    const auto volumes = volumes_of(said, options_, 1);
    if (!volumes) return;
    const std::uint64_t memory = client_memory(*volumes, options_.delivery, 1, 1);
    last_frame_ = 0;
    for (const auto& volume : frame().volumes) {
      if (!anew) break;
      for (const auto& texture : volume.textures) {
        last_frame_ += texture.texels.size() + texture.changed.size() * sizeof(std::uint64_t);
      }
    }
    ending_ = std::exchange(session_, memory);
    earned_ += 2 * static_cast<std::size_t>(memory);
  }

  /// Bytes of blocks of an update that the client may work on. Earns what they may allocate: bands
  /// and lists of blocks per packet, a context where guard bands are compressed, and another
  /// decoder for a stream that was not proven.
  std::uint64_t worth(const UpdateMessage& update) {
    UpdateMessage known;
    for (const auto& part : update.parts) {
      if (!exists(part.stream)) continue;
      known.parts.push_back(part);
      const auto info = peek(part.packet);
      if (info.ok() && info->guard_band_size > 0) earned_ += kContexts;
    }
    for (const auto& proof : update.proofs) {
      if (!exists(proof.stream)) continue;
      known.proofs.push_back(proof);
      earned_ += 2 * static_cast<std::size_t>(held_memory(desc_of(proof.stream)));
    }
    listed_ = view_.states.size() + known.parts.size();
    const std::uint64_t work = update_work(known, frame());
    earned_ += 4 * static_cast<std::size_t>(std::min(work, kClientLimits.max_work_bytes));
    return work;
  }
  [[nodiscard]] bool exists(StreamId id) const {
    const auto* const volume = client_->is_connected() ? frame().find(id.volume) : nullptr;
    if (volume == nullptr || id.texture >= volume->textures.size()) return false;
    if (view_.delivery == Delivery::unicast) return id.region == StreamId::kWholeVolume;
    return id.region < regions_of(volume->textures[id.texture].desc, volume->region).regions();
  }
  [[nodiscard]] TextureDesc desc_of(StreamId id) const {
    return stream_desc(*frame().find(id.volume), id);
  }
  /// Bytes of blocks that were replaced since the frame of that serial.
  [[nodiscard]] std::uint64_t replaced_since(std::uint64_t serial) const {
    std::uint64_t bytes = 0;
    for (const auto& volume : frame().volumes) {
      for (const auto& texture : volume.textures) {
        const auto blocks = std::ranges::count_if(
            texture.changed, [&](std::uint64_t changed) { return changed > serial; });
        bytes += static_cast<std::uint64_t>(blocks) * block_bytes(texture.desc);
      }
    }
    return bytes;
  }

  /// Takes its replies; `update` is what it was just told, if so.
  void answer(const UpdateMessage* update) {
    spend(0, [&] { replies_ = client_->take_messages(); });
    said_.insert(said_.end(), replies_.begin(), replies_.end());
    for (const Message& reply : replies_) {
      const auto read = read_message(reply);
      check(read.ok(), "its replies are sound");
      if (const auto* resync = std::get_if<Resync>(&*read)) view_.keep(resync->sync, resync->held);
      if (const auto* done = std::get_if<Acknowledge>(&*read)) {
        view_.number = done->number;
        if (update == nullptr) continue;
        for (const auto& part : update->parts) view_.note(part.stream, part.packet);
      }
    }
    listed_ = view_.states.size();
  }

  std::optional<Client> client_;
  Message hello_;
  std::vector<Message> replies_, said_;
  ClientView view_;
  ClientOptions options_;
  std::uint64_t session_ = 0;     ///< what this session may hold
  std::uint64_t ending_ = 0;      ///< likewise the one before, while a Welcome ends it
  std::uint64_t last_frame_ = 0;  ///< bytes of its frame
  std::size_t listed_ = 0;        ///< states that the next reply may name
  std::size_t held_ = 0, spent_ = 0, earned_ = 2 * kContexts;
};

}  // namespace gicodec::fuzz
