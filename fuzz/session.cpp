// A server with an honest client and a hostile one, and a client with a hostile server: whatever
// the hostile ones say, the honest client holds what was published, and the victim's frame stays
// whole.
#include "cost.h"
#include "messages.h"
#include "mutate.h"

#include <gicodec/client.h>
#include <gicodec/probes.h>
#include <gicodec/server.h>

namespace {

using namespace gicodec;

constexpr Grid kGrid{3, 2, 2};
constexpr std::uint32_t kBlocks = 12;
const TextureDesc kDesc = probe_texture(Format::R16_SFLOAT, kGrid, 2);
/// What a server keeps of a session with volumes this small, whatever is said; and of each byte.
constexpr std::size_t kOfSession = std::size_t{64} << 10, kPerByte = 64;

/// `secret`: of the honest client's ticket.
Server make_server(std::uint64_t secret) {
  // Tickets that an input can know, but for the first client's, the same in every run.
  const auto random = [secret, drawn = std::uint8_t{0}](std::span<std::byte> out) mutable {
    std::ranges::fill(out, std::byte{++drawn});
    if (drawn == 2) std::memcpy(out.data(), &secret, sizeof secret);
    return Status::ok;
  };
  auto server = Server::create({.backend = "raw",
                                .proofs = true,
                                .access = {.random = random},
                                .limits = {.max_clients = 4, .max_message_bytes = 4096}});
  fuzz::check(server.ok(), "a server is made");
  const std::vector<NamedTexture> textures{{"t", kDesc}};
  fuzz::check(server->add_volume("v", *probe_volume(textures), {kGrid}).ok(), "a volume is added");
  return *std::move(server);
}

void exchange(Server& server, ConnectionId connection, Client& client, double now) {
  for (const Message& message : joined(server.take_messages(connection))) {
    fuzz::check(client.receive(message) == Status::ok, "the server's messages are sound");
  }
  for (const Message& reply : client.take_messages()) server.receive(connection, reply, now);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  Server server = make_server(XXH3_64bits(data, size));
  const ClientOptions options{
      .limits = {.max_texture_bytes = 1 << 16,
                 .max_packet_bytes = 1 << 16,
                 .max_total_bytes = 8 << 20},
      .delivery = input.below(2) == 0 ? Delivery::unicast : Delivery::shared};
  auto honest = Client::create(options), victim = Client::create(options);
  fuzz::check(honest.ok() && victim.ok(), "clients are made");
  const ConnectionId good = *server.connect(0);
  ConnectionId bad = *server.connect(0);
  server.receive(good, *honest->hello(), 0);
  Message all;
  fuzz::check(write_message(Subscribe{1, 0, 0, BlockMask(kBlocks, 1)}, all) == Status::ok,
              "written");
  server.receive(good, all, 0);
  fuzz::check(victim->hello().ok(), "a hello is made");

  std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(kDesc)));
  double now = 0;
  for (int i = 0; i < 12 && !input.empty(); ++i) {
    fuzz::Exact message(input.part().bytes);
    const std::size_t worth = kPerByte * message.span().size();
    fuzz::check_cost("a connection costs what its message is worth", [&]() -> fuzz::Allowance {
      server.receive(bad, message.span(), now);
      return {kOfSession + worth, 2 * (kOfSession + worth)};
    });
    const std::uint64_t serial = victim->frame().serial;
    Status status = Status::ok;
    fuzz::check_cost("a server costs no more than the limit", [&]() -> fuzz::Allowance {
      status = victim->receive(message.span());
      const std::size_t limit = options.limits.max_total_bytes * 6 / 5;
      return {limit + worth, 2 * (limit + worth)};
    });
    fuzz::check(status == Status::ok || victim->frame().serial == serial, "errors end nothing");
    static_cast<void>(victim->take_messages());

    for (auto& texel : texels) texel = static_cast<std::byte>(i + 1);
    fuzz::check(server.publish(0, 0, {texels}) == Status::ok, "published");
    now += 0.1;
    fuzz::check(server.update(now, now) == Status::ok, "updated");
    exchange(server, good, *honest, now);
    fuzz::check(honest->consistent() && honest->statistics().failed_proofs == 0, "states agree");
    fuzz::check(honest->frame().volumes[0].textures[0].texels == texels, "texels are exact");
    for (const ServerEvent& event : server.take_events()) {
      fuzz::check(event.type != ServerEvent::Type::dropped || event.connection == bad,
                  "only the bad go");
      if (event.type != ServerEvent::Type::dropped) continue;
      server.disconnect(bad, now);
      bad = *server.connect(now);
    }
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return fuzz::mutate_parts(data, size, max_size, seed, 1, fuzz::mutate_blindly);
}
