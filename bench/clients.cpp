// What a server of many clients costs, with unicast delivery and with shared regions:
//
//   clients [--updates N] [--view SHARE] [--clients N,N,...] [--region XxYxZ] [--backend NAME]
//   DUMPS
//
// Every client sees a box of the volume, SHARE of its blocks. The boxes are all at the same place,
// next to each other (within a quarter of the volume), or anywhere. Per update, once the first
// keyframes are through: processor time of the server's update and of one client's decoding, each
// on one thread, bytes made, bytes sent to one client, and the memory of the server and of one
// client.
#include "dumps.h"

#include "dump/error.h"

#include "session/server/distributor.h"

#include <gicodec/gicodec.h>
#include <gicodec/server.h>

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>

namespace gicodec::bench {
namespace {

struct Options {
  std::size_t updates = 5;
  double view = 0.25;
  std::vector<std::size_t> clients{1, 10, 50, 200, 1000};
  Grid region = ServerOptions().region;
  std::string backend = "native", dumps;
};

enum class Overlap { same, near, anywhere };

/// The box of one client.
BlockMask box(Grid grid, double share, Overlap overlap, std::mt19937& random) {
  // As deep as the volume is high; equal shares along x and z.
  const double side = std::sqrt(share);
  const auto length = [&](std::uint32_t n) {
    return std::clamp<std::uint32_t>(static_cast<std::uint32_t>(std::lround(side * n)), 1, n);
  };
  const auto first = [&](std::uint32_t n) {
    const std::uint32_t room = n - length(n);
    const std::uint32_t reach = overlap == Overlap::same   ? 0
                                : overlap == Overlap::near ? std::min(room, (n + 3) / 4)
                                                           : room;
    return reach == 0 ? 0 : static_cast<std::uint32_t>(random() % (reach + 1));
  };
  const std::uint32_t x0 = first(grid.x), z0 = first(grid.z);
  BlockMask mask(std::size_t{grid.x} * grid.y * grid.z, 0);
  for (std::uint32_t z = z0; z < z0 + length(grid.z); ++z) {
    for (std::uint32_t y = 0; y < grid.y; ++y) {
      for (std::uint32_t x = x0; x < x0 + length(grid.x); ++x) {
        mask[x + grid.x * (y + std::size_t{grid.y} * z)] = 1;
      }
    }
  }
  return mask;
}

struct Cost {
  double seconds = 0, decoding = 0, made = 0, sent = 0;
  std::size_t memory = 0, per_client = 0;
};

void need(Status status) {
  if (status != Status::ok) throw std::runtime_error(std::string(to_string(status)));
}

Cost measure(const std::vector<Texture>& textures, const Options& o, std::size_t clients,
             Delivery delivery, Overlap overlap) {
  auto distributor = Distributor::create({.backend = o.backend, .region = o.region});
  need(distributor.status());
  std::vector<NamedTexture> named;
  for (const Texture& t : textures) named.push_back({t.name, t.desc});
  const Grid grid = textures[0].desc.grid;
  const auto volume = probe_volume(named);
  need(volume.status());
  need(distributor->add_volume(*volume, {grid}).status());
  std::mt19937 random(1);
  std::vector<ClientId> ids;
  for (std::size_t i = 0; i < clients; ++i) {
    const auto id = distributor->connect(delivery);
    need(id.status());
    need(distributor->set_visible(*id, 0, box(grid, o.view, overlap, random)));
    ids.push_back(*id);
  }
  Cost cost;
  std::map<StreamId, Decoder> decoders;  // Of the first client.
  const auto decode = [&] {
    for (const OutgoingPacket& packet : distributor->packets(ids[0])) {
      const TextureDesc& desc = textures[packet.stream.texture].desc;
      const bool whole = packet.stream.region == StreamId::kWholeVolume;
      if (!decoders.contains(packet.stream)) {
        auto made =
            Decoder::create(whole ? desc : region_texture(desc, o.region, packet.stream.region));
        need(made.status());
        decoders.emplace(packet.stream, *std::move(made));
      }
      need(decoders.at(packet.stream).decode(*packet.packet));
    }
  };
  for (std::size_t update = 0; update <= o.updates; ++update) {
    for (std::uint8_t t = 0; t < textures.size(); ++t) {
      const auto& frames = textures[t].frames;
      need(distributor->publish(0, t, {frames[update % frames.size()]}));
    }
    const double start = processor_time();
    need(distributor->update());
    const double end = processor_time();
    decode();
    if (update == 0) continue;  // Keyframes.
    cost.seconds += end - start;
    cost.decoding += processor_time() - end;
    std::set<const Packet*> made;
    for (const ClientId id : ids) {
      for (const OutgoingPacket& packet : distributor->packets(id)) {
        cost.sent += static_cast<double>(packet.packet->size());
        if (made.insert(packet.packet.get()).second) {
          cost.made += static_cast<double>(packet.packet->size());
        }
      }
      // A client that is in touch.
      if (delivery == Delivery::shared) continue;
      for (const OutgoingPacket& packet : distributor->packets(id)) {
        need(distributor->acknowledge(id, packet.stream, packet.sequence));
      }
    }
  }
  const auto updates = static_cast<double>(o.updates);
  cost.seconds /= updates, cost.decoding /= updates, cost.made /= updates;
  cost.sent /= updates * static_cast<double>(clients);
  cost.memory = distributor->memory();
  cost.per_client = distributor->memory_of(ids[0]);
  return cost;
}

template <typename T>
T number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::runtime_error(fmt::format("'{}' is no number", text));
  }
  return value;
}

