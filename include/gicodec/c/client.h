// Streaming client without a transport: takes messages of a server, holds the textures of its
// volumes. Safe on hostile messages.
#ifndef GICODEC_C_CLIENT_H
#define GICODEC_C_CLIENT_H

#include <gicodec/c/container.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How a client is served.
enum {
  GICODEC_DELIVERY_UNICAST = 0,  ///< packets made for it
  GICODEC_DELIVERY_SHARED = 1,   ///< packets of regions, made once for all
};

typedef struct gicodec_client_options {
  uint32_t struct_size;
  uint32_t delivery;
  uint32_t budget_blocks;  ///< most blocks of an update; 0: no limit
  uint32_t no_texels;      ///< not 0: hold no textures beside the decoders' records
  uint64_t budget_bytes;   ///< most bytes of an update; 0: no limit
  const char* token;       ///< what the server asks for; NULL: none
  const gicodec_limits* limits;
  const gicodec_backend* const* backends;  ///< besides the built-in ones; outlive the client
  size_t backend_count;
  const gicodec_host* host;  ///< NULL: operator new, one thread
} gicodec_client_options;

typedef struct gicodec_client gicodec_client;

/// `options`: NULL for the defaults. GICODEC_INVALID_SETTINGS, GICODEC_INVALID_ARGUMENT,
/// GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_client_create(const gicodec_client_options* options,
                                                   gicodec_client** out);
GICODEC_C_API void gicodec_client_destroy(gicodec_client* client);

/// Prepares the message that opens a connection, the next of gicodec_client_message(). After a lost
/// connection it asks to continue the session, and drops messages that were not taken. The client
/// has no clock: if `connected` stays 0 for some seconds after you sent the message, or messages
/// cease to come, close the connection, open another one, and call this again.
GICODEC_C_API gicodec_status gicodec_client_hello(gicodec_client* client);
/// Takes one message of the server. GICODEC_END after its goodbye; after an error close the
/// connection.
GICODEC_C_API gicodec_status gicodec_client_receive(gicodec_client* client, const void* message,
                                                    size_t size);
/// The oldest message to send, NULL if there is none; the next call gives the next one.
GICODEC_C_API const uint8_t* gicodec_client_message(gicodec_client* client, size_t* size);
/// As gicodec_decoder_cancel(), for gicodec_client_receive().
GICODEC_C_API void gicodec_client_cancel(gicodec_client* client, uint32_t cancel);

/// A camera in world units, by which a server may choose blocks.
typedef struct gicodec_viewpoint {
  uint32_t struct_size;
  float eye[3], target[3], up[3];
  float fov_y;   ///< degrees, over 0 and below 180
  float aspect;  ///< width over height, positive
  float time;    ///< of the client's picture, seconds; 0: no clock of its own
} gicodec_viewpoint;

/// Sent to every new session, too. What it sees of a scene is the server's to judge: `eye` and
/// `target` may be the same. GICODEC_INVALID_ARGUMENT for numbers out of range.
GICODEC_C_API gicodec_status gicodec_client_set_viewpoint(gicodec_client* client,
                                                          const gicodec_viewpoint* viewpoint);
/// Chooses the blocks of a group, whatever the viewpoint: a byte each, 0 for unwanted. Before the
/// server has answered, any choice is kept; one that does not fit its volumes is dropped then.
/// GICODEC_UNKNOWN_VOLUME, GICODEC_UNKNOWN_GROUP, GICODEC_MASK_MISMATCH.
GICODEC_C_API gicodec_status gicodec_client_subscribe(gicodec_client* client, uint32_t volume,
                                                      uint32_t group, const uint8_t* blocks,
                                                      size_t count);
/// Ends the session for good; send the messages, then close the connection.
GICODEC_C_API gicodec_status gicodec_client_disconnect(gicodec_client* client);

/// What the client holds.
typedef struct gicodec_client_state {
  uint32_t struct_size;
  uint32_t connected;   ///< not 0 once the server has answered
  uint32_t resumed;     ///< not 0 if the last hello continued a session
  uint32_t consistent;  ///< not 0 if the frame is complete
  uint64_t epoch;       ///< of the publisher: `update` and `time` belong to it
  uint64_t serial;      ///< counts the updates applied; 0 before the first
  uint64_t update;      ///< the server's number of the update
  double time;          ///< of what the server shows, seconds
  uint32_t volumes;     ///< their number
  uint32_t reason;      ///< of the server's goodbye, gicodec_reason_text()
  uint64_t messages, bytes, packets, blocks;  ///< received and decoded so far
  uint64_t gaps;                              ///< times that the client missed an update
} gicodec_client_state;

GICODEC_C_API gicodec_status gicodec_client_get_state(const gicodec_client* client,
                                                      gicodec_client_state* out);
/// Static storage, for any number.
GICODEC_C_API const char* gicodec_reason_text(uint32_t reason);

/// The volumes, by their place in the frame: the server's number of one, and a number that no other
/// volume of this client ever has. GICODEC_UNKNOWN_VOLUME.
GICODEC_C_API gicodec_status gicodec_client_volume(const gicodec_client* client, uint32_t place,
                                                   uint32_t* volume, uint64_t* instance);
/// Its description, a copy for the caller, with the server's layouts.
GICODEC_C_API gicodec_status gicodec_client_volume_desc(const gicodec_client* client,
                                                        uint32_t volume, gicodec_volume_desc** out);
/// NULL for an unknown volume.
GICODEC_C_API const char* gicodec_client_volume_name(const gicodec_client* client, uint32_t volume);
GICODEC_C_API gicodec_status gicodec_client_geometry(const gicodec_client* client, uint32_t volume,
                                                     gicodec_geometry* out);
/// A texture's texels, tightly packed, guard bands included; NULL if it is unknown or the client
/// holds none.
GICODEC_C_API const uint8_t* gicodec_client_texels(const gicodec_client* client, uint32_t volume,
                                                   uint32_t texture, size_t* size);
/// Blocks that were replaced after the update of serial `after`, ascending.
/// GICODEC_UNKNOWN_VOLUME, GICODEC_UNKNOWN_TEXTURE.
GICODEC_C_API gicodec_status gicodec_client_changed(gicodec_client* client, uint32_t volume,
                                                    uint32_t texture, uint64_t after,
                                                    const uint32_t** blocks, size_t* count);
/// Writes these blocks into `view`, guard bands included.
GICODEC_C_API gicodec_status gicodec_client_read(const gicodec_client* client, uint32_t volume,
                                                 uint32_t texture, uint64_t after,
                                                 const gicodec_view* view);

#ifdef __cplusplus
}
#endif

#endif
