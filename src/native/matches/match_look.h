// Whether match chunks may be worth the time of fast.
#pragma once

#include <gicodec/backend.h>

#include <cstddef>

namespace gicodec::native {

/// Whether they may have fewer than `size` bytes: looks at some records, in microseconds.
[[nodiscard]] bool may_match(const EncodeJob& job, std::size_t size) noexcept;

}  // namespace gicodec::native
