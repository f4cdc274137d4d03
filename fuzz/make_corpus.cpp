// Writes seeds for every fuzz target: make_corpus FOLDER SESSIONS gives FOLDER/NAME/seed-N, with
// the recorded sessions of tests/session/golden. The corpora in the repository were grown from
// these, with NEW and GROWN as work folders:
//   script/fuzz NAME SECONDS GROWN FOLDER/NAME
//   fuzz_NAME -set_cover_merge=1 -use_counters=0 -max_len=4096 NEW FOLDER/NAME GROWN
#include "bitstream/container_format.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "input.h"
#include "memory_sink.h"
#include "messages.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/streaming.h>
#ifdef GICODEC_HEVC
#include "backend/hevc/payload.h"
#include "hevc_setup.h"
#endif

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <random>
#include <string>

namespace {

using namespace gicodec;
using Bytes = std::vector<std::byte>;

class Corpus {
 public:
  explicit Corpus(std::filesystem::path root) : root_(std::move(root)) {}
  void add(const std::string& target, const Bytes& bytes) {
    const auto folder = root_ / target;
    std::filesystem::create_directories(folder);
    const auto name = "seed-" + std::to_string(++count_);
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

 private:
  std::filesystem::path root_;
  int count_ = 0;
};

void append(Bytes& to, std::span<const std::byte> more) {
  to.reserve(to.size() + more.size());
  to.insert(to.end(), more.begin(), more.end());
}
void append_u16(Bytes& to, std::size_t value) {
  to.push_back(static_cast<std::byte>(value));
  to.push_back(static_cast<std::byte>(value >> 8));
}

/// Packets of a texture with smooth blocks, some changes per frame and stale guard bands; none if
/// the backend does not code it.
std::vector<Packet> make_packets(const TextureDesc& desc, std::string_view backend,
                                 std::mt19937& random) {
  EncoderOptions options;
  options.backend = backend;
  options.gop = 3;
  auto encoder = Encoder::create(desc, options);
  std::vector<Packet> packets;
  if (!encoder) return packets;
  Bytes texels(texture_bytes(desc));
  for (int frame = 0; frame < 4; ++frame) {
    for (std::size_t i = 0; i < texels.size(); ++i) {
      if (frame == 0 || random() % 7 == 0)
        texels[i] = static_cast<std::byte>(i / 16 + random() % 3);
    }
    std::vector<std::uint32_t> some;
    for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
      if (random() % 2 == 0) some.push_back(probe);
    }
    auto packet = encoder->encode(ConstTextureView(texels),
                                  frame % 2 == 0 ? Selection::all() : Selection(some));
    if (packet) packets.push_back(*std::move(packet));
  }
  return packets;
}

/// The packets of a session as intra ones and as they are, in turn.
void add_fresh(Corpus& corpus, const TextureDesc& desc, const std::vector<Packet>& packets) {
  for (const std::byte choice : {std::byte{0}, std::byte{3}}) {
    Bytes session;
    fuzz::put_desc(desc, session);
    session.push_back(choice);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      fuzz::put_part(packets[i], i % 3 == 1 ? 3 : 0, session);
    }
    corpus.add("intra", session);
  }
}

/// The packets of a session; a decoder that joins by a snapshot, with intra updates.
void add_joining(Corpus& corpus, const TextureDesc& desc, const std::vector<Packet>& packets) {
  Bytes session;
  fuzz::put_desc(desc, session);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const auto parts = *parse_packet(packets[i]);
    PacketHead head{.info = parts.info,
                    .index_mode = parts.index_mode,
                    .base = parts.base,
                    .stands_for = parts.stands_for};
    if (i == 0) head.info.type = PacketType::snapshot;
    head.stands_for = 0x12345678;
    if (i != 0 && is_keyframe(head.info.type)) {
      head.info.type = PacketType::intra;
      head.info.reference = head.info.sequence - 1;
    }
    Bytes packet;
    write_packet_head(head, parts.index, parts.guard_bands, packet);
    append(packet, parts.payload);
    seal_packet(packet);
    fuzz::put_part(packet, 0, session);
    corpus.add("peek", packet);
  }
  corpus.add("packet", session);
}

