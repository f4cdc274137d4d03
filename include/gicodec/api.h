// What a shared library shows to others: public headers open their namespace as GICODEC_API. What
// is inside of their classes is GICODEC_LOCAL.
#pragma once

#if defined(__GNUC__)
#define GICODEC_API [[gnu::visibility("default")]]
#define GICODEC_LOCAL [[gnu::visibility("hidden")]]
#else
#define GICODEC_API
#define GICODEC_LOCAL
#endif
