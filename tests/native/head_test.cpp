// Every "must" of docs/native.md about heads: payloads that break one alone are refused by both
// decoders, and without decoding where heads tell.
#include "native/chunk_head.h"

#include "native/content.h"
#include "native/reference_decoder.h"

#include <gtest/gtest.h>

#include <functional>

namespace gicodec::native {
namespace {

using test::Bytes;
using test::UpdateCase;
using Groups = std::vector<std::vector<Step>>;  ///< in coding order

constexpr std::size_t kChunk = 4;  ///< where the only chunk of a payload begins

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}
int at(const Bytes& payload, std::size_t place) { return std::to_integer<int>(payload[place]); }
Bytes with(Bytes payload, std::size_t place, int value) {
  payload.at(place) = static_cast<std::byte>(value);
  return payload;
}
/// A word more or less, at the end.
Bytes longer(Bytes payload, std::size_t by) {
  payload.resize(payload.size() + by);
  return payload;
}

Status decode(const UpdateCase& u, const Bytes& payload, Bytes& out) {
  out.resize(u.records.size());
  std::vector<Workspace> workspaces;
  return decode_payload(u.decode_job(payload, out), best_isa(), workspaces);
}
void expect_sound(const UpdateCase& u, const Bytes& payload) {
  Bytes out;
  EXPECT_EQ(check_payload(u.desc, u.blocks.size(), payload), Status::ok);
  EXPECT_EQ(decode(u, payload, out), Status::ok);
  EXPECT_EQ(out, u.records);
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(*expected, u.records);
}
void expect_refused(const UpdateCase& u, const Bytes& payload, Status status = Status::corrupt) {
  Bytes out;
  EXPECT_EQ(decode(u, payload, out), status);
  EXPECT_FALSE(
      reference::decode(u.desc, u.blocks, u.mirror, u.received, payload).has_value());
}
/// Heads alone tell.
void expect_refused_at_once(const UpdateCase& u, const Bytes& payload,
                            Status status = Status::corrupt) {
  expect_refused(u, payload, status);
  EXPECT_EQ(check_payload(u.desc, u.blocks.size(), payload), status);
}

/// A payload of one chunk with that head.
Bytes payload_of(const UpdateCase& u, const ChunkHead& head, const Groups& groups) {
  const PlaneLayout layout = plane_layout(u.desc.record);
  AdaptedTables adapted;
  const Tables& tables = adapted.apply(layout.pairs, !u.keyframe, head.tables);
  std::size_t steps = 0;
  for (const auto& group : groups) steps += group.size();
  std::vector<std::uint8_t> words(steps * kMaxStepBytes + kSlack);
  Output output{};
  std::fill(std::begin(output.state), std::end(output.state), kStateLow);
  output.next = words.data() + words.size();
  for (std::size_t g = groups.size(); g-- > 0;) {
    const auto& group = groups[g];
    kernels(best_isa()).encode_steps(group.data(), group.data() + group.size(), tables, output);
  }
  Bytes payload = bytes({kVersion, 0, 0, 0});
  write_head(layout, head, payload);
  ByteWriter writer(payload);
  for (unsigned l = 0; l < head.lanes; ++l) writer.fixed(output.state[l]);
  const std::uint8_t* const end = words.data() + words.size();
  writer.bytes(std::as_bytes(std::span<const std::uint8_t>(output.next, end)));
  return payload;
}

/// What an encoder made of an update of one chunk.
struct Encoded {
  ChunkHead head;
  Groups groups;
};
Encoded encoded(const UpdateCase& u) {
  Encoded e;
  PayloadSettings settings;
  settings.chunk.observe = [&](const Step* begin, const Step* end) {
    e.groups.insert(e.groups.begin(), {begin, end});
  };
  const Bytes payload = test::encode(u, settings, best_isa());
  EXPECT_EQ(payload.at(1), std::byte{0});
  ByteReader reader(std::span(payload).subspan(kChunk));
  const auto first = reader.fixed<std::uint8_t>();
  EXPECT_EQ(first & 3, kModelledChunk);
  read_head(plane_layout(u.desc.record), !u.keyframe, first, reader, e.head);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(payload_of(u, e.head, e.groups), payload);
  e.head.tables.clear();
  return e;
}

UpdateCase colour(bool keyframe = true) {
  auto u = test::make_update(probe_texture(Format::A2B10G10R10_UNORM_PACK32, {5, 4, 3}, 4, 1),
                             test::Content::smooth, keyframe, 1, 1);
  // A plane that is constant.
  for (std::size_t i = 3; i < u.records.size(); i += 4) u.records[i] &= std::byte{0x3F};
  return u;
}
UpdateCase visibility(bool keyframe) {
  return test::make_update(probe_texture(Format::R16G16_SFLOAT, {4, 3, 3}, 4, 1),
                           test::Content::smooth, keyframe, 1, 1);
}

// -- The payload's head ------------------------------------------------------------------------

/// Two raw chunks of single halves: version, parts, box, count, two ends, then what they hold.
struct TwoChunks {
  static constexpr std::size_t kParts = 1, kZero = 2, kBox = 4, kBoxZero = 10, kCount = 12,
                               kEnds = 16, kFirst = 24, kPadding = 27;
  UpdateCase u = test::make_update(probe_texture(Format::R16_SFLOAT, {2, 1, 1}, 1, 0),
                                   test::Content::smooth, true, 1, 1);
  Bytes payload = bytes({kVersion, 3, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 2, 0, 0, 0, 27, 0, 0, 0, 31, 0,
                         0, 0, 0, 1, 2, 0, 0, 3, 4});
  TwoChunks() { u.records = bytes({1, 2, 3, 4}); }
};

TEST(NativeHead, PartsOfAPayload) {
  using T = TwoChunks;
  const T t;
  ASSERT_NO_FATAL_FAILURE(expect_sound(t.u, t.payload));
  for (const int version : {0, 1, 3}) {
    expect_refused_at_once(t.u, with(t.payload, 0, version), Status::unsupported_version);
  }
  for (int bit = 4; bit < 256; bit *= 2) {
    expect_refused_at_once(t.u, with(t.payload, T::kParts, 3 | bit));
  }
  for (const auto place : {T::kZero, T::kZero + 1, T::kBoxZero, T::kBoxZero + 1, T::kPadding}) {
    SCOPED_TRACE(place);
    expect_refused_at_once(t.u, with(t.payload, place, 1));
  }
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
  for (const int side : {64, 65}) {
    const auto grid = Grid{static_cast<std::uint32_t>(side), 64, 1};
    const auto u = test::make_update(probe_texture(Format::R16_SFLOAT, grid, 1, 0),
                                     test::Content::white, true, 1, 1);
    Bytes payload = bytes({kVersion, 1, 0, 0, side, 0, 64, 0, 1, 0, 0, 0, kRawChunk});
    payload.insert(payload.end(), u.records.begin(), u.records.end());
    if (side == 64) {
      expect_sound(u, payload);
    } else {
      expect_refused_at_once(u, payload);
    }
  }
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
  expect_sound(one, bytes({kVersion, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 3, 4}));
  expect_refused_at_once(one, bytes({kVersion, 2, 0, 0, 1, 0, 0, 0, 12, 0, 0, 0, 0, 3, 4}));
  expect_refused_at_once(t.u, bytes({kVersion, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 3, 4}),
                         Status::truncated);
  auto none = t.u;
  none.blocks.clear();
  none.records.clear();
  expect_sound(none, bytes({kVersion, 0, 0, 0}));
  expect_refused_at_once(none, bytes({kVersion, 0, 0, 0, 0}));
}

// -- Heads of chunks ---------------------------------------------------------------------------

TEST(NativeHead, FirstBytes) {
  const TwoChunks t;
  for (int first = 1; first < 256; ++first) {  // of a raw chunk
    if ((first & 3) == kModelledChunk) continue;
    SCOPED_TRACE(first);
    expect_refused_at_once(t.u, with(t.payload, TwoChunks::kFirst, first));
  }
  for (const bool pairs : {false, true}) {
    const auto u = pairs ? visibility(true) : colour();
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
      expect_refused_at_once(u, with(sound, kChunk, first | kHasHits));
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
    write_head(plane_layout(u.desc.record), head, written);
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
      : u(test::make_update(probe_texture(Format::R16_SFLOAT, {probes, 1, 1}, 1, 0),
                            test::Content::smooth, true, 1, 1)) {
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
  const auto u = colour();
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
        Bytes out;
        EXPECT_EQ(decode(u, payload, out), Status::corrupt);
        EXPECT_FALSE(
            reference::decode(u.desc, u.blocks, u.mirror, u.received, payload).has_value());
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
  const auto two = test::make_update(probe_texture(Format::R32_SFLOAT, {4, 3, 2}, 4, 1),
                                     test::Content::smooth, true, 1, 1);
  const auto deep = encoded(two);
  check(two, deep.head, deep.groups, {true, true, false, true});
  auto own = encoded(visibility(false));
  own.head.tables.hits.members = 1;
  own.head.tables.hits.end[0][0] = 2000;
  own.head.tables.hits.end[0][1] = 3000;
  check(visibility(false), own.head, own.groups, {true, true, false, true});
}

// -- Tables of a chunk's own -------------------------------------------------------------------

TEST(NativeHead, OwnHits) {
  const auto u = visibility(true);
  auto [head, groups] = encoded(u);
  OwnHits& hits = head.tables.hits;
  hits.members = 3;
  for (unsigned m = 0; m < 3; ++m) {
    hits.end[m][0] = static_cast<std::uint16_t>(m == 1 ? 1 : 1000 + m);
    hits.end[m][1] = static_cast<std::uint16_t>(m == 1 ? 4095 : 2000 + m);
  }
  for (unsigned c = 0; c < kHitContexts; ++c) hits.map[c] = c % 3;
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  constexpr std::size_t kHits = kChunk + 7, kEnds = kHits + 1, kMap = kEnds + 3 * 4;
  for (const int members : {0, 17}) expect_refused_at_once(u, with(sound, kHits, members));
  const auto ends = [&](unsigned m, int end0, int end1) {
    Bytes payload = sound;
    for (unsigned k = 0; k < 2; ++k) {
      const int end = k == 0 ? end0 : end1;
      payload = with(with(payload, kEnds + 4 * m + 2 * k, end & 255), kEnds + 4 * m + 2 * k + 1,
                     end >> 8);
    }
    return payload;
  };
  for (const unsigned m : {0U, 2U}) {
    expect_refused_at_once(u, ends(m, 0, 2000));
    expect_refused_at_once(u, ends(m, 2000, 2000));
    expect_refused_at_once(u, ends(m, 2001, 2000));
    expect_refused_at_once(u, ends(m, 1000, 4096));
  }
  for (const std::size_t i : {0U, 31U}) {
    const int both = at(sound, kMap + i);
    expect_refused_at_once(u, with(sound, kMap + i, (both & 0xF0) | 3));
    expect_refused_at_once(u, with(sound, kMap + i, (both & 0x0F) | 3 << 4));
  }
}

/// Overrides of two members and two contexts in the place `place` that change nothing: what a
/// decoder that does not look would read.
struct SameTables {
  static constexpr std::size_t kMember = 18;  ///< number, form, 14 units, that of the escape
  static constexpr std::size_t kNumber = 1, kForm = 2, kUnits = 4, kEscapeUnits = 18,
                               kSecond = kNumber + kMember, kContextCount = kSecond + kMember,
                               kEntries = kContextCount + 2;
  UpdateCase u;
  Bytes payload;
  std::size_t begin;  ///< of the overrides of that place

  SameTables(const UpdateCase& update, unsigned place) : u(update) {
    const PlaneLayout layout = plane_layout(u.desc.record);
    const auto [head, groups] = encoded(u);
    const Bytes plain = payload_of(u, head, groups);
    Bytes written;
    write_head(layout, head, written);
    const std::size_t rest = kChunk + written.size();
    payload.assign(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(rest));
    payload[kChunk] |= std::byte{kHasOverrides};
    ByteWriter writer(payload);
    for (unsigned p = 0; p < residual_places(layout.pairs); ++p) {
      if (p != place) {
        writer.bytes(bytes({0, 0, 0}));
        continue;
      }
      begin = payload.size();
      const unsigned role = role_of(layout.pairs, !u.keyframe, p);
      const auto& map = role_tables(role, 0).map;
      writer.bytes(bytes({2}));
      for (const unsigned m : {2U, 9U}) write_whole(writer, m, member_of(role, 0, m));
      writer.bytes(bytes({2, 0, 10, map[10], 200, map[200]}));
    }
    writer.bytes(std::span(plain).subspan(rest));
  }
  static void write_whole(ByteWriter& writer, unsigned number, const Member& m) {
    writer.fixed(static_cast<std::uint8_t>(number));
    writer.fixed(static_cast<std::uint16_t>(m.shift | m.unit << 3 | kEscape << 6));
    for (const auto units : m.units) writer.fixed(units);
  }
  [[nodiscard]] Bytes damaged(std::size_t place, int value) const {
    return with(payload, begin + place, value);
  }
  [[nodiscard]] int byte(std::size_t place) const { return at(payload, begin + place); }
};

TEST(NativeHead, Overrides) {
  using S = SameTables;
  for (const bool pairs : {false, true}) {
    for (unsigned place = 0; place < residual_places(pairs); ++place) {
      SCOPED_TRACE(std::string(pairs ? "pairs " : "planes ") + std::to_string(place));
      const S s(pairs ? visibility(false) : colour(), place);
      ASSERT_NO_FATAL_FAILURE(expect_sound(s.u, s.payload));
      const auto refused = [&](std::size_t at, int value) {
        SCOPED_TRACE(at);
        expect_refused_at_once(s.u, s.damaged(at, value));
      };
      refused(0, 17);
      refused(S::kNumber, 9);   // the same twice
      refused(S::kNumber, 10);  // descending
      refused(S::kSecond, 16);
      const int low = s.byte(S::kForm), high = s.byte(S::kForm + 1);
      for (const int unit : {5, 6, 7}) refused(S::kForm, (low & ~0x38) | unit << 3);
      refused(S::kForm, low | 1 << 6);  // 15 units
      for (int bit = 4; bit < 256; bit *= 2) refused(S::kForm + 1, high | bit);
      refused(S::kEscapeUnits, 0);
      refused(S::kUnits, 255);
      refused(S::kContextCount + 1, 2);
      refused(S::kEntries + 2, 10);  // the same twice
      refused(S::kEntries + 2, 9);   // descending
      for (const int member : {16, 255}) refused(S::kEntries + 1, member);
      // More than there are contexts, whatever they are.
      Bytes many = s.damaged(S::kContextCount + 1, 1);
      many.insert(many.begin() + static_cast<std::ptrdiff_t>(s.begin + S::kEntries), 510,
                  std::byte{0});
      many[s.begin + S::kContextCount] = std::byte{1};
      expect_refused_at_once(s.u, many);
    }
  }
}

/// Sums of units up to 255 are taken, one more is not.
TEST(NativeHead, UnitsOfAMember) {
  const auto u = colour();
  auto [head, groups] = encoded(u);
  Member m{4, 0, {}};
  std::fill(std::begin(m.units), std::end(m.units), std::uint8_t{17});
  for (std::uint8_t number = 0; number < kMembers; ++number) {
    head.tables.overrides[0].members.push_back({number, m});
  }
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  for (unsigned s = 0; s < kListed; ++s) {
    const std::size_t last = kChunk + 6 + 1 + 15 * SameTables::kMember + 3 + s;
    ASSERT_EQ(at(sound, last), 17);
    expect_refused_at_once(u, with(sound, last, 18));
  }
}

}  // namespace
}  // namespace gicodec::native