/// A volume of the texture, and one of a kind that is not known.
ContainerDescription describe(const TextureDesc& desc) {
  ContainerDescription description;
  const NamedTexture texture{"t", desc, {}, {}};
  (void)add_volume(description, "v", *probe_volume(std::span(&texture, 1)));
  description.volumes[0].geometry = {desc.grid, {1, 2, 3}, {1, 0.5F, 1}, {0, -1, 2}};
  description.textures[0].metadata = {{"a", "b"}};
  TextureEntry unknown;
  unknown.name = "u";
  unknown.volume = 1;
  description.textures.push_back(unknown);
  VolumeEntry future;
  future.kind = 77;
  future.description = Bytes(3, std::byte{9});
  future.region = {2, 1, 1};
  future.first_texture = future.textures = 1;
  description.volumes.push_back(future);
  description.scene = {"s", 7};
  description.epoch = 3;
  description.metadata = {{"c", ""}};
  return description;
}

void add_regions(Corpus& corpus, const TextureDesc& desc, std::string_view backend,
                 std::mt19937& random);

void add_packets(Corpus& corpus, const TextureDesc& desc, std::string_view backend,
                 std::mt19937& random) {
  const auto packets = make_packets(desc, backend, random);
  if (packets.empty()) return;
  Bytes session, payloads;
  fuzz::put_desc(desc, session);
  fuzz::put_desc(desc, payloads);
  test::MemorySink sink;
  const ContainerDescription description = describe(desc);
  auto writer = ContainerWriter::create(sink, description);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    corpus.add("peek", packets[i]);
    fuzz::put_part(packets[i], 0, session);
    (void)writer->add(i, packets[i]);

    const auto parts = *parse_packet(packets[i]);
    Vector<std::uint32_t> probes;
    (void)decode_index_buffer(parts.index_mode,
                              parts.info.all_blocks ? block_count(desc) : parts.info.blocks,
                              block_count(desc), parts.index, probes);
    Bytes head;
    head.push_back(std::byte{is_keyframe(parts.info.type)});
    fuzz::put_blocks(desc, probes, head);
    if (!parts.guard_bands.empty()) {
      Bytes section;
      fuzz::put_desc(desc, section);
      append(section, head);
      append(section, parts.guard_bands);
      corpus.add("guard_band_section", section);
    }
    append(head, parts.payload);
    fuzz::put_part(head, 0, payloads);
    if (backend == "native" && parts.payload.size() > 1 && parts.payload[0] >> 4 == std::byte{0}) {
      // Without a box, a directory or steps the only chunk comes next.
      Bytes chunk{session[0]};
      append(chunk, parts.payload.subspan(1));
      corpus.add("native_chunk_head", chunk);
    }
  }
  (void)writer->finish();
  corpus.add(backend == "native" ? "native_payload" : "payload_" + std::string(backend), payloads);
  corpus.add("packet", session);
  add_fresh(corpus, desc, packets);
  add_joining(corpus, desc, packets);
  corpus.add("container", sink.bytes);
  Bytes body{std::byte{0}};
  Bytes bytes;
  (void)write_description(description, {}, bytes);
  append(body, bytes);
  corpus.add("description", body);
  add_regions(corpus, desc, backend, random);
}

/// A container of a volume that is cut, with index parts between its packets.
void add_regions(Corpus& corpus, const TextureDesc& desc, std::string_view backend,
                 std::mt19937& random) {
  ContainerDescription description = describe(desc);
  const Grid region{2, 1, 1};
  description.volumes[0].region = region;
  test::MemorySink sink;
  auto writer = ContainerWriter::create(sink, description);
  (void)writer->add_metadata(0, {{"attribute@1:a", "string b"}, {"attribute@2:a", "string c"}});
  const std::uint32_t regions = std::min(regions_of(desc, region).regions(), 3U);
  std::vector<std::vector<Packet>> packets;
  for (std::uint32_t i = 0; i < regions; ++i) {
    packets.push_back(make_packets(region_texture(desc, region, i), backend, random));
  }
  for (std::size_t frame = 0; frame < 4; ++frame) {
    for (std::uint32_t i = 0; i < regions; ++i) {
      if (frame < packets[i].size()) (void)writer->add(frame, packets[i][frame], i);
    }
    if (frame == 1) (void)writer->flush();
  }
  (void)writer->finish();
  corpus.add("container", sink.bytes);
}

