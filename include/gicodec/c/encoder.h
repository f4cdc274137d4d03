// Encoders: textures in, packets out.
#ifndef GICODEC_C_ENCODER_H
#define GICODEC_C_ENCODER_H

#include <gicodec/c/description.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GICODEC_GOP_ON_REQUEST UINT32_MAX

/// Settings of encoders. The defaults (0, NULL) are what most want.
typedef struct gicodec_encoder_options {
  uint32_t struct_size;
  /// A keyframe every `gop` packets; 0: 30; GICODEC_GOP_ON_REQUEST: only on request.
  uint32_t gop;
  const char* backend;  ///< "native" (NULL), "raw", "lz4", "zstd", or a name from `backends`
  const char* preset;   ///< native: "turbo", "fast" (NULL), "strong"; hevc: x265's names
  int32_t level;        ///< lz4, zstd: theirs; 0: the backend's default
  uint32_t chunk;       ///< native: most blocks per chunk, 1..4096; 0: chosen by size
  /// Not 0: raw, lz4 and zstd code updates as they are, not as differences to the last ones.
  uint32_t no_difference;
  /// The texture_id in packets, 0..255; a volume's textures count from it on.
  uint32_t texture_id;
  /// Error bound of decoded records (docs/guarantees.md): 0 lossless, below 1 relative, else codes
  /// or representable values.
  float max_error;
  uint32_t max_error_count;  ///< of `max_errors`
  /// Volume encoders: a bound for each texture, instead of max_error; NULL: none.
  const float* max_errors;
  const gicodec_backend* const* backends;
  size_t backend_count;
  const gicodec_host* host;  ///< NULL: operator new, one thread
} gicodec_encoder_options;

/// Turns successive contents of one texture into packets. The first one is a keyframe.
typedef struct gicodec_encoder gicodec_encoder;

/// `options`: NULL for the defaults. Errors: GICODEC_INVALID_DESCRIPTION, GICODEC_UNKNOWN_BACKEND,
/// GICODEC_INVALID_SETTINGS, GICODEC_INVALID_BOUND, GICODEC_UNSUPPORTED_FORMAT,
/// GICODEC_UNSUPPORTED_SHAPE, GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_encoder_create(const gicodec_texture_desc* desc,
                                                    const gicodec_encoder_options* options,
                                                    gicodec_encoder** out);
GICODEC_C_API void gicodec_encoder_destroy(gicodec_encoder* encoder);

/// Upper bound of the bytes of a packet of that many blocks.
GICODEC_C_API size_t gicodec_encoder_bound(const gicodec_encoder* encoder, size_t blocks);
/// Codes the selected blocks of `view` into `out`. `blocks` is read with GICODEC_SELECT_LIST only.
/// `out` may be smaller than gicodec_encoder_bound() if the packet fits. With
/// GICODEC_BUFFER_TOO_SMALL nothing was coded, and `size` is a bound. Errors:
/// GICODEC_VIEW_TOO_SMALL, GICODEC_BLOCK_OUT_OF_RANGE, GICODEC_BLOCK_REPEATED,
/// GICODEC_OUT_OF_MEMORY, GICODEC_OUT_OF_ORDER if the texture needs presence first.
GICODEC_C_API gicodec_status gicodec_encoder_encode(gicodec_encoder* encoder,
                                                    const gicodec_const_view* view,
                                                    uint32_t selection, const uint32_t* blocks,
                                                    size_t block_count, void* out, size_t capacity,
                                                    size_t* size);
/// A keyframe of what decoders hold, for those that join late. GICODEC_OUT_OF_ORDER before the
/// first packet; GICODEC_UNSUPPORTED_BACKEND for hevc.
GICODEC_C_API gicodec_status gicodec_encoder_snapshot(gicodec_encoder* encoder, void* out,
                                                      size_t capacity, size_t* size);
