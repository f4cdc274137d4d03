#include "backend/hevc/access_unit.h"

#include <algorithm>
#include <array>

namespace gicodec::hevc {
namespace {

// nal_unit_type (ITU-T H.265 Table 7-1).
enum NalType : unsigned {
  kTrailN = 0,
  kTrailR = 1,
  kIdrWithRadl = 19,
  kIdr = 20,
  kVps = 32,
  kSps = 33,
  kPps = 34,
  kDelimiter = 35,
  kFiller = 38,
  kPrefixSei = 39,
  kSuffixSei = 40,
};
constexpr std::size_t kHeaderBytes = 2;

unsigned type_of(NalUnit unit) noexcept { return std::to_integer<unsigned>(unit[0]) >> 1 & 0x3F; }

bool is_slice(unsigned type) noexcept {
  return type == kTrailN || type == kTrailR || type == kIdrWithRadl || type == kIdr;
}

// True for layer 0, temporal sub-layer 0, forbidden bit zero, and a payload.
bool header_is_sound(NalUnit unit) noexcept {
  return unit.size() > kHeaderBytes && (unit[0] & std::byte{0x81}) == std::byte{0} &&
         unit[1] == std::byte{1};
}

// Returns the position of the next 00 00 01 at or after `from`; bytes.size() if there is none.
std::size_t find_start(std::span<const std::byte> bytes, std::size_t from) noexcept {
  const auto pattern = std::span(kStartCode).last<3>();
  const auto found = std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(),
                                 pattern.begin(), pattern.end());
  return static_cast<std::size_t>(found - bytes.begin());
}

// Splits a byte stream into NAL units, without the zero bytes around them.
std::vector<NalUnit> split(std::span<const std::byte> bytes) {
  std::vector<NalUnit> units;
  for (std::size_t start = find_start(bytes, 0); start < bytes.size();) {
    const std::size_t begin = start + 3;
    start = find_start(bytes, begin);
    NalUnit unit = bytes.subspan(begin, start - begin);
    while (!unit.empty() && unit.back() == std::byte{0}) unit = unit.first(unit.size() - 1);
    units.push_back(unit);
  }
  return units;
}

bool starts_with_code(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= kStartCode.size() &&
         std::equal(kStartCode.begin(), kStartCode.end(), bytes.begin());
}

}  // namespace

Result<AccessUnit> parse_access_unit(std::span<const std::byte> bytes,
                                     const PictureFormat& expected, ParameterSets& sets) {
  if (bytes.size() < kStartCode.size()) return Status::truncated;
  if (!starts_with_code(bytes)) return Status::corrupt;
  AccessUnit unit{.idr = false, .units = split(bytes)};
  for (const NalUnit& nal : unit.units) {
    if (!header_is_sound(nal)) return Status::corrupt;
    const unsigned type = type_of(nal);
    if (!is_slice(type) && type != kVps && type != kSps && type != kPps) {
      return Status::unsupported_feature;
    }
  }
  std::size_t first_slice = 0;
  if (type_of(unit.units.front()) == kVps) {
    constexpr std::array kOrder{kVps, kSps, kPps};
    first_slice = kOrder.size();
    if (unit.units.size() <= first_slice) return Status::truncated;
    for (std::size_t i = 0; i < first_slice; ++i) {
      if (type_of(unit.units[i]) != kOrder[i]) return Status::corrupt;
    }
    const auto payload = [&](std::size_t i) { return unit.units[i].subspan(kHeaderBytes); };
    if (!check_vps(payload(0)) || !check_sps(payload(1), expected, sets) ||
        !check_pps(payload(2), sets)) {
      return Status::corrupt;
    }
    unit.idr = true;
  }
  const unsigned slice_type = type_of(unit.units[first_slice]);
  if ((slice_type == kIdr || slice_type == kIdrWithRadl) != unit.idr) return Status::corrupt;
  for (std::size_t i = first_slice; i < unit.units.size(); ++i) {
    if (type_of(unit.units[i]) != slice_type ||
        !check_slice(unit.units[i].subspan(kHeaderBytes), unit.idr, i == first_slice, sets)) {
      return Status::corrupt;
    }
  }
  return unit;
}

void append_access_unit(std::span<const std::byte> encoded, std::vector<std::byte>& out) {
  for (const NalUnit& unit : split(encoded)) {
    if (unit.size() <= kHeaderBytes) continue;
    const unsigned type = type_of(unit);
    if (type == kDelimiter || type == kFiller || type == kPrefixSei || type == kSuffixSei) continue;
    out.insert(out.end(), kStartCode.begin(), kStartCode.end());
    out.insert(out.end(), unit.begin(), unit.end());
  }
}

}  // namespace gicodec::hevc