/// Texels for the targets that take them as they stand, and an index.
void add_transforms(Corpus& corpus, std::mt19937& random) {
  for (const char* target : {"yuv444p16", "yuv444p8", "byte_planes", "blocks", "hevc_picture"}) {
    for (int i = 0; i < 24; ++i) {
      Bytes seed(20 + random() % 400);
      for (auto& byte : seed) byte = static_cast<std::byte>(random());
      corpus.add(target, seed);
    }
  }
  Bytes index{std::byte{1}};
  Bytes part;
  write_index_part(
      std::vector<SeekEntry>{{0, 40, 0, 0, true}, {0, 90, 1, 1, true}, {300, 1000, 7, 2, false}}, 0,
      0x3FFFFFFF, part);
  append(index, part);
  corpus.add("description", index);
}

void add_index_buffers(Corpus& corpus, std::mt19937& random) {
  for (const std::uint32_t total : {1U, 7U, 64U, 900U}) {
    for (const std::uint32_t keep : {1U, 2U, 5U, 40U}) {
      std::vector<std::uint32_t> probes;
      std::uint32_t run = 0;
      for (std::uint32_t i = 0; i < total; ++i) {
        if (run == 0 && random() % keep == 0) run = 1 + static_cast<std::uint32_t>(random() % 4);
        if (run > 0) {
          probes.push_back(i);
          --run;
        }
      }
      Bytes buffer, seed;
      const auto mode = encode_index_buffer(probes, total, buffer);
      seed.push_back(static_cast<std::byte>(mode));
      append_u16(seed, total - 1);
      append_u16(seed, probes.size());
      append(seed, buffer);
      corpus.add("index_buffer", seed);
    }
  }
}

/// A description, settings, then a keyframe and an update: smooth texels and noise.
void add_native_round_trips(Corpus& corpus, std::mt19937& random) {
  for (const FormatInfo& info : formats()) {
    const auto side = static_cast<std::uint8_t>(1 + random() % 3);
    const TextureDesc desc = probe_texture(info.record, {5, 4, 3}, side, 0);
    for (const bool noisy : {false, true}) {
      Bytes seed;
      fuzz::put_desc(desc, seed);
      for (int i = 0; i < 4; ++i) seed.push_back(static_cast<std::byte>(random()));
      for (const std::byte kind : {std::byte{1}, std::byte{2}}) {
        Bytes part{kind, std::byte{0}};
        for (std::size_t i = 0; i < (kind == std::byte{1} ? 600 : 50); ++i) {
          part.push_back(static_cast<std::byte>(noisy ? random() : i / 8 + random() % 2));
        }
        fuzz::put_part(part, 0, seed);
      }
      corpus.add("native_round_trip", seed);
    }
  }
}

