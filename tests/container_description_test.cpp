// What containers say of volumes and textures: all of it comes back, and nothing else is accepted.
#include "container_support.h"
#include "same_description.h"

#include "base/bytes.h"

#include <gicodec/irradiance_vectors.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Writes it and reads it again.
Result<ContainerDescription> through(const ContainerDescription& description) {
  MemorySink sink;
  auto writer = ContainerWriter::create(sink, description);
  if (!writer) return writer.status();
  if (const Status status = writer->finish(); status != Status::ok) return status;
  const Exact bytes{std::span(sink.bytes)};
  MemorySource source(bytes.span());
  const auto reader = ContainerReader::open(source);
  if (!reader) return reader.status();
  return reader->description();
}

Status read_body(std::span<const std::byte> body) {
  const auto head = head_of(sample_description());
  const Bytes magic(head.begin(), head.begin() + kFileHeader);
  return read_through(magic + entry(1, body) + end_entry(0));
}

Bytes body_of(const ContainerDescription& description) {
  Bytes body;
  EXPECT_EQ(write_description(description, {}, body), Status::ok);
  return body;
}

std::string random_text(Random& random, std::uint32_t max) {
  constexpr std::string_view kPieces[] = {
      "a", " ", "\n", "\x7F", "\u00E9", "\u20AC", "\U0001F4A1", std::string_view("\0", 1)};
  std::string all;
  for (std::uint32_t i = pick(random, 0, max / 4); i > 0; --i) {
    all += kPieces[random() % std::size(kPieces)];
  }
  return all;
}

Metadata random_metadata(Random& random) {
  Metadata all(random() % 4);
  for (auto& [name, value] : all) {
    name = random_text(random, 20);
    value = random_text(random, 300);
  }
  return all;
}

VolumeDesc random_volume(Random& random) {
  const Grid grid{pick(random, 1, 9), pick(random, 1, 9), pick(random, 1, 9)};
  if (chance(random, 3)) return *irradiance_vector_volume(grid, chance(random, 2));
  std::vector<NamedTexture> textures;
  for (std::uint32_t i = pick(random, 1, 4); i > 0; --i) {
    const Record& record = formats()[random() % formats().size()].record;
    textures.push_back({std::to_string(i) + random_text(random, 200),
                        probe_texture(record, grid, static_cast<std::uint8_t>(pick(random, 1, 64)),
                                      static_cast<std::uint8_t>(random() % 2),
                                      static_cast<Tiling>(random() % kTilingCount)),
                        {},
                        {}});
    if (chance(random, 3)) textures.back().desc.layout.pad_before = 2;
    if (chance(random, 3)) textures.back().desc.layout.pad_after = kMaxPadding;
  }
  return *probe_volume(textures);
}

