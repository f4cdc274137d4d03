// A client with realistic limits, fed what servers say: the first byte chooses its delivery, then
// come parts, one message each, also over new connections. Sync points, numbers, references and
// checksums are put right. Afterwards it follows an honest server.
#include "messages.h"
#include "watched_client.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/probes.h>
#include <gicodec/server.h>

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr unsigned kAsItStands = 1, kNewConnection = 2, kPacketsAsTheyStand = 3;
constexpr std::size_t kHead = 1;

/// A new session, one update of all blocks.
void follow_honest_server(WatchedClient& client) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 2, 2}, 2);
  auto server = Server::create({.backend = "raw", .proofs = true});
  check(server.ok(), "a server is made");
  const std::vector<NamedTexture> textures{{"t", desc}};
  check(server->add_volume("v", *probe_volume(textures), {desc.grid}).ok(), "a volume is added");
  const ConnectionId connection = *server->connect(0);
  server->receive(connection, client.hello(), 0);
  Message all;
  check(write_message(Subscribe{1, 0, 0, BlockMask(block_count(desc), 1)}, all) == Status::ok,
        "written");
  server->receive(connection, all, 0);
  Exact texels(static_cast<std::size_t>(texture_bytes(desc)));
  check(server->publish(0, 0, ConstTextureView{texels.span()}) == Status::ok, "published");
  check(server->update(0, 0) == Status::ok, "updated");
  for (const Message& message : joined(server->take_messages(connection))) {
    check(client.receive(message) == Status::ok, "an honest server is understood");
  }
  check(client.consistent() && same(client.frame().volumes[0].textures[0].texels, texels.span()),
        "whatever came before");
}

/// Probes or vectors of another grid, with other cores and perhaps one texture more.
void mutate_volume(DescribedVolume& said, Random& random) {
  const Kind* const kind = find_kind(said.kind);
  auto volume =
      kind == nullptr ? Result<VolumeDesc>(Status::unknown_kind) : kind->read(said.description);
  if (!volume) return;
  auto& grid = said.geometry.grid;
  auto& side = *std::array{&grid.x, &grid.y, &grid.z}[pick(random, 3)];
  side = 1 + static_cast<std::uint32_t>(pick(random, std::size_t{1} << pick(random, 10)));
  if (once_in(random, 8) || said.kind == kKindIrradianceVectors) {
    volume = irradiance_vector_volume(grid, once_in(random, 2));
  } else {
    auto& textures = volume->groups[0].textures;
    if (once_in(random, 4)) {
      const NamedTexture copy{"more" + std::to_string(textures.size()), textures[0].desc};
      textures.push_back(copy);
    }
    const auto core = static_cast<std::uint8_t>(1 + pick(random, kMaxBlockSide));
    for (NamedTexture& texture : textures) {
      const TextureDesc& desc = texture.desc;
      texture.desc = probe_texture(desc.record, grid, once_in(random, 3) ? core : desc.block.x,
                                   desc.guard_band);
    }
    volume = probe_volume(textures);
  }
  if (!volume) return;
  said.kind = volume->kind;
  said.description.clear();
  check(find_kind(said.kind)->write(*volume, said.description) == Status::ok, "it has a kind");
  said.textures.clear();
  for (const NamedTexture& texture : volume->groups[0].textures) {
    said.textures.push_back({texture.name});
  }
}

/// One field of a list of volumes, by steps that stay near the limits.
void mutate_volumes(std::uint32_t& generation, std::vector<DescribedVolume>& volumes,
                    Random& random) {
  if (once_in(random, 4)) ++generation;
  if (volumes.empty()) return;
  if (once_in(random, 4)) {
    auto copy = volumes.back();
    ++copy.id;
    volumes.push_back(copy);
  }
  if (once_in(random, 8)) volumes.erase(volumes.begin());
  if (volumes.empty()) return;
  auto& volume = volumes[pick(random, volumes.size())];
  if (once_in(random, 4)) volume.added = generation;
  if (once_in(random, 4)) volume.region.x = 1 + static_cast<std::uint32_t>(pick(random, 16));
  if (once_in(random, 8)) return mutate(volume.description, volume.description.size() + 8);
  mutate_volume(volume, random);
}

void mutate_welcome(Welcome& welcome, Random& random) {
  if (once_in(random, 4)) welcome.resumed = !welcome.resumed;
  if (once_in(random, 8)) welcome.epoch ^= 1;
  mutate_volumes(welcome.generation, welcome.volumes, random);
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
      part.stream.region += static_cast<std::uint32_t>(pick(random, 3));
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
  if (auto* welcome = std::get_if<Welcome>(&*read)) {
    mutate_welcome(*welcome, random);
    // Volumes that come or go in a session.
    if (once_in(random, 4)) {
      AnyMessage volumes = Volumes{welcome->generation, std::move(welcome->volumes)};
      read = std::move(volumes);
    }
  } else if (auto* volumes = std::get_if<Volumes>(&*read)) {
    mutate_volumes(volumes->generation, volumes->volumes, random);
  }
  if (auto* update = std::get_if<UpdateMessage>(&*read))
    mutate_update(*update, room, random, packet);
  Message written;
  if (write_message(*read, written) == Status::ok) bytes = written;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  WatchedClient client(input.below(2) == 0 ? Delivery::unicast : Delivery::shared);
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
