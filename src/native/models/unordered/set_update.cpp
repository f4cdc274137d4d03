#include "native/models/unordered/set_update.h"

#include "base/binary_coder.h"
#include "native/models/numbers.h"
#include "native/models/unordered/set_contexts.h"

#include <cstring>

namespace gicodec::native {
namespace {

// Mixers of flags.
constexpr unsigned kSetEqualMixer = 2, kPairsMixer = 3, kKeptMixer = 4, kChangedMixer = 8,
                   kUnchangedMixer = 176;

/// One in so many of the previous records must be retained to be worth a flag for each of them.
constexpr std::size_t kMinPaired = 16;

/// How many records there are before the first one that is zero.
std::uint32_t leading(std::span<const std::byte> records, std::size_t size) {
  std::uint32_t count = 0;
  while (count * size < records.size() && !is_zero(records.subspan(count * size, size))) ++count;
  return count;
}

}  // namespace

void SetUpdate::reset(ValueModel& values) {
  set_.reset(values);
  values_ = &values;
  history_ = 0;
  differences_ = {};
}

void SetUpdate::encode(BinaryEncoder& coder, const Record& record,
                       std::span<const std::byte> previous, std::span<const std::byte> records) {
  if (!previous.empty() && !records.empty()) {
    const bool same = std::memcmp(records.data(), previous.data(), records.size()) == 0;
    if (values_->flag(coder, kSetEqualMixer, kSetEqual, same)) return;
    if (values_->flag(coder, kPairsMixer, kPairs, pair(record, previous, records))) {
      code_states(coder, static_cast<std::uint32_t>(records.size() / record.bytes));
      set_.encode(coder, record, new_);
      code_retained(coder, record, previous, records);
      return;
    }
  }
  set_.encode(coder, record, records);
}

bool SetUpdate::decode(BinaryDecoder& coder, const Record& record,
                       std::span<const std::byte> previous, std::span<std::byte> records) {
  if (!previous.empty() && !records.empty()) {
    if (values_->flag(coder, kSetEqualMixer, kSetEqual, false)) {
      std::memcpy(records.data(), previous.data(), records.size());
      return true;
    }
    if (values_->flag(coder, kPairsMixer, kPairs, false)) {
      states_.resize(leading(previous, record.bytes));
      return code_states(coder, static_cast<std::uint32_t>(records.size() / record.bytes)) &&
             set_.decode(coder, record, records.subspan(std::size_t{retained_} * record.bytes)) &&
             code_retained(coder, record, previous, records);
    }
  }
  return set_.decode(coder, record, records);
}

/// Finds the states of the previous records, and the new ones. False if the decoder would not put
/// them into this order, or few are retained.
bool SetUpdate::pair(const Record& record, std::span<const std::byte> previous,
                     std::span<const std::byte> records) {
  const std::size_t size = record.bytes;
  const SetPlace place_of(record);
  const std::uint32_t before = leading(previous, size), count = leading(records, size);
  if (!is_zero(records.subspan(count * size))) return false;
  states_.resize(before);
  retained_at_.clear();
  new_.clear();
  std::uint32_t next = 0;
  SetPlace::Axes next_place{}, last_place{};
  const auto advance = [&] {
    const SetPlace::Axes last = next_place;
    if (next < count) next_place = place_of(records.data() + next * size);
    return !SetPlace::before(next_place, last);
  };
  const auto add_new = [&] {
    const std::byte* const at = records.data() + next++ * size;
    new_.insert(new_.end(), at, at + size);
    return advance();
  };
  if (!advance()) return false;
  for (std::uint32_t i = 0; i < before; ++i) {
    const std::byte* const was = previous.data() + i * size;
    const SetPlace::Axes place = place_of(was);
    if (SetPlace::before(place, last_place)) return false;
    last_place = place;
    while (next < count && SetPlace::before(next_place, place)) {
      if (!add_new()) return false;
    }
    states_[i] = removed;
    if (next == count || next_place != place) continue;
    states_[i] = std::memcmp(records.data() + next * size, was, size) == 0 ? kept : changed;
    retained_at_.push_back(next++);
    if (!advance()) return false;
  }
  while (next * size < records.size()) {
    if (!add_new()) return false;
  }
  return !retained_at_.empty() && retained_at_.size() * kMinPaired >= before;
}

/// At most `most` records are retained. False for what no encoder writes.
template <typename Coder>
bool SetUpdate::code_states(Coder& coder, std::uint32_t most) {
  retained_ = 0;
  for (RecordState& state : states_) {
    if constexpr (Coder::kDecodes) {
      if (coder.overrun()) return false;
    }
    state = retained_ < most ? code_state(coder, state) : removed;
    if (state != removed) ++retained_;
  }
  return true;
}

template <typename Coder>
SetUpdate::RecordState SetUpdate::code_state(Coder& coder, RecordState state) {
  const std::uint32_t last = history_ & 3;
  const auto flag = [&](unsigned mixer, std::uint32_t context, bool value) {
    return values_->flag(coder, mixer + last,
                         {{{context, last},
                           {hashed(context + 1, history_ & 0xFF), 0},
                           {hashed(context + 2, history_ & 0xFFF), 0}}},
                         value);
  };
  if (flag(kKeptMixer, kKept, state == kept)) {
    state = kept;
  } else {
    state = flag(kChangedMixer, kRecordChanged, state == changed) ? changed : removed;
  }
  history_ = history_ << 2 | state;
  return state;
}

template <typename Coder, typename Byte>
bool SetUpdate::code_retained(Coder& coder, const Record& record,
                              std::span<const std::byte> previous, std::span<Byte> records) {
  const std::size_t size = record.bytes;
  const SetPlace place_of(record);
  // New records move towards the front, and never onto one that has not moved yet: the gap before
  // them has room for the retained records to come.
  Byte* out = records.data();
  [[maybe_unused]] const Byte* next = out + retained_ * size;
  std::uint32_t retained = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (states_[i] == removed) continue;
    const std::byte* const was = previous.data() + i * size;
    if constexpr (Coder::kDecodes) {
      if (coder.overrun()) return false;
      const SetPlace::Axes place = place_of(was);
      while (next != records.data() + records.size() && !is_zero({next, size}) &&
             SetPlace::before(place_of(next), place)) {
        std::memmove(out, next, size);
        out += size;
        next += size;
      }
      std::memcpy(out, was, size);
    } else {
      out = records.data() + retained_at_[retained] * size;
    }
    if (states_[i] == changed) code_changed(coder, record, was, out);
    out += size;
    ++retained;
  }
  return true;
}

