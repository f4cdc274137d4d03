// The transforms undone by their inverses, on plain bytes: bodies of the property tests and of the
// fuzz targets. Each function returns the promise that was broken, or nothing. Every instruction
// set is compared with the one in use. Vectors have just their size, so that AddressSanitizer sees
// every step beyond, and are filled with what must not be left.
#pragma once

#include "messages.h"
#include "transform/byte_plane_kernels.h"
#include "transform/byte_planes.h"
#include "transform/yuv444_kernels.h"
#include "transform/yuv444p16.h"
#include "transform/yuv444p8.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec::test {

template <typename Sample>
struct Samples {
  explicit Samples(std::size_t count, Sample left = Sample{0xEE})
      : y(count, left), u(count, left), v(count, left) {}
  Planes<Sample> planes() { return {y, u, v}; }
  Planes<const Sample> planes() const { return {y, u, v}; }
  friend bool operator==(const Samples&, const Samples&) = default;
  std::vector<Sample> y, u, v;
};

/// Any words as texels, then as samples.
inline std::string_view broken_yuv444p16(Format format, SampleAlignment alignment,
                                         std::span<const std::uint32_t> words) {
  const std::size_t count = words.size();
  const auto bytes = std::as_bytes(words);
  const std::vector<std::byte> texels(bytes.begin(), bytes.end());
  const unsigned up = alignment == SampleAlignment::high ? 6 : 0;

  Samples<std::uint16_t> samples(count);
  to_yuv444p16(best_isa(), format, alignment, texels, samples.planes());
  std::vector<std::byte> back(texels.size(), std::byte{0xEE});
  if (!from_yuv444p16(best_isa(), format, alignment, std::as_const(samples).planes(), back)) {
    return "own samples are refused";
  }
  std::vector<std::byte> packed((count + 3) / 4, std::byte{0xEE}), constant = back;
  pack_alpha(texels, packed);
  unpack_alpha(packed, back);
  if (back != texels) return "texels with alpha beside the planes come back";
  if (const auto alpha = constant_alpha(texels)) {
    add_alpha(*alpha, constant);
    if (constant != texels) return "texels of one alpha come back";
  }

  // The words again, as samples of which some have bits outside their ten.
  const std::uint32_t mask = 0x3FFU << up;
  Samples<std::uint16_t> any(count), again(count);
  bool codes = true;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t mine[3] = {words[i] & 0xFFFF, words[i] >> 16, words[i] >> 8 & 0xFFFF};
    any.y[i] = static_cast<std::uint16_t>(mine[0] & (i % 8 == 0 ? 0xFFFF : mask));
    any.u[i] = static_cast<std::uint16_t>(mine[1] & mask);
    any.v[i] = static_cast<std::uint16_t>(mine[2] & mask);
    codes = codes && (any.y[i] & ~mask) == 0;
  }
  if (from_yuv444p16(best_isa(), format, alignment, std::as_const(any).planes(), back) != codes) {
    return "samples with bits outside their ten are refused, others not";
  }
  to_yuv444p16(best_isa(), format, alignment, back, again.planes());
  if (codes && again != any) return "samples come back";

  const auto& components = find_format(format)->record.components;
  const CodeShifts shifts{components[0].offset, components[1].offset, components[2].offset, up};
  std::vector<std::byte> joined = back;
  for (const Isa isa : supported_isas()) {
    Samples<std::uint16_t> split(count);
    kernels<Yuv444Kernels>(isa).split_codes(texels.data(), count, shifts, split.y.data(),
                                            split.u.data(), split.v.data());
    if (split != samples) return "every instruction set gives the same samples";
    std::ranges::fill(joined, std::byte{0xEE});
    const auto seen = kernels<Yuv444Kernels>(isa).join_codes(
        any.y.data(), any.u.data(), any.v.data(), count, shifts, joined.data());
    if (((seen & ~mask) == 0) != codes) return "every instruction set sees the same bits";
    if (codes && joined != back) return "every instruction set gives the same texels";
  }
  return {};
}

