#include "native/frame/statistics.h"

#include "native/planes/tables.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace gicodec::native {
namespace {

constexpr double kPriceUnit = 1.0 / 256;  // bits

double token_bits(const RoleTables& tables, std::uint16_t context, std::uint16_t value) {
  return tables.price[tables.map[context]][bin_of(value)] * kPriceUnit;
}

void count_repeats(const Step& step, const RepeatTables& tables, PayloadStatistics& s) {
  for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
    const auto l = static_cast<unsigned>(std::countr_zero(rest));
    const std::uint32_t end[] = {0, tables.end(0, step.context[l]), tables.end(1, step.context[l]),
                                 kProbabilityScale};
    const unsigned symbol = step.value[l];
    s.repeat_bits += frequency_cost(end[symbol + 1] - end[symbol]) * kPriceUnit;
    ++s.repeats[symbol];
  }
}

void count_residuals(const Step& step, unsigned plane, const RoleTables& tables,
                     PayloadStatistics& s) {
  for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
    const auto l = static_cast<unsigned>(std::countr_zero(rest));
    s.plane_bits[plane] += token_bits(tables, step.context[l], step.value[l]);
    ++s.plane_symbols[plane];
  }
}

}  // namespace

void count_group(const Update& u, const Group& group, const Tables& tables, Workspace& w,
                 PayloadStatistics& s) {
  const unsigned kinds = u.layout.mode_kinds(u.update);
  for (unsigned k = 0; k < kinds; ++k) {
    const auto context = static_cast<std::uint16_t>(mode_context(u.layout.pairs, u.update, k));
    for (std::uint32_t rest = group.active; rest != 0; rest &= rest - 1) {
      const std::uint16_t mode = group.mode[k][std::countr_zero(rest)];
      s.mode_bits += token_bits(*tables.role[kModePlace], context, mode);
      ++s.modes[k][mode];
    }
  }
  w.reserve_steps(u, 1);
  const Step* step = w.steps.data();
  const Step* const end = u.layout.pairs ? u.kernels.model_pairs(group, w.steps.data())
                                         : u.kernels.model_planes(group, w.steps.data());
  for (; step != end; ++step) {
    if (step->repeat != 0) {
      count_repeats(*step, *tables.repeats, s);
    } else {
      count_residuals(*step, step->plane, *tables.role[step->place], s);
    }
  }
}

}  // namespace gicodec::native

namespace gicodec {

PayloadStatistics& PayloadStatistics::operator+=(const PayloadStatistics& other) noexcept {
  chunks += other.chunks;
  raw_chunks += other.raw_chunks;
  chunk_blocks = std::max(chunk_blocks, other.chunk_blocks);
  head_bytes += other.head_bytes;
  table_bytes += other.table_bytes;
  raw_bytes += other.raw_bytes;
  word_bytes += other.word_bytes;
  mode_bits += other.mode_bits;
  repeat_bits += other.repeat_bits;
  for (unsigned p = 0; p < kPlanes; ++p) {
    plane_bits[p] += other.plane_bits[p];
    plane_symbols[p] += other.plane_symbols[p];
  }
  for (unsigned i = 0; i < std::size(repeats); ++i) repeats[i] += other.repeats[i];
  for (unsigned k = 0; k < std::size(modes); ++k) {
    for (unsigned m = 0; m < std::size(modes[k]); ++m) modes[k][m] += other.modes[k][m];
  }
  return *this;
}

}  // namespace gicodec
