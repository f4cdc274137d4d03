#include "native/reference_packing.h"

#include <algorithm>
#include <utility>

namespace gicodec::reference {
namespace {

std::vector<Plane> planes_of(const Record& record) {
  std::vector<Component> components(record.used().begin(), record.used().end());
  if (components.size() >= 3) std::swap(components[0], components[1]);
  std::vector<Plane> planes;
  for (const auto& c : components) {
    if (c.bits > 16) {
      planes.push_back({c.offset + 16U, c.bits - 16U});
      planes.push_back({c.offset, 16, true});
    } else {
      planes.push_back({c.offset, c.bits});
    }
  }
  return planes;
}

void put_bits(std::byte* record, unsigned offset, unsigned bits, unsigned value) {
  for (unsigned b = 0; b < bits; ++b) {
    if ((value >> b & 1) != 0) record[(offset + b) / 8] |= std::byte(1 << (offset + b) % 8);
  }
}

}  // namespace

unsigned bits_at(const std::byte* record, unsigned offset, unsigned bits) {
  unsigned value = 0;
  for (unsigned b = 0; b < bits; ++b) {
    const auto byte = static_cast<unsigned>(record[(offset + b) / 8]);
    value |= (byte >> (offset + b) % 8 & 1) << b;
  }
  return value;
}

RecordPlanes::RecordPlanes(const TextureDesc& desc)
    : pairs_(desc.record.format == Format::R16G16_SFLOAT && desc.presence == Presence::all),
      records_(std::size_t{desc.block.x} * desc.block.y * desc.block.z),
      record_bytes_(desc.record.bytes),
      planes_(planes_of(desc.record)) {}

bool RecordPlanes::read_steps(Bytes& in) {
  bool some = false;
  for (Plane& plane : planes_) {
    plane.step = static_cast<int>(in.u16());
    const int largest = (1 << plane.stored) - 1;
    const bool power = (plane.step & (plane.step - 1)) == 0;
    if (plane.step < 1 || plane.step > largest || (pairs_ && !power)) return false;
    some = some || plane.step > 1;
    if (pairs_) continue;
    for (plane.bits = 1; (largest + plane.step - 1) / plane.step >> plane.bits != 0;) ++plane.bits;
  }
  return some && (planes_.size() % 2 == 0 || in.u16() == 0) && !in.failed();
}

int RecordPlanes::value_of(const Plane& plane, int steps) const {
  return pairs_ ? steps * plane.step & 0xFFFF
                : std::min(steps * plane.step, (1 << plane.stored) - 1);
}

int RecordPlanes::steps_of(const Plane& plane, int value) const {
  if (!pairs_) return (value + plane.step - 1) / plane.step;
  const int is_signed = value < 0x8000 ? value : value - 0x10000;
  const int below = is_signed < 0 ? (plane.step - 1 - is_signed) / plane.step : 0;
  return (is_signed < 0 ? -below : is_signed / plane.step) & 0xFFFF;
}

Values RecordPlanes::unpack(const std::byte* records) const {
  Values v(planes_.size(), std::vector<int>(records_));
  for (std::size_t t = 0; t < records_; ++t) {
    const std::byte* record = records + t * record_bytes_;
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      v[p][t] = static_cast<int>(bits_at(record, planes_[p].offset, planes_[p].stored));
    }
    if (pairs_) v[1][t] = (v[1][t] - 2 * v[0][t]) & 0xFFFF;
    for (std::size_t p = 0; p < planes_.size(); ++p) v[p][t] = steps_of(planes_[p], v[p][t]);
  }
  return v;
}

std::vector<std::byte> RecordPlanes::pack(const Values& v) const {
  std::vector<std::byte> out(records_ * record_bytes_);
  for (std::size_t t = 0; t < records_; ++t) {
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      int value = value_of(planes_[p], v[p][t]);
      if (pairs_ && p == 1) value = (value + 2 * value_of(planes_[0], v[0][t])) & 0xFFFF;
      put_bits(out.data() + t * record_bytes_, planes_[p].offset, planes_[p].stored,
               static_cast<unsigned>(value));
    }
  }
  return out;
}

}  // namespace gicodec::reference