RC_GTEST_PROP(ContainerDescriptions, AnyDescription, (std::uint64_t seed)) {
  Random random(seed);
  ContainerDescription description;
  description.epoch = random();
  description.scene = {random_text(random, 250), random()};
  description.metadata = random_metadata(random);
  for (std::uint32_t i = pick(random, 1, 5); i > 0; --i) {
    RC_ASSERT(add_volume(description, random_text(random, 250), random_volume(random)) ==
              Status::ok);
    VolumeEntry& volume = description.volumes.back();
    volume.metadata = random_metadata(random);
    if (chance(random, 2)) volume.region = {pick(random, 1, 12), 1, pick(random, 1, kMaxBlocks)};
    if (!chance(random, 2)) continue;
    VolumeGeometry geometry;
    geometry.grid = volume.desc.groups[0].textures[0].desc.grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      geometry.origin[axis] = static_cast<float>(random()) - 1e19F;
      geometry.spacing[axis] = static_cast<float>(random() % 1000 + 1) / 64;
      geometry.scroll[axis] =
          static_cast<std::int32_t>(pick(random, 0, 2 * kMaxScroll)) - kMaxScroll;
    }
    volume.geometry = geometry;
  }
  const float errors[] = {0, 1, 0.001F, kInfinity, std::numeric_limits<float>::denorm_min()};
  for (TextureEntry& texture : description.textures) {
    texture.metadata = random_metadata(random);
    texture.largest_error = errors[random() % std::size(errors)];
  }
  const auto back = through(description);
  RC_ASSERT(back.ok());
  expect_same(*back, description);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(ContainerDescriptions, WhatTheWriterRefuses) {
  const auto create = [&](auto change) {
    auto description = sample_description();
    description.volumes[0].geometry = VolumeGeometry{{2, 1, 2}, {}, {1, 1, 1}, {}};
    change(description);
    MemorySink sink;
    const Status status = ContainerWriter::create(sink, description).status();
    EXPECT_EQ(sink.bytes.empty(), status != Status::ok);
    return status;
  };
  const auto good = Status::ok, bad = Status::invalid_description;
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(create([](auto&) {}), good);
  EXPECT_EQ(create([](auto& d) { d.textures.clear(); }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes.clear(); }), bad);
  EXPECT_EQ(create([](auto& d) { d = {}; }), bad);
  EXPECT_EQ(create([](auto& d) { d.scene.name.assign(256, 'x'); }), bad);
  EXPECT_EQ(create([](auto& d) { d.scene.name.assign(255, 'x'); }), good);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].name.assign(256, 'x'); }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].name = d.volumes[1].name = ""; }), good);
  EXPECT_EQ(create([](auto& d) { d.metadata[0].second.assign((1U << 20) + 1, 'x'); }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[0].metadata[0].first.assign((1U << 20) + 1, 'x'); }),
            bad);
  // Names are the kind's.
  EXPECT_EQ(create([](auto& d) { d.textures[1].name = "color"; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].name = "else"; }), bad);
  EXPECT_EQ(create([](auto& d) { std::swap(d.textures[0], d.textures[1]); }), bad);
  // So is all of a description but the layout.
  EXPECT_EQ(create([](auto& d) { ++d.textures[1].desc.grid.x; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc = {}; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.layout = Tiling::blocks; }), good);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.layout = static_cast<Tiling>(kTilingCount); }),
            bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.layout.pad_after = 9; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[1].desc.layout.slots = {4, 1, 1}; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].kind = 0; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].kind = kKindIrradianceVectors; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].description.pop_back(); }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[0].description.push_back({}); }), bad);
  // Places say the same as the lists.
  EXPECT_EQ(create([](auto& d) { d.volumes[1].first_texture = 1; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].textures = 2; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].textures = 0; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].textures = UINT32_MAX; }), bad);
  EXPECT_EQ(create([](auto& d) { d.textures[2].volume = 0; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes.pop_back(); }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].region = {1, 0, 1}; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].region = {0, 1, 1}; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].region.x = kMaxBlocks + 1; }), bad);
  EXPECT_EQ(create([](auto& d) { d.volumes[1].region.x = kMaxBlocks; }), good);
  for (const float error : {nan, -nan, -kInfinity, -1.0F, -0.0F}) {
    EXPECT_EQ(create([&](auto& d) { d.textures[0].largest_error = error; }), bad) << error;
  }
  for (const float error : {0.0F, 1e-40F, 3e38F, kInfinity}) {
    EXPECT_EQ(create([&](auto& d) { d.textures[0].largest_error = error; }), good) << error;
  }
  EXPECT_EQ(create([](auto& d) { ++d.volumes[0].geometry->grid.x; }), bad);
  for (const float wrong : {nan, kInfinity, -kInfinity}) {
    EXPECT_EQ(create([&](auto& d) { d.volumes[0].geometry->origin[1] = wrong; }), bad) << wrong;
    EXPECT_EQ(create([&](auto& d) { d.volumes[0].geometry->spacing[1] = wrong; }), bad) << wrong;
  }
  EXPECT_EQ(create([](auto& d) { d.volumes[0].geometry->spacing[2] = 0; }), bad);
  for (const std::int32_t cells : {kMaxScroll, -kMaxScroll}) {
    const std::int32_t beyond = cells + (cells > 0 ? 1 : -1);
    EXPECT_EQ(create([&](auto& d) { d.volumes[0].geometry->scroll[0] = cells; }), good);
    EXPECT_EQ(create([&](auto& d) { d.volumes[0].geometry->scroll[0] = beyond; }), bad);
  }
  EXPECT_EQ(create([](auto& d) { d.volumes[0].geometry->scroll[0] = INT32_MIN; }), bad);
  // At most 256 textures and as many volumes.
  const auto many = [](std::size_t count) {
    return [count](auto& d) {
      const VolumeDesc one = d.volumes[1].desc;
      d = {};
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(add_volume(d, "", one), Status::ok);
    };
  };
  EXPECT_EQ(create(many(256)), good);
  EXPECT_EQ(create(many(257)), bad);
}

