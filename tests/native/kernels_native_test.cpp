// The stages of the kernels: each with its inverse, and alike on every instruction set.
#include "native/planes.h"
#include "native/tables.h"
#include "support.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>

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
  for (const auto& format : formats()) {
    if (!can_code(probe_texture(format.record, {1, 1, 1}, 1))) continue;
    const auto layout = plane_layout(format.record);
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

/// Steps of every value width, contexts at random, any set of active lanes.
TEST(NativeKernels, StepsAreWrittenAndReadBack) {
  test::Random random(3);
  std::vector<Step> steps(400);
  for (auto& s : steps) {
    s.hit = 0;
    s.active = test::chance(random, 3) ? 0xFFFFFFFFU : static_cast<std::uint32_t>(random());
    const auto context = static_cast<std::uint16_t>(random() % (kRows * kRowSize));
    const unsigned bits = test::pick(random, 0, 16);
    for (unsigned l = 0; l < kLanes; ++l) {
      s.context[l] = context;
      s.value[l] = static_cast<std::uint16_t>(random() & ((1U << bits) - 1));
    }
  }
  const Tables& t = tables(1, true);
  std::vector<std::uint8_t> first;
  for (const Isa isa : supported_isas()) {
    std::vector<std::uint8_t> buffer(steps.size() * kMaxStepBytes + kSlack);
    Output out{};
    for (auto& x : out.state) x = kStateLow;
    out.next = buffer.data() + buffer.size();
    kernels(isa).encode_steps(steps.data(), steps.data() + steps.size(), t, out);
    std::vector<std::uint8_t> words(out.next, buffer.data() + buffer.size());
    const std::size_t size = words.size();
    if (first.empty()) first = words;
    EXPECT_EQ(words, first) << to_string(isa);
    words.resize(size + kSlack + kMaxTexelBytes);
    Input in{};
    std::memcpy(in.state, out.state, sizeof in.state);
    in.next = words.data();
    in.end = in.next + size;
    for (const auto& s : steps) {
      alignas(64) std::uint16_t values[kLanes];
      ASSERT_TRUE(kernels(isa).decode_values(s.active, s.context[0], t, in, values));
      for (unsigned l = 0; l < kLanes; ++l) {
        if ((s.active >> l & 1) != 0) {
          ASSERT_EQ(values[l], s.value[l]) << to_string(isa);
        }
      }
    }
    EXPECT_EQ(in.next, in.end);
    for (const auto x : in.state) EXPECT_EQ(x, kStateLow);
  }
}

TEST(NativeTables, DataIsSound) {
  for (const auto& f : kTableData.frequency) {
    unsigned sum = 0;
    for (const unsigned n : f) {
      EXPECT_GE(n, 1U);
      sum += n;
    }
    EXPECT_EQ(sum, kProbabilityScale);
  }
  for (unsigned set = 0; set < kSets; ++set) {
    for (const char* row : kTableData.map[set])
      EXPECT_EQ(std::strlen(row), kSignClasses * kMagnitudes);
    for (const auto& ends : kTableData.hits[set]) {
      for (unsigned c = 0; c < kHitContexts; ++c) {
        EXPECT_GE(ends[0][c], 1U);
        EXPECT_LT(ends[0][c], ends[1][c]);
        EXPECT_LT(ends[1][c], kProbabilityScale);
      }
    }
  }
}

TEST(NativeTables, CostsAreLogarithms) {
  EXPECT_EQ(frequency_cost(4096), 0);
  EXPECT_EQ(frequency_cost(2048), 256);
  EXPECT_EQ(frequency_cost(1), 12 * 256);
  for (unsigned f = 2; f <= 4096; ++f) EXPECT_LE(frequency_cost(f), frequency_cost(f - 1));
}

}  // namespace
}  // namespace gicodec::native
