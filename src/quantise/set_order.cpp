#include "quantise/set_order.h"

#include "base/memory.h"

#include <algorithm>
#include <cstring>

namespace gicodec {

bool is_zero(std::span<const std::byte> record) noexcept {
  return std::all_of(record.begin(), record.end(), [](std::byte b) { return b == std::byte{0}; });
}

void sort_set(const Record& record, std::span<std::byte> records) {
  struct Item {
    SetPlace::Axes place;
    const std::byte* bytes;
    bool zero;
  };
  const std::size_t size = record.bytes;
  const Vector<std::byte> before(records.begin(), records.end());
  const SetPlace place(record);
  Vector<Item> items(records.size() / size);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::byte* const bytes = before.data() + i * size;
    items[i] = {place(bytes), bytes, is_zero({bytes, size})};
  }
  std::sort(items.begin(), items.end(), [size](const Item& a, const Item& b) {
    if (a.zero || b.zero) return b.zero && !a.zero;
    if (a.place != b.place) return SetPlace::before(a.place, b.place);
    return std::memcmp(a.bytes, b.bytes, size) < 0;
  });
  for (std::size_t i = 0; i < items.size(); ++i) {
    std::memcpy(records.data() + i * size, items[i].bytes, size);
  }
}

}  // namespace gicodec
