// Which parts a build of the library has.
#pragma once

namespace gicodec {

/// False in a library that decodes alone (GICODEC_DECODE_ONLY): it leaves out what encoders alone
/// call.
#ifdef GICODEC_DECODE_ONLY
inline constexpr bool kEncodes = false;
#else
inline constexpr bool kEncodes = true;
#endif

}  // namespace gicodec
