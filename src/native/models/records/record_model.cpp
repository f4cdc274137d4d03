#include "native/models/records/record_model.h"

#include "base/binary_coder.h"
#include "native/models/numbers.h"
#include "native/models/records/record_contexts.h"
#include "quantise/component_code.h"
#include "quantise/set_order.h"
#include "texture/presence.h"

#include <algorithm>

namespace gicodec::native {
namespace {

// Mixers of flags, below those of signs.
constexpr unsigned kChangedMixer = 0, kComponentsMixer = 2, kSameMixer = 16, kMatchMixer = 32;
constexpr unsigned kCandidates = 3, kTopBits = 8;
/// Components in rows: small ones are coded by their differences, large ones may be copies.
constexpr unsigned kSmall = 8, kLarge = 16;

bool all_zero(const std::array<std::uint32_t, kMaxComponents>& values) {
  return std::all_of(values.begin(), values.end(), [](std::uint32_t v) { return v == 0; });
}

}  // namespace

void RecordModel::reset(const TextureDesc& desc, bool update, ValueModel& values) {
  values_ = &values;
  constexpr unsigned kMaxShift = 5;
  values_->reset();
  desc_ = desc;
  update_ = update;
  one_row_ = desc.block.y == 1 && desc.block.z == 1;
  mantissas_ = 0;
  exponent_ = 0;
  const Record& record = desc_.record;
  unsigned next = 0;
  for (unsigned c = 0; c < record.count; ++c) {
    const Component& component = record.components[c];
    if (component.type != ComponentType::exponent || component.bits > kMaxShift) continue;
    exponent_ = c;
    order_[next++] = static_cast<std::uint8_t>(c);
    break;
  }
  const bool shared = next != 0;
  for (unsigned i = 0; i < record.count; ++i) {
    const unsigned c = record.count >= 3 && i < 2 ? 1 - i : i;
    const Component& component = record.components[c];
    if (shared && c == exponent_) continue;
    if (shared && component.type == ComponentType::ufloat && component.bits < 10) {
      mantissas_ |= 1U << c;
    }
    order_[next++] = static_cast<std::uint8_t>(c);
  }
  // Blocks of one row leave the other as it is.
  for (auto& row : rows_) row.fill({});
  last_ = last_but_one_ = {};
  similar_.reset(desc_.record);
  copy_history_ = 1;
  changed_components_ = 0;
  error_ = {};
  noise_ = {};
  moved_ = {};
  changes_before_ = 0;
}

template <typename Coder>
void RecordModel::code(Coder& coder, std::span<const std::byte> in, std::span<std::byte> out,
                       std::span<const std::byte> previous, std::span<const std::byte> presence) {
  const Record& record = desc_.record;
  const std::size_t size = record.bytes;
  const std::uint32_t records = record_count(desc_.block);
  const BlockPresence present(desc_, presence);
  std::fill(out.begin(), out.end(), std::byte{0});
  history_ = 1;
  changes_ = 0;
  left_ = 0;
  for (std::uint32_t i = 0; i < records && update_ && one_row_; ++i) {
    if (present.exists(i) && !is_zero(previous.subspan(i * size, size))) ++left_;
  }
  row_ = 0;
  const std::size_t columns = desc_.block.x + std::size_t{2};
  for (auto& row : rows_) std::fill_n(row.begin(), one_row_ ? 0 : columns, Seen{});
  std::fill_n(rows_[0].begin(), columns, Seen{});
  for (std::uint32_t i = 0, column = 0; i < records; ++i, ++column) {
    if (column == desc_.block.x) {
      column = 0;
      row_ = 1 - row_;
      std::fill_n(rows_[row_].begin(), columns, Seen{});
    }
    if (!present.exists(i)) continue;
    Seen& here = rows_[row_][column + 1];
    here.exists = true;
    if (update_) {
      for (unsigned c = 0; c < record.count; ++c) {
        here.previous[c] = code_of(previous.data() + i * size, record.components[c], size);
      }
      here.now = here.previous;
      here.known = !all_zero(here.previous);
    }
    const std::byte* const source = Coder::kDecodes ? nullptr : in.data() + i * size;
    if constexpr (!Coder::kDecodes) {
      for (unsigned c = 0; c < record.count && !here.changed; ++c) {
        here.changed = code_of(source, record.components[c], size) != here.previous[c];
      }
    }
    if (here.known && one_row_) --left_;
    here.changed = one_row_ && update_ ? code_changed_in_row(coder, here, i, here.changed)
                                       : code_changed(coder, here, column, i, here.changed);
    history_ = history_ << 1 | (here.changed ? 1U : 0U);
    if (here.changed) {
      ++changes_;
      if (here.known) {
        code_update(coder, here, column, source);
      } else {
        code_new(coder, here, column, source);
      }
      last_but_one_ = last_;
      last_ = here;
    }
    if (here.known && one_row_) similar_.put(here.previous, here.changed, here.residual);
    if constexpr (Coder::kDecodes) {
      for (unsigned c = 0; c < record.count; ++c) {
        set_code(out.data() + i * size, record.components[c], size, here.now[c]);
      }
    }
  }
  changes_before_ = 8 * changes_ / (records + 1);
}

template <typename Coder>
bool RecordModel::code_changed(Coder& coder, const Seen& here, unsigned column, std::uint32_t index,
                               bool changed) {
  const std::uint32_t known = here.known ? 1 : 0;
  const std::uint32_t around = one_row_
                                   ? (w(column).exists && all_zero(w(column).now) ? 1U : 0U)
                                   : (w(column).changed ? 1U : 0U) + (n(column).changed ? 2U : 0U);
  return values_->flag(
      coder, kChangedMixer + known,
      {{{hashed(kChanged, known), history_ & 15},
        {hashed(kChanged2, known, std::min(index, 63U)), std::min(changes_, 15U)},
        {hashed(kChanged3, known, changes_before_, around), std::min(index, 15U)}}},
      changed);
}

/// A record that was zero, or of which nothing is known: the last component first.
template <typename Coder>
void RecordModel::code_new(Coder& coder, Seen& here, unsigned column, const std::byte* in) {
  const Record& record = desc_.record;
  const bool first = column == 0;
  const Values& before = first ? last_.now : w(column).now;
  const Values& other = !one_row_     ? n(column).now
                        : column >= 2 ? rows_[row_][column - 1].now
                                      : last_but_one_.now;
  std::uint32_t others = 0, equal_before = 1;
  for (unsigned c = record.count; c-- > 0;) {
    const Component& component = record.components[c];
    const unsigned bits = component.bits;
    const auto top = [bits](std::uint32_t value) { return top_bits(value, bits, kTopBits); };
    std::uint32_t value = 0;
    if constexpr (!Coder::kDecodes) value = code_of(in, component, record.bytes);
    bool match = false;
    if (bits > 8) {
      const std::uint32_t ahead = (2 * last_.now[c] - last_but_one_.now[c]) & largest(bits);
      const std::array<std::uint32_t, kCandidates> candidate{last_.now[c], ahead, other[c]};
      for (unsigned k = 0; k < kCandidates && !match; ++k) {
        if (std::find(candidate.begin(), candidate.begin() + k, candidate[k]) !=
            candidate.begin() + k) {
          continue;
        }
        match = values_->flag(coder, kMatchMixer + kCandidates * c + k,
                              {{{hashed(kMatch + c, k), equal_before & 7},
                                {hashed(kMatch2 + c, equal_before & 255), k},
                                {hashed(kMatch3 + c, history_ & 15), k}}},
                              value == candidate[k]);
        if (match) value = candidate[k];
      }
    }
    if (!match) {
      const std::uint32_t at = first ? 1 : 0;
      value = values_->value(coder, c,
                             {hashed(kNew + c, at), hashed(kNewBefore + c, top(before[c]), at),
                              hashed(kNewOthers + c, others),
                              hashed(kNewBoth + c, top(before[c]), top(other[c]), equal_before & 3),
                              hashed(kNewEqual + c, top(before[c]), equal_before, at)},
                             bits, value);
    }
    others = hashed(others, top(value));
    equal_before = equal_before << 1 | (value == before[c] ? 1U : 0U);
    here.now[c] = value;
  }
}

template <typename Coder>
void RecordModel::code_update(Coder& coder, Seen& here, unsigned column, const std::byte* in) {
  const Record& record = desc_.record;
  coded_ = 0;
  residual_ = residual_before_ = 0;
  lead_prediction_ = 0;
  last_copied_ = 0;
  std::uint32_t pattern = 1, actual = 0, moved = 0;
  for (unsigned c = 0; c < record.count && !Coder::kDecodes; ++c) {
    if (code_of(in, record.components[c], record.bytes) != here.previous[c]) actual |= 1U << c;
  }
  // In rows, often the same components as in the record that changed before.
  const bool same_components =
      one_row_ && changed_components_ != 0 &&
      values_->flag(coder, kComponentsMixer,
                    {{{kComponents, 0},
                      {hashed(kComponents2, changed_components_), 0},
                      {hashed(kComponents3, history_ & 7), std::min(changes_, 3U)}}},
                    actual == changed_components_);
  for (unsigned place = 0; place < record.count; ++place) {
    const unsigned c = order_[place];
    const unsigned bits = record.components[c].bits;
    std::uint32_t value = 0;
    if constexpr (!Coder::kDecodes) value = code_of(in, record.components[c], record.bytes);
    const bool same = same_components ? (changed_components_ >> c & 1) == 0
                                      : code_same(coder, here, column, c, pattern, value);
    pattern = pattern << 1 | (same ? 0U : 1U);
    if (same) continue;
    moved |= 1U << c;
    if (one_row_ && bits <= kSmall) {
      here.now[c] = code_difference(coder, c, here, column, value);
      here.residual[c] = static_cast<std::int32_t>(signed_of(here.now[c] - here.previous[c], bits));
    } else if (!one_row_ || bits <= kLarge || !code_copy(coder, place, here, value)) {
      here.now[c] = code_number(coder, place, here, column, value);
    }
  }
  changed_components_ = moved;
}

template <typename Coder>
bool RecordModel::code_same(Coder& coder, const Seen& here, unsigned column, unsigned c,
                            std::uint32_t pattern, std::uint32_t value) {
  const std::uint32_t around =
      (w(column).residual[c] != 0 ? 1U : 0U) + (n(column).residual[c] != 0 ? 2U : 0U);
  return values_->flag(coder, kSameMixer + c,
                       {{{hashed(kSame + c, pattern & 255), 0},
                         {hashed(kSame2 + c, history_ & 7), last_.residual[c] != 0 ? 1U : 0U},
                         {hashed(kSame3 + c, pattern & 255, around), std::min(changes_, 3U)}}},
                       value == here.previous[c]);
}

template void RecordModel::code(BinaryEncoder&, std::span<const std::byte>, std::span<std::byte>,
                                std::span<const std::byte>, std::span<const std::byte>);
template void RecordModel::code(BinaryDecoder&, std::span<const std::byte>, std::span<std::byte>,
                                std::span<const std::byte>, std::span<const std::byte>);

}  // namespace gicodec::native
