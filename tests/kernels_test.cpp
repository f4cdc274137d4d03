// Every implementation of the transform kernels gives the bits of the scalar one, for every count,
// and touches nothing outside its buffers.
#include "distinct_formats.h"
#include "shapes.h"
#include "support.h"

#include "texture/block_kernels.h"
#include "transform/byte_plane_kernels.h"
#include "transform/yuv444_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec {
namespace {

using namespace test;

/// Typed view of an exact buffer.
template <typename T>
T* as(Exact& buffer) {
  return reinterpret_cast<T*>(buffer.span().data());
}

bool same(const Exact& a, const Exact& b) { return test::same(a.span(), b.span()); }

std::vector<std::size_t> counts() {
  std::vector<std::size_t> all;
  for (std::size_t count = 0; count <= 70; ++count) all.push_back(count);
  all.insert(all.end(), {127, 128, 129, 255, 256, 500, 511, 512});
  return all;
}

class KernelsOf : public testing::TestWithParam<Isa> {
 protected:
  template <typename Table>
  const Table& tested() const {
    return kernels<Table>(GetParam());
  }
  template <typename Table>
  const Table& scalar() const {
    return kernels<Table>(Isa::scalar);
  }
  Random random_{41};
};

TEST_P(KernelsOf, Codes) {
  for (const auto count : counts()) {
    const Exact texels(noise(random_, 4 * count));
    for (const CodeShifts shifts : {CodeShifts{20, 10, 0, 6}, CodeShifts{0, 10, 20, 0},
                                    CodeShifts{20, 10, 0, 0}, CodeShifts{0, 10, 20, 6}}) {
      Exact y(2 * count), u(2 * count), v(2 * count), back(4 * count);
      Exact y0(2 * count), u0(2 * count), v0(2 * count), back0(4 * count);
      tested<Yuv444Kernels>().split_codes(texels.span().data(), count, shifts, as<std::uint16_t>(y),
                                          as<std::uint16_t>(u), as<std::uint16_t>(v));
      scalar<Yuv444Kernels>().split_codes(texels.span().data(), count, shifts,
                                          as<std::uint16_t>(y0), as<std::uint16_t>(u0),
                                          as<std::uint16_t>(v0));
      ASSERT_TRUE(same(y, y0) && same(u, u0) && same(v, v0)) << count;
      // Any samples, also such with bits outside the codes.
      for (auto* plane : {&y, &u, &v}) {
        for (auto& byte : plane->span()) byte = static_cast<std::byte>(random_());
      }
      const auto seen = tested<Yuv444Kernels>().join_codes(
          as<std::uint16_t>(y), as<std::uint16_t>(u), as<std::uint16_t>(v), count, shifts,
          back.span().data());
      const auto seen0 = scalar<Yuv444Kernels>().join_codes(
          as<std::uint16_t>(y), as<std::uint16_t>(u), as<std::uint16_t>(v), count, shifts,
          back0.span().data());
      ASSERT_EQ(seen, seen0) << count;
      ASSERT_TRUE(same(back, back0)) << count;
    }
  }
}

TEST_P(KernelsOf, BytesInTurn) {
  for (const auto count : counts()) {
    const Exact bytes(noise(random_, 3 * count));
    Exact y(count), u(count), v(count), back(3 * count);
    tested<Yuv444Kernels>().split_bytes(bytes.span().data(), count, as<std::uint8_t>(y),
                                        as<std::uint8_t>(u), as<std::uint8_t>(v));
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(y.span()[i], bytes.span()[3 * i]);
      ASSERT_EQ(u.span()[i], bytes.span()[3 * i + 1]);
      ASSERT_EQ(v.span()[i], bytes.span()[3 * i + 2]);
    }
    tested<Yuv444Kernels>().join_bytes(as<std::uint8_t>(y), as<std::uint8_t>(u),
                                       as<std::uint8_t>(v), count, back.span().data());
    ASSERT_TRUE(same(back, bytes)) << count;
  }
}