/// Blocks in pools some records of which exist, and records of many planes: payloads, round trips.
void add_partial(Corpus& corpus, std::mt19937& random) {
  for (unsigned i = 0; i < 12; ++i) {
    // Counted, masked, whole or a set; of the application's own records and presets.
    const Bytes seed{static_cast<std::byte>(192 + 2 * i + i / 3 % 2),
                     static_cast<std::byte>(i),
                     std::byte{2},
                     static_cast<std::byte>(i % 2 == 0 ? 1 : 33),
                     static_cast<std::byte>(1 + 16 * (i % 3)),
                     static_cast<std::byte>(random())};
    const TextureDesc desc = fuzz::Input(seed).any_desc();
    // How many bytes say it over and over, and they.
    Bytes said(desc.presence == Presence::all ? 0 : 5);
    for (auto& byte : said) byte = static_cast<std::byte>(&byte == said.data() ? 4 : random());
    const Bytes presence = fuzz::Input(said).presence(desc);
    const auto size = static_cast<std::size_t>(texture_bytes(desc));
    Bytes payloads = seed, trips = seed, texels(size);
    append(payloads, said);
    append(trips, said);
    for (int k = 0; k < 4; ++k) trips.push_back(static_cast<std::byte>(random()));
    auto encoder = *Encoder::create(desc, {.backend = "native"});
    (void)encoder.set_presence(presence);
    for (int frame = 0; frame < 2; ++frame) {
      for (auto& byte : texels) {
        if (frame == 0 || random() % 8 == 0)
          byte = static_cast<std::byte>(frame * 3 + random() % 4);
      }
      const auto packet = *encoder.encode(ConstTextureView(texels), Selection::all());
      Bytes part{std::byte{frame == 0}, std::byte{0}};
      Bytes pattern = part;
      append(part, parse_packet(packet)->payload);
      if (part.size() <= fuzz::kMaxPart) fuzz::put_part(part, 0, payloads);
      append(pattern, std::span(texels).first(std::min<std::size_t>(size, 300)));
      fuzz::put_part(pattern, 0, trips);
    }
    corpus.add("native_payload", payloads);
    corpus.add("native_round_trip", trips);
  }
}

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
          fuzz::put_part(message, 0, session);
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
        fuzz::put_part(message, 0, session);
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
      fuzz::put_part(message, 0, replied);
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
        fuzz::put_part(message, 0, said);
        (void)client.receive(message);
      }
      for (const Message& message : client.take_messages()) reply(connection, message, update);
    }
    corpus.add("client", said);
    corpus.add("session", said);
    corpus.add("session", replied);
  }
}

#ifdef GICODEC_HEVC
/// Payloads, and the access units in them for every format of picture.
void add_hevc(Corpus& corpus) {
  for (unsigned choice = 0; choice < fuzz::kHevcSetups; ++choice) {
    const auto setup = fuzz::make_hevc_setup(choice);
    Bytes payloads{static_cast<std::byte>(choice)}, units, packets = payloads;
    for (unsigned k = 0; k < 2; ++k) fuzz::put_part(fuzz::packet_of(setup, k), 0, packets);
    corpus.add("hevc_packet", packets);
    for (const auto& update : setup.updates) {
      Bytes part{std::byte{&update == setup.updates}};
      fuzz::put_blocks(setup.desc, update.blocks, part);
      append(part, update.payload);
      fuzz::put_part(part, 0, payloads);
      const auto payload = hevc::read_payload(update.payload);
      fuzz::put_part(payload->access_unit, 0, units);
    }
    corpus.add("hevc_decode", payloads);
    for (unsigned format = 0; format < 9 && (choice & 4) == 0; ++format) {
      Bytes seed{static_cast<std::byte>(format)};
      append(seed, units);
      corpus.add("hevc_access_unit", seed);
    }
  }
}
#endif

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  Corpus corpus(argv[1]);
  std::mt19937 random(1);
  for (const auto* backend : built_in_backends()) {
    for (const auto& info : formats()) {
      const auto side = static_cast<std::uint8_t>(1 + random() % 5);
      const auto guard_band = static_cast<std::uint8_t>(random() % 3 != 0);
      const auto tiling = static_cast<Tiling>(random() % kTilingCount);
      const TextureDesc desc = probe_texture(info.record, {3, 2, 1}, side, guard_band, tiling);
      add_packets(corpus, desc, backend->name(), random);
      const TextureDesc many = probe_texture(info.record, {6, 5, 4}, 1, 1, Tiling::slices_xz_y);
      add_packets(corpus, many, backend->name(), random);
    }
  }
  add_index_buffers(corpus, random);
  for (int i = 0; i < 24; ++i) {
    Bytes seed(40 + random() % 200);
    for (auto& byte : seed) byte = static_cast<std::byte>(random() % (i % 2 == 0 ? 256 : 12));
    corpus.add("round_trip", seed);
  }
  add_native_round_trips(corpus, random);
  add_partial(corpus, random);
  add_transforms(corpus, random);
  add_sessions(corpus, argv[2]);
  add_clients(corpus);
  add_changing_volumes(corpus);
#ifdef GICODEC_HEVC
  add_hevc(corpus);
#endif
  return 0;
}
