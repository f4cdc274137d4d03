// A renderer and two that draw with its probes: texture arrays in mapped memory with a pitch, an
// eighth of the probes updated in each frame, probes inside walls, a volume that follows the
// camera, a second one that comes and goes with a level, a unicast client and one
// of shared regions. In place of a network there are queues, which lose messages if asked to:
//   engine [PERCENT]
#include <gicodec/streaming.h>

#include <charconv>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

using namespace gicodec;

namespace {

constexpr Grid kGrid{12, 4, 12};
constexpr unsigned kFrames = 96, kParts = 8;  // A probe is updated in every eighth frame.
constexpr double kInterval = 1.0 / 30;

std::uint32_t random_number() {
  static std::uint32_t state = 12345;
  return state = state * 1664525 + 1013904223, state >> 8;
}

/// A texture array as an API maps it: rows begin at multiples of 256 bytes.
struct Mapped {
  explicit Mapped(const TextureDesc& desc_in) : desc(desc_in) {
    const Extent size = extent(desc);
    row_pitch = (size.width * desc.record.bytes + 255) / 256 * 256;
    slice_pitch = row_pitch * size.height;
    bytes.resize(slice_pitch * size.slices);
  }
  [[nodiscard]] TextureView view() { return {bytes, row_pitch, slice_pitch}; }
  /// One row of a probe's block, guard band included.
  [[nodiscard]] std::span<std::byte> row(std::uint32_t probe, unsigned y) {
    const BlockOrigin at = block_origin(desc, probe);
    const std::size_t begin =
        at.slice * slice_pitch + (at.y + y) * row_pitch + at.x * desc.record.bytes;
    return std::span(bytes).subspan(begin, side() * std::size_t{desc.record.bytes});
  }
  [[nodiscard]] unsigned side() const { return desc.block.x + 2U * desc.guard_band; }

  TextureDesc desc;
  std::size_t row_pitch = 0, slice_pitch = 0;
  std::vector<std::byte> bytes;
};

/// Where a renderer would dispatch its update of some probes. Borders come last, as in RTXGI.
void render(Mapped& texture, std::span<const std::uint32_t> probes, unsigned frame) {
  const unsigned side = texture.side(), size = texture.desc.record.bytes, core = side - 2;
  for (const std::uint32_t probe : probes) {
    for (unsigned y = 1; y <= core; ++y) {
      for (unsigned x = 1; x <= core; ++x) {
        const std::uint32_t texel = (probe * 7 + frame) << 16 | (x * y + random_number() % 3);
        std::memcpy(texture.row(probe, y).subspan(x * size).data(), &texel, size);
      }
    }
    const auto copy = [&](unsigned x, unsigned y, unsigned from_x, unsigned from_y) {
      std::memcpy(texture.row(probe, y).subspan(x * size).data(),
                  texture.row(probe, from_y).subspan(from_x * size).data(), size);
    };
    for (unsigned i = 1; i <= core; ++i) {
      copy(i, 0, side - 1 - i, 1);
      copy(i, side - 1, side - 1 - i, core);
      copy(0, i, 1, side - 1 - i);
      copy(side - 1, i, core, side - 1 - i);
    }
    copy(0, 0, core, core);
    copy(side - 1, 0, 1, core);
    copy(0, side - 1, core, 1);
    copy(side - 1, side - 1, 1, 1);
  }
}

/// A volume of the renderer's: irradiance and distance of its probes.
struct Volume {
  explicit Volume(Grid grid)
      : geometry{grid, {0, 0, 0}, {2, 2, 2}},
        textures{Mapped(probe_texture(Format::A2B10G10R10_UNORM_PACK32, grid, 6, 1,
                                      Tiling::slices_xz_y)),
                 Mapped(probe_texture(Format::R16G16_SFLOAT, grid, 14, 1, Tiling::slices_xz_y))},
        active(grid.x * grid.y * grid.z, 1) {
    for (std::size_t probe = 0; probe < active.size(); probe += 5) active[probe] = 0;
  }
  [[nodiscard]] Result<VolumeDesc> describe() const {
    const NamedTexture named[] = {{"irradiance", textures[0].desc}, {"distance", textures[1].desc}};
    return probe_volume(named);
  }

