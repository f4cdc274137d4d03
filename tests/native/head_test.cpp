// Every "must" of docs/native.md about heads: payloads that break one alone are refused by both
// decoders, and without decoding where heads suffice.
#include "native/crafted.h"
#include "native/matches/match_chunk.h"
#include "native/tokens/token_head.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace gicodec::native {
namespace {

using namespace test;

int head_of(int parts) { return kVersion | parts << 4; }

/// Two raw chunks of single halves: version and parts, box, count, two ends, then what they hold.
struct TwoChunks {
  static constexpr std::size_t kBox = 1, kBoxZero = 7, kCount = 9, kEnds = 13, kZero = 21,
                               kFirst = 24, kPadding = 27;
  UpdateCase u =
      make_update(probe_texture(Format::R16_SFLOAT, {2, 1, 1}, 1, 0), Content::smooth, true, 1, 1);
  Bytes payload = bytes({head_of(3), 1,  0, 1, 0, 1, 0, 0, 0, 2, 0, 0, 0, 27, 0, 0,
                         0,          31, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 3,  4});
  TwoChunks() { u.records = bytes({1, 2, 3, 4}); }
};

TEST(NativeHead, PartsOfAPayload) {
  using T = TwoChunks;
  const T t;
  ASSERT_NO_FATAL_FAILURE(expect_sound(t.u, t.payload));
  for (const int version : {0, 1, 2, 4}) {
    expect_refused_at_once(t.u, with(t.payload, 0, version), Status::unsupported_version);
  }
  expect_refused_at_once(t.u, with(t.payload, 0, head_of(3 | 8)));
  for (const auto place : {T::kZero, T::kZero + 2, T::kBoxZero, T::kBoxZero + 1, T::kPadding}) {
    SCOPED_TRACE(place);
    expect_refused_at_once(t.u, with(t.payload, place, 1));
  }
}

TEST(NativeHead, Steps) {
  constexpr std::size_t kStep = 1, kRest = 3;
  auto one =
      make_update(probe_texture(Format::R8_UNORM, {1, 1, 1}, 1, 0), Content::smooth, true, 1, 1);
  one.records = bytes({77});
  const auto raw = [](int low, int high) {
    return bytes({head_of(4), low, high, 0, 0, kRawChunk, 77});
  };
  for (const int step : {2, 200, 255}) expect_sound(one, raw(step, 0));
  for (const int step : {0, 1}) expect_refused_at_once(one, raw(step, 0));
  expect_refused_at_once(one, raw(0, 1));
  for (const auto place : {kRest, kRest + 1}) {
    expect_refused_at_once(one, with(raw(2, 0), place, 1));
  }

  // Nothing is left between multiples and the largest value.
  auto three =
      make_update(probe_texture(Format::R8_UNORM, {3, 1, 1}, 1, 0), Content::smooth, true, 1, 1);
  three.records = bytes({0, 200, 255});
  const Bytes payload = encode(three, {}, best_isa());
  ASSERT_EQ(at(payload, 0), head_of(4));
  EXPECT_EQ(at(payload, kStep), 200);
  expect_sound(three, payload);

  auto pair = make_update(probe_texture(Format::R16G16_SFLOAT, {1, 1, 1}, 1, 0), Content::smooth,
                          true, 1, 1);
  pair.records = bytes({1, 2, 3, 4});
  const auto raw_pair = [](int first, int second) {
    return bytes(
        {head_of(4), first & 255, first >> 8, second & 255, second >> 8, kRawChunk, 1, 2, 3, 4});
  };
  expect_sound(pair, raw_pair(1, 0x8000));
  for (const int step : {0, 3, 0x8001}) expect_refused_at_once(pair, raw_pair(4, step));
}

TEST(NativeHead, Repeats) {
  const auto repeated = [](const TextureDesc& desc) {
    return make_update(desc, Content::shared, true, 1, 1);
  };
  const auto u = repeated(probe_texture(Format::R32G32_SFLOAT, {6, 4, 5}, 6, 1));
  PayloadSettings settings;
  settings.chunk.others = false;
  const Bytes payload = encode(u, settings, best_isa());
  ASSERT_EQ(at(payload, kChunk) & 0x80, 0x80);
  expect_sound(u, payload);
  // Smaller than each plane on its own would be, of which three quarters are known.
  EXPECT_LT(payload.size(), u.records.size() / 2);
  // Not if the chunk is flat, nor if some records do not exist.
  expect_refused_at_once(u, with(payload, kChunk, at(payload, kChunk) | 0x40));
}

TEST(NativeHead, Boxes) {
  using T = TwoChunks;
  const T t;
  for (const std::size_t axis : {0U, 2U, 4U}) {
    expect_refused_at_once(t.u, with(t.payload, T::kBox + axis, 0));
    expect_refused_at_once(t.u, with(t.payload, T::kBox + axis, 3));
    expect_refused_at_once(t.u, with(t.payload, T::kBox + axis + 1, 1));
  }
  // As large as boxes may be, and larger.
  for (const int side : {1024, 1025}) {
    const auto grid = Grid{static_cast<std::uint32_t>(side), 1024, 1};
    const auto u =
        make_update(probe_texture(Format::R16_SFLOAT, grid, 1, 0), Content::white, true, 1, 1);
    Bytes payload = bytes({head_of(1), side & 255, 4, 0, 4, 1, 0, 0, 0, kRawChunk});
    payload.insert(payload.end(), u.records.begin(), u.records.end());
    if (side == 1024) {
      expect_sound(u, payload);
    } else {
      expect_refused_at_once(u, payload);
    }
  }
}

/// Modelled chunks have smaller boxes than others.
TEST(NativeHead, ChunksOfLargeBoxes) {
  const auto u =
      make_update(pool_texture(Format::R16_SFLOAT, 5000, {1, 1, 1}), Content::smooth, true, 1, 1);
  const Bytes payload = encode(u, {}, best_isa());
  ASSERT_NO_FATAL_FAILURE(expect_sound(u, payload));
  ASSERT_EQ(at(payload, 0), head_of(8));
  for (const int kind : {1, 3, 2 | 4, 2 | 128}) {
    expect_refused_at_once(u, with(payload, kChunk, kind));
  }
  expect_refused(u, Bytes(payload.begin(), payload.begin() + 4), Status::truncated);
}

TEST(NativeHead, Directories) {
  using T = TwoChunks;
  const T t;
  const auto ends = [&](int first, int second) {
    return with(with(t.payload, T::kEnds, first), T::kEnds + 4, second);
  };
  expect_refused_at_once(t.u, ends(31, 31));
  expect_refused_at_once(t.u, ends(31, 27));
  expect_refused_at_once(t.u, ends(24, 31));  // no byte for the first
  expect_refused_at_once(t.u, ends(0, 31));
  expect_refused_at_once(t.u, ends(27, 28));  // none for the second
  expect_refused_at_once(t.u, ends(27, 32), Status::truncated);
  expect_refused_at_once(t.u, with(t.payload, T::kEnds + 7, 0x80), Status::truncated);
  expect_refused_at_once(t.u, ends(27, 30));
  expect_refused_at_once(t.u, longer(t.payload, 1));
  // Raw chunks are as long as their probes.
  expect_refused(t.u, ends(26, 31));
  // Other numbers of chunks than boxes.
  for (const int count : {0, 1}) expect_refused_at_once(t.u, with(t.payload, T::kCount, count));
  expect_refused_at_once(t.u, with(t.payload, T::kCount, 3));
  expect_refused_at_once(t.u, with(t.payload, T::kCount + 3, 1), Status::truncated);
  auto one = t.u;
  one.blocks = {1};
  one.records = bytes({3, 4});
  expect_refused_at_once(one, t.payload);
  expect_sound(one, bytes({head_of(1), 1, 0, 1, 0, 1, 0, 0, 0, 0, 3, 4}));
  expect_refused_at_once(one, bytes({head_of(2), 1, 0, 0, 0, 15, 0, 0, 0, 0, 0, 0, 0, 3, 4}));
  expect_refused_at_once(t.u, bytes({head_of(1), 1, 0, 1, 0, 1, 0, 0, 0, 0, 3, 4}),
                         Status::truncated);
  auto none = t.u;
  none.blocks.clear();
  none.records.clear();
  expect_sound(none, bytes({kVersion}));
  expect_refused_at_once(none, bytes({kVersion, 0}));
}

TEST(NativeHead, FirstBytes) {
  const TwoChunks t;
  for (int first = 1; first < 256; ++first) {  // of a raw chunk
    if ((first & 3) == kModelledChunk) continue;
    SCOPED_TRACE(first);
    const Bytes other = with(t.payload, TwoChunks::kFirst, first);
    // Of adaptive and match chunks no more can be checked; tokens take more bytes than are there.
    const bool tokens = (first & 3) == kTokenChunk && (first >> 3 & 7) <= 4 && first < 128 &&
                        (first & (kRefers | kContinues)) != (kRefers | kContinues);
    first == kAdaptiveChunk ? expect_refused(t.u, other)
    : first == kMatchChunk
        ? expect_refused(t.u, other, Status::truncated)
        : expect_refused_at_once(t.u, other, tokens ? Status::truncated : Status::corrupt);
  }
  for (const bool pairs : {false, true}) {
    const auto u = pairs ? visibility(true) : colour(true);
    const auto [head, groups] = encoded(u);
    const Bytes sound = payload_of(u, head, groups);
    expect_sound(u, sound);
    const int first = at(sound, kChunk);
    for (const int kind : {0, 2, 3}) {
      expect_refused_at_once(u, with(sound, kChunk, (first & ~3) | kind));
    }
    for (const int lanes : {6, 7}) {
      expect_refused_at_once(u, with(sound, kChunk, (first & ~0x1C) | lanes << 2));
    }
    if (!pairs) {
      expect_refused_at_once(u, with(sound, kChunk, first | kHasRepeats));
    }
  }
}

TEST(NativeHead, StatesAndWords) {
  for (const bool pairs : {false, true}) {
    const auto u = pairs ? visibility(false) : colour(false);
    const auto [head, groups] = encoded(u);
    const Bytes sound = payload_of(u, head, groups);
    expect_sound(u, sound);
    Bytes written;
    write_head(plane_layout(u.desc), head, written);
    for (unsigned l = 0; l < head.lanes; ++l) {
      const std::size_t state = kChunk + written.size() + 4 * l;
      expect_refused_at_once(u, with(with(sound, state + 2, 0), state + 3, 0));
    }
    expect_refused_at_once(u, longer(sound, 1));
    expect_refused(u, longer(sound, 2));
  }
}

/// Planes that hold one value: the modes are all that is coded.
struct Constant {
  UpdateCase u;
  ChunkHead head;
  Groups groups;

