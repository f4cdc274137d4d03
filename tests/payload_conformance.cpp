#include "payload_conformance.h"
#include "bitstream/description.h"
#include "messages.h"

#include <map>

namespace gicodec::test {
namespace {

constexpr const Kind* kKinds[] = {&kScenes};

std::uint32_t below(Generator& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(random() % n);
}

/// Exactly the bytes: what reads beyond is seen.
std::vector<std::byte> exact(std::span<const std::byte> bytes) {
  std::vector<std::byte> copy(bytes.begin(), bytes.end());
  copy.shrink_to_fit();
  return copy;
}

/// What a block holds, as a decoder gives it: absent records and those beyond the end are zero.
std::vector<std::byte> records_of(const TextureDesc& desc, std::span<const std::byte> texture,
                                  std::span<const std::byte> presence) {
  EncoderOptions options;
  options.backend = "raw";
  auto encoder = *Encoder::create(desc, options);
  auto decoder = *Decoder::create(desc);
  if (!presence.empty()) {
    (void)encoder.set_presence(presence);
    (void)decoder.set_presence(presence);
  }
  const auto packet = *encoder.encode(texture, Selection::all());
  if (decoder.decode(packet) != Status::ok) return {};
  return {decoder.records().begin(), decoder.records().end()};
}

}  // namespace

Contents blank(const VolumeDesc& volume) {
  Contents contents;
  for (const NamedTexture* texture : textures_of(volume)) {
    contents.emplace_back(static_cast<std::size_t>(texture_bytes(texture->desc)));
  }
  return contents;
}

void change(const VolumeDesc& volume, Contents& contents, Generator& random) {
  for (std::vector<std::byte>& texture : contents) {
    const std::size_t changes = random() % 3 == 0 ? 0 : random() % (1 + texture.size() / 8);
    for (std::size_t i = 0; i < changes; ++i) {
      texture[random() % texture.size()] = static_cast<std::byte>(random() % 5 * 17);
    }
  }
  // Blocks have no more records than their shape.
  std::size_t first = 0;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      if (texture.desc.presence != Presence::count) continue;
      std::vector<std::byte>& counts = contents[first + group.presence];
      for (std::size_t at = 0; at + 1 < counts.size(); at += 2) {
        std::uint16_t count = 0;
        std::memcpy(&count, counts.data() + at, sizeof count);
        count = static_cast<std::uint16_t>(count % (record_count(texture.desc.block) + 1));
        std::memcpy(counts.data() + at, &count, sizeof count);
      }
    }
    first += group.textures.size();
  }
  if (volume.kind != kKindScenes) return;
  // Lights name bricks that there are.
  std::vector<std::byte>& lights = contents.back();
  for (std::size_t at = 0; at < lights.size(); at += 8) {
    const auto brick = below(random, block_count(volume.groups[0].textures[0].desc));
    std::memcpy(lights.data() + at, &brick, sizeof brick);
  }
}

std::span<const std::byte> presence_of(const VolumeDesc& volume, const Contents& contents,
                                       std::size_t texture) {
  const auto [group, first] = group_of(volume, static_cast<std::uint8_t>(texture));
  const TextureDesc& desc = group->textures[texture - first].desc;
  if (desc.presence == Presence::all) return {};
  return contents[first + group->presence];
}

std::string check_description(const Row& row) {
  const Kind* kind = find_kind(row.volume.kind, kKinds);
  if (kind == nullptr) return "the kind is not known";
  if (validate(row.volume) != Status::ok) return "the volume is not valid";
  std::vector<std::byte> bytes;
  if (kind->write(row.volume, bytes) != Status::ok) return "it cannot be described";
  const auto back = kind->read(exact(bytes));
  if (!back || !same_but_layout(*back, row.volume)) return "its description reads otherwise";
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    if (kind->read(exact(std::span(bytes).first(size))).ok()) return "a cut description is read";
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto other = bytes;
    other[bit / 8] ^= std::byte(1U << bit % 8);
    const auto read = kind->read(other);
    if (!read) continue;
    if (validate(*read) != Status::ok) return "a description gives a volume that is not valid";
    std::vector<std::byte> again;
    if (kind->write(*read, again) != Status::ok || again != other) {
      return "a description has two forms";
    }
  }
  return {};
}

