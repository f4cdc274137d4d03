// Irradiance vectors: closed forms, and the container that they go into.
#include "ddgi/volume_container.h"
#include "rooms.h"

#include <gicodec/container.h>
#include <gicodec/decoder.h>
#include <gicodec/io.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace gicodec::ddgi {
namespace {

using test::busy_room;
using test::room;
using test::Traced;

constexpr std::array<Vec3, 6> kAxes = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

// Light that is the same from everywhere: the vector over a hemisphere is its axis times that.
TEST(Vectors, EvenLightGivesTheAxes) {
  for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
    for (const VectorForm form : {VectorForm::quantised, VectorForm::floats}) {
      Traced traced(room({4, 3, 5}, 0, 0.25F),
                    {.mode = mode, .rays = 2048, .forms = {.vectors = form}});
      for (int i = 0; i < 3; ++i) traced.volume.update(0);
      const VectorTextures& t = traced.volume.textures().vectors;
      ASSERT_EQ(t.direction.size(), 60U * 6 * (form == VectorForm::floats ? 12 : 3));
      for (std::size_t i = 0; i < std::size_t{60} * 6; ++i) {
        Vec3 d, c;
        if (form == VectorForm::floats) {
          std::memcpy(&d, &t.direction[12 * i], sizeof d);
          std::memcpy(&c, &t.color[12 * i], sizeof c);
        } else {
          const auto axis = [&](std::size_t k) {
            return static_cast<float>(static_cast<std::int8_t>(t.direction[3 * i + k])) / 127.0F;
          };
          d = {axis(0), axis(1), axis(2)};
          std::uint32_t bits = 0;
          std::memcpy(&bits, &t.color[4 * i], sizeof bits);
          c = from_shared_exponent(bits);
        }
        EXPECT_GT(dot(d, kAxes[i % 6]), 0.99F) << i;
        EXPECT_NEAR(c.x, 0.25F, 0.01F) << i;
        EXPECT_NEAR(c.z, 0.25F, 0.01F) << i;
      }
    }
  }
}

// All six come from the same rays, so both hemispheres of each axis hold all light.
TEST(Vectors, OppositeHemispheresAddUpToTheSame) {
  Traced traced(busy_room(), {.rays = 256, .forms = {.vectors = VectorForm::floats}});
  traced.volume.update(1);
  const VectorTextures& t = traced.volume.textures().vectors;
  for (const std::uint32_t probe : traced.volume.active_probes()) {
    std::array<Vec3, 3> sum{};
    for (std::size_t h = 0; h < 6; ++h) {
      Vec3 d, c;
      std::memcpy(&d, &t.direction[12 * (6 * probe + h)], sizeof d);
      std::memcpy(&c, &t.color[12 * (6 * probe + h)], sizeof c);
      sum[h / 2] += d * (c.x + c.y + c.z);
    }
    EXPECT_LT(length(sum[0] - sum[1]), 1e-4F + 1e-3F * length(sum[0])) << probe;
    EXPECT_LT(length(sum[0] - sum[2]), 1e-4F + 1e-3F * length(sum[0])) << probe;
  }
}

TEST(Vectors, TheContainerHoldsEveryFrame) {
  Traced traced(busy_room(), {.rays = 32, .forms = {.vectors = VectorForm::quantised}});
  VolumeContainer container(traced.volume.textures().vectors.volume, "vectors",
                            traced.volume.shape(), "room", "vectors.gic");
  std::vector<VectorTextures> frames;
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    traced.volume.update(static_cast<double>(frame));
    frames.push_back(traced.volume.textures().vectors);
    container.add(frame, texels_of(frames.back()));
  }
  EXPECT_FALSE(frames[0] == frames[1]);
  const auto bytes = container.finish();
  MemorySource source(bytes);
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->description().textures.size(), 2U);
  EXPECT_EQ(reader->description().textures[0].name, "direction");
  ASSERT_TRUE(reader->description().volumes[0].geometry);
  std::vector<Decoder> decoders;
  std::array<std::vector<std::byte>, 2> texels{frames[0].direction, frames[0].color};
  for (std::uint8_t id = 0; id < 2; ++id) {
    std::fill(texels[id].begin(), texels[id].end(), std::byte{});
    auto decoder = Decoder::create(reader->description().textures[id].desc);
    ASSERT_TRUE(decoder);
    decoders.push_back(*std::move(decoder));
  }
  ContainerPacket packet;
  std::size_t packets = 0;
  std::vector<std::uint32_t> blocks;
  while (reader->next(packet) == Status::ok) {
    auto& into = texels[packet.texture_id];
    ASSERT_EQ(decoders[packet.texture_id].decode(packet.bytes, TextureView{into}), Status::ok);
    const VectorTextures& expected = frames[packet.frame];
    EXPECT_EQ(into, packet.texture_id == 0 ? expected.direction : expected.color);
    // A block travels in both.
    const auto updated = decoders[packet.texture_id].updated();
    if (packet.texture_id == 0) {
      blocks.assign(updated.begin(), updated.end());
    } else {
      EXPECT_EQ(std::vector<std::uint32_t>(updated.begin(), updated.end()), blocks);
    }
    ++packets;
  }
  EXPECT_EQ(packets, 6U);
  EXPECT_TRUE(reader->finished());
}

}  // namespace
}  // namespace gicodec::ddgi
