// odd_server PORT_FILE: welcomes whoever comes to a volume of a kind that nobody knows, until it is
// ended, or for five minutes.
#include "dump/error.h"
#include "stream/net.h"

#include <gicodec/protocol.h>

#include <chrono>
#include <cstdio>

namespace {

using namespace gicodec;
using namespace gicodec::streaming;

Message welcome(const Hello& hello) {
  DescribedVolume volume;
  volume.name = "skin";
  volume.kind = 77;
  volume.description = {std::byte{1}};
  volume.geometry.grid = {2, 2, 2};
  volume.textures = {{"surfels"}};
  Welcome welcome;
  welcome.sync = hello.sync;
  welcome.ticket[0] = std::byte{1};
  welcome.delivery = hello.delivery;
  welcome.epoch = 1;
  welcome.volumes = {volume};
  Message message;
  tools::check(write_message(welcome, message), "welcome");
  return message;
}

void serve(const std::string& port_file) {
  NetOptions options;
  options.links = 8;
  Net net(Address{"127.0.0.1", 0}, std::nullopt, options);
  write_ports(port_file, net.ports());
  NetEvent event;
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (std::chrono::steady_clock::now() < end) {
    if (!net.next(event, 100) || event.type != NetEvent::Type::received) continue;
    const auto message = read_message(event.message);
    if (!message) continue;
    if (const auto* hello = std::get_if<Hello>(&*message)) net.send(event.link, {welcome(*hello)});
    if (std::holds_alternative<Goodbye>(*message)) net.close(event.link);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    serve(argv[1]);
  } catch (const tools::Error& error) {
    std::fprintf(stderr, "odd_server: %s\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
