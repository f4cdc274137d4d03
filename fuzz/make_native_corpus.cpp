// Seeds of native's payloads and round trips.
#include "bitstream/packet.h"
#include "make_corpus.h"
#include "native_settings.h"

#include <numeric>

namespace gicodec::fuzz {
namespace {

/// A description, settings, then a keyframe and an update: smooth texels and noise.
void add_native_round_trips(Corpus& corpus, std::mt19937& random) {
  for (const FormatInfo& info : formats()) {
    const auto side = static_cast<std::uint8_t>(1 + random() % 3);
    const TextureDesc desc = probe_texture(info.record, {5, 4, 3}, side, 0);
    for (const bool noisy : {false, true}) {
      Bytes seed;
      put_desc(desc, seed);
      for (int i = 0; i < 4; ++i) seed.push_back(static_cast<std::byte>(random()));
      for (const std::byte kind : {std::byte{1}, std::byte{2}}) {
        Bytes part{kind, std::byte{0}};
        for (std::size_t i = 0; i < (kind == std::byte{1} ? 600 : 50); ++i) {
          part.push_back(static_cast<std::byte>(noisy ? random() : i / 8 + random() % 2));
        }
        put_part(part, 0, seed);
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
    const TextureDesc desc = Input(seed).any_desc();
    // How many bytes say it over and over, and they.
    Bytes said(desc.presence == Presence::all ? 0 : 5);
    for (auto& byte : said) byte = static_cast<std::byte>(&byte == said.data() ? 4 : random());
    const Bytes presence = Input(said).presence(desc);
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
      if (part.size() <= kMaxPart) put_part(part, 0, payloads);
      append(pattern, std::span(texels).first(std::min<std::size_t>(size, 300)));
      put_part(pattern, 0, trips);
    }
    corpus.add("native_payload", payloads);
    corpus.add("native_round_trip", trips);
  }
}

/// Maps and 3D textures, whole or cut off at their ends, by every kind of chunk: payloads, round
/// trips.
void add_maps(Corpus& corpus, std::mt19937& random) {
  for (unsigned i = 0; i < 26; ++i) {
    constexpr std::byte kContinuous{16};
    const bool solid = i % 3 == 0;
    const Bytes seed{static_cast<std::byte>(192 + 2 * i),
                     static_cast<std::byte>((i % 4 == 1 ? 128 : 0) + i % 5),
                     std::byte{3},
                     kContinuous | (solid ? std::byte{2} : std::byte{0}),
                     static_cast<std::byte>(i % 7 == 5 ? 32 : 0),
                     static_cast<std::byte>(7 + 8 * (3 + i % 5))};
    const TextureDesc desc = Input(seed).any_desc();
    const Bytes said(desc.presence == Presence::all ? 0 : 1);  // no bytes over and over: all exist
    const Bytes presence = Input(said).presence(desc);
    const std::size_t block = block_bytes(desc), size = block * block_count(desc);
    std::vector<std::uint32_t> blocks(block_count(desc));
    std::iota(blocks.begin(), blocks.end(), 0U);
    for (const std::uint8_t kind : kChunkKinds) {
      Bytes payloads = seed, trips = seed;
      payloads.insert(payloads.end(), said.begin(), said.end());
      trips.insert(trips.end(), said.begin(), said.end());
      trips.push_back(static_cast<std::byte>(kind));
      for (int k = 0; k < 3; ++k) trips.push_back(std::byte{0});
      Bytes records(size), mirror(size);
      const std::vector<std::uint8_t> received(blocks.size(), 1);
      for (int frame = 0; frame < 2; ++frame) {
        for (std::size_t at = 0; at < size; ++at) {
          const std::size_t place = at / desc.record.bytes;
          if (frame == 0 || place % 8 == 5) {
            const std::size_t value = 40 + place / 32 % 8 + at % desc.record.bytes + frame;
            records[at] = static_cast<std::byte>(value + (random() % 8 == 0 ? 1 : 0));
          }
        }
        Bytes part{std::byte{frame == 0}, std::byte{0}};
        Bytes pattern = part;
        native::PayloadMemory memory;
        const EncodeJob job{.desc = desc,
                            .blocks = blocks,
                            .records = {records.data(), block},
                            .mirror = {{mirror.data(), block}, received.data(), {}},
                            .keyframe = frame == 0,
                            .presence = presence};
        native::encode_payload(job, native_settings(kind), best_isa(), memory, part);
        if (part.size() <= kMaxPart) put_part(part, 0, payloads);
        append(pattern, std::span(records).first(std::min<std::size_t>(size, 400)));
        put_part(pattern, 0, trips);
        mirror = records;
      }
      corpus.add("native_payload", payloads);
      corpus.add("native_round_trip", trips);
    }
  }
}

}  // namespace

void add_native(Corpus& corpus, std::mt19937& random) {
  add_native_round_trips(corpus, random);
  add_partial(corpus, random);
  add_maps(corpus, random);
}

}  // namespace gicodec::fuzz