std::string check_codec(const VolumeDesc& volume, std::size_t texture, const Backend& backend,
                        Generator& random) {
  const NamedTexture& named = *textures_of(volume)[texture];
  EncoderOptions options;
  options.backend = backend.name();
  options.backends = {&backend};
  auto made = Encoder::create(named.desc, options);
  if (made.status() == Status::unsupported_shape || made.status() == Status::unsupported_format) {
    return "unsupported";
  }
  DecoderOptions decoder_options;
  decoder_options.backends = {&backend};
  auto decoder = Decoder::create(named.desc, decoder_options);
  if (!made || !decoder) return "no encoder or decoder";
  Encoder& encoder = *made;
  Contents contents = blank(volume);
  std::vector<std::byte> shown(contents[texture].size());
  for (unsigned update = 0; update < 4; ++update) {
    change(volume, contents, random);
    const auto presence = presence_of(volume, contents, texture);
    if (!presence.empty() && encoder.set_presence(presence) != Status::ok) return "no presence";
    const bool all = update == 0 || random() % 3 == 0;
    const auto packet = encoder.encode(std::span<const std::byte>(contents[texture]),
                                       all ? Selection::all() : Selection::changed());
    if (!packet) return "an update is not coded";
    if (packet->size() > encoder.bound(block_count(named.desc))) return "a packet beyond its bound";
    if (!presence.empty() && decoder->set_presence(presence) != Status::ok) return "no presence";
    const auto before = decoder->state_hash();
    for (std::size_t size = 0; size < packet->size(); ++size) {
      if (decoder->decode(exact(std::span(*packet).first(size))) == Status::ok)
        return "a cut packet";
    }
    for (std::size_t at = 0; at < packet->size(); ++at) {
      auto other = exact(*packet);
      other[at] ^= std::byte(1U << random() % 8);
      if (decoder->decode(other) == Status::ok) return "a damaged packet is applied";
    }
    if (decoder->state_hash() != before) return "a refused packet changes something";
    if (decoder->decode(*packet, TextureView{shown}) != Status::ok) return "a packet is refused";
    if (std::vector<std::byte>(decoder->records().begin(), decoder->records().end()) !=
        records_of(named.desc, contents[texture], presence)) {
      return "other records";
    }
  }
  const auto received = decoder->received();
  if (std::find(received.begin(), received.end(), 0) != received.end()) return "not all received";
  return {};
}

std::string check_volume(const VolumeDesc& volume, const Backend& backend, Generator& random) {
  auto encoder = VolumeEncoder::create(volume, {.backend = backend.name(), .backends = {&backend}});
  if (encoder.status() == Status::unsupported_shape ||
      encoder.status() == Status::unsupported_format) {
    return "unsupported";
  }
  auto decoder = VolumeDecoder::create(volume, {.backends = {&backend}});
  if (!encoder || !decoder) return "no encoder or decoder";
  const auto textures = textures_of(volume);
  Contents contents = blank(volume), shown = contents;
  for (unsigned update = 0; update < 5; ++update) {
    change(volume, contents, random);
    if (update == 3) encoder->request_keyframe();
    const std::vector<ConstTextureView> views(contents.begin(), contents.end());
    const auto packets =
        encoder->encode(views, update == 0 ? Selection::all() : Selection::changed());
    if (!packets || packets->size() != textures.size()) return "an update is not coded";
    if (decoder->decode(*packets) != Status::ok) return "an update is refused";
    for (std::uint8_t t = 0; t < textures.size(); ++t) {
      const auto presence = presence_of(volume, contents, t);
      const auto held = decoder->decoder(t)->records();
      if (std::vector<std::byte>(held.begin(), held.end()) !=
          records_of(textures[t]->desc, contents[t], presence)) {
        return "other records of " + textures[t]->name;
      }
      if (decoder->read(t, TextureView{shown[t]}, decoder->changed(t)) != Status::ok) {
        return "what changed is not read";
      }
      std::vector<std::byte> whole(shown[t].size()), sent(shown[t].size());
      if (decoder->read(t, TextureView{whole}) != Status::ok ||
          encoder->read(t, TextureView{sent}) != Status::ok || whole != shown[t] || whole != sent) {
        return "other contents of " + textures[t]->name;
      }
      const auto [group, first] = group_of(volume, t);
      // Not std::ranges::equal(), which the libc++ of Emscripten lacks.
      const auto changed = decoder->changed(t), other = decoder->changed(first);
      bool alike = changed.size() == other.size();
      for (std::size_t i = 0; alike && i < other.size(); ++i) alike = changed[i] == other[i];
      if (group->bundled && !alike) {
        return "blocks of " + textures[t]->name + " travel alone";
      }
    }
  }
  const auto again = *encoder->snapshot();
  auto late = *VolumeDecoder::create(volume, {.backends = {&backend}});
  if (late.decode(again) != Status::ok) return "a snapshot is refused";
  for (std::uint8_t t = 0; t < textures.size(); ++t) {
    if (late.decoder(t)->state_hash() != decoder->decoder(t)->state_hash()) return "another state";
  }
  return {};
}

