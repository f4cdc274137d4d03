// A kind of an application's own, in one file: sparks. Emitters hold pages; a page is a block of up
// to 16 sparks in a pool, an emitter a block of one record that names its pages.
#include <gicodec/streaming.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <vector>

using namespace gicodec;

// 1. The records, each bit of them in one component.

static Record spark_record() {
  Record spark;
  spark.bytes = 8;
  for (const char* name : {"x", "y", "z"}) {
    spark.components[spark.count] = {name, static_cast<std::uint16_t>(16 * spark.count), 16,
                                     ComponentType::unorm};
    ++spark.count;
  }
  spark.components[spark.count++] = {"heat", 48, 16, ComponentType::sfloat};
  return spark;
}

static Record emitter_record() {
  Record emitter;
  emitter.bytes = 4;
  emitter.count = 2;
  emitter.components[0] = {"first", 0, 16, ComponentType::uint};
  emitter.components[1] = {"pages", 16, 16, ComponentType::uint};
  return emitter;
}

// 2. The texture groups. Pages have two textures that travel together: how many sparks exist, and
// the sparks.

/// An emitter names the pages from the first one on: they reach a client before it, or with it.
static std::size_t pages_of(std::span<const std::byte> emitter, std::span<std::uint32_t> out) {
  std::uint16_t range[2];
  std::memcpy(range, emitter.data(), sizeof range);
  for (std::uint32_t i = 0; i < range[1] && i < out.size(); ++i) out[i] = range[0] + i;
  return range[1];
}

static VolumeDesc spark_volume(std::uint32_t pages, std::uint32_t emitters) {
  TextureDesc sparks = pool_texture(spark_record(), pages, {16, 1, 1});
  sparks.presence = Presence::count;
  TextureGroup page_group;
  page_group.textures = {{"count", pool_texture(Format::R16_UINT, pages, {1, 1, 1})},
                         {"sparks", sparks}};
  page_group.bundled = true;
  page_group.presence = 0;
  TextureGroup emitter_group;
  emitter_group.textures = {{"emitters", pool_texture(emitter_record(), emitters, {1, 1, 1})}};
  emitter_group.depends_on = 0;
  emitter_group.dependencies = pages_of;
  return {200, {page_group, emitter_group}};
}

// 3. The row of the table: number, name, and how a volume is described to its receivers.

static Status write_sparks(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.groups.size() != 2 || volume.groups[0].textures.size() != 2) {
    return Status::invalid_description;
  }
  const std::uint32_t sizes[2] = {volume.groups[0].textures[0].desc.grid.x,
                                  volume.groups[1].textures[0].desc.grid.x};
  if (!same_but_layout(spark_volume(sizes[0], sizes[1]), volume))
    return Status::invalid_description;
  const auto bytes = std::as_bytes(std::span(sizes));
  out.insert(out.end(), bytes.begin(), bytes.end());
  return Status::ok;
}

static Result<VolumeDesc> read_sparks(std::span<const std::byte> description) {
  std::uint32_t sizes[2];
  if (description.size() != sizeof sizes) return Status::corrupt;
  std::memcpy(sizes, description.data(), sizeof sizes);
  VolumeDesc volume = spark_volume(sizes[0], sizes[1]);
  if (validate(volume) != Status::ok) return Status::corrupt;  // Descriptions may be hostile.
  return volume;
}

/// Sparks have no order: the same set of them always gives the same bytes.
static void sort_sparks(const TextureDesc& desc, std::span<std::byte> block) {
  if (!(desc.record == spark_record())) return;
  std::vector<std::uint64_t> sparks(block.size() / 8);
  std::memcpy(sparks.data(), block.data(), block.size());
  // Sparks that do not exist are zero and stay at the end.
  std::sort(sparks.begin(), sparks.end(), std::greater<>());
  std::memcpy(block.data(), sparks.data(), block.size());
}

constexpr Kind kSparks{200, "sparks", write_sparks, read_sparks, sort_sparks};

// 4. Everything else is there: servers, clients, containers, budgets, selection, proofs.

int main() {
  constexpr std::uint32_t kPages = 64, kEmitters = 8;
  const VolumeDesc volume = spark_volume(kPages, kEmitters);
  ServerOptions server_options;
  server_options.kinds = {&kSparks};
  server_options.proofs = true;
  auto server = Server::create(server_options);
  ClientOptions client_options;
  client_options.kinds = {&kSparks};
  auto client = Client::create(client_options);
  if (!server || !client) return 1;
  if (!server->add_volume("forge", volume, {{kPages, 1, 1}}).ok()) return 1;
  const auto connection = server->connect(0);
  const auto hello = client->hello();
  if (!connection || !hello) return 1;
  server->receive(*connection, *hello, 0);

  std::vector<std::uint16_t> count(kPages), emitters(2 * kEmitters);
  std::vector<std::uint64_t> sparks(kPages * 16);
  const std::vector<std::uint8_t> all(kEmitters, 1);
  const auto bytes_of = [](const auto& list) { return std::as_bytes(std::span(list)); };
  for (unsigned frame = 0; frame < 20; ++frame) {
    for (std::uint32_t page = frame % 3; page < kPages; page += 3) {
      count[page] = static_cast<std::uint16_t>((page + frame) % 17);
      for (std::uint32_t i = 0; i < 16; ++i) {
        sparks[page * 16 + i] = i < count[page] ? (page * 1000003ULL + i) * (frame + 1) : 0;
      }
      sort_sparks(volume.groups[0].textures[1].desc,
                  std::as_writable_bytes(std::span(sparks).subspan(page * 16, 16)));
    }
    for (std::uint32_t e = 0; e < kEmitters; ++e) {
      emitters[2 * e] = static_cast<std::uint16_t>(8 * e);
      emitters[2 * e + 1] = static_cast<std::uint16_t>(1 + (e + frame) % 8);
    }
    if (server->publish(0, 0, bytes_of(count)) != Status::ok ||
        server->publish(0, 1, bytes_of(sparks)) != Status::ok ||
        server->publish(0, 2, bytes_of(emitters)) != Status::ok) {
      return 1;
    }
    // The client sees emitters; their pages follow from what they name.
    if (server->set_visible(*connection, 0, {}, 0) != Status::ok ||
        server->set_visible(*connection, 0, all, 1) != Status::ok) {
      return 1;
    }
    const double now = 0.1 * (frame + 1);
    if (server->update(now, now) != Status::ok) return 1;
    for (const OutgoingMessage& message : server->take_messages(*connection)) {
      const auto whole = message.joined();
      if (!whole || client->receive(*whole) != Status::ok) return 1;
    }
    for (const Message& reply : client->take_messages())
      server->receive(*connection, reply, now + 0.01);
  }
  const auto& textures = client->frame().volumes[0].textures;
  bool equal = client->consistent() &&
               textures[2].texels ==
                   std::vector<std::byte>(bytes_of(emitters).begin(), bytes_of(emitters).end());
  for (std::uint32_t e = 0; e < kEmitters; ++e) {
    for (std::uint32_t page = emitters[2 * e]; page < emitters[2 * e] + emitters[2 * e + 1];
         ++page) {
      equal = equal &&
              std::memcmp(textures[1].texels.data() + page * 128, &sparks[page * 16], 128) == 0;
    }
  }
  std::printf("%llu updates, %llu proofs, pages and emitters %s\n",
              static_cast<unsigned long long>(client->frame().serial),
              static_cast<unsigned long long>(client->statistics().proofs),
              equal && client->statistics().failed_proofs == 0 ? "equal" : "DIFFER");
  return equal ? 0 : 1;
}