TEST(ContainerDescriptions, WhatIsWrongWithAVolume) {
  const auto found = [](auto change) {
    VolumeDesc volume = sample_description().volumes[0].desc;
    change(volume, volume.groups[0]);
    EXPECT_EQ(problem(volume).empty(), validate(volume) == Status::ok);
    return std::string(problem(volume));
  };
  EXPECT_EQ(found([](auto&, auto&) {}), "");
  EXPECT_EQ(found([](auto& v, auto&) { v.kind = 0; }).substr(0, 5), "kind:");
  EXPECT_EQ(found([](auto& v, auto&) { v.groups.clear(); }), "groups: 1 to 16");
  EXPECT_EQ(found([](auto& v, auto&) { v.groups.emplace_back(); }), "groups: one has no textures");
  EXPECT_EQ(found([](auto&, auto& g) { ++g.textures[1].desc.grid.x; }),
            "grid: the textures of a group have one space and one grid");
  EXPECT_EQ(found([](auto&, auto& g) { g.textures[1].desc.record = {}; }).substr(0, 7), "format:");
  EXPECT_EQ(found([](auto&, auto& g) { g.textures[1].desc.guard_band = 9; }),
            "guard_band: it is 0 or 1");
  EXPECT_EQ(found([](auto&, auto& g) { g.depends_on = 0; }).substr(0, 11), "depends_on:");
  EXPECT_EQ(found([](auto&, auto& g) { g.presence = 1; }).substr(0, 9), "presence:");
  EXPECT_EQ(found([](auto&, auto& g) { g.textures[1].name = "color"; }),
            "name: two textures have the same");
  EXPECT_EQ(found([](auto&, auto& g) { g.textures[1].name = ""; }).substr(0, 5), "name:");
}

TEST(ContainerDescriptions, AddingAVolumeThatIsNone) {
  ContainerDescription description;
  VolumeDesc volume = sample_description().volumes[0].desc;
  EXPECT_EQ(validate(volume), Status::ok);
  volume.kind = 0;
  EXPECT_EQ(validate(volume), Status::invalid_description);
  EXPECT_EQ(add_volume(description, "v", volume), Status::unknown_kind);
  volume.kind = kKindIrradianceVectors;
  EXPECT_EQ(add_volume(description, "v", volume), Status::invalid_description);
  volume.kind = kKindProbes;
  volume.groups[0].textures[1].name = "color";
  EXPECT_EQ(add_volume(description, "v", volume), Status::invalid_description);
  EXPECT_TRUE(description.volumes.empty() && description.textures.empty());
}

