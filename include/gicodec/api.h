// Symbol visibility in a shared library: GICODEC_API exports the namespace of a public header,
// GICODEC_LOCAL hides the private parts of its classes.
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
