// A client with realistic limits, fed what servers say: the first byte chooses its delivery, then
// come parts, one message each, also over new connections. Epochs, numbers, references and
// checksums are put right. Afterwards it follows an honest server.
#include "watched_client.h"

#include <gicodec/host.h>

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr unsigned kAsItStands = 1, kNewConnection = 2, kPacketsAsTheyStand = 3;
constexpr std::size_t kHead = 1;

/// A new session, one update of all probes.
void follow_honest_server(WatchedClient& client) {
  constexpr TextureDesc kDesc{Format::R16_SFLOAT, {3, 2, 2}, 2, 1, {}};
  auto server = Server::create({.backend = "raw"});
  check(server.ok(), "a server is made");
  auto host = Host::create(*std::move(server), {.proofs = true});
  check(host.ok(), "a host is made");
  const std::vector<StreamedTexture> textures{{kDesc}};
  const std::vector<std::string> names{"t"};
  check(host->add_volume("v", {kDesc.grid}, textures, names).ok(), "a volume is added");
  const PeerId peer = *host->connect(0);
  host->receive(peer, client.hello(), 0);
  Message all;
  check(write_message(Subscribe{0, ProbeMask(probe_count(kDesc), 1)}, all) == Status::ok,
        "written");
  host->receive(peer, all, 0);
  Exact texels(static_cast<std::size_t>(texture_bytes(kDesc)));
  check(host->server().publish(0, 0, ConstTextureView{texels.span()}) == Status::ok, "published");
  check(host->update(0, 0) == Status::ok, "updated");
  for (const Message& message : host->take_messages(peer)) {
    check(client.receive(message) == Status::ok, "an honest server is understood");
  }
  check(client.consistent() && same(client.frame().volumes[0].textures[0].texels, texels.span()),
        "whatever came before");
}

/// One field of a Welcome, by steps that stay near the limits.
void mutate_welcome(Welcome& welcome, Random& random) {
  if (once_in(random, 4)) welcome.resumed = !welcome.resumed;
  if (once_in(random, 4)) welcome.chunk.x = 1 + static_cast<std::uint32_t>(pick(random, 16));
  if (welcome.volumes.empty()) return;
  if (once_in(random, 4)) {
    const auto copy = welcome.volumes[pick(random, welcome.volumes.size())];
    welcome.volumes.push_back(copy);
  }
  auto& volume = welcome.volumes[pick(random, welcome.volumes.size())];
  if (once_in(random, 4) && !volume.textures.empty()) {
    const auto copy = volume.textures[0];
    volume.textures.push_back(copy);
  }
  auto& grid = volume.geometry.grid;
  auto& side = *std::array{&grid.x, &grid.y, &grid.z}[pick(random, 3)];
  side = 1 + static_cast<std::uint32_t>(pick(random, std::size_t{1} << pick(random, 10)));
  const auto core = static_cast<std::uint16_t>(1 + pick(random, kMaxCore));
  for (auto& texture : volume.textures) {
    texture.desc.grid = grid;
    if (once_in(random, 3)) texture.desc.core = core;
  }
}

/// A packet, or the list of them.
void mutate_update(UpdateMessage& update, std::size_t room, Random& random, Bytes& packet) {
  if (update.parts.empty()) return;
  auto& part = update.parts[pick(random, update.parts.size())];
  switch (pick(random, 8)) {
    case 0: {
      const auto copy = part;
      update.parts.push_back(copy);
      break;
    }
    case 1:
      part.stream.chunk += static_cast<std::uint32_t>(pick(random, 3));
      break;
    case 2:
      update.proofs.push_back({part.stream, 0});
      break;
    case 3:
      if (!update.scrolls.empty()) update.scrolls[0][pick(random, 3)] += 1;
      break;
    default:
      packet.assign(part.packet.begin(), part.packet.end());
      mutate_packet(packet, room, random);
      part.packet = packet;
  }
}

void mutate_message(std::span<const std::byte>, Bytes& bytes, std::size_t room, Random& random) {
  auto read = read_message(bytes, kClientMessages);
  if (!read || once_in(random, 6)) return mutate(bytes, bytes.size() + room);
  Bytes packet;
  if (auto* welcome = std::get_if<Welcome>(&*read)) mutate_welcome(*welcome, random);
  if (auto* update = std::get_if<UpdateMessage>(&*read))
    mutate_update(*update, room, random, packet);
  Message written;
  if (write_message(*read, written) == Status::ok) bytes = written;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  WatchedClient client(input.below(2) == 0 ? Delivery::own : Delivery::shared);
  static_cast<void>(client.hello());
  for (int i = 0; i < 24 && !input.empty(); ++i) {
    const auto part = input.part();
    if (part.flags == kNewConnection) static_cast<void>(client.hello());
    const Bytes bytes = part.flags == kAsItStands
                            ? Bytes(part.bytes.begin(), part.bytes.end())
                            : client.put_right(part.bytes, part.flags != kPacketsAsTheyStand);
    static_cast<void>(client.receive(Exact(bytes).span()));
  }
  follow_honest_server(client);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kHead, mutate_message);
}