/// Every record exists.
std::vector<std::byte> presence_of_all(const TextureDesc& desc) {
  const std::uint32_t records = record_count(desc.block);
  std::vector<std::byte> presence;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (desc.presence == Presence::count) {
      for (const unsigned shift : {0U, 8U}) presence.push_back(std::byte(records >> shift));
    } else if (desc.presence == Presence::mask) {
      presence.resize(presence.size() + records / 8, std::byte{0xFF});
      if (records % 8 != 0) presence.push_back(std::byte((1U << records % 8) - 1));
    } else if (desc.presence == Presence::brick) {
      presence.resize(presence.size() + 8, std::byte{0});
      presence.resize(presence.size() + records / kVoxelDirections / 8, std::byte{0xFF});
    }
  }
  return presence;
}

std::string check_container(const Row& row, Generator& random) {
  struct Writer final : Sink {
    std::vector<std::byte> bytes;
    Status write(std::span<const std::byte> more) override {
      bytes.insert(bytes.end(), more.begin(), more.end());
      return Status::ok;
    }
  } sink;
  ContainerDescription description;
  if (add_volume(description, "volume", row.volume, kKinds) != Status::ok) return "not added";
  const Grid size{2, 2, 1};
  description.volumes[0].region = size;
  const auto textures = textures_of(row.volume);
  std::map<std::pair<std::size_t, std::uint32_t>, std::vector<std::vector<std::byte>>> packets;
  {
    auto writer = ContainerWriter::create(sink, description, kKinds);
    if (!writer) return "no container";
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
      for (std::size_t t = 0; t < textures.size(); ++t) {
        const RegionGrid regions = regions_of(textures[t]->desc, size);
        for (std::uint32_t region = 0; region < regions.regions(); ++region) {
          const TextureDesc part = region_texture(textures[t]->desc, size, region);
          EncoderOptions options;
          options.backend = "lz4";
          options.texture_id = static_cast<std::uint8_t>(t);
          auto encoder = *Encoder::create(part, options);
          if (encoder.set_presence(presence_of_all(part)) != Status::ok) return "no presence";
          std::vector<std::byte> contents(static_cast<std::size_t>(texture_bytes(part)));
          for (std::byte& byte : contents) byte = static_cast<std::byte>(random() % 3);
          const auto packet = *encoder.encode(std::span<const std::byte>(contents));
          if (writer->add(frame, packet, region) != Status::ok) return "a packet is not added";
          packets[{t, region}].push_back(packet);
        }
      }
    }
    if (writer->finish() != Status::ok) return "not finished";
  }
  MemorySource source(sink.bytes);
  auto reader = ContainerReader::open(source, {}, kKinds);
  if (!reader) return "not opened";
  if (!same_but_layout(reader->description().volumes[0].desc, row.volume)) return "other volume";
  const auto read_all = [&] {
    std::map<std::pair<std::size_t, std::uint32_t>, std::vector<std::vector<std::byte>>> found;
    for (ContainerPacket packet; reader->next(packet) == Status::ok;) {
      found[{packet.texture_id, packet.region}].push_back(packet.bytes);
    }
    return found;
  };
  if (read_all() != packets) return "other packets";
  const TextureRegion corner{static_cast<std::uint8_t>(textures.size() - 1), 0};
  if (reader->select(std::span(&corner, 1)) != Status::ok || reader->seek(0) != Status::ok) {
    return "no selection";
  }
  const std::pair<std::size_t, std::uint32_t> key{corner.texture_id, corner.region};
  if (read_all() != decltype(packets){{key, packets[key]}}) return "other packets of a region";
  MemorySource again(sink.bytes);
  const auto unknown = ContainerReader::open(again);
  if (!unknown) return "an unknown kind closes the file";
  return {};
}

