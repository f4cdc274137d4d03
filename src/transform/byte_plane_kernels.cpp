// Records ↔ byte planes, for one instruction set (simd/dispatch.h): loops that compilers vectorise.
#include "transform/byte_plane_kernels.h"

#include "base/parts.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

namespace gicodec::GICODEC_ISA {
namespace {

#include "simd/memory.inl"

constexpr std::uint32_t mask(unsigned bits) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}

/// The bits of a component in its word.
struct Field {
  explicit Field(const Component& component)
      : word(component.offset / 32U),
        shift(component.offset % 32U),
        bits(component.bits),
        up(32 - shift - bits),
        down(32 - bits) {}
  unsigned word, shift, bits, up, down;

  /// The component of a word; with a reference, the zigzag-folded difference of both components.
  template <bool difference>
  std::uint32_t fold(std::uint32_t value, std::uint32_t reference) const {
    const std::uint32_t here = mask(bits) << shift;
    if constexpr (!difference) return (value & here) >> shift;
    // In the upper bits, so that the difference has its sign.
    const std::uint32_t delta = ((value & here) - (reference & here)) << up;
    const auto sign = static_cast<std::uint32_t>(static_cast<std::int32_t>(delta) >> 31);
    return (delta << 1 ^ sign) >> down;
  }
  /// The inverse, shifted into place; other bits of the word are zero.
  template <bool difference>
  std::uint32_t unfold(std::uint32_t folded, std::uint32_t reference) const {
    if constexpr (!difference) return folded << shift;
    const std::uint32_t delta = (folded >> 1) ^ (0U - (folded & 1U));
    return (reference + (delta << shift)) & mask(bits) << shift;
  }
};

/// Records of kBytes bytes; 0: of any size.
template <unsigned kBytes>
struct Records {
  using Word = std::conditional_t<kBytes == 1, std::uint8_t,
                                  std::conditional_t<kBytes == 2, std::uint16_t, std::uint32_t>>;

  static std::size_t size(const RecordLayout& record) {
    return kBytes != 0 ? kBytes : record.bytes;
  }
  /// Bytes of a word; the last one may be shorter than others.
  static std::size_t word_size(const RecordLayout& record, unsigned word) {
    if constexpr (kBytes != 0) return sizeof(Word);
    const std::size_t left = record.bytes - std::size_t{4} * word;
    return left < 4 ? left : 4;
  }
  static std::uint32_t load_word(const std::byte* from, std::size_t bytes) {
    if constexpr (kBytes != 0) return read<Word>(from);
    std::uint32_t value = 0;
    std::memcpy(&value, from, bytes);
    return value;
  }
  static void store_words(const RecordLayout& record, const std::uint32_t* __restrict words,
                          unsigned word, std::size_t count, std::byte* to) {
    const std::size_t step = size(record);
    to += std::size_t{4} * word;
    if constexpr (kBytes != 0) {
      for (std::size_t i = 0; i < count; ++i) write(to + i * step, static_cast<Word>(words[i]));
    } else {
      const std::size_t bytes = word_size(record, word);
      for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * step, &words[i], bytes);
    }
  }

  template <bool difference>
  static void load_component(const RecordLayout& record, Field field,
                             const std::byte* __restrict records,
                             const std::byte* __restrict reference, std::size_t count,
                             std::uint32_t* __restrict values) {
    const std::size_t step = size(record), bytes = word_size(record, field.word);
    const std::size_t at = std::size_t{4} * field.word;
    for (std::size_t i = 0; i < count; ++i) {
      values[i] =
          field.fold<difference>(load_word(records + at + i * step, bytes),
                                 difference ? load_word(reference + at + i * step, bytes) : 0);
    }
  }
  template <bool difference>
  static void place_component(const RecordLayout& record, Field field,
                              const std::uint32_t* __restrict values,
                              const std::byte* __restrict reference, std::size_t count,
                              std::uint32_t* __restrict words) {
    const std::size_t step = size(record), bytes = word_size(record, field.word);
    const std::size_t at = std::size_t{4} * field.word;
    for (std::size_t i = 0; i < count; ++i) {
      words[i] |= field.unfold<difference>(
          values[i], difference ? load_word(reference + at + i * step, bytes) : 0);
    }
  }

