// Sessions that have seen updates like those to come allocate nothing for them. On several threads
// chance decides whose memory has to grow: here one after the other does the work.
#include "allocation_counter.h"
#include "base/parallel.h"
#include "native/content.h"
#include "shapes.h"

#include <gicodec/probes.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

constexpr Executor kOneByOne{
    [](void*, unsigned count, void (*work)(void*, unsigned) noexcept, void* context) {
      for (unsigned i = 0; i < count; ++i) work(context, i);
    }};

const Coding kPresets[] = {{"native", 0, true, "fast"}, {"native", 0, true, "strong"}};
const Coding kSteadyCodings[] = {
    kPresets[0], kPresets[1], {"raw", 0, true}, {"lz4", 1, true}, {"zstd", 3, true}};

/// Probes, bricks and pools; blocks of one record and of many, of all records and of some; one
/// chunk and several.
std::vector<TextureDesc> shapes() {
  TextureDesc pool = pool_texture(Format::R16G16B16A16_SFLOAT, 90, {4, 3, 2});
  TextureDesc masked = pool_texture(Format::R16_UNORM, 60, {4, 4, 4});
  masked.presence = Presence::mask;
  TextureDesc counted = pool_texture(Format::R8G8B8A8_UNORM, 60, {9, 3, 1});
  counted.presence = Presence::count;
  TextureDesc apart = probe_texture(Format::R8G8_UNORM, {5, 4, 3}, 7, 0);
  apart.model = Model::none;
  return {ddgi_irradiance({5, 4, 4}),
          ddgi_visibility({3, 3, 3}),
          bricks(),
          pool,
          masked,
          counted,
          apart,
          probe_texture(Format::R16_SFLOAT, {12, 12, 10}, 1, 0),
          probe_texture(Format::R16G16_SFLOAT, {12, 12, 10}, 1, 0),
          probe_texture(Format::R32G32B32A32_SFLOAT, {3, 3, 2}, 5, 1),
          probe_texture(Format::E5B9G9R9_UFLOAT_PACK32, {4, 1, 1}, 64, 0)};
}

/// Blocks of an update: all, some, a few, one, none.
std::vector<std::vector<std::uint32_t>> selections(const TextureDesc& desc) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const std::uint32_t step : {1U, 3U, block_count(desc) / 8 + 1, block_count(desc)}) {
    auto& blocks = all.emplace_back();
    for (std::uint32_t b = 0; b < block_count(desc); b += step) blocks.push_back(b);
  }
  all.emplace_back();
  return all;
}

/// What `round` allocates when it is run again.
template <typename Round>
std::size_t allocations_of(const Round& round) {
  round();
  const std::size_t before = heap_allocations();
  round();
  return heap_allocations() - before;
}

const Backend& native_backend() {
  for (const Backend* backend : built_in_backends()) {
    if (backend->id() == kBackendNative) return *backend;
  }
  std::abort();
}

TEST(SteadyState, TheNativeBackendAllocatesNothing) {
  for (const auto& desc : shapes()) {
    ASSERT_EQ(validate(desc), Status::ok) << desc;
    for (const auto& coding : kPresets) {
      BackendSettings settings;
      settings.preset = coding.preset;
      auto encoder = *native_backend().make_encoder(desc, settings);
      auto decoder = *native_backend().make_decoder(desc);
      std::vector<UpdateCase> updates;
      for (const Content content : {Content::smooth, Content::noisy, Content::white}) {
        for (const bool keyframe : {true, false}) {
          for (const std::uint32_t one_in : {1U, 20U}) {
            updates.push_back(make_update(desc, content, keyframe, one_in, 7));
          }
        }
      }
      std::vector<Bytes> payloads(updates.size());
      Bytes out(block_count(desc) * block_bytes(desc));
      bool sound = true;
      const std::size_t encoding = allocations_of([&] {
        for (std::size_t i = 0; i < updates.size(); ++i) {
          payloads[i].clear();
          sound &= encoder->encode(updates[i].encode_job(), payloads[i]) == Status::ok;
        }
      });
      const std::size_t decoding = allocations_of([&] {
        for (std::size_t i = 0; i < updates.size(); ++i) {
          const UpdateCase& u = updates[i];
          const auto records = std::span(out).first(u.records.size());
          sound &= decoder->check(desc, u.blocks.size(), payloads[i]) == Status::ok &&
                   decoder->decode(u.decode_job(payloads[i], records)) == Status::ok;
        }
      });
      EXPECT_TRUE(sound) << desc;
      EXPECT_EQ(encoding, 0U) << desc << " " << coding.preset;
      EXPECT_EQ(decoding, 0U) << desc << " " << coding.preset;
    }
  }
}