/// Makes the next packet a keyframe.
GICODEC_C_API gicodec_status gicodec_encoder_request_keyframe(gicodec_encoder* encoder);
/// The preset of the next packets. GICODEC_INVALID_SETTINGS, GICODEC_UNSUPPORTED_BACKEND.
GICODEC_C_API gicodec_status gicodec_encoder_set_preset(gicodec_encoder* encoder,
                                                        const char* preset);
/// Leaves inactive blocks out of GICODEC_SELECT_CHANGED: a byte per block, 0 for inactive; none:
/// all are active. GICODEC_MASK_MISMATCH.
GICODEC_C_API gicodec_status gicodec_encoder_set_active(gicodec_encoder* encoder,
                                                        const uint8_t* active, size_t count);
/// Sets which records exist from now on: presence_bytes for each block. GICODEC_MASK_MISMATCH,
/// GICODEC_PRESENCE_INVALID.
GICODEC_C_API gicodec_status gicodec_encoder_set_presence(gicodec_encoder* encoder,
                                                          const void* presence, size_t size);
/// Writes what decoders hold into `view`. GICODEC_VIEW_TOO_SMALL.
GICODEC_C_API gicodec_status gicodec_encoder_read(const gicodec_encoder* encoder,
                                                  const gicodec_view* view);
/// Number of the last packet; 0 before the first.
GICODEC_C_API uint32_t gicodec_encoder_sequence(const gicodec_encoder* encoder);

/// Turns successive contents of all textures of a volume into updates: one packet per texture.
typedef struct gicodec_volume_encoder gicodec_volume_encoder;

/// The description is copied. Errors: those of gicodec_encoder_create().
GICODEC_C_API gicodec_status gicodec_volume_encoder_create(const gicodec_volume_desc* volume,
                                                           const gicodec_encoder_options* options,
                                                           gicodec_volume_encoder** out);
GICODEC_C_API void gicodec_volume_encoder_destroy(gicodec_volume_encoder* encoder);

/// Codes the selected blocks of the views, one for each texture, into packets that the handle
/// holds until the next call. A list applies to every group. An error leaves all as before.
/// GICODEC_INVALID_ARGUMENT if `view_count` is not the number of textures, and the errors of
/// gicodec_encoder_encode().
GICODEC_C_API gicodec_status gicodec_volume_encoder_encode(gicodec_volume_encoder* encoder,
                                                           const gicodec_const_view* views,
                                                           size_t view_count, uint32_t selection,
                                                           const uint32_t* blocks,
                                                           size_t block_count);
/// Makes those packets keyframes of what decoders hold.
GICODEC_C_API gicodec_status gicodec_volume_encoder_snapshot(gicodec_volume_encoder* encoder);
/// The packets of the last call, in the order in which decoders must apply them: their number, and
/// one of them; NULL and size 0 beyond the last.
GICODEC_C_API uint32_t gicodec_volume_encoder_packets(const gicodec_volume_encoder* encoder);
GICODEC_C_API const uint8_t* gicodec_volume_encoder_packet(const gicodec_volume_encoder* encoder,
                                                           uint32_t packet, size_t* size);
GICODEC_C_API gicodec_status
gicodec_volume_encoder_request_keyframe(gicodec_volume_encoder* encoder);
/// GICODEC_UNKNOWN_TEXTURE, and errors of gicodec_encoder_set_preset().
GICODEC_C_API gicodec_status gicodec_volume_encoder_set_preset(gicodec_volume_encoder* encoder,
                                                               uint32_t texture,
                                                               const char* preset);
/// As gicodec_encoder_set_active(), for a group. GICODEC_UNKNOWN_GROUP.
GICODEC_C_API gicodec_status gicodec_volume_encoder_set_active(gicodec_volume_encoder* encoder,
                                                               uint32_t group,
                                                               const uint8_t* active, size_t count);
/// GICODEC_UNKNOWN_TEXTURE, GICODEC_VIEW_TOO_SMALL.
GICODEC_C_API gicodec_status gicodec_volume_encoder_read(const gicodec_volume_encoder* encoder,
                                                         uint32_t texture,
                                                         const gicodec_view* view);

#ifdef __cplusplus
}
#endif

#endif