/// Components after the axes, by their differences to the previous values.
template <typename Coder, typename Byte>
void SetUpdate::code_changed(Coder& coder, const Record& record, const std::byte* previous,
                             Byte* now) {
  const std::size_t size = record.bytes;
  std::uint32_t changes = 1;
  for (unsigned c = SetPlace(record).axes(); c < record.count; ++c) {
    const Component& component = record.components[c];
    const unsigned bits = component.bits;
    const std::uint32_t was = code_of(previous, component, size);
    std::uint32_t difference = 0;
    if constexpr (!Coder::kDecodes) difference = folded(code_of(now, component, size) - was, bits);
    const std::uint32_t last = differences_[c];
    const bool unchanged = values_->flag(coder, kUnchangedMixer + c,
                                         {{{kUnchanged + c, 0},
                                           {hashed(kUnchanged2 + c, changes & 0xFF), 0},
                                           {hashed(kUnchanged3 + c, last), 0}}},
                                         difference == 0);
    changes = changes << 1 | (unchanged ? 0U : 1U);
    if (unchanged) continue;
    difference = values_->value(coder, kMaxComponents + c,
                                {hashed(kDifference + c, 0U), hashed(kAfterDifference + c, last),
                                 hashed(kFromPrevious + c, was), hashed(kFromBoth + c, was, last),
                                 hashed(kAfterChanges + c, changes)},
                                bits, difference);
    differences_[c] = difference;
    if constexpr (Coder::kDecodes) {
      set_code(now, component, size, (was + unfolded(difference, bits)) & largest(bits));
    }
  }
}

}  // namespace gicodec::native
