// The exception barrier at the library's API.
#pragma once

#include <gicodec/status.h>

#include <new>
#include <stdexcept>
#include <system_error>

namespace gicodec {

/// Runs `body`, which returns Status or Result. Turns a failed allocation, or a failure to start a
/// thread, into out_of_memory.
template <typename Body>
[[nodiscard]] auto guarded(Body&& body) noexcept -> decltype(body()) {
#ifdef __cpp_exceptions
  try {
    return body();
  } catch (const std::length_error&) {
    return Status::out_of_memory;
  } catch (const std::bad_alloc&) {
    return Status::out_of_memory;
  } catch (const std::system_error&) {
    return Status::out_of_memory;
  } catch (...) {
    return Status::backend_failed;
  }
#else
  return body();
#endif
}

}  // namespace gicodec