TEST_P(KernelsOf, Planes) {
  std::vector<Record> records;
  for (const auto& info : test::distinct_formats()) records.push_back(info.record);
  for (std::uint8_t bytes = 1; bytes <= kMaxRecordBytes; ++bytes) {
    records.push_back(custom_record(random_, bytes));
  }
  for (const Record& record : records) {
    const std::size_t bytes = record.bytes;
    const RecordLayout layout{record.components.data(), record.count, record.bytes};
    for (const auto count : counts()) {
      const std::size_t stride = count + random_() % 5;
      const std::size_t planes_size = count == 0 ? 0 : (bytes - 1) * stride + count;
      const Exact texels(noise(random_, bytes * count)), reference(noise(random_, bytes * count));
      for (const auto* ref : {static_cast<const std::byte*>(nullptr), reference.span().data()}) {
        Exact planes(planes_size), planes0(planes_size), back(bytes * count);
        tested<BytePlaneKernels>().to_planes(layout, texels.span().data(), ref,
                                             planes.span().data(), count, stride);
        scalar<BytePlaneKernels>().to_planes(layout, texels.span().data(), ref,
                                             planes0.span().data(), count, stride);
        ASSERT_TRUE(same(planes, planes0)) << bytes << " " << count;
        tested<BytePlaneKernels>().from_planes(layout, planes.span().data(), ref,
                                               back.span().data(), count, stride);
        ASSERT_TRUE(same(back, texels)) << bytes << " " << count;
      }
    }
  }
}

TEST_P(KernelsOf, RunsOfBlocks) {
  for (const unsigned bytes : {1U, 2U, 3U, 4U, 5U, 8U, 12U, 16U, 64U}) {
    for (const unsigned core : {1U, 2U, 5U, 8U, 16U, 17U}) {
      for (const unsigned band : {0U, 1U}) {
        for (const unsigned count : {1U, 3U, 64U}) {
          const unsigned side = core + 2 * band;
          // Side by side, or with padding between the blocks.
          const std::size_t step = (side + random_() % 3) * bytes;
          const std::size_t row = (count - 1) * step + side * bytes, pitch = row + random_() % 9;
          const std::size_t size = (side - 1) * pitch + row;
          const Exact cores(noise(random_, std::size_t{count} * core * core * bytes));
          Exact texture(noise(random_, size)), texture0(size), back(cores.span().size());
          std::copy_n(texture.span().data(), size, texture0.span().data());
          const auto run_in = [&](Exact& of) {
            return BlockRun<std::byte>{of.span().data(), pitch, step, count, core, band, bytes};
          };
          const auto strip = [&](const BlockKernels& with) {
            const BlockRun<const std::byte> run{
                texture.span().data(), pitch, step, count, core, band, bytes};
            return with.strip_run(run, back.span().data());
          };
          tested<BlockKernels>().reconstruct_run(cores.span().data(), run_in(texture));
          scalar<BlockKernels>().reconstruct_run(cores.span().data(), run_in(texture0));
          ASSERT_TRUE(same(texture, texture0)) << bytes << " " << core << " " << band;
          EXPECT_EQ(strip(tested<BlockKernels>()), 0U);
          ASSERT_TRUE(same(back, cores)) << bytes << " " << core << " " << band;
          // Some damage anywhere, guard bands, core texels or between the rows.
          for (unsigned i = 0; i <= count / 4; ++i) {
            texture.span()[random_() % size] ^= std::byte{0x10};
          }
          const auto stale = strip(tested<BlockKernels>());
          const Exact once(back.span());
          EXPECT_EQ(stale, strip(scalar<BlockKernels>())) << bytes << " " << core << " " << band;
          EXPECT_TRUE(same(back, once));
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, KernelsOf, testing::ValuesIn(supported_isas()),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(Kernels, Names) {
  for (const Isa isa : {Isa::scalar, Isa::sse4, Isa::avx2, Isa::avx512, Isa::neon, Isa::simd128}) {
    EXPECT_EQ(isa_from_string(to_string(isa)), isa);
  }
  EXPECT_EQ(isa_from_string("mmx"), std::nullopt);
}

TEST(Kernels, TheBestIsUsed) {
  ASSERT_FALSE(supported_isas().empty());
  EXPECT_EQ(supported_isas().front(), Isa::scalar);
  EXPECT_TRUE(std::is_sorted(supported_isas().begin(), supported_isas().end()));
  EXPECT_EQ(best_isa(), supported_isas().back());
  EXPECT_EQ(EncoderOptions{}.settings.isa, best_isa());
  EXPECT_EQ(DecoderOptions{}.isa, best_isa());
}

}  // namespace
}  // namespace gicodec
