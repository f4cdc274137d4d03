// Tables that chunks bring along (docs/native.md, section 8): what must not be there is refused.
#include "native/crafted.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec::native {
namespace {

using namespace test;

TEST(NativeOwnTables, RepeatCounts) {
  const auto u = visibility(true);
  auto [head, groups] = encoded(u);
  OwnRepeats& repeats = head.tables.repeats;
  repeats.distributions = 3;
  for (unsigned m = 0; m < 3; ++m) {
    repeats.end[m][0] = static_cast<std::uint16_t>(m == 1 ? 1 : 1000 + m);
    repeats.end[m][1] = static_cast<std::uint16_t>(m == 1 ? 4095 : 2000 + m);
  }
  for (unsigned c = 0; c < kRepeatContexts; ++c) repeats.map[c] = static_cast<std::uint8_t>(c % 3);
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  constexpr std::size_t kRepeatTables = kChunk + 7, kEnds = kRepeatTables + 1, kMap = kEnds + 3 * 4;
  for (const int distributions : {0, 17})
    expect_refused_at_once(u, with(sound, kRepeatTables, distributions));
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

/// Overrides of two distributions and two contexts in the place `place` that change nothing: what a
/// decoder that does not check would read.
struct SameTables {
  static constexpr std::size_t kDistribution =
      18;  ///< number, fields, 14 units, that of the escape
  static constexpr std::size_t kNumber = 1, kForm = 2, kUnits = 4, kEscapeUnits = 18,
                               kSecond = kNumber + kDistribution,
                               kContextCount = kSecond + kDistribution,
                               kEntries = kContextCount + 2;
  UpdateCase u;
  Bytes payload;
  std::size_t begin;  ///< of the overrides of that place

  SameTables(const UpdateCase& update, unsigned place) : u(update) {
    const PlaneLayout layout = plane_layout(u.desc);
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
      for (const unsigned m : {2U, 9U}) write_whole(writer, m, distribution_of(role, 0, m));
      writer.bytes(bytes({2, 0, 10, map[10], 200, map[200]}));
    }
    writer.bytes(std::span(plain).subspan(rest));
  }
  static void write_whole(ByteWriter& writer, unsigned number, const Distribution& m) {
    writer.fixed(static_cast<std::uint8_t>(number));
    writer.fixed(static_cast<std::uint16_t>(m.shift | m.unit << 3 | kEscape << 6));
    for (const auto units : m.units) writer.fixed(units);
  }
  [[nodiscard]] Bytes damaged(std::size_t place, int value) const {
    return with(payload, begin + place, value);
  }
  [[nodiscard]] int byte(std::size_t place) const { return at(payload, begin + place); }
};

TEST(NativeOwnTables, Overrides) {
  using S = SameTables;
  for (const bool pairs : {false, true}) {
    for (unsigned place = 0; place < residual_places(pairs); ++place) {
      SCOPED_TRACE(std::string(pairs ? "pairs " : "planes ") + std::to_string(place));
      const S s(pairs ? visibility(false) : colour(true), place);
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
      for (const int distribution : {16, 255}) refused(S::kEntries + 1, distribution);
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
TEST(NativeOwnTables, UnitsOfADistribution) {
  const auto u = colour(true);
  auto [head, groups] = encoded(u);
  Distribution m{4, 0, {}};
  std::fill(std::begin(m.units), std::end(m.units), std::uint8_t{17});
  for (std::uint8_t number = 0; number < kDistributions; ++number) {
    head.tables.overrides[0].distributions.push_back({number, m});
  }
  const Bytes sound = payload_of(u, head, groups);
  expect_sound(u, sound);
  for (unsigned s = 0; s < kListed; ++s) {
    const std::size_t last = kChunk + 6 + 1 + 15 * SameTables::kDistribution + 3 + s;
    ASSERT_EQ(at(sound, last), 17);
    expect_refused_at_once(u, with(sound, last, 18));
  }
}

}  // namespace
}  // namespace gicodec::native
