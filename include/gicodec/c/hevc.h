// The HEVC backend, of the library gicodec-hevc alone: x265 is GPL, FFmpeg and libde265 are LGPL.
#ifndef GICODEC_C_HEVC_H
#define GICODEC_C_HEVC_H

#include <gicodec/c/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// NULL and 0 are the defaults. <gicodec/hevc.h> says more.
typedef struct gicodec_hevc_options {
  uint32_t struct_size;
  uint32_t packing;          ///< 0 paper, 1 planes, 2 luma (lossy colour alone)
  uint32_t layout;           ///< 0 all blocks in place, 1 those of the update, side by side
  uint32_t decoder_threads;  ///< 1..64; 0: 1
  const char* encoder;       ///< "x265" (NULL) or names of FFmpeg encoders, separated by commas
  const char* decoder;       ///< "libde265" (NULL) or "ffmpeg"
  uint32_t lossy;            ///< not 0: lossy colour by `quantiser`
  uint32_t quantiser;        ///< 0..51
} gicodec_hevc_options;

GICODEC_C_API gicodec_status gicodec_hevc_create(const gicodec_hevc_options* options,
                                                 gicodec_backend** out);
GICODEC_C_API void gicodec_hevc_destroy(gicodec_backend* backend);

#ifdef __cplusplus
}
#endif

#endif
