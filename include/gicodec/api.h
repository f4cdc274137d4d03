// What a shared library shows to others: public headers open their namespace as GICODEC_API. What
// is inside of their classes is GICODEC_LOCAL.
#pragma once

#if (defined(_MSVC_LANG) ? _MSVC_LANG : __cplusplus) < 202002L
#error "libgicodec needs C++20 (-std=c++20)"
#endif

#if defined(__GNUC__)
#define GICODEC_API [[gnu::visibility("default")]]
#define GICODEC_LOCAL [[gnu::visibility("hidden")]]
#else
#define GICODEC_API
#define GICODEC_LOCAL
#endif