TEST(SteadyState, SessionsAllocateNothing) {
  for (const auto& desc : shapes()) {
    for (const auto& coding : kSteadyCodings) {
      const Threads threads{coding.level % 2 == 0 ? 3U : 1U, kOneByOne};
      std::vector<std::unique_ptr<Texture>> frames;
      Random random(91);
      for (int frame = 0; frame < 2; ++frame) {
        auto& texture = *frames.emplace_back(std::make_unique<Texture>(desc));
        for (std::uint32_t block = 0; block < block_count(desc); ++block) {
          texture.fill_block(block, Fill::small, random);
          if (block % 9 != 0) texture.fill_band(block);  // Others do not follow the rule.
        }
      }
      EncoderOptions options = options_of(coding);
      options.settings.threads = threads;
      auto encoder = *Encoder::create(desc, options);
      auto decoder = *Decoder::create(desc, {.threads = threads});
      const Bytes presence = any_presence(random, desc);
      ASSERT_EQ(encoder.set_presence(presence), Status::ok);
      ASSERT_EQ(decoder.set_presence(presence), Status::ok);
      Texture out(desc);
      Packet packet;
      std::size_t encoding = 0, decoding = 0;
      bool sound = true;
      const auto chosen = selections(desc);
      const auto update = [&](const Texture& frame, Selection selection) {
        const std::size_t start = heap_allocations();
        sound &= encoder.encode_to(frame.view(), selection, packet) == Status::ok;
        const std::size_t encoded = heap_allocations();
        sound &= decoder.decode(packet, out.view()) == Status::ok;
        encoding += encoded - start;
        decoding += heap_allocations() - encoded;
      };
      for (int round = 0; round < 4; ++round) {
        encoding = decoding = 0;  // The last round counts.
        for (const auto& frame : frames) {
          update(*frame, Selection::changed());
          update(*frame, Selection::all());
          for (const auto& blocks : chosen) update(*frame, blocks);
          encoder.request_keyframe();
        }
      }
      EXPECT_TRUE(sound) << desc;
      EXPECT_EQ(encoding, 0U) << desc << " " << coding.backend << coding.preset;
      EXPECT_EQ(decoding, 0U) << desc << " " << coding.backend << coding.preset;
    }
  }
}

TEST(SteadyState, PublishingAllocatesNothing) {
  const VolumeGeometry geometry{{6, 4, 5}};
  const std::vector<NamedTexture> named{{"color", ddgi_irradiance(geometry.grid)},
                                        {"visibility", ddgi_visibility(geometry.grid)}};
  auto server = *Server::create();
  const auto volume = *server.add_volume("villa", *probe_volume(named), geometry);
  Random random(17);
  std::vector<std::unique_ptr<Texture>> frames;
  for (const int frame : {0, 1}) {
    for (const NamedTexture& texture : named) {
      frames.emplace_back(std::make_unique<Texture>(texture.desc));
      frames.back()->fill(frame == 0 ? Fill::small : Fill::noise, random);
    }
  }
  const std::vector<std::uint32_t> some{1, 7, 50};
  std::size_t publishing = 0;
  double now = 0;
  for (int round = 0; round < 4; ++round) {
    publishing = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const std::size_t before = heap_allocations();
      ASSERT_EQ(server.publish(volume, i % 2, std::as_const(*frames[i]).view()), Status::ok);
      ASSERT_EQ(server.publish(volume, i % 2, std::as_const(*frames[(i + 2) % 4]).view(), some),
                Status::ok);
      publishing += heap_allocations() - before;
      now += 0.1;
      ASSERT_EQ(server.update(now, now), Status::ok);
    }
  }
  EXPECT_EQ(publishing, 0U);
}

TEST(SteadyState, OwnThreadsTakeWorkWithoutMemory) {
  const auto work = [](unsigned, std::size_t) {};
  for_each_item(5, 100, work);  // They are started.
  EXPECT_EQ(allocations_of([&] { for_each_item(5, 100, work); }), 0U);
}

}  // namespace
}  // namespace gicodec
