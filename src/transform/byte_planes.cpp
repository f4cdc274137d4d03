#include "transform/byte_planes.h"

#include "transform/byte_plane_kernels.h"

#include <algorithm>

namespace gicodec {
void to_byte_planes(Isa isa, const Record& record, std::span<const std::byte> records,
                    std::span<const std::byte> reference, std::span<std::byte> planes) {
  const RecordLayout layout{record.components.data(), record.count, record.bytes};
  const std::size_t size = record.bytes;
  const std::size_t total = records.size() / size;
  for (std::size_t i = 0; i < total; i += kPlaneStep) {
    kernels<BytePlaneKernels>(isa).to_planes(
        layout, records.data() + i * size,
        reference.empty() ? nullptr : reference.data() + i * size, planes.data() + i,
        std::min(kPlaneStep, total - i), total);
  }
}

void from_byte_planes(Isa isa, const Record& record, std::span<const std::byte> planes,
                      std::span<const std::byte> reference, std::span<std::byte> records) {
  const RecordLayout layout{record.components.data(), record.count, record.bytes};
  const std::size_t size = record.bytes;
  const std::size_t total = records.size() / size;
  for (std::size_t i = 0; i < total; i += kPlaneStep) {
    kernels<BytePlaneKernels>(isa).from_planes(
        layout, planes.data() + i, reference.empty() ? nullptr : reference.data() + i * size,
        records.data() + i * size, std::min(kPlaneStep, total - i), total);
  }
}

}  // namespace gicodec
