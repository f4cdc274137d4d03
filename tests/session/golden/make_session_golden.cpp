// Wrote the recorded sessions once: make_session_golden FOLDER. See README.md before running it.
#include "../../messages.h"
#include "session/golden/session_golden.h"
#include "volumes.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace {

using namespace gicodec;
using namespace gicodec::golden;

void need(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "%s failed\n", what);
  std::exit(1);
}

class Recording {
 public:
  explicit Recording(const std::string& path) : file_(path, std::ios::binary) {}
  void add(bool from_server, const Message& message) {
    const auto size = static_cast<std::uint32_t>(message.size());
    file_.put(from_server ? 1 : 0);
    file_.write(reinterpret_cast<const char*>(&size), sizeof size);
    file_.write(reinterpret_cast<const char*>(message.data()),
                static_cast<std::streamsize>(message.size()));
  }

 private:
  std::ofstream file_;
};

/// The recordings are the same each time.
Status counted(std::span<std::byte> out) {
  static std::uint8_t next = 0;
  for (std::byte& byte : out) byte = std::byte{++next};
  return Status::ok;
}

/// One client that watches from `first` on; another one has been there before.
void record(const std::string& path, const char* backend, Delivery delivery, int first) {
  auto server = Server::create({.backend = backend,
                                .region = {3, 2, 2},
                                .scene = {"golden", 0x0123456789ABCDEF},
                                .epoch = 0x0102030405060708,
                                .proofs = true,
                                .access = {.random = counted}});
  need(server.ok(), "server");
  const auto textures = session_textures();
  const auto volume = test::probes_of({{"color", textures[0]}, {"vis", textures[1]}});
  need(server->add_volume("golden", volume, {kGrid}).ok(), "volume");
  ClientOptions options;
  options.delivery = delivery;
  options.token = "token";
  auto early = Client::create(options), late = Client::create(options);
  const ConnectionId before = *server->connect(0);
  server->receive(before, *early->hello(), 0);
  Message all;
  need(write_message(Subscribe{1, 0, 0, BlockMask(kBlocks, 1)}, all) == Status::ok, "subscribe");
  server->receive(before, all, 0);

  Recording recording(path);
  ConnectionId connection = 0;
  const auto say = [&](const Message& message) {
    recording.add(false, message);
    server->receive(connection, message, 0);
  };
  for (int update = 1; update <= kUpdates; ++update) {
    if (update == first) {
      connection = *server->connect(0);
      say(*late->hello());
      say(all);
      Message viewpoint;
      need(write_message(Viewpoint{}, viewpoint) == Status::ok, "viewpoint");
      say(viewpoint);
    }
    need(server->scroll(0, session_scroll(update)) == Status::ok, "scroll");
    for (std::uint8_t i = 0; i < 2; ++i) {
      test::Texture texture(session_textures()[i]);
      paint_session(texture, update);
      need(server->publish(0, i, std::as_const(texture).view()) == Status::ok, "publish");
    }
    need(server->update(update, update * 0.5) == Status::ok, "update");
    for (const Message& message : joined(server->take_messages(before))) {
      need(early->receive(message) == Status::ok, "receive");
    }
    for (const Message& reply : early->take_messages()) server->receive(before, reply, 0);
    if (connection == 0) continue;
    for (const Message& message : joined(server->take_messages(connection))) {
      recording.add(true, message);
      need(late->receive(message) == Status::ok, "receive");
    }
    for (const Message& reply : late->take_messages()) say(reply);
  }
  server->drop(connection, Reason::shutdown);
  for (const Message& message : joined(server->take_messages(connection)))
    recording.add(true, message);
}

}  // namespace

int main(int argc, char** argv) {
  need(argc == 2, "make_session_golden FOLDER:");
  const std::string folder = std::string(argv[1]) + "/";
  record(folder + "unicast_raw.session", "raw", Delivery::unicast, 1);
  record(folder + "unicast_native.session", "native", Delivery::unicast, 2);
  record(folder + "shared_zstd.session", "zstd", Delivery::shared, 2);
  record(folder + "shared_native.session", "native", Delivery::shared, 1);
  return 0;
}
