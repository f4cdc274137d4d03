// Decoders: packets in, textures out. Safe on hostile bytes: a packet is applied completely or not
// at all.
#ifndef GICODEC_C_DECODER_H
#define GICODEC_C_DECODER_H

#include <gicodec/c/description.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gicodec_decoder_options {
  uint32_t struct_size;
  uint32_t texture_id;  ///< 0..255; volume decoders: of the first texture's packets
  const gicodec_limits* limits;
  const gicodec_backend* const* backends;  ///< besides the built-in ones
  size_t backend_count;
  const gicodec_host* host;  ///< NULL: operator new, one thread
} gicodec_decoder_options;

/// Turns the packets of one texture back into records.
typedef struct gicodec_decoder gicodec_decoder;

/// `options`: NULL for the defaults. Errors: GICODEC_INVALID_DESCRIPTION, GICODEC_INVALID_SETTINGS,
/// GICODEC_LIMIT_EXCEEDED, GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_decoder_create(const gicodec_texture_desc* desc,
                                                    const gicodec_decoder_options* options,
                                                    gicodec_decoder** out);
GICODEC_C_API void gicodec_decoder_destroy(gicodec_decoder* decoder);

/// Applies a packet, then writes the blocks that it may have changed into `view`, guard bands
/// included; NULL: writes nothing. GICODEC_REFERENCE_MISSING: an earlier packet was not applied;
/// wait for a keyframe. Other errors: those of 3xx and 4xx, GICODEC_LIMIT_EXCEEDED,
/// GICODEC_VIEW_TOO_SMALL, GICODEC_OUT_OF_ORDER if the texture needs presence first.
GICODEC_C_API gicodec_status gicodec_decoder_decode(gicodec_decoder* decoder, const void* packet,
                                                    size_t size, const gicodec_view* view);
/// Any thread may call it: the decode() that runs soon fails with GICODEC_CANCELLED, and so do
/// later ones until it is called with 0.
GICODEC_C_API void gicodec_decoder_cancel(gicodec_decoder* decoder, uint32_t cancel);
/// Sets which records exist, for the next packets. Copied. GICODEC_MASK_MISMATCH.
GICODEC_C_API gicodec_status gicodec_decoder_set_presence(gicodec_decoder* decoder,
                                                          const void* presence, size_t size);
/// Writes the whole texture into `view`, or with a list just those blocks.
/// GICODEC_VIEW_TOO_SMALL, GICODEC_BLOCK_OUT_OF_RANGE.
GICODEC_C_API gicodec_status gicodec_decoder_read(const gicodec_decoder* decoder,
                                                  const gicodec_view* view, const uint32_t* blocks,
                                                  size_t block_count);
/// Blocks that the last packet may have changed, ascending. Not NULL, also for none.
GICODEC_C_API const uint32_t* gicodec_decoder_changed(const gicodec_decoder* decoder,
                                                      size_t* count);
/// All blocks, tightly packed, without guard bands; zero if not received.
GICODEC_C_API const uint8_t* gicodec_decoder_records(const gicodec_decoder* decoder, size_t* size);
/// A byte per block, not 0 if the block was received.
GICODEC_C_API const uint8_t* gicodec_decoder_received(const gicodec_decoder* decoder,
                                                      size_t* count);
/// Number of the last packet applied; 0 before the first.
GICODEC_C_API uint32_t gicodec_decoder_sequence(const gicodec_decoder* decoder);
/// Hash of the whole contents.
GICODEC_C_API uint64_t gicodec_decoder_state_hash(const gicodec_decoder* decoder);

/// Turns the packets of a volume encoder back into textures.
typedef struct gicodec_volume_decoder gicodec_volume_decoder;

/// The description is copied. Errors: those of gicodec_decoder_create().
GICODEC_C_API gicodec_status gicodec_volume_decoder_create(const gicodec_volume_desc* volume,
                                                           const gicodec_decoder_options* options,
                                                           gicodec_volume_decoder** out);
GICODEC_C_API void gicodec_volume_decoder_destroy(gicodec_volume_decoder* decoder);

/// Applies one packet. A packet of presence comes before those of the textures it is for. After
/// GICODEC_OUT_OF_MEMORY repeat the call; after other errors the texture needs a keyframe.
GICODEC_C_API gicodec_status gicodec_volume_decoder_decode(gicodec_volume_decoder* decoder,
                                                           const void* packet, size_t size);
/// As gicodec_decoder_cancel().
GICODEC_C_API void gicodec_volume_decoder_cancel(gicodec_volume_decoder* decoder, uint32_t cancel);
/// As gicodec_decoder_read(); GICODEC_UNKNOWN_TEXTURE.
GICODEC_C_API gicodec_status gicodec_volume_decoder_read(const gicodec_volume_decoder* decoder,
                                                         uint32_t texture, const gicodec_view* view,
                                                         const uint32_t* blocks,
                                                         size_t block_count);
/// Blocks of a texture that the last packet may have changed, ascending; none after a packet of
/// another texture: ask after each packet. Not NULL, also for none.
GICODEC_C_API const uint32_t* gicodec_volume_decoder_changed(const gicodec_volume_decoder* decoder,
                                                             uint32_t texture, size_t* count);
/// As gicodec_decoder_records(), of a texture; NULL if it is unknown.
GICODEC_C_API const uint8_t* gicodec_volume_decoder_records(const gicodec_volume_decoder* decoder,
                                                            uint32_t texture, size_t* size);

/// The head of a packet; sizes are in bytes.
typedef struct gicodec_packet_info {
  uint32_t struct_size;
  uint32_t version;
  uint32_t type;     ///< 0 keyframe, 1 delta, 2 intra, 3 snapshot, 4 catch-up, 5 intra catch-up
  uint32_t backend;  ///< gicodec_backend_name()
  uint32_t texture_id;
  uint32_t lossy;       ///< not 0: decoded records may differ from the encoder's input
  uint32_t sequence;    ///< number of the update
  uint32_t reference;   ///< number of the update it builds on; 0 for a keyframe
  uint32_t all_blocks;  ///< not 0: it has all blocks, and lists none
  uint32_t blocks;      ///< that it lists
  uint64_t header_size, index_size, guard_band_size, payload_size;
} gicodec_packet_info;

/// Reads the head of a packet without a decoder. Errors: those of 3xx.
GICODEC_C_API gicodec_status gicodec_packet_peek(const void* packet, size_t size,
                                                 gicodec_packet_info* out);
/// "raw", "lz4", "zstd", "hevc", "native"; NULL for other numbers.
GICODEC_C_API const char* gicodec_backend_name(uint32_t backend);

#ifdef __cplusplus
}
#endif

#endif