/// A row of record bytes, then the same bytes as samples.
inline std::string_view broken_yuv444p8(std::span<const std::byte> bytes) {
  const std::vector<std::byte> row(bytes.begin(), bytes.end());
  const std::size_t width = yuv444p8_width(row.size());
  Samples<std::uint8_t> samples(width);
  to_yuv444p8(best_isa(), row, samples.planes());
  std::vector<std::byte> back(row.size(), std::byte{0xEE});
  if (!from_yuv444p8(best_isa(), std::as_const(samples).planes(), back))
    return "own samples are refused";
  if (back != row) return "a row comes back";

  Samples<std::uint8_t> any(width), again(width);
  for (std::size_t i = 0; i < width; ++i) {
    any.y[i] = std::to_integer<std::uint8_t>(row[i]);
    any.u[i] = std::to_integer<std::uint8_t>(row[row.size() - 1 - i]);
    any.v[i] = std::to_integer<std::uint8_t>(row[i] ^ row.back());
  }
  const bool sound =
      (row.size() % 3 == 0 || any.v.back() == 0) && (row.size() % 3 != 1 || any.u.back() == 0);
  if (width != 0 && from_yuv444p8(best_isa(), std::as_const(any).planes(), back) != sound) {
    return "padding that is not zero is refused, other samples not";
  }
  to_yuv444p8(best_isa(), back, again.planes());
  if (width != 0 && sound && again != any) return "samples come back";

  const std::size_t whole = row.size() / 3;
  for (const Isa isa : supported_isas()) {
    Samples<std::uint8_t> split = samples;  // Keeps the padded last ones.
    std::fill_n(split.y.begin(), whole, std::uint8_t{0xEE});
    kernels<Yuv444Kernels>(isa).split_bytes(row.data(), whole, split.y.data(), split.u.data(),
                                            split.v.data());
    if (split != samples) return "every instruction set gives the same samples";
    std::vector<std::byte> joined = row;
    std::fill_n(joined.begin(), 3 * whole, std::byte{0xEE});
    kernels<Yuv444Kernels>(isa).join_bytes(samples.y.data(), samples.u.data(), samples.v.data(),
                                           whole, joined.data());
    if (joined != row) return "every instruction set gives the same row";
  }
  return {};
}

/// Texels to planes, then the same bytes as planes; `reference` is empty or of the same size.
inline std::string_view broken_byte_planes(const Record& record, std::span<const std::byte> bytes,
                                           std::span<const std::byte> reference) {
  const std::vector<std::byte> records(bytes.begin(), bytes.end());
  std::vector<std::byte> planes(records.size(), std::byte{0xEE}), back = planes;
  to_byte_planes(best_isa(), record, records, reference, planes);
  from_byte_planes(best_isa(), record, planes, reference, back);
  if (back != records) return "records come back";

  std::vector<std::byte> joined(records.size(), std::byte{0xEE}), again = joined;
  from_byte_planes(best_isa(), record, records, reference, joined);
  to_byte_planes(best_isa(), record, joined, reference, again);
  if (again != records) return "any planes are those of some records";

  const RecordLayout layout{record.components.data(), record.count, record.bytes};
  const std::size_t count = records.size() / record.bytes;
  if (count > 512) return {};
  const std::byte* ref = reference.empty() ? nullptr : reference.data();
  for (const Isa isa : supported_isas()) {
    std::vector<std::byte> split(records.size(), std::byte{0xEE}), records_again = split;
    kernels<BytePlaneKernels>(isa).to_planes(layout, records.data(), ref, split.data(), count,
                                             count);
    if (split != planes) return "every instruction set gives the same planes";
    kernels<BytePlaneKernels>(isa).from_planes(layout, planes.data(), ref, records_again.data(),
                                               count, count);
    if (records_again != records) return "every instruction set gives the same records";
  }
  return {};
}

}  // namespace gicodec::test