  /// Stores the bytes of values, lowest first, two planes at a time.
  static void store_planes(const std::uint32_t* __restrict values, unsigned bytes,
                           std::size_t count, std::size_t stride, std::byte* planes) {
    unsigned k = 0;
    for (; k + 2 <= bytes; k += 2) {
      std::byte* __restrict to = planes + k * stride;
      std::byte* __restrict next = to + stride;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t value = values[i] >> 8 * k;
        to[i] = static_cast<std::byte>(value);
        next[i] = static_cast<std::byte>(value >> 8);
      }
    }
    if (k == bytes) return;
    std::byte* __restrict to = planes + k * stride;
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::byte>(values[i] >> 8 * k);
  }

  static void forward(const RecordLayout& record, const std::byte* __restrict records,
                      const std::byte* __restrict reference, std::byte* __restrict planes,
                      std::size_t count, std::size_t stride) {
    if (count == 0) return;  // Maybe there is no memory.
    const unsigned first_high = whole_planes(record);
    for (unsigned p = first_high; p < record.bytes; ++p) std::memset(planes + p * stride, 0, count);
    unsigned plane = 0, high = 0;
    std::uint32_t values[kPlaneStep];
    for (unsigned c = 0; c < record.count; ++c) {
      const Field field(record.component[c]);
      const unsigned bits = field.bits, whole = bits / 8;
      if (reference != nullptr) {
        load_component<true>(record, field, records, reference, count, values);
      } else {
        load_component<false>(record, field, records, reference, count, values);
      }
      store_planes(values, whole, count, stride, planes + plane * stride);
      plane += whole;
      if (bits % 8 == 0) continue;
      std::byte* to = planes + (first_high + high / 8) * stride;
      const unsigned down = 8 * whole, up = high % 8;
      for (std::size_t i = 0; i < count; ++i) {
        to[i] |= static_cast<std::byte>(values[i] >> down << up);
      }
      if (up + bits % 8 > 8) {
        to += stride;
        for (std::size_t i = 0; i < count; ++i) {
          to[i] |= static_cast<std::byte>(values[i] >> down << up >> 8);
        }
      }
      high += bits % 8;
    }
  }

  /// Moves `bits` bits from bit `first` of a plane, or of two, to bit `to` of values.
  static void load_high(const std::byte* __restrict from, unsigned first, unsigned bits,
                        unsigned to, std::size_t count, std::size_t stride,
                        std::uint32_t* __restrict values) {
    const std::uint32_t wanted = mask(bits);
    if (first + bits <= 8) {
      for (std::size_t i = 0; i < count; ++i) {
        values[i] = (static_cast<std::uint32_t>(from[i]) >> first & wanted) << to;
      }
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto both =
          static_cast<std::uint32_t>(from[i]) | static_cast<std::uint32_t>(from[i + stride]) << 8;
      values[i] = (both >> first & wanted) << to;
    }
  }

  static void inverse(const RecordLayout& record, const std::byte* __restrict planes,
                      const std::byte* __restrict reference, std::byte* __restrict records,
                      std::size_t count, std::size_t stride) {
    if (count == 0) return;  // Maybe there is no memory.
    const unsigned first_high = whole_planes(record);
    unsigned plane = 0, high = 0;
    std::uint32_t values[kPlaneStep];
    std::uint32_t words[kBytes != 0 ? (kBytes + 3) / 4 : kMaxRecordBytes / 4][kPlaneStep] = {};
    for (unsigned c = 0; c < record.count; ++c) {
      const Field field(record.component[c]);
      const unsigned bits = field.bits, whole = bits / 8;
      unsigned k = 0;
      if (bits % 8 == 0) {
        const std::byte* from = planes + plane++ * stride;
        for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<std::uint32_t>(from[i]);
        k = 1;
      } else {
        load_high(planes + (first_high + high / 8) * stride, high % 8, bits % 8, 8 * whole, count,
                  stride, values);
        high += bits % 8;
      }
      for (; k < whole; ++k, ++plane) {
        const std::byte* from = planes + plane * stride;
        for (std::size_t i = 0; i < count; ++i) {
          values[i] |= static_cast<std::uint32_t>(from[i]) << 8 * k;
        }
      }
      if (reference != nullptr) {
        place_component<true>(record, field, values, reference, count, words[field.word]);
      } else {
        place_component<false>(record, field, values, reference, count, words[field.word]);
      }
    }
    for (unsigned w = 0; w < (record.bytes + 3U) / 4; ++w) {
      store_words(record, words[w], w, count, records);
    }
  }

  static unsigned whole_planes(const RecordLayout& record) {
    unsigned sum = 0;
    for (unsigned c = 0; c < record.count; ++c) sum += record.component[c].bits / 8U;
    return sum;
  }
};

/// Calls body(Records<bytes>()) for the record's size.
template <typename Body>
void with_record_bytes(const RecordLayout& record, Body&& body) {
  switch (record.bytes) {
    case 1:
      return body(Records<1>());
    case 2:
      return body(Records<2>());
    case 4:
      return body(Records<4>());
    case 8:
      return body(Records<8>());
    case 16:
      return body(Records<16>());
    default:
      return body(Records<0>());
  }
}

void to_planes(const RecordLayout& record, const std::byte* records, const std::byte* reference,
               std::byte* planes, std::size_t count, std::size_t stride) {
  with_record_bytes(record, [&](auto of_size) {
    of_size.forward(record, records, reference, planes, count, stride);
  });
}

void from_planes(const RecordLayout& record, const std::byte* planes, const std::byte* reference,
                 std::byte* records, std::size_t count, std::size_t stride) {
  with_record_bytes(record, [&](auto of_size) {
    of_size.inverse(record, planes, reference, records, count, stride);
  });
}

constexpr BytePlaneKernels kKernels{kEncodes ? to_planes : nullptr, from_planes};

}  // namespace
}  // namespace gicodec::GICODEC_ISA

namespace gicodec {
template <>
constinit const BytePlaneKernels TableOf<BytePlaneKernels, Isa::GICODEC_ISA>::kernels =
    GICODEC_ISA::kKernels;
}  // namespace gicodec
