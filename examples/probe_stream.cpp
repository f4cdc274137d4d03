// The server and the client of docs/stream-from-a-renderer.md, with queues between them for a
// network.
#include "probe_client.h"
#include "probe_server.h"

#include <algorithm>
#include <cstdio>
#include <thread>

using namespace gicodec;

int main() {
  const VolumeGeometry geometry{{6, 4, 6}, {0, 0, 0}, {1, 1, 1}};
  const TextureDesc color = ddgi_irradiance(geometry.grid);
  const TextureDesc visibility = ddgi_visibility(geometry.grid);
  std::vector<std::byte> colors(texture_bytes(color)), distances(texture_bytes(visibility));
  const std::size_t probes = block_count(color);

  std::vector<Message> to_client, to_server;
  bool open = true;
  auto server = ProbeServer::create(
      geometry, {"example", 0}, "secret",
      {[&](int, const OutgoingMessage& message) { to_client.push_back(*message.joined()); },
       [&](int) { open = false; }});
  auto client =
      ProbeClient::create("secret", [&](const Message& message) { to_server.push_back(message); });
  if (!server || !client) return 1;
  server->connected(0, 0);
  if (client->connected() != Status::ok || client->look_from({}) != Status::ok) return 1;

  std::vector<std::byte> drawn;
  std::size_t uploads = 0;
  const auto upload = [&](const ClientTexture& texture, std::uint32_t) {
    if (texture.name == "color") drawn = texture.texels;
    ++uploads;
  };
  // The viewer sees all of the volume.
  const auto positions_seen = [&](const Viewpoint&) {
    std::vector<Position> positions;
    for (std::uint32_t i = 0; i < probes; ++i) positions.push_back(block_position(geometry, i));
    return positions;
  };
  const auto exchange = [&](double now) {
    for (Message& message : std::exchange(to_client, {})) {
      if (client->received(std::move(message)) != Status::ok) return false;
    }
    const bool well = client->answer() == Status::ok;
    for (const Message& message : std::exchange(to_server, {})) server->received(0, message, now);
    return well && open;
  };
  constexpr double kInterval = 0.01;
  const auto begin = std::chrono::steady_clock::now();
  const auto update = [&] {
    std::this_thread::sleep_for(std::chrono::duration<double>(kInterval));
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    const double now = passed.count();
    if (!exchange(now)) return false;
    const Status status = server->update({ConstTextureView(colors), ConstTextureView(distances),
                                          std::vector<std::uint8_t>(probes, 1), now},
                                         positions_seen, now, kInterval);
    return status == Status::ok && exchange(now);
  };
  for (unsigned frame = 0; frame < 20; ++frame) {
    for (std::size_t i = frame; i < colors.size(); i += 101) colors[i] = std::byte(i + frame);
    if (!update()) return 1;
    client->draw(upload);
  }
  // Until the client has caught up, which it may do at its own pace.
  for (unsigned tries = 0; drawn != colors && tries < 1000; ++tries) {
    if (!update()) return 1;
    client->draw(upload);
  }
  std::printf("%zu uploads, texels %s\n", uploads, drawn == colors ? "equal" : "DIFFER");
  return drawn == colors ? 0 : 1;
}
