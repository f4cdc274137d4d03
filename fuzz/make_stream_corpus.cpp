// Seeds of messages, sessions and clients.
#include "make_corpus.h"
#include "messages.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/streaming.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>

#include <iterator>
#include <map>

namespace gicodec::fuzz {
namespace {

/// Messages of recorded sessions, one by one and all of a side together.
void add_sessions(Corpus& corpus, const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".session") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto bytes = std::as_bytes(std::span(text));
    for (const std::byte side : {std::byte{0}, std::byte{1}}) {
      Bytes session(1, std::byte{entry.path().filename().string().starts_with("shared")});
      for (std::size_t at = 0; at < bytes.size();) {
        std::uint32_t size = 0;
        std::memcpy(&size, bytes.data() + at + 1, sizeof size);
        const auto message = bytes.subspan(at + 5, size);
        if (bytes[at] == side && size < 1024) {
          corpus.add("message", Bytes(message.begin(), message.end()));
          put_part(message, 0, session);
        }
        at += 5 + size;
      }
      corpus.add("session", session);
      if (side == std::byte{1}) corpus.add("client", session);
    }
  }
}

/// What a server says to a client of large volumes in which little changes.
void add_clients(Corpus& corpus) {
  constexpr Grid kGrid{16, 8, 16};
  const std::vector<NamedTexture> probes{
      {"color", probe_texture(Format::A2B10G10R10_UNORM_PACK32, kGrid, 8)},
      {"vis", probe_texture(Format::R16G16_SFLOAT, kGrid, 16, 1, Tiling::slices_xz_y)}};
  const std::pair<const char*, VolumeDesc> cases[] = {{"native", *probe_volume(probes)},
                                                      {"zstd", *probe_volume(probes)},
                                                      {"lz4", *irradiance_vector_volume(kGrid)}};
  for (const auto& [backend, volume] : cases) {
    const auto& textures = volume.groups[0].textures;
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      auto server = *Server::create({.backend = backend, .proofs = true});
      (void)server.add_volume("v", volume, {kGrid});
      auto client = *Client::create({.delivery = delivery});
      const ConnectionId connection = *server.connect(0);
      server.receive(connection, *client.hello(), 0);
      BlockMask some(block_count(textures[0].desc));
      const std::size_t step = delivery == Delivery::shared ? 1100 : 300;
      for (std::size_t i = 0; i < some.size(); i += step) some[i] = 1;
      Message subscribe;
      (void)write_message(Subscribe{1, 0, 0, some}, subscribe);
      server.receive(connection, subscribe, 0);
      Bytes session{std::byte{delivery == Delivery::shared}};
      for (int update = 1; update <= 4; ++update) {
        if (update == 3) (void)server.scroll(0, {1, 0, 0});
        for (std::uint8_t t = 0; t < textures.size(); ++t) {
          const Bytes texels(texture_bytes(textures[t].desc), static_cast<std::byte>(update * 21));
          (void)server.publish(0, t, ConstTextureView{texels});
        }
        (void)server.update(update, update);
      }
      for (const Message& message : joined(server.take_messages(connection)))
        put_part(message, 0, session);
      corpus.add("client", session);
    }
  }
}

