// Memory kept for the time when there is none left. Libraries that this program uses (JSON, EXR)
// lose an exception of a failed allocation, or end the program by it; with the reserve released,
// small allocations succeed, and the large one that fails is reported.
#pragma once

namespace gicodec::tools {

/// Call it once, at a program's begin: the first allocation by `new` that fails releases the
/// reserve and is tried again.
void keep_memory_reserve() noexcept;
/// True after that.
[[nodiscard]] bool memory_ran_out() noexcept;

}  // namespace gicodec::tools
