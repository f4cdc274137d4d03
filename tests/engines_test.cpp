// Engines' volumes: each through every backend, a container and a session, on a synthetic volume;
// where their texels stand, and how their probes are numbered.
#include "engine_grids.h"
#include "payload_conformance.h"
#include "support.h"

#include <gicodec/engines.h>
#include <gicodec/gicodec.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>
#include <string>

namespace gicodec::test {
namespace {

VolumeDesc volume_of(const EngineLayout& row) {
  auto volume = row.make(engine_grid(row.unit));
  EXPECT_TRUE(volume.ok()) << row.name;
  return *std::move(volume);
}

/// Waves that differ between components and move from frame to frame, some texels of any bits: NaNs
/// with payloads, negative zeros, codes that no light has.
Bytes synthetic(const TextureDesc& desc, unsigned frame, Random& random) {
  Bytes texels(static_cast<std::size_t>(texture_bytes(desc)));
  const std::uint64_t width = extent(desc).width;
  for (std::size_t i = 0; i < texels.size() / desc.record.bytes; ++i) {
    std::byte* const texel = texels.data() + i * desc.record.bytes;
    if (random() % 16 == 0) {
      const std::uint64_t any = random();
      std::memcpy(texel, &any, std::min<std::size_t>(desc.record.bytes, sizeof any));
      continue;
    }
    const double x = static_cast<double>(i % width), y = static_cast<double>(i / width);
    unsigned place = 0;
    for (const Component& component : desc.record.used()) {
      const double wave = 0.5 + 0.4 * std::sin(0.3 * x + 0.2 * y + place++ + 0.1 * frame);
      const auto code = static_cast<std::uint64_t>(wave * std::ldexp(1.0, component.bits));
      std::uint64_t word = 0;
      const std::size_t at = component.offset / 32 * 4;
      const std::size_t size = std::min<std::size_t>(4, desc.record.bytes - at);
      std::memcpy(&word, texel + at, size);
      word |= code << component.offset % 32;
      std::memcpy(texel + at, &word, size);
    }
  }
  return texels;
}

/// Bits of records: what stands between them in a pool that is not full is nobody's.
Bytes records_of(const TextureDesc& desc, const Bytes& texels) {
  auto encoder = *Encoder::create(desc, {.backend = "raw"});
  auto decoder = *Decoder::create(desc);
  const auto packet = *encoder.encode(std::span<const std::byte>(texels), Selection::all());
  EXPECT_EQ(decoder.decode(packet), Status::ok);
  return {decoder.records().begin(), decoder.records().end()};
}

TEST(Engines, NamesOccurOnceAndAreFound) {
  std::set<std::string_view> names;
  for (const EngineLayout& row : engine_layouts()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(find_engine_layout(row.name), &row);
    EXPECT_FALSE(row.summary.empty());
    EXPECT_LE(row.summary.size(), 60U) << row.name;
  }
  EXPECT_GE(names.size(), 15U);
  EXPECT_EQ(find_engine_layout("unknown"), nullptr);
  EXPECT_EQ(find_engine_layout(""), nullptr);
}

TEST(Engines, DescriptionsAreExactAndSafe) {
  for (const EngineLayout& row : engine_layouts()) {
    EXPECT_EQ(check_description({std::string(row.name), volume_of(row)}), "") << row.name;
  }
}

TEST(Engines, EveryBackendIsExact) {
  Random random(1);
  for (const EngineLayout& row : engine_layouts()) {
    const VolumeDesc volume = volume_of(row);
    for (const NamedTexture* texture : textures_of(volume)) {
      for (const Backend* backend : built_in_backends()) {
        const std::string what =
            std::string(row.name) + ", " + texture->name + ", " + std::string(backend->name());
        EncoderOptions options;
        options.backend = backend->name();
        auto encoder = Encoder::create(texture->desc, options);
        auto decoder = Decoder::create(texture->desc);
        ASSERT_TRUE(encoder.ok() && decoder.ok()) << what;
        Bytes shown(static_cast<std::size_t>(texture_bytes(texture->desc)));
        for (unsigned frame = 0; frame < 3; ++frame) {
          const Bytes texels = synthetic(texture->desc, frame, random);
          const auto packet = encoder->encode(std::span<const std::byte>(texels),
                                              frame == 0 ? Selection::all() : Selection::changed());
          ASSERT_TRUE(packet.ok()) << what;
          ASSERT_EQ(decoder->decode(*packet, TextureView{shown}), Status::ok) << what;
          EXPECT_EQ(records_of(texture->desc, shown), records_of(texture->desc, texels)) << what;
          const bool free_slots =
              texture->desc.space == Space::pool &&
              texels.size() != block_bytes(texture->desc) * block_count(texture->desc);
          if (free_slots) continue;
          EXPECT_TRUE(same(shown, texels)) << what << ", in memory";
        }
      }
    }
  }
}

TEST(Engines, ContainersHoldThem) {
  Generator random(2);
  for (const EngineLayout& row : engine_layouts()) {
    EXPECT_EQ(check_container({std::string(row.name), volume_of(row)}, random), "") << row.name;
  }
}

TEST(Engines, SessionsCarryThem) {
  Generator random(3);
  for (const EngineLayout& row : engine_layouts()) {
    const Row volume{std::string(row.name), volume_of(row)};
    for (const Backend* backend : built_in_backends()) {
      if (backend->name() != "native") continue;
      EXPECT_EQ(check_session(volume, *backend, Delivery::unicast, 0, random), "") << row.name;
    }
  }
}

TEST(Engines, RefuseGridsThatAreNone) {
  for (const EngineLayout& row : engine_layouts()) {
    for (const Grid grid : {Grid{0, 1, 1}, Grid{1, 0, 1}, Grid{1, 1, 0},
                            Grid{1U << 30, 1U << 30, 4}, Grid{UINT32_MAX, UINT32_MAX, UINT32_MAX},
                            Grid{1, UINT32_MAX, 1}, Grid{1, 1, UINT32_MAX}}) {
      EXPECT_EQ(row.make(grid).status(), Status::invalid_description) << row.name << grid.x;
    }
  }
  EXPECT_EQ(flax_volume({2, 2, 2}, 0).status(), Status::invalid_description);
  EXPECT_EQ(flax_volume({2, 2, 2}, UINT32_MAX).status(), Status::invalid_description);
  RtxgiOptions options;
  options.axes = static_cast<RtxgiAxes>(3);
  EXPECT_EQ(rtxgi_volume({2, 2, 2}, options).status(), Status::invalid_description);
  EXPECT_EQ(rtxgi_atlas_data_volume({2, 2, 2}, options.axes).status(), Status::invalid_description);
  EXPECT_EQ(rtxgi_atlas_data_volume({0, 2, 2}, RtxgiAxes::y_up).status(),
            Status::invalid_description);
  EXPECT_EQ(rtxgi_atlas_data_volume({2, 2, 2}, RtxgiAxes::y_up, Format::UNDEFINED).status(),
            Status::unsupported_format);
  options = {.irradiance = Format::UNDEFINED};
  EXPECT_EQ(rtxgi_volume({2, 2, 2}, options).status(), Status::unsupported_format);
  EXPECT_EQ(three_volume({4, 4, 1}, Format::UNDEFINED).status(), Status::unsupported_format);
  EXPECT_EQ(godot_lightmap_volume({4, 4, 1}, {.format = Format::UNDEFINED}).status(),
            Status::unsupported_format);
}

const TextureDesc& texture_of(const VolumeDesc& volume, std::size_t group, std::size_t texture) {
  return volume.groups[group].textures[texture].desc;
}

/// RTXGI's texel of a probe: tile (x, y) of slice z of its arrays, by the probe's index.
TEST(Engines, RtxgiProbesStandWhereItsShadersLookForThem) {
  const Grid n{3, 4, 5};
  struct Case {
    RtxgiAxes axes;
    std::uint32_t first, second, planes;  ///< probes along a row and a column of a plane
  };
  for (const Case& c : {Case{RtxgiAxes::y_up, n.x, n.z, n.y},
                        {RtxgiAxes::left_z_up, n.y, n.x, n.z},
                        {RtxgiAxes::right_z_up, n.x, n.y, n.z}}) {
    const auto arrays = *rtxgi_volume(n, {.axes = c.axes});
    const auto atlases = *rtxgi_volume(n, {.axes = c.axes, .arrays = false});
    const auto data = *rtxgi_atlas_data_volume(n, c.axes);
    EXPECT_EQ(extent(texture_of(data, 0, 0)), (Extent{c.first * c.planes, c.second, 1}));
    std::set<std::uint32_t> blocks;
    for (std::uint32_t probe = 0; probe < 60; ++probe) {
      const std::uint32_t block = block_of_rtxgi_probe(n, c.axes, probe);
      EXPECT_EQ(rtxgi_probe_of_block(n, c.axes, block), probe);
      blocks.insert(block);
      const std::uint32_t x = probe % c.first, y = probe / c.first % c.second;
      const std::uint32_t plane = probe / (c.first * c.second);
      for (const std::size_t texture : {0U, 1U, 2U}) {
        const std::uint32_t tile = texture == 0 ? 8 : texture == 1 ? 16 : 1;
        const BlockOrigin at = block_origin(texture_of(arrays, 0, texture), block);
        EXPECT_EQ(at.x, x * tile);
        EXPECT_EQ(at.y, y * tile);
        EXPECT_EQ(at.slice, plane);
        if (texture == 2) continue;
        const BlockOrigin in_atlas = block_origin(texture_of(atlases, 0, texture), block);
        EXPECT_EQ(in_atlas.x, (x + plane * c.first) * tile);
        EXPECT_EQ(in_atlas.y, y * tile);
      }
    }
    EXPECT_EQ(blocks.size(), 60U);
  }
}

TEST(Engines, ListsOfRtxgiProbesBecomeListsOfBlocks) {
  const Grid n{3, 4, 5};
  // Index x + nx·(z + nz·y): probes (2, 0, 0), (0, 0, 1) and (1, 3, 4).
  const std::uint32_t list[] = {2, 3, 1 + 3 * (4 + 5 * 3), 2};
  const auto blocks = blocks_of_rtxgi_probes(n, RtxgiAxes::y_up, list);
  ASSERT_TRUE(blocks.ok());
  EXPECT_EQ(*blocks, (std::vector<std::uint32_t>{2, 12, 1 + 3 * (3 + 4 * 4)}));
  const std::uint32_t beyond[] = {60};
  EXPECT_EQ(blocks_of_rtxgi_probes(n, RtxgiAxes::y_up, beyond).status(),
            Status::block_out_of_range);
  EXPECT_EQ(blocks_of_rtxgi_probes({0, 1, 1}, RtxgiAxes::y_up, {}).status(),
            Status::invalid_argument);
  EXPECT_EQ(blocks_of_rtxgi_probes(n, static_cast<RtxgiAxes>(3), {}).status(),
            Status::invalid_argument);

  std::vector<std::uint8_t> active(60, 0);
  for (const std::uint32_t probe : list) active[probe] = 1;
  const auto mask = block_mask_of_rtxgi_probes(n, RtxgiAxes::y_up, active);
  ASSERT_TRUE(mask.ok());
  for (std::uint32_t block = 0; block < 60; ++block) {
    EXPECT_EQ((*mask)[block] != 0, std::ranges::find(*blocks, block) != blocks->end()) << block;
  }
  active.pop_back();
  EXPECT_EQ(block_mask_of_rtxgi_probes(n, RtxgiAxes::y_up, active).status(), Status::mask_mismatch);
}

TEST(Engines, FlaxStacksItsCascades) {
  const Grid n{3, 4, 5};
  const auto volume = *flax_volume(n, 4);
  const TextureDesc& irradiance = texture_of(volume, 0, 0);
  EXPECT_EQ(extent(irradiance), (Extent{8 * 12, 8 * 20, 1}));
  for (std::uint32_t cascade = 0; cascade < 4; ++cascade) {
    for (std::uint32_t probe = 0; probe < 60; ++probe) {
      const std::uint32_t block = block_of_rtxgi_probe(n, RtxgiAxes::y_up, probe) + cascade * 60;
      const BlockOrigin at = block_origin(irradiance, block);
      EXPECT_EQ(at.x, 8 * (probe % 3 + probe / 15 * 3));
      EXPECT_EQ(at.y, 8 * (probe / 3 % 5 + cascade * 5));
    }
  }
}

TEST(Engines, BricksFillTheirTexturesAsTheEnginesDo) {
  const auto extent_of = [](const Result<VolumeDesc>& volume, std::size_t group) {
    return extent(texture_of(*volume, group, 0));
  };
  EXPECT_EQ(extent_of(unity_apv_volume(128), 0), (Extent{512, 4, 4}));
  EXPECT_EQ(extent_of(unity_apv_volume(128 * 1024), 0), (Extent{2048, 1024, 4}));
  EXPECT_EQ(extent_of(unity_apv_volume(512 * 512 + 128), 1), (Extent{2048, 2048, 8}));
  EXPECT_EQ(extent_of(unreal_lightmap_volume({3, 2, 1}, 5), 0), (Extent{25, 5, 5}));
  EXPECT_EQ(extent_of(unreal_lightmap_volume({3, 2, 1}, 257), 0), (Extent{1280, 10, 5}));
  EXPECT_EQ(extent_of(unreal_lightmap_volume({3, 2, 1}, 257), 1), (Extent{3, 2, 1}));
  EXPECT_EQ(extent_of(bevy_volume({7, 5, 3}), 0), (Extent{7, 10, 9}));
  EXPECT_EQ(extent_of(three_volume({7, 5, 3}), 0), (Extent{7, 5, 35}));
  EXPECT_EQ(extent_of(godot_lightmap_volume({19, 11, 2}), 0), (Extent{19, 11, 8}));
  const auto compressed =
      godot_lightmap_volume({19, 11, 2}, {.shadowmask = true, .format = Format::BC6H_UFLOAT_BLOCK});
  EXPECT_EQ(extent_of(compressed, 0), (Extent{5, 3, 8}));
  EXPECT_EQ(extent_of(compressed, 1), (Extent{19, 11, 2}));
}

TEST(Textures, AreCutIntoBlocks) {
  const auto map = [](Grid records, BlockShape block) {
    return map_texture(Format::R8_UNORM, records, block);
  };
  EXPECT_EQ(map({16, 8, 3}, {8, 8, 1}).grid, (Grid{2, 1, 3}));
  EXPECT_EQ(map({16, 8, 3}, {8, 8, 1}).records, Grid{});
  EXPECT_EQ(map({17, 8, 3}, {8, 8, 2}).grid, (Grid{3, 1, 2}));
  EXPECT_EQ(map({17, 8, 3}, {8, 8, 2}).records, (Grid{17, 8, 3}));
  EXPECT_EQ(extent(map({17, 8, 3}, {8, 8, 2})), (Extent{17, 8, 3}));
  // No larger than the texture.
  EXPECT_EQ(map({5, 1, 1}, {8, 8, 2}).block, (BlockShape{5, 1, 1}));
  for (const Grid none : {Grid{0, 1, 1}, Grid{1, 0, 1}, Grid{1, 1, 0}, Grid{UINT32_MAX, 1, 1}}) {
    EXPECT_EQ(validate(map(none, {8, 8, 8})), Status::invalid_description);
  }
  EXPECT_EQ(validate(map({8, 8, 8}, {8, 0, 8})), Status::invalid_description);
  EXPECT_EQ(validate(brick_texture(Format::R8_UNORM, 9, {4, 4, 4}, {2, 2, 2})),
            Status::invalid_description);
}

TEST(Textures, TheirDescriptionIsAsTheFormatSays) {
  TextureGroup map, bricks;
  map.textures = {{"a", map_texture(Format::R8_UNORM, {9, 8, 1}, {8, 8, 1}), Threshold::exact,
                   Preview::distance}};
  bricks.bundled = true;
  bricks.textures = {{"bc", brick_texture(Format::R16_SFLOAT, 300, {5, 4, 3}, {300, 1, 1})}};
  const auto volume = texture_volume(std::array{map, bricks});
  ASSERT_TRUE(volume.ok());
  std::vector<std::byte> bytes;
  ASSERT_EQ(kTextures.write(*volume, bytes), Status::ok);
  const std::uint8_t expected[] = {
      2,                                                 // groups
      0, 1,                                              // not together, one texture
      1, 'a', 9,                                         // name, R8_UNORM
      8, 8,   1,   0,  0, 2,    1, 1, 9, 8, 1, 0, 2,     // block to presence, continuous
      1, 2,                                              // exact, distance
      1, 1,                                              // together, one texture
      2, 'b', 'c', 76,                                   // name, R16_SFLOAT
      5, 4,   3,   0,  1, 0xAC, 2, 1, 1, 0, 0, 0, 0, 0,  // a pool of 300, no model
      0, 0};                                             // components, no preview
  const auto said = std::as_bytes(std::span(expected));
  EXPECT_EQ(bytes, (Bytes{said.begin(), said.end()}));
}

TEST(Textures, RefuseWhatTheyCannotSay) {
  const NamedTexture counts{"counts", pool_texture(Format::R16_UINT, 3, {1, 1, 1})};
  NamedTexture counted{"counted", pool_texture(Format::R8_UNORM, 3, {4, 1, 1})};
  counted.desc.presence = Presence::count;
  TextureGroup group;
  group.textures = {counts, counted};
  group.bundled = true;
  group.presence = 0;
  EXPECT_EQ(texture_volume(std::span(&group, 1)).status(), Status::invalid_description);
  group = {};
  group.textures = {counts};
  ASSERT_TRUE(texture_volume(std::span(&group, 1)).ok());
  group.rank = [](std::span<const std::byte>) { return 0.0F; };
  EXPECT_EQ(texture_volume(std::span(&group, 1)).status(), Status::invalid_description);
  group.rank = nullptr;
  TextureGroup dependent = group;
  dependent.textures.front().name = "dependent";
  dependent.depends_on = 0;
  dependent.dependencies = [](std::span<const std::byte>, std::span<std::uint32_t>) {
    return std::size_t{0};
  };
  EXPECT_EQ(texture_volume(std::array{group, dependent}).status(), Status::invalid_description);
  EXPECT_EQ(texture_volume(std::array{group, group}).status(), Status::invalid_description);
  EXPECT_EQ(texture_volume({}).status(), Status::invalid_description);
  auto preview = group;
  preview.textures.front().preview = static_cast<Preview>(4);
  EXPECT_EQ(texture_volume(std::span(&preview, 1)).status(), Status::invalid_description);
  auto volume = *texture_volume(std::span(&group, 1));
  volume.kind = kKindProbes;
  std::vector<std::byte> bytes;
  EXPECT_EQ(kTextures.write(volume, bytes), Status::invalid_description);
}

}  // namespace
}  // namespace gicodec::test