/// A session in which volumes come and go, one of them under the number of one that went.
void add_changing_volumes(Corpus& corpus) {
  constexpr Grid kGrid{3, 2, 2};
  const NamedTexture texture{"t", probe_texture(Format::R16_SFLOAT, kGrid, 2), {}, {}};
  const VolumeDesc probes = *probe_volume({&texture, 1}),
                   vectors = *irradiance_vector_volume(kGrid);
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    auto server = *Server::create({.backend = "raw", .proofs = true});
    auto client = *Client::create({.delivery = delivery});
    std::map<std::uint16_t, const VolumeDesc*> there;
    const auto add = [&](const char* name, const VolumeDesc& volume) {
      there[*server.add_volume(name, volume, {kGrid})] = &volume;
    };
    const auto remove = [&](std::uint16_t number) {
      (void)server.remove_volume(number);
      there.erase(number);
    };
    Bytes said{std::byte{delivery == Delivery::shared}}, replied = said;
    const auto reply = [&](ConnectionId connection, const Message& message, double now) {
      corpus.add("message", Bytes(message.begin(), message.end()));
      put_part(message, 0, replied);
      server.receive(connection, message, now);
    };
    add("near", probes);
    const ConnectionId connection = *server.connect(0);
    reply(connection, *client.hello(), 0);
    for (int update = 1; update <= 8; ++update) {
      if (update == 3) add("vectors", vectors);
      if (update == 5) remove(0);
      if (update == 6) add("far", probes);
      if (update == 7) remove(1);
      for (const auto& [number, volume] : there) {
        for (std::uint8_t t = 0; t < volume->groups[0].textures.size(); ++t) {
          const Bytes texels(texture_bytes(volume->groups[0].textures[t].desc),
                             static_cast<std::byte>(update * 21));
          (void)server.publish(number, t, ConstTextureView{texels});
        }
        (void)client.subscribe(number, BlockMask(block_count(texture.desc), 1));
      }
      (void)server.update(update, update);
      for (const Message& message : joined(server.take_messages(connection))) {
        corpus.add("message", Bytes(message.begin(), message.end()));
        put_part(message, 0, said);
        (void)client.receive(message);
      }
      for (const Message& message : client.take_messages()) reply(connection, message, update);
    }
    corpus.add("client", said);
    corpus.add("session", said);
    corpus.add("session", replied);
  }
}

/// What a publisher says of a volume that changes a little, or of one that comes.
void add_tracks(Corpus& corpus) {
  constexpr Grid kGrid{6, 2, 3};
  const std::vector<NamedTexture> probes{{"color", probe_texture(Format::R16_SFLOAT, kGrid, 2)},
                                         {"vis", probe_texture(Format::R16G16_SFLOAT, kGrid, 2)}};
  const std::pair<const char*, VolumeDesc> cases[] = {{"native", *probe_volume(probes)},
                                                      {"raw", *irradiance_vector_volume(kGrid)}};
  for (const auto& [backend, volume] : cases) {
    auto server =
        *Server::create({.backend = backend, .region = {2, 2, 3}, .epoch = 7, .proofs = true});
    (void)server.add_volume("v", volume, {kGrid});
    auto publisher = *TrackPublisher::create(server, {.snapshot_seconds = 3});
    Bytes said;
    for (int update = 1; update <= 9; ++update) {
      for (std::uint8_t t = 0; t < volume.groups[0].textures.size(); ++t) {
        Bytes texels(texture_bytes(volume.groups[0].textures[t].desc), std::byte{1});
        texels[static_cast<std::size_t>(update * 37) % texels.size()] = std::byte{9};
        (void)server.publish(0, t, ConstTextureView{texels});
      }
      if (update == 6) (void)server.add_volume("w", volume, {kGrid});
      (void)publisher.update(update, update);
      for (const TrackMessage& message : publisher.messages()) {
        corpus.add("message", Bytes(message.bytes.begin(), message.bytes.end()));
        put_part(message.bytes, 0, said);
      }
    }
    corpus.add("tracks", said);
    // Backwards.
    Bytes reverse;
    for (int update = 0; update < 3; ++update) {
      for (auto it = publisher.messages().rbegin(); it != publisher.messages().rend(); ++it)
        put_part(it->bytes, 0, reverse);
    }
    corpus.add("tracks", reverse);
  }
}

}  // namespace

void add_streams(Corpus& corpus, const std::filesystem::path& folder) {
  add_sessions(corpus, folder);
  add_clients(corpus);
  add_changing_volumes(corpus);
  add_tracks(corpus);
}

}  // namespace gicodec::fuzz
