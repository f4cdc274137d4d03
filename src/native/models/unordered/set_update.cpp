#include "native/models/unordered/set_update.h"

#include "base/binary_coder.h"
#include "native/record_numbers.h"

#include <cstring>

namespace gicodec::native {
namespace {

// What a context is for, the first number of its hash; those of components are added. Others than
// the set model's.
enum Role : std::uint32_t {
  kSame = 3,
  kPairs = 4,
  kKept = 5,
  kChanged = 60,
  kStill = 230,  // + component, and the next ones likewise
  kStill2 = 246,
  kStill3 = 262,
  kDifference = 278,
  kAfterDifference = 294,
  kFromPast = 310,
  kFromBoth = 326,
  kAfterChanges = 342,
};
// Mixers of flags.
constexpr unsigned kSameMixer = 2, kPairsMixer = 3, kKeptMixer = 4, kChangedMixer = 8,
                   kStillMixer = 176;

/// One in so many of the past's records must be there still to be worth a flag for each of them.
constexpr std::size_t kLeastPairs = 16;

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

void SetUpdate::encode(BinaryEncoder& coder, const Record& record, std::span<const std::byte> past,
                       std::span<const std::byte> records) {
  if (!past.empty() && !records.empty()) {
    const bool same = std::memcmp(records.data(), past.data(), records.size()) == 0;
    if (values_->flag(coder, kSameMixer, kSame, same)) return;
    if (values_->flag(coder, kPairsMixer, kPairs, pair(record, past, records))) {
      code_fates(coder, static_cast<std::uint32_t>(records.size() / record.bytes));
      set_.encode(coder, record, new_);
      code_survivors(coder, record, past, records);
      return;
    }
  }
  set_.encode(coder, record, records);
}

bool SetUpdate::decode(BinaryDecoder& coder, const Record& record, std::span<const std::byte> past,
                       std::span<std::byte> records) {
  if (!past.empty() && !records.empty()) {
    if (values_->flag(coder, kSameMixer, kSame, false)) {
      std::memcpy(records.data(), past.data(), records.size());
      return true;
    }
    if (values_->flag(coder, kPairsMixer, kPairs, false)) {
      fates_.resize(leading(past, record.bytes));
      return code_fates(coder, static_cast<std::uint32_t>(records.size() / record.bytes)) &&
             set_.decode(coder, record, records.subspan(std::size_t{survivors_} * record.bytes)) &&
             code_survivors(coder, record, past, records);
    }
  }
  return set_.decode(coder, record, records);
}

/// Finds what became of the past's records, and which are new. False if the decoder would not put
/// them into this order, or hardly one has survived.
bool SetUpdate::pair(const Record& record, std::span<const std::byte> past,
                     std::span<const std::byte> records) {
  const std::size_t size = record.bytes;
  const SetPlace place_of(record);
  const std::uint32_t before = leading(past, size), count = leading(records, size);
  if (!is_zero(records.subspan(count * size))) return false;
  fates_.resize(before);
  now_.clear();
  new_.clear();
  std::uint32_t next = 0;
  SetPlace::Axes next_place{}, last_place{};
  const auto look = [&] {
    const SetPlace::Axes last = next_place;
    if (next < count) next_place = place_of(records.data() + next * size);
    return !SetPlace::before(next_place, last);
  };
  const auto add_new = [&] {
    const std::byte* const at = records.data() + next++ * size;
    new_.insert(new_.end(), at, at + size);
    return look();
  };
  if (!look()) return false;
  for (std::uint32_t i = 0; i < before; ++i) {
    const std::byte* const was = past.data() + i * size;
    const SetPlace::Axes place = place_of(was);
    if (SetPlace::before(place, last_place)) return false;
    last_place = place;
    while (next < count && SetPlace::before(next_place, place)) {
      if (!add_new()) return false;
    }
    fates_[i] = gone;
    if (next == count || next_place != place) continue;
    fates_[i] = std::memcmp(records.data() + next * size, was, size) == 0 ? kept : changed;
    now_.push_back(next++);
    if (!look()) return false;
  }
  while (next * size < records.size()) {
    if (!add_new()) return false;
  }
  return !now_.empty() && now_.size() * kLeastPairs >= before;
}

/// At most `most` records are not gone. False for what no encoder writes.
template <typename Coder>
bool SetUpdate::code_fates(Coder& coder, std::uint32_t most) {
  survivors_ = 0;
  for (Fate& fate : fates_) {
    if constexpr (Coder::kDecodes) {
      if (coder.overrun()) return false;
    }
    fate = survivors_ < most ? code_fate(coder, fate) : gone;
    if (fate != gone) ++survivors_;
  }
  return true;
}

template <typename Coder>
SetUpdate::Fate SetUpdate::code_fate(Coder& coder, Fate fate) {
  const std::uint32_t last = history_ & 3;
  const auto flag = [&](unsigned mixer, std::uint32_t role, bool value) {
    return values_->flag(coder, mixer + last,
                         {{{role, last},
                           {hashed(role + 1, history_ & 0xFF), 0},
                           {hashed(role + 2, history_ & 0xFFF), 0}}},
                         value);
  };
  if (flag(kKeptMixer, kKept, fate == kept)) {
    fate = kept;
  } else {
    fate = flag(kChangedMixer, kChanged, fate == changed) ? changed : gone;
  }
  history_ = history_ << 2 | fate;
  return fate;
}

template <typename Coder, typename Byte>
bool SetUpdate::code_survivors(Coder& coder, const Record& record, std::span<const std::byte> past,
                               std::span<Byte> records) {
  const std::size_t size = record.bytes;
  const SetPlace place_of(record);
  // New records are moved towards the front, and never onto one that is still to be moved: of the
  // room before them as much is left as there are survivors to come.
  Byte* out = records.data();
  [[maybe_unused]] const Byte* next = out + survivors_ * size;
  std::uint32_t survivor = 0;
  for (std::size_t i = 0; i < fates_.size(); ++i) {
    if (fates_[i] == gone) continue;
    const std::byte* const was = past.data() + i * size;
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
      out = records.data() + now_[survivor] * size;
    }
    if (fates_[i] == changed) code_changed(coder, record, was, out);
    out += size;
    ++survivor;
  }
  return true;
}

/// Components behind the axes, by their differences to the past.
template <typename Coder, typename Byte>
void SetUpdate::code_changed(Coder& coder, const Record& record, const std::byte* past, Byte* now) {
  const std::size_t size = record.bytes;
  std::uint32_t changes = 1;
  for (unsigned c = SetPlace(record).axes(); c < record.count; ++c) {
    const Component& component = record.components[c];
    const unsigned bits = component.bits;
    const std::uint32_t was = code_of(past, component, size);
    std::uint32_t difference = 0;
    if constexpr (!Coder::kDecodes) difference = folded(code_of(now, component, size) - was, bits);
    const std::uint32_t last = differences_[c];
    const bool still = values_->flag(coder, kStillMixer + c,
                                     {{{kStill + c, 0},
                                       {hashed(kStill2 + c, changes & 0xFF), 0},
                                       {hashed(kStill3 + c, last), 0}}},
                                     difference == 0);
    changes = changes << 1 | (still ? 0U : 1U);
    if (still) continue;
    difference = values_->value(coder, kMaxComponents + c,
                                {hashed(kDifference + c, 0U), hashed(kAfterDifference + c, last),
                                 hashed(kFromPast + c, was), hashed(kFromBoth + c, was, last),
                                 hashed(kAfterChanges + c, changes)},
                                bits, difference);
    differences_[c] = difference;
    if constexpr (Coder::kDecodes) {
      set_code(now, component, size, (was + unfolded(difference, bits)) & largest(bits));
    }
  }
}

}  // namespace gicodec::native
