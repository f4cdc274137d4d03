// Which sanitizer watches the tests; GCC and clang say it in different ways.
#pragma once

#ifdef __has_feature
#define GICODEC_HAS_FEATURE(feature) __has_feature(feature)
#else
#define GICODEC_HAS_FEATURE(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || GICODEC_HAS_FEATURE(address_sanitizer)
#define GICODEC_ASAN 1
#include <sanitizer/lsan_interface.h>
#endif
#if defined(__SANITIZE_THREAD__) || GICODEC_HAS_FEATURE(thread_sanitizer)
#define GICODEC_TSAN 1
#endif
#undef GICODEC_HAS_FEATURE

namespace gicodec::test {

/// While it lives, what is allocated is not looked for when the program ends: for what other
/// people's libraries do not free.
#ifdef GICODEC_ASAN
using LeakAllowed = __lsan::ScopedDisabler;
#else
struct LeakAllowed {
  LeakAllowed() noexcept {}
};
#endif

}  // namespace gicodec::test
