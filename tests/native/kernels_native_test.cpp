// The stages of the kernels: each with its inverse, and equal on every instruction set.
#include "distinct_formats.h"
#include "native/planes/adaptation.h"
#include "native/planes/distribution_fit.h"
#include "native/planes/planes.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::native {
namespace {

TEST(NativeKernels, LanesAndBack) {
  test::Random random(1);
  constexpr std::size_t kCount = 40;
  std::vector<std::vector<std::uint16_t>> blocks(kLanes, std::vector<std::uint16_t>(kCount));
  std::array<const std::uint16_t*, kLanes> in;
  for (unsigned l = 0; l < kLanes; ++l) {
    for (auto& v : blocks[l]) v = static_cast<std::uint16_t>(random());
    in[l] = blocks[l].data();
  }
  for (const Isa isa : supported_isas()) {
    std::vector<std::uint16_t> lanes(kCount * kLanes);
    kernels(isa).to_lanes(in.data(), kCount, lanes.data());
    for (unsigned l = 0; l < kLanes; ++l) {
      for (std::size_t t = 0; t < kCount; ++t) ASSERT_EQ(lanes[t * kLanes + l], blocks[l][t]);
    }
    std::vector<std::vector<std::uint16_t>> back(kLanes, std::vector<std::uint16_t>(kCount));
    std::array<std::uint16_t*, kLanes> out;
    for (unsigned l = 0; l < kLanes; ++l) out[l] = back[l].data();
    kernels(isa).from_lanes(lanes.data(), kCount, out.data());
    EXPECT_EQ(back, blocks) << to_string(isa);
  }
}

TEST(NativeKernels, EveryFormatUnpacksAndPacks) {
  test::Random random(2);
  for (const auto& format : test::distinct_formats()) {
    const auto layout = plane_layout(probe_texture(format.record, {1, 1, 1}, 1));
    unsigned bits = 0;
    for (unsigned p = 0; p < layout.planes; ++p) bits += layout.plane[p].bits;
    EXPECT_EQ(bits, 8U * format.record.bytes) << format.name;
    const std::size_t texels = 37;
    const auto bytes = test::noise(random, texels * format.record.bytes);
    std::vector<std::uint16_t> first;
    for (const Isa isa : supported_isas()) {
      std::vector<std::uint16_t> planes(layout.planes * texels);
      std::vector<std::byte> back(bytes.size());
      kernels(isa).unpack(layout, reinterpret_cast<const std::uint8_t*>(bytes.data()), texels,
                          planes.data());
      kernels(isa).pack(layout, planes.data(), texels,
                        reinterpret_cast<std::uint8_t*>(back.data()));
      EXPECT_EQ(back, bytes) << format.name << to_string(isa);
      if (first.empty()) first = planes;
      EXPECT_EQ(planes, first) << format.name << to_string(isa);
    }
  }
}

/// Tables of every place as chunks may have them: of any sets, some with overrides or own repeats.
struct AnyTables {
  AnyTables(test::Random& random, bool pairs, bool update) {
    TableChoice choice;
    for (auto& set : choice.set) set = static_cast<std::uint8_t>(test::pick(random, 0, kSets - 1));
    for (unsigned p = 0; p < residual_places(pairs); ++p) {
      if (test::chance(random, 2)) override_place(random, choice.overrides[p]);
    }
    if (!pairs || test::chance(random, 2)) own_repeats(random, choice.repeats);
    tables = adapted.apply(pairs, update, choice);
  }
  static void override_place(test::Random& random, Overrides& overrides) {
    for (unsigned m = 0; m < kDistributions; m += test::pick(random, 1, 5)) {
      std::uint32_t counts[kBins] = {};
      for (unsigned i = 0; i < 9; ++i) counts[test::pick(random, 0, bin_of(0xFFFF))] += 1U << i;
      overrides.distributions.push_back({static_cast<std::uint8_t>(m), fit_distribution(counts)});
    }
    for (unsigned c = 0; c < kContexts; c += test::pick(random, 1, 9)) {
      overrides.contexts.push_back(
          {static_cast<std::uint8_t>(c),
           static_cast<std::uint8_t>(test::pick(random, 0, kDistributions - 1))});
    }
  }
  static void own_repeats(test::Random& random, OwnRepeats& repeats) {
    repeats.distributions = test::pick(random, 1, kDistributions);
    for (unsigned m = 0; m < repeats.distributions; ++m) {
      repeats.end[m][0] = static_cast<std::uint16_t>(test::pick(random, 1, 4094));
      repeats.end[m][1] =
          static_cast<std::uint16_t>(test::pick(random, repeats.end[m][0] + 1U, 4095));
    }
    for (auto& m : repeats.map) {
      m = static_cast<std::uint8_t>(test::pick(random, 0, repeats.distributions - 1));
    }
  }
  AdaptedTables adapted;
  Tables tables;
};

struct Coded {
  Output out{};
  std::vector<std::uint8_t> words;  ///< and room to read whole vectors