  explicit Constant(std::uint32_t probes, unsigned mode = 0, unsigned lanes = 1)
      : u(make_update(probe_texture(Format::R16_SFLOAT, {probes, 1, 1}, 1, 0), Content::smooth,
                      true, 1, 1)) {
    for (std::size_t i = 0; i < u.records.size(); ++i) u.records[i] = std::byte(i % 2 + 8);
    head.lanes = lanes;
    head.flat = true;
    head.coded = 0;
    head.constant[0] = 0x0908;
    for (std::uint32_t probe = 0; probe < probes; probe += lanes) {
      Step step{};
      step.active = (1U << std::min(lanes, probes - probe)) - 1;
      step.place = kModePlace;
      std::fill(std::begin(step.value), std::end(step.value), static_cast<std::uint16_t>(mode));
      groups.push_back({step});
    }
  }
  [[nodiscard]] Bytes payload() const { return payload_of(u, head, groups); }
};

TEST(NativeHead, FewLanesForManyProbes) {
  for (unsigned lanes = 1; lanes < kLanes; lanes *= 2) {
    SCOPED_TRACE(lanes);
    const Constant few(16 * lanes - 1, 0, lanes), many(16 * lanes, 0, lanes);
    expect_sound(few.u, few.payload());
    expect_refused(many.u, many.payload());
  }
}

TEST(NativeHead, WithoutNeighboursChunksAreFlat) {
  Constant c(9);
  c.u.desc = pool_texture(Format::R16_SFLOAT, 9, {1, 1, 1});
  expect_sound(c.u, c.payload());
  c.head.flat = false;
  expect_refused(c.u, c.payload());
  c.u.desc = probe_texture(Format::R16_SFLOAT, {9, 1, 1}, 1, 0);
  expect_sound(c.u, c.payload());
  c.u.desc.model = Model::none;
  expect_refused(c.u, c.payload());
  c.head.flat = true;
  expect_sound(c.u, c.payload());
}

TEST(NativeHead, ModesAreBelowEight) {
  for (unsigned mode = 0; mode < kModes; ++mode) {
    const Constant c(3, mode);
    expect_sound(c.u, c.payload());
  }
  for (const unsigned mode : {8U, 9U, 255U, 65535U}) {
    const Constant c(3, mode);
    expect_refused(c.u, c.payload());
  }
  const auto u = visibility(false);
  const auto sound = encoded(u);
  expect_sound(u, payload_of(u, sound.head, sound.groups));
  for (const std::size_t plane : {0U, 1U}) {
    auto groups = sound.groups;
    groups.back()[plane].value[0] += kModes;
    expect_refused(u, payload_of(u, sound.head, groups));
  }
}

TEST(NativeHead, PlanesAndConstants) {
  const auto u = colour(true);
  const auto [head, groups] = encoded(u);
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  constexpr std::size_t kCoded = kChunk + 3, kConstant = kCoded + 1;
  ASSERT_EQ(at(sound, kCoded), 0b0111);
  for (const int bit : {0x10, 0x80}) expect_refused_at_once(u, with(sound, kCoded, 7 | bit));
  ASSERT_LT(at(sound, kConstant), 4);
  expect_refused_at_once(u, with(sound, kConstant, 4));
  expect_refused_at_once(u, with(sound, kConstant + 1, 1));
}

/// A bit for each plane, in as many bytes as they need.
TEST(NativeHead, MoreThanEightPlanes) {
  Record record;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"}) {
    record.components[record.count] = {name, static_cast<std::uint16_t>(8 * record.bytes), 8,
                                       ComponentType::uint};
    ++record.count;
    ++record.bytes;
  }
  auto u = make_update(pool_texture(record, 12, {4, 4, 1}), Content::smooth, true, 1, 1);
  for (std::size_t i = 9; i < u.records.size(); i += 12) u.records[i] = std::byte{77};
  const auto [head, groups] = encoded(u);
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  constexpr std::size_t kCoded = kChunk + 3;
  ASSERT_EQ(at(sound, kCoded), 0xFF);
  ASSERT_EQ(at(sound, kCoded + 1), 0b1101);
  ASSERT_EQ(at(sound, kCoded + 2), 77);
  for (const int bit : {0x10, 0x80}) {
    expect_refused_at_once(u, with(sound, kCoded + 1, 0b1101 | bit));
  }
  expect_refused_at_once(u, with(sound, kCoded + 3, 1));  // of eight bits
}