Options parse(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string_view flag = argv[i];
    const bool valued = i + 1 < argc;
    if (flag == "--updates" && valued) {
      o.updates = std::max<std::size_t>(1, number<std::size_t>(argv[++i]));
    } else if (flag == "--view" && valued) {
      o.view = std::clamp(number<double>(argv[++i]), 0.0, 1.0);
    } else if (flag == "--clients" && valued) {
      o.clients.clear();
      std::string_view list = argv[++i];
      while (!list.empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        o.clients.push_back(std::max<std::size_t>(1, number<std::size_t>(list.substr(0, comma))));
        list.remove_prefix(std::min(comma + 1, list.size()));
      }
    } else if (flag == "--region" && valued) {
      const auto region = tools::grid_from_string(argv[++i]);
      if (!region) throw std::runtime_error("--region: a grid such as 4x4x8");
      o.region = *region;
    } else if (flag == "--backend" && valued) {
      o.backend = argv[++i];
    } else {
      o.dumps = flag;
    }
  }
  if (o.dumps.empty() || o.clients.empty()) {
    throw std::runtime_error(
        "clients [--updates N] [--view SHARE] [--clients N,N,...] [--region XxYxZ] "
        "[--backend NAME] DUMPS");
  }
  return o;
}

int run(int argc, char** argv) {
  const Options o = parse(argc, argv);
  const std::vector<Texture> textures = read_dumps(o.dumps);
  fmt::print("{}: {} updates, every client sees {:.0f} % of {} blocks\n\n", o.dumps, o.updates,
             100 * o.view, block_count(textures[0].desc));
  fmt::print("{:<9} {:>7} {:<7} {:>10} {:>10} {:>10} {:>12} {:>10} {:>12}\n", "views", "clients",
             "packets", "update ms", "decode ms", "made kB", "kB/client", "server MB", "kB/client");
  for (const auto& [overlap, name] :
       {std::pair(Overlap::same, "same"), std::pair(Overlap::near, "near"),
        std::pair(Overlap::anywhere, "anywhere")}) {
    for (const std::size_t clients : o.clients) {
      for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
        const Cost cost = measure(textures, o, clients, delivery, overlap);
        fmt::print(
            "{:<9} {:>7} {:<7} {:>10.2f} {:>10.2f} {:>10.1f} {:>12.1f} {:>10.1f} {:>12.1f}\n", name,
            clients, delivery == Delivery::unicast ? "unicast" : "shared", cost.seconds * 1e3,
            cost.decoding * 1e3, cost.made / 1e3, cost.sent / 1e3,
            static_cast<double>(cost.memory) / 1e6, static_cast<double>(cost.per_client) / 1e3);
        std::fflush(stdout);
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace gicodec::bench

int main(int argc, char** argv) {
  try {
    return gicodec::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "clients: {}\n", error.what());
    return 1;
  }
}