  Coded(const Kernels& kernels, std::span<const Step> steps, const Tables& tables) {
    std::vector<std::uint8_t> buffer(steps.size() * kMaxStepBytes + kSlack);
    std::fill(std::begin(out.state), std::end(out.state), kStateLow);
    out.next = buffer.data() + buffer.size();
    kernels.encode_steps(steps.data(), steps.data() + steps.size(), tables, out);
    words.assign(out.next, buffer.data() + buffer.size());
    size = words.size();
    words.resize(size + kSlack + kMaxTexelBytes);
  }
  [[nodiscard]] Input input() const {
    Input in{};
    for (unsigned l = 0; l < kLanes; ++l) {
      in.high[l] = static_cast<std::uint16_t>(out.state[l] >> 16);
      in.low[l] = static_cast<std::uint16_t>(out.state[l]);
    }
    in.next = words.data();
    in.end = in.next + size;
    return in;
  }
  std::size_t size;
};
void expect_end(const Input& in) {
  EXPECT_EQ(in.next, in.end);
  for (unsigned l = 0; l < kLanes; ++l) {
    EXPECT_EQ(in.high[l] << 16 | in.low[l], kStateLow);
  }
}
void expect_same(const Coded& a, const Coded& b) {
  EXPECT_EQ(a.words, b.words);
  EXPECT_TRUE(std::equal(std::begin(a.out.state), std::end(a.out.state), b.out.state));
}

constexpr std::pair<bool, bool> kModels[] = {
    {false, false}, {false, true}, {true, false}, {true, true}};

std::vector<Step> any_steps(test::Random& random, bool pairs, std::size_t count) {
  std::vector<Step> steps(count);
  for (auto& s : steps) {
    s.repeat = 0;
    s.active = test::chance(random, 3) ? 0xFFFFFFFFU : static_cast<std::uint32_t>(random());
    const unsigned place = test::pick(random, 0, residual_places(pairs));
    s.place = static_cast<std::uint16_t>(place == residual_places(pairs) ? kModePlace : place);
    const auto context = static_cast<std::uint16_t>(random() % kContexts);
    const unsigned bits = test::pick(random, 0, 16);
    for (unsigned l = 0; l < kLanes; ++l) {
      s.context[l] = context;
      s.value[l] = static_cast<std::uint16_t>(random() & ((1U << bits) - 1));
    }
  }
  return steps;
}

/// Steps of every role, place and value width, contexts at random, any set of active lanes.
TEST(NativeKernels, StepsAreWrittenAndReadBack) {
  test::Random random(3);
  for (const auto& [pairs, update] : kModels) {
    for (int round = 0; round < 20; ++round) {
      const AnyTables any(random, pairs, update);
      const auto steps = any_steps(random, pairs, 200);
      const Coded first(kernels(Isa::scalar), steps, any.tables);
      for (const Isa isa : supported_isas()) {
        SCOPED_TRACE(to_string(isa));
        const Coded coded(kernels(isa), steps, any.tables);
        expect_same(coded, first);
        Input in = coded.input();
        for (const auto& s : steps) {
          alignas(64) std::uint16_t values[kLanes];
          ASSERT_TRUE(kernels(isa).decode_values(*any.tables.role[s.place], s.active, s.context[0],
                                                 in, values));
          for (unsigned l = 0; l < kLanes; ++l) {
            if ((s.active >> l & 1) != 0) {
              ASSERT_EQ(values[l], s.value[l]);
            }
          }
        }
        expect_end(in);
      }
    }
  }
}

/// Reading beyond the words is detected, whatever is read there.
TEST(NativeKernels, MissingWordsAreTold) {
  test::Random random(7);
  const AnyTables any(random, false, true);
  const auto steps = any_steps(random, false, 100);
  for (const Isa isa : supported_isas()) {
    const Coded coded(kernels(isa), steps, any.tables);
    Input in = coded.input();
    in.end -= 2;
    bool sound = true;
    for (const auto& s : steps) {
      alignas(64) std::uint16_t values[kLanes];
      sound = sound && kernels(isa).decode_values(*any.tables.role[s.place], s.active, s.context[0],
                                                  in, values);
    }
    EXPECT_FALSE(sound) << to_string(isa);
  }
}

/// Prices are the bits of the words, but for states and the rounding of logarithms.
TEST(NativeKernels, PricesAreWhatStepsTake) {
  test::Random random(4);
  for (const auto& [pairs, update] : kModels) {
    const AnyTables any(random, pairs, update);
    const auto steps = any_steps(random, pairs, 2000);
    const std::size_t size = Coded(kernels(Isa::scalar), steps, any.tables).size;
    std::array<std::uint32_t, kLanes> first{};
    for (const Isa isa : supported_isas()) {
      std::array<std::uint32_t, kLanes> cost{};
      for (unsigned place = 0; place < kPlaces; ++place) {
        if (any.tables.role[place] == nullptr) continue;
        kernels(isa).price_steps(steps.data(), steps.data() + steps.size(), place,
                                 *any.tables.role[place], cost.data());
      }
      if (isa == Isa::scalar) first = cost;
      EXPECT_EQ(cost, first) << to_string(isa);
    }
    const double bytes = std::accumulate(first.begin(), first.end(), 0.0) / (8 * 256);
    EXPECT_NEAR(static_cast<double>(size), bytes, 0.01 * bytes + 4 * kLanes);
  }
}

/// A group with its own memory; values are near the references, or anything.
struct AnyGroup {
  AnyGroup(test::Random& random, bool of_pairs, bool update) : pairs(of_pairs) {
    Group& g = group;
    const unsigned used = test::pick(random, 1, kLanes);
    g.active = used == kLanes ? 0xFFFFFFFFU : (1U << used) - 1;
    g.width = test::pick(random, 1, 6);
    g.rows = test::pick(random, 1, 6);
    g.planes = pairs ? 2 : test::pick(random, 1, kMaxPlanes);
    g.update = update;
    for (auto& bits : g.bits)
      bits = static_cast<std::uint8_t>(pairs ? 16 : test::pick(random, 1, 16));
    g.coded =
        static_cast<std::uint32_t>(pairs ? 3 : random() & ((std::uint64_t{1} << g.planes) - 1));
    for (auto& kind : g.mode) {
      for (auto& mode : kind) mode = static_cast<std::uint16_t>(random() % kModes);
    }
    for (auto& frequent : g.frequent) frequent = static_cast<std::uint16_t>(random());
    const bool near = !test::chance(random, 3);
    for (auto& v : arrays) v.resize(g.planes * plane());
    for (std::size_t i = 0; i < arrays[0].size(); ++i) {
      const std::uint32_t mask = (1U << g.bits[i / plane()]) - 1;
      const auto base = static_cast<std::uint32_t>(random());
      for (auto& v : arrays) {
        v[i] = static_cast<std::uint16_t>((near ? base + random() % 3 : random()) & mask);
      }
    }
    g.shared = !pairs && test::chance(random, 2);
    if (!pairs && test::chance(random, 2)) make_partial(random);
    g.repeats = !pairs && !g.shared && g.present == nullptr && test::chance(random, 3);
    scratch.resize(scratch_size(plane() / kLanes, g.planes, pairs, g.shared));
    g.reference = arrays[0].data();
    for (unsigned k = 0; k < 4; ++k) g.candidate[k] = arrays[1 + k].data();
    g.current = arrays[5].data();
    g.scratch = scratch.data();
  }
  /// Some records do not exist, and are zero.
  void make_partial(test::Random& random) {
    const std::uint32_t one_in = test::pick(random, 1, 4);
    present.resize(plane() / kLanes);
    std::uint32_t before = 0;
    for (auto& p : present) {
      std::uint32_t here = 0;
      for (unsigned l = 0; l < kLanes; ++l) here |= (test::chance(random, one_in) ? 1U : 0U) << l;
      p = {here & group.active, before};
      before |= p.here;
    }
    for (std::size_t i = 0; i < arrays[5].size(); ++i) {
      const std::uint32_t here = present[i % plane() / kLanes].here;
      if ((here >> i % kLanes & 1) == 0) arrays[5][i] = 0;
    }
    group.present = present.data();
  }
  /// Values of a plane.
  [[nodiscard]] std::size_t plane() const { return std::size_t{group.width} * group.rows * kLanes; }
  std::vector<Step> model(const Kernels& kernels) {
    std::vector<Step> steps(3 * group.planes * plane() / kLanes);
    Step* const end = pairs ? kernels.model_pairs(group, steps.data())
                            : kernels.model_planes(group, steps.data());
    steps.resize(static_cast<std::size_t>(end - steps.data()));
    return steps;
  }
  bool decode(const Kernels& kernels, const Tables& tables, Input& in) {
    return pairs ? kernels.decode_pairs(group, tables, in)
                 : kernels.decode_planes(group, tables, in);
  }
  bool pairs;
  Group group{};
  std::vector<std::uint16_t> arrays[6], scratch;
  std::vector<Present> present;
};

/// Each lane with contexts of its own, and repeats.
TEST(NativeKernels, GroupsAreModelledAndDecoded) {
  test::Random random(8);
  for (const auto& [pairs, update] : kModels) {
    for (int round = 0; round < 30; ++round) {
      AnyGroup any(random, pairs, update);
      Group& g = any.group;
      const AnyTables tables(random, pairs, update);
      const auto original = any.arrays[5];
      const Coded first(kernels(Isa::scalar), any.model(kernels(Isa::scalar)), tables.tables);
      for (const Isa isa : supported_isas()) {
        SCOPED_TRACE(to_string(isa));
        any.arrays[5] = original;
        g.current = any.arrays[5].data();
        std::fill(any.scratch.begin(), any.scratch.end(), std::uint16_t{0xABCD});
        const Coded coded(kernels(isa), any.model(kernels(isa)), tables.tables);
        expect_same(coded, first);
        Input in = coded.input();
        for (std::size_t i = 0; i < any.arrays[5].size(); ++i) {
          if ((g.coded >> i / any.plane() & 1) != 0) any.arrays[5][i] = 0xDCBA;
        }
        ASSERT_TRUE(any.decode(kernels(isa), tables.tables, in));
        expect_end(in);
        for (std::size_t i = 0; i < original.size(); ++i) {
          if ((g.active >> i % kLanes & 1) != 0) {
            ASSERT_EQ(any.arrays[5][i], original[i]) << i;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::native