/// What exists is all that they hold.
TEST(NativeHead, RawChunksInPart) {
  TextureDesc desc = pool_texture(Format::R16_UINT, 3, {2, 1, 1});
  for (const Presence presence : {Presence::count, Presence::mask}) {
    desc.presence = presence;
    UpdateCase u{desc, {0, 1, 2}, bytes({1, 2, 0, 0, 0, 0, 0, 0, 3, 4, 5, 6}), {}, {}, true, {}};
    u.presence = presence == Presence::count ? bytes({1, 0, 0, 0, 2, 0}) : bytes({1, 0, 3});
    const Bytes sound = bytes({kVersion, kRawChunk, 1, 2, 3, 4, 5, 6});
    expect_sound(u, sound);
    expect_refused_at_once(u, longer(sound, 1));
    expect_refused(u, longer(sound, 2));
    expect_refused(u, Bytes(sound.begin(), sound.end() - 2), Status::truncated);
    std::ranges::fill(u.presence, std::byte{0});
    std::ranges::fill(u.records, std::byte{0});
    expect_refused(u, sound);
    expect_sound(u, Bytes(sound.begin(), sound.begin() + 2));
  }
}

TEST(NativeHead, SetsOfWhatAChunkUses) {
  const auto check = [](const UpdateCase& u, ChunkHead head, const Groups& groups,
                        std::array<bool, kPlaces> used) {
    for (unsigned p = 0; p < kPlaces; ++p) {
      SCOPED_TRACE(p);
      head.tables.set[p] = kSets - 1;
      const Bytes payload = payload_of(u, head, groups);
      if (used[p]) {
        expect_sound(u, payload);
      } else {
        expect_refused(u, payload);
      }
      head.tables.set[p] = 0;
      const Bytes sound = payload_of(u, head, groups);
      const std::size_t place = kChunk + 1 + p / 2;
      for (const int set : {8, 15}) {
        expect_refused_at_once(u, with(sound, place, set << p % 2 * 4));
      }
    }
  };
  for (const bool keyframe : {true, false}) {
    const auto planes = encoded(colour(keyframe));
    check(colour(keyframe), planes.head, planes.groups, {true, true, true, true});
    const auto pairs = encoded(visibility(keyframe));
    check(visibility(keyframe), pairs.head, pairs.groups, {true, true, true, !keyframe});
  }
  const Constant none(3);
  check(none.u, none.head, none.groups, {false, false, false, true});
  auto two =
      make_update(probe_texture(Format::R32_SFLOAT, {4, 3, 2}, 8, 1), Content::smooth, true, 1, 1);
  // Few enough bits that the chunk is not raw.
  constexpr std::byte kBits[] = {std::byte{3}, std::byte{0}, std::byte{0xFF}, std::byte{1}};
  for (std::size_t i = 0; i < two.records.size(); ++i) two.records[i] &= kBits[i % 4];
  const auto deep = encoded(two);
  check(two, deep.head, deep.groups, {true, true, false, true});
  auto own = encoded(visibility(false));
  own.head.tables.repeats.distributions = 1;
  own.head.tables.repeats.end[0][0] = 2000;
  own.head.tables.repeats.end[0][1] = 3000;
  std::fill_n(own.head.tables.repeats.map, kRepeatContexts, std::uint8_t{0});
  check(visibility(false), own.head, own.groups, {true, true, false, true});
}

}  // namespace
}  // namespace gicodec::native
