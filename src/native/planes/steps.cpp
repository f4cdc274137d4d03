#include "native/planes/steps.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace gicodec::native {
namespace {

constexpr std::size_t kSampledBlocks = 8;  ///< blocks

/// The values of a plane as far as they were seen.
struct PlaneStatistics {
  std::uint32_t step = 0;  ///< greatest common divisor; 0: none but 0
  std::uint16_t least = 0xFFFF, most = 0;
};

/// In pairs, whose differences wrap, only powers of two divide. Zeros, of which every step is a
/// divisor, are passed over where they may not exist.
void accumulate(const PlaneLayout& layout, unsigned plane, bool zeros,
                std::span<const std::uint16_t> values, PlaneStatistics& statistics) {
  const std::uint32_t largest = (1U << layout.plane[plane].stored) - 1;
  for (const std::uint16_t value : values) {
    if (value == 0 && !zeros) continue;
    statistics.least = std::min(statistics.least, value);
    statistics.most = std::max(statistics.most, value);
    if (statistics.step == 1 || (value == largest && !layout.pairs)) continue;
    const std::uint32_t both =
        layout.pairs ? statistics.step | value : std::gcd(statistics.step, value);
    statistics.step = layout.pairs ? both & (~both + 1) : both;
  }
}

class StepFinder {
 public:
  StepFinder(const EncodeJob& job, const Kernels& kernels, PlaneLayout& layout,
             Vector<std::uint16_t>& scratch)
      : job_(job), kernels_(kernels), layout_(layout), texels_(record_count(job.desc.block)) {
    scratch.resize(block_stride(layout.planes, texels_));
    planes_ = scratch.data();
  }

  void run() {
    const bool zeros = job_.desc.presence == Presence::all;
    const std::size_t blocks = job_.blocks.size(), sampled = std::min(blocks, kSampledBlocks);
    std::uint64_t candidates = (std::uint64_t{1} << layout_.planes) - 1;
    for (std::size_t i = 0; i < sampled && candidates != 0; ++i) {
      unpack(i * blocks / sampled);
      for (unsigned p = 0; p < layout_.planes; ++p) {
        accumulate(layout_, p, zeros, plane(p), statistics_[p]);
        if (statistics_[p].step == 1) candidates &= ~(std::uint64_t{1} << p);
      }
    }
    PlaneLayout tried = layout_;
    for (unsigned p = 0; p < layout_.planes; ++p) {
      // A constant needs no steps.
      const bool some = statistics_[p].step > 1 && statistics_[p].least < statistics_[p].most;
      if (!some) candidates &= ~(std::uint64_t{1} << p);
      if (some) set_step(tried, p, statistics_[p].step);
    }
    for (std::size_t i = 0; i < blocks && candidates != 0; ++i) {
      unpack(i);
      for (unsigned p = 0; p < layout_.planes; ++p) {
        if ((candidates >> p & 1) == 0 || kernels_.has_steps(tried, p, plane(p).data(), texels_))
          continue;
        accumulate(layout_, p, zeros, plane(p), statistics_[p]);
        if (statistics_[p].step == 1) {
          candidates &= ~(std::uint64_t{1} << p);
        } else {
          set_step(tried, p, statistics_[p].step);
        }
      }
    }
    for (unsigned p = 0; p < layout_.planes; ++p) {
      if ((candidates >> p & 1) != 0) set_step(layout_, p, statistics_[p].step);
    }
  }

 private:
  void unpack(std::size_t block) {
    const auto* records = reinterpret_cast<const std::uint8_t*>(job_.records[block].data());
    kernels_.unpack(layout_, records, texels_, planes_);
  }
  [[nodiscard]] std::span<const std::uint16_t> plane(unsigned p) const {
    return {planes_ + p * texels_, texels_};
  }

  const EncodeJob& job_;
  const Kernels& kernels_;
  PlaneLayout& layout_;
  std::size_t texels_;
  std::uint16_t* planes_ = nullptr;
  PlaneStatistics statistics_[kMaxPlanes] = {};
};

}  // namespace

void find_steps(const EncodeJob& job, const Kernels& kernels, PlaneLayout& layout,
                Vector<std::uint16_t>& scratch) {
  StepFinder(job, kernels, layout, scratch).run();
}

}  // namespace gicodec::native
