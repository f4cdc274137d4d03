// Records as planes for the reference decoder (docs/native.md, section 2).
#pragma once

#include "native/reference_model.h"

#include <gicodec/texture.h>

#include <cstddef>
#include <vector>

namespace gicodec::reference {

[[nodiscard]] unsigned bits_at(const std::byte* record, unsigned offset, unsigned bits);

struct Plane {
  unsigned offset, stored;  ///< within the record
  bool low = false;
  unsigned bits = stored;  ///< of numbers of steps
  int step = 1;
};

/// The planes of a texture's records.
class RecordPlanes {
 public:
  explicit RecordPlanes(const TextureDesc& desc);
  [[nodiscard]] bool pairs() const { return pairs_; }
  [[nodiscard]] std::size_t size() const { return planes_.size(); }
  [[nodiscard]] const std::vector<Plane>& all() const { return planes_; }
  bool read_steps(Bytes& in);
  /// A block's records ↔ numbers of steps.
  [[nodiscard]] Values unpack(const std::byte* records) const;
  [[nodiscard]] std::vector<std::byte> pack(const Values& v) const;

 private:
  [[nodiscard]] int value_of(const Plane& plane, int steps) const;
  [[nodiscard]] int steps_of(const Plane& plane, int value) const;

  bool pairs_;
  std::size_t records_, record_bytes_;
  std::vector<Plane> planes_;
};

}  // namespace gicodec::reference