std::string compare(const VolumeDesc& volume, const Contents& contents, const ClientVolume& shown) {
  const auto textures = textures_of(volume);
  for (std::size_t t = 0; t < textures.size(); ++t) {
    const ClientTexture& texture = shown.textures[t];
    const auto presence = presence_of(volume, contents, t);
    if (records_of(textures[t]->desc, texture.texels, presence) !=
        records_of(textures[t]->desc, contents[t], presence)) {
      return "other contents of " + textures[t]->name;
    }
    if (std::find(texture.changed.begin(), texture.changed.end(), 0U) != texture.changed.end()) {
      return "blocks of " + textures[t]->name + " never came";
    }
  }
  return {};
}

std::string check_session(const Row& row, const Backend& backend, Delivery delivery,
                          unsigned lost_one_in, Generator& random) {
  ServerOptions options;
  options.region = {2, 2, 1};
  options.backend = backend.name();
  options.backends = {&backend};
  options.kinds = {&kScenes};
  options.proofs = true;
  options.limits.resyncs_per_second = 1e6;
  auto server = Server::create(options);
  ClientOptions client_options;
  client_options.kinds = {&kScenes};
  client_options.delivery = delivery;
  client_options.backends = {&backend};
  auto client = Client::create(client_options);
  const auto textures = textures_of(row.volume);
  if (!server || !client) return "no session";
  const auto added = server->add_volume("volume", row.volume, {textures[0]->desc.grid});
  if (added.status() == Status::unsupported_shape || added.status() == Status::unsupported_format) {
    return "unsupported";
  }
  if (!added) return "the volume is not added";
  const auto connection = *server->connect(0);
  server->receive(connection, *client->hello(), 0);
  Contents contents = blank(row.volume);
  constexpr unsigned kLossy = 30, kUpdates = 60;
  for (unsigned update = 0; update < kUpdates; ++update) {
    const double now = 0.1 * (update + 1);
    if (update < kLossy) change(row.volume, contents, random);
    for (std::uint8_t t = 0; t < textures.size(); ++t) {
      if (server->publish(0, t, std::span<const std::byte>(contents[t])) != Status::ok)
        return "not published";
    }
    if (!server->client(connection)) return "the connection was dropped";
    if (server->update(now, now) != Status::ok) return "no update";
    const bool lossy = update < kLossy && lost_one_in != 0;
    for (const Message& message : joined(server->take_messages(connection))) {
      // The first one is the Welcome, which a transport does not lose.
      if (lossy && update > 0 && random() % lost_one_in == 0) continue;
      if (client->receive(message) != Status::ok) return "a message is refused";
    }
    for (const Message& reply : client->take_messages())
      server->receive(connection, reply, now + 0.02);
  }
  if (!client->consistent()) return "inconsistent in the end";
  if (client->statistics().failed_proofs != 0) return "another state than the server's";
  return compare(row.volume, contents, client->frame().volumes[0]);
}

}  // namespace gicodec::test