  VolumeGeometry geometry;
  std::vector<Mapped> textures;
  std::vector<std::uint8_t> active;  ///< 0: inside a wall, never sent
  std::uint16_t id = 0;              ///< that the server gave it
};

/// Renders some probes and hands over what changed.
Status update(Server& server, Volume& volume, std::span<const std::uint32_t> probes,
              unsigned frame) {
  for (std::uint8_t t = 0; t < volume.textures.size(); ++t) {
    render(volume.textures[t], probes, frame);
    const Status status = server.publish(volume.id, t, volume.textures[t].view(), probes);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

std::vector<std::uint32_t> probes_of_turn(const Volume& volume, unsigned frame) {
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = frame % kParts; probe < volume.active.size(); probe += kParts) {
    if (volume.active[probe] != 0) probes.push_back(probe);
  }
  return probes;
}

Result<std::uint16_t> add(Server& server, const char* name, Volume& volume) {
  const auto desc = volume.describe();
  if (!desc) return desc.status();
  const auto id = server.add_volume(name, *desc, volume.geometry);
  if (!id) return id;
  volume.id = *id;
  const Status status = server.set_active(*id, volume.active);
  if (status != Status::ok) return status;
  return id;
}

/// The renderer. Its textures are mapped memory of its own, and it copies what has changed in them.
struct Viewer {
  std::optional<Client> client;
  ConnectionId connection = 0;
  std::deque<Message> up, down;
  std::map<std::uint64_t, std::vector<Mapped>> textures;  ///< by ClientVolume::instance
  std::uint64_t drawn = 0, uploads = 0;  ///< serial of the frame; boxes that were copied

  /// Once a frame of the renderer's.
  Status draw() {
    const ClientFrame& frame = client->frame();
    if (!client->consistent() || frame.serial == drawn) return Status::ok;
    std::vector<std::uint32_t> blocks;
    std::vector<UploadBox> boxes;
    for (const ClientVolume& volume : frame.volumes) {
      auto& mine = textures[volume.instance];
      const bool anew = mine.empty();
      for (std::uint8_t t = 0; t < volume.textures.size(); ++t) {
        const ClientTexture& texture = volume.textures[t];
        if (anew) mine.emplace_back(texture.desc);
        const std::uint64_t drawn_serial = anew ? 0 : drawn;
        Status status = client->read(volume.id, t, drawn_serial, mine[t].view());
        if (status != Status::ok) return status;
        status = texture.changed_blocks(drawn_serial, blocks);
        if (status != Status::ok) return status;
        status = upload_boxes(texture.desc, mine[t].view(), blocks, boxes);
        if (status != Status::ok) return status;
        uploads += boxes.size();  // vkCmdCopyBufferToImage(..., boxes) goes here.
      }
    }
    drawn = frame.serial;
    return Status::ok;
  }
};

/// The network. What it loses the client notices, and asks for.
void carry(Server& server, Viewer& viewer, unsigned lost_percent, double now) {
  for (const OutgoingMessage& message : server.take_messages(viewer.connection)) {
    const bool lost = viewer.client->is_connected() && random_number() % 100 < lost_percent;
    auto arrived = message.joined();
    if (!lost && arrived) viewer.down.push_back(*std::move(arrived));
  }
  for (; !viewer.down.empty(); viewer.down.pop_front()) {
    const Status status = viewer.client->receive(viewer.down.front());
    if (status != Status::ok) std::printf("client: %s\n", to_string(status).data());
  }
  for (Message& message : viewer.client->take_messages()) {
    if (random_number() % 100 >= lost_percent) viewer.up.push_back(std::move(message));
  }
  for (; !viewer.up.empty(); viewer.up.pop_front()) {
    server.receive(viewer.connection, viewer.up.front(), now);
  }
}

/// True if all active probes are there as they were rendered.
bool equal(Viewer& viewer, Volume& volume) {
  const ClientVolume* const held = viewer.client->frame().find(volume.id);
  if (held == nullptr || !viewer.client->consistent()) return false;
  auto& textures = viewer.textures[held->instance];
  for (std::size_t t = 0; t < textures.size(); ++t) {
    for (std::uint32_t probe = 0; probe < volume.active.size(); ++probe) {
      if (volume.active[probe] == 0) continue;
      for (unsigned y = 0; y < textures[t].side(); ++y) {
        const auto a = textures[t].row(probe, y), b = volume.textures[t].row(probe, y);
        if (std::memcmp(a.data(), b.data(), a.size()) != 0) return false;
      }
    }
  }
  return !textures.empty();
}

int failed(const char* what, Status status) {
  std::printf("%s: %s\n", what, to_string(status).data());
  return 1;
}

/// A whole number from 0 to 100.
std::optional<unsigned> parse_percent(std::string_view text) {
  unsigned percent = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, percent);
  if (parsed.ec != std::errc{} || parsed.ptr != end || percent > 100) return std::nullopt;
  return percent;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<unsigned> percent = argc > 1 ? parse_percent(argv[1]) : 0U;
  if (!percent || argc > 2) {
    std::fprintf(stderr, "usage: engine [PERCENT]: of messages that are lost, 0 to 100\n");
    return 2;
  }
  const unsigned lost_percent = *percent;
  auto server =
      Server::create({.threads = 2, .interval = kInterval, .limits = {.resyncs_per_second = 30}});
  if (!server) return failed("server", server.status());
  Volume world(kGrid), cellar({4, 2, 4});
  if (const auto id = add(*server, "world", world); !id) return failed("world", id.status());

  Viewer viewers[2];
  for (Viewer& viewer : viewers) {
    const auto delivery = &viewer == &viewers[0] ? Delivery::unicast : Delivery::shared;
    auto client = Client::create({.delivery = delivery, .texels = false});
    const auto connection = server->connect(0);
    if (!client || !connection) return failed("client", client.status());
    viewer.client.emplace(*std::move(client));
    viewer.connection = *connection;
    const auto hello = viewer.client->hello();
    if (!hello) return failed("hello", hello.status());
    viewer.up.push_back(*hello);
    // It sees half of the world at first.
    std::vector<std::uint8_t> half(world.active.size(), 1);
    for (std::size_t probe = half.size() / 2; probe < half.size(); ++probe) half[probe] = 0;
    const Status status = viewer.client->subscribe(world.id, half);
    if (status != Status::ok) return failed("subscribe", status);
    for (; !viewer.up.empty(); viewer.up.pop_front()) {
      server->receive(viewer.connection, viewer.up.front(), 0);
    }
  }

  const std::vector<std::uint8_t> all(world.active.size(), 1);
  double now = 0;
  for (unsigned frame = 0; frame < 2 * kFrames; ++frame, now += kInterval) {
    const bool moving = frame < kFrames;  // Then nothing changes, so that all can catch up.
    if (moving) {
      // The volume follows the camera; cells that enter are rendered, whoever's turn it is.
      const Scroll before = server->geometry(world.id)->scroll;
      const Scroll scroll =
          scroll_to(world.geometry, {12.0F + 0.1F * static_cast<float>(frame), 4, 12});
      Status status = server->scroll(world.id, scroll);
      if (status != Status::ok) return failed("scroll", status);
      const auto entered = entering_blocks(kGrid, before, scroll);
      status = update(*server, world, entered, frame);
      if (status == Status::ok)
        status = update(*server, world, probes_of_turn(world, frame), frame);
      if (status != Status::ok) return failed("world", status);
      if (frame == 20) {
        if (const auto id = add(*server, "cellar", cellar); !id)
          return failed("cellar", id.status());
      }
      if (frame >= 20 && frame < 60) {
        status = update(*server, cellar, probes_of_turn(cellar, frame), frame);
        if (status != Status::ok) return failed("cellar", status);
      }
      if (frame == 60 && server->remove_volume(cellar.id) != Status::ok) return 1;
      if (frame == 70) {
        for (Viewer& viewer : viewers) {
          if (viewer.client->subscribe(world.id, all) != Status::ok) return 1;
        }
      }
    } else if (frame % 8 == 0) {
      // A wish that got lost is not asked for; over a transport that keeps order nothing is.
      for (Viewer& viewer : viewers) {
        if (viewer.client->is_connected()) (void)viewer.client->subscribe(world.id, all);
      }
    }
    const Status made = server->update(now, now);
    if (made != Status::ok) return failed("update", made);
    for (Viewer& viewer : viewers) {
      carry(*server, viewer, moving ? lost_percent : 0, now);
      const Status drawn = viewer.draw();
      if (drawn != Status::ok) return failed("draw", drawn);
    }
  }
  bool right = true;
  for (Viewer& viewer : viewers) {
    const bool same = equal(viewer, world) && viewer.client->frame().volumes.size() == 1;
    const ClientStatistics& s = viewer.client->statistics();
    std::printf("%s: %llu updates, %llu gaps, %llu bytes, %llu boxes uploaded, texels %s\n",
                &viewer == &viewers[0] ? "unicast" : "shared",
                static_cast<unsigned long long>(s.messages),
                static_cast<unsigned long long>(s.gaps), static_cast<unsigned long long>(s.bytes),
                static_cast<unsigned long long>(viewer.uploads), same ? "equal" : "DIFFER");
    right = right && same;
  }
  return right ? 0 : 1;
}
