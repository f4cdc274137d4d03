#include "native/reference_records.h"

namespace gicodec::reference {

std::vector<std::byte> packed(const Record& record, const std::vector<Components>& records) {
  std::vector<std::byte> out(records.size() * record.bytes);
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (unsigned c = 0; c < record.count; ++c) {
      const Component& component = record.components[c];
      for (unsigned b = 0; b < component.bits; ++b) {
        const unsigned at = component.offset + b;
        if ((records[r][c] >> b & 1) != 0)
          out[r * record.bytes + at / 8] |= std::byte(1U << at % 8);
      }
    }
  }
  return out;
}

Components unpacked(const Record& record, const std::byte* bytes) {
  Components values(record.count, 0);
  for (unsigned c = 0; c < record.count; ++c) {
    const Component& component = record.components[c];
    for (unsigned b = 0; b < component.bits; ++b) {
      const unsigned at = component.offset + b;
      values[c] |= Number{static_cast<unsigned>(bytes[at / 8]) >> at % 8 & 1} << b;
    }
  }
  return values;
}

}  // namespace gicodec::reference
