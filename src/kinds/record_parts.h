// Builds the records of kinds, component by component.
#pragma once

#include <gicodec/record.h>

#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace gicodec {

struct RecordPart {
  std::string_view name;
  std::uint8_t bits;
  ComponentType kind;
};

/// A record of consecutive components from bit 0 on. Precondition: they fill whole bytes.
[[nodiscard]] inline Record record_of(std::initializer_list<RecordPart> parts) noexcept {
  Record record;
  std::uint16_t at = 0;
  for (const RecordPart& part : parts) {
    record.components[record.count++] = {part.name, at, part.bits, part.kind};
    at = static_cast<std::uint16_t>(at + part.bits);
  }
  record.bytes = static_cast<std::uint8_t>(at / 8);
  return record;
}

}  // namespace gicodec