TEST(ContainerDescriptions, TextsThatAreNotUtf8) {
  // Each in a place of its own, replaced in the bytes.
  const auto with = [](const std::string& text) {
    std::vector<Status> read;
    for (int place = 0; place < 5; ++place) {
      auto description = sample_description();
      auto& metadata = place == 0   ? description.textures[1].metadata
                       : place == 1 ? description.volumes[0].metadata
                                    : description.metadata;
      metadata = {{"name", "value"}};
      std::string& field = place < 3    ? metadata[0].second
                           : place == 3 ? description.scene.name
                                        : description.volumes[1].name;
      const std::string plain(text.size(), 'p');
      field = plain;
      Bytes body = body_of(description);
      const auto bytes = std::as_bytes(std::span(plain));
      const auto at = std::search(body.begin(), body.end(), bytes.begin(), bytes.end());
      EXPECT_NE(at, body.end());
      const auto wrong = std::as_bytes(std::span(text));
      std::copy(wrong.begin(), wrong.end(), at);
      read.push_back(read_body(body));
      // Writers do not write it either.
      field = text;
      MemorySink sink;
      EXPECT_EQ(ContainerWriter::create(sink, description).ok(), read.back() == Status::ok);
    }
    EXPECT_EQ(std::count(read.begin(), read.end(), read[0]), 5);
    return read[0];
  };
  for (const char* good : {"ppppp", "\xC3\xA9p", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xEE\x80\x80",
                           "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "\xC2\x80\xDF\xBF"}) {
    EXPECT_EQ(with(good), Status::ok) << good;
  }
  for (const char* bad :
       {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC3", "\xC3p", "\xE0\x9F\xBF", "\xE2\x82",
        "\xE2\x82p", "\xED\xA0\x80", "\xED\xBF\xBF", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80",
        "\xF0\x90\x80", "\xF5\x80\x80\x80", "\xFF", "\xFE\x80"}) {
    EXPECT_EQ(with(bad), Status::corrupt) << bad;
  }
}

/// The bytes of a description with one volume of an unknown kind, field by field.
struct Fields {
  std::uint64_t volumes = 1;
  std::uint8_t kind = 77;
  Bytes description{std::byte{1}};
  std::uint8_t placed = 0;
  std::array<float, 6> place{0, 0, 0, 1, 1, 1};
  std::array<std::uint64_t, 3> scroll{}, region{};
  std::uint64_t textures = 2;
  std::string first = "a", second = "b";
  std::array<std::uint8_t, 3> layout{};
  std::array<std::uint64_t, 3> slots{};
  float error = 0;
  std::uint64_t metadata = 0;

  [[nodiscard]] Bytes bytes() const {
    Bytes body;
    ByteWriter writer(body);
    writer.fixed(std::uint64_t{5});
    writer.text("scene");
    writer.fixed(std::uint64_t{6});
    writer.varint(volumes);
    writer.text("volume");
    writer.fixed(kind);
    writer.varint(description.size());
    writer.bytes(description);
    writer.fixed(placed);
    if (placed == 1) {
      writer.bytes(std::as_bytes(std::span(place)));
      for (const auto cells : scroll) writer.varint(cells);
    }
    for (const auto side : region) writer.varint(side);
    writer.varint(textures);
    for (const std::string& name : {first, second}) {
      writer.text(name);
      for (const auto field : layout) writer.fixed(field);
      for (const auto along : slots) writer.varint(along);
      writer.bytes(std::as_bytes(std::span(&error, 1)));
      writer.varint(metadata);
    }
    writer.varint(0);
    writer.varint(0);
    return body;
  }
};

TEST(ContainerDescriptions, FieldsOutOfRange) {
  const auto with = [](auto change) {
    Fields fields;
    change(fields);
    return read_body(fields.bytes());
  };
  const auto good = Status::ok, bad = Status::corrupt;
  EXPECT_EQ(with([](auto&) {}), good);
  for (const std::uint64_t count : {0, 2, 257}) {
    EXPECT_EQ(with([&](auto& f) { f.volumes = count; }), bad) << count;
  }
  EXPECT_EQ(with([](auto& f) { f.kind = 0; }), bad);
  EXPECT_EQ(with([](auto& f) { f.kind = kKindProbes; }), bad);
  EXPECT_EQ(with([](auto& f) { f.kind = 255; }), good);
  EXPECT_EQ(with([](auto& f) { f.description.resize(kMaxKindDescription); }), good);
  EXPECT_EQ(with([](auto& f) { f.description.resize(kMaxKindDescription + 1); }), bad);
  EXPECT_EQ(with([](auto& f) { f.placed = 1; }), good);
  EXPECT_EQ(with([](auto& f) { f.placed = 2; }), bad);
  for (std::size_t i = 0; i < 6; ++i) {
    for (const float wrong : {std::nanf(""), kInfinity, -kInfinity, i < 3 ? kInfinity : 0.0F}) {
      EXPECT_EQ(with([&](auto& f) {
                  f.placed = 1;
                  f.place[i] = wrong;
                }),
                bad)
          << i;
    }
  }
  for (const auto& [folded, status] :
       {std::pair{8388607U, good}, {8388608U, good}, {8388609U, bad}, {UINT32_MAX, bad}}) {
    EXPECT_EQ(with([&, cells = folded](auto& f) {
                f.placed = 1;
                f.scroll[2] = cells;
              }),
              status)
        << folded;
  }
  EXPECT_EQ(with([](auto& f) { f.region = {1, 1, 1}; }), good);
  EXPECT_EQ(with([](auto& f) { f.region = {1, 1, 0}; }), bad);
  EXPECT_EQ(with([](auto& f) { f.region = {0, 0, 1}; }), bad);
  EXPECT_EQ(with([](auto& f) { f.region = {kMaxBlocks + 1, 1, 1}; }), bad);
  for (const std::uint64_t count : {0, 1, 3, 256}) {
    EXPECT_EQ(with([&](auto& f) { f.textures = count; }), bad) << count;
  }
  EXPECT_EQ(with([](auto& f) { f.first = ""; }), bad);
  EXPECT_EQ(with([](auto& f) { f.first = "b"; }), bad);
  EXPECT_EQ(with([](auto& f) { f.first.assign(255, 'x'); }), good);
  EXPECT_EQ(with([](auto& f) { f.first.assign(256, 'x'); }), bad);
  EXPECT_EQ(with([](auto& f) { f.layout = {5, 8, 8}; }), good);
  EXPECT_EQ(with([](auto& f) { f.layout[0] = kTilingCount; }), bad);
  EXPECT_EQ(with([](auto& f) { f.layout[1] = 9; }), bad);
  EXPECT_EQ(with([](auto& f) { f.layout[2] = 9; }), bad);
  EXPECT_EQ(with([](auto& f) { f.slots = {kMaxBlocks, 1, 1}; }), good);
  EXPECT_EQ(with([](auto& f) { f.slots = {kMaxBlocks + 1, 1, 1}; }), bad);
  EXPECT_EQ(with([](auto& f) { f.slots = {4, 4, 0}; }), bad);
  for (const float error : {0.0F, 2.0F, kInfinity}) {
    EXPECT_EQ(with([&](auto& f) { f.error = error; }), good) << error;
  }
  for (const float error : {std::nanf(""), -std::nanf(""), -kInfinity, -1.0F, -0.0F}) {
    EXPECT_EQ(with([&](auto& f) { f.error = error; }), bad) << error;
  }
  EXPECT_EQ(with([](auto& f) { f.metadata = UINT64_MAX; }), bad);
}

TEST(ContainerDescriptions, EveryPrefixAndEveryBit) {
  auto description = sample_description();
  description.volumes[1].geometry = VolumeGeometry{{3, 1, 4}, {1, 2, 3}, {1, 1, 2}, {0, -4, 5}};
  Bytes body = body_of(description);
  EXPECT_EQ(read_body(body), Status::ok);
  for (std::size_t size = 0; size < body.size(); ++size) {
    ASSERT_EQ(read_body(std::span(body).first(size)), Status::corrupt) << size;
  }
  // What is read of other bytes is what is written again.
  for (std::size_t bit = 0; bit < body.size() * 8; ++bit) {
    const Exact flipped{flip_bit(body, bit)};
    ContainerDescription read;
    if (read_description(flipped.span(), {}, {}, read) != Status::ok) continue;
    Bytes again;
    ASSERT_EQ(write_description(read, {}, again), Status::ok) << bit;
    ASSERT_TRUE(
        std::equal(again.begin(), again.end(), flipped.span().begin(), flipped.span().end()))
        << bit;
  }
  body.push_back(std::byte{0});
  EXPECT_EQ(read_body(body), Status::corrupt);
}

TEST(ContainerDescriptions, Limits) {
  auto description = sample_description();
  description.textures.pop_back();
  description.volumes.pop_back();
  const Grid grid{64, 32, 64};
  const NamedTexture large{"large", probe_texture(Format::R32G32B32A32_SFLOAT, grid, 16), {}, {}};
  ASSERT_EQ(add_volume(description, "", *probe_volume(std::span(&large, 1))), Status::ok);
  const auto with = [&](const Grid& region, auto change) {
    description.volumes[1].region = region;
    DecodeLimits limits;
    limits.max_texture_bytes = std::uint64_t{1} << 20;
    change(limits);
    return read_through(head_of(description) + end_entry(0), false, limits);
  };
  const auto as_is = [](DecodeLimits&) {};
  // A decoder of one region need not hold the volume.
  EXPECT_EQ(with({}, as_is), Status::limit_exceeded);
  EXPECT_EQ(with({8, 8, 3}, as_is), Status::ok);
  EXPECT_EQ(with({8, 8, 4}, as_is), Status::limit_exceeded);
  EXPECT_EQ(with({1, 1, 1}, [](auto& l) { l.max_textures = 2; }), Status::limit_exceeded);
  EXPECT_EQ(with({1, 1, 1}, [](auto& l) { l.max_textures = 3; }), Status::ok);
  EXPECT_EQ(with({1, 1, 1}, [](auto& l) { l.max_description_bytes = 40; }), Status::limit_exceeded);
}

}  // namespace
}  // namespace gicodec
