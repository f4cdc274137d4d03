// A receiver of tracks with a client behind it, fed what publishers say: parts, one message each,
// some of them after the client has begun anew or chosen other blocks. Afterwards it follows an
// honest publisher.
#include "messages.h"
#include "watched_client.h"

#include <gicodec/probes.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr unsigned kBeginAnew = 2, kChoose = 3;
constexpr std::uint32_t kTracks = 2048;
constexpr std::size_t kWaiting = std::size_t{1} << 20;
/// Of a track in tables, beside the lists of what is wanted.
constexpr std::size_t kOfTrack = 1024;

class Viewer {
 public:
  Viewer()
      : receiver_(*TrackReceiver::create({.max_tracks = kTracks, .max_waiting_bytes = kWaiting})) {
    hello();
  }
  void hello() { check(receiver_.take(client_.hello()) == Status::ok, "a Hello is taken"); }
  void choose(std::span<const std::byte> bytes) {
    static_cast<void>(receiver_.take(Exact(bytes).span()));
  }
  void receive(std::span<const std::byte> message) {
    check_cost("a receiver costs what its limits allow", [&]() -> Allowance {
      const Status status = receiver_.receive(Exact(message).span());
      check(status != Status::out_of_memory, "what it may not have it does not ask for");
      const std::size_t memory = kTracks * kOfTrack + kWaiting + 32 * message.size() + kContexts;
      return {memory, 4 * memory};
    });
    if (receiver_.wants_hello()) hello();
    auto made = receiver_.take_messages();
    check(made.ok(), "messages are made");
    for (const Message& one : *made) {
      if (client_.receive(one) == Status::ok) continue;
      // As a program does: the connection is over, and the next one begins.
      hello();
      break;
    }
    for (const Message& reply : client_.replies())
      check(receiver_.take(reply) == Status::ok, "a client's replies are taken");
    check(receiver_.take_requests().ok(), "requests are made");
    for (const StreamId stream : receiver_.wanted())
      check(receiver_.name(stream).has_value(), "what is wanted exists");
  }
  [[nodiscard]] const WatchedClient& client() const { return client_; }
  [[nodiscard]] bool complete() const { return receiver_.complete(); }

 private:
  TrackReceiver receiver_;
  WatchedClient client_{Delivery::shared};
};

/// A publisher of the last epoch there is.
void follow_honest_publisher(Viewer& viewer) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 2, 2}, 2);
  auto server = Server::create({.backend = "raw", .epoch = UINT64_MAX, .proofs = true});
  check(server.ok(), "a server is made");
  const std::vector<NamedTexture> textures{{"t", desc}};
  check(server->add_volume("v", *probe_volume(textures), {desc.grid}).ok(), "a volume is added");
  auto publisher = TrackPublisher::create(*server);
  check(publisher.ok(), "a publisher is made");
  Exact texels(static_cast<std::size_t>(texture_bytes(desc)));
  for (int update = 1; update <= 4; ++update) {
    soil(texels.span(), static_cast<unsigned>(update));
    check(server->publish(0, 0, ConstTextureView{texels.span()}) == Status::ok, "published");
    check(publisher->update(update, update) == Status::ok, "updated");
    std::vector<TrackMessage> all(publisher->messages().begin(), publisher->messages().end());
    // The list, which ends an update, first: a receiver begins with it.
    std::stable_partition(all.begin(), all.end(), [](const TrackMessage& message) {
      return message.type == TrackMessage::Type::list;
    });
    for (const TrackMessage& message : all) viewer.receive(message.bytes);
  }
  if (viewer.client().frame().epoch != UINT64_MAX || !viewer.complete()) return;
  check(same(viewer.client().frame().volumes[0].textures[0].texels, texels.span()) ||
            viewer.client().frame().update != server->updates(),
        "whatever came before");
}

void mutate_runs(std::vector<TrackRun>& runs, Random& random) {
  if (runs.empty()) return;
  TrackRun& run = runs[pick(random, runs.size())];
  switch (pick(random, 4)) {
    case 0:
      run.count += static_cast<std::uint32_t>(pick(random, 3));
      break;
    case 1:
      run.age = pick(random, 4);
      break;
    case 2:
      run.number = static_cast<std::uint32_t>(pick(random, 6));
      break;
    default:
      run.first.region += static_cast<std::uint32_t>(pick(random, 2));
  }
}

void mutate_message(std::span<const std::byte>, Bytes& bytes, std::size_t room, Random& random) {
  auto read = read_message(bytes, kClientMessages);
  if (!read || once_in(random, 6)) return mutate(bytes, bytes.size() + room);
  Bytes packet;
  const auto change_run = [&](auto& message) {
    if (once_in(random, 8)) message.epoch += pick(random, 3);
    if (once_in(random, 12)) ++message.generation;
    if (once_in(random, 3)) message.update += pick(random, 4);
  };
  if (auto* list = std::get_if<TrackList>(&*read)) {
    change_run(*list);
    if (once_in(random, 2)) mutate_runs(list->snapshots, random);
    if (once_in(random, 4) && !list->volumes.empty())
      list->volumes[0].region.x = 1 + static_cast<std::uint32_t>(pick(random, 8));
    if (once_in(random, 3)) list->round = list->update - std::min<std::uint64_t>(list->update, 1);
  } else if (auto* tick = std::get_if<TrackTick>(&*read)) {
    change_run(*tick);
    mutate_runs(tick->changed, random);
    if (once_in(random, 3)) tick->round = std::min(tick->update, tick->round + pick(random, 3));
    if (once_in(random, 6) && !tick->scrolls.empty()) tick->scrolls[0][0] += 1;
  } else if (auto* object = std::get_if<TrackObject>(&*read)) {
    change_run(*object);
    if (once_in(random, 3)) object->previous = pick(random, object->update);
    if (once_in(random, 3)) object->stream.region += static_cast<std::uint32_t>(pick(random, 2));
    if (once_in(random, 6)) object->number = static_cast<std::uint32_t>(pick(random, 4));
    if (once_in(random, 6)) object->packets.push_back(object->packets.front());
    if (once_in(random, 4)) object->proof.clear();
    if (once_in(random, 3)) {
      packet.assign(object->packets[0].begin(), object->packets[0].end());
      mutate_packet(packet, room, random);
      object->packets[0] = packet;
    }
  }
  Message written;
  if (write_message(*read, written) == Status::ok) bytes = written;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Viewer viewer;
  for (int i = 0; i < 64 && !input.empty(); ++i) {
    const auto part = input.part();
    if (part.flags == kBeginAnew) viewer.hello();
    if (part.flags == kChoose) {
      viewer.choose(part.bytes);
    } else {
      viewer.receive(part.bytes);
    }
  }
  follow_honest_publisher(viewer);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, 0, mutate_message);
}
