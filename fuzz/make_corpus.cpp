// Writes seeds for every fuzz target: make_corpus FOLDER SESSIONS gives FOLDER/NAME/seed-N, with
// the recorded sessions of tests/session/golden. The corpora in the repository were grown from
// these, with NEW and GROWN as work folders:
//   script/fuzz NAME SECONDS GROWN FOLDER/NAME
//   fuzz_NAME -set_cover_merge=1 -use_counters=0 -max_len=4096 NEW FOLDER/NAME GROWN
#include "make_corpus.h"

#include "bitstream/container_format.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "memory_sink.h"

#include <gicodec/streaming.h>
#ifdef GICODEC_HEVC
#include "backend/hevc/payload.h"
#include "hevc_setup.h"
#endif

#include <numeric>

namespace {

using namespace gicodec;
using fuzz::append;
using fuzz::Bytes;
using fuzz::Corpus;

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
  write_index_part({{{300, 900, 0, 0, true}, {300, 950, 1, 1, true}, {301, 1000, 7, 2, false}},
                    {{1, 1}, {2, 1}},
                    0,
                    {{100, 40, 0, {}}, {200, 99, 2, {{1, 1}}}, {400, 50, 7, {}}, {460, 33, 7, {}}}},
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
  fuzz::add_native(corpus, random);
  add_transforms(corpus, random);
  fuzz::add_streams(corpus, argv[2]);
#ifdef GICODEC_HEVC
  add_hevc(corpus);
#endif
  return 0;
}