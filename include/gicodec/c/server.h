// Streaming server without a transport: takes textures of volumes and messages of clients, gives
// messages for the clients. Checks all that clients send. `now` is in seconds on any clock that
// does not go backwards.
#ifndef GICODEC_C_SERVER_H
#define GICODEC_C_SERVER_H

#include <gicodec/c/client.h>

#ifdef __cplusplus
extern "C" {
#endif

/// 0: the default, in brackets. Bytes and seconds unless said; <gicodec/server.h> says more.
typedef struct gicodec_server_options {
  uint32_t struct_size;
  int32_t level;        ///< lz4, zstd: theirs
  const char* backend;  ///< "native" (NULL) or another
  const char* preset;   ///< NULL: the server chooses for each client
  const char* token;    ///< that clients must know; NULL: none
  const char* scene;    ///< name of the scene; NULL: none
  uint64_t scene_geometry;
  uint64_t epoch;                   ///< 0: drawn at random
  uint32_t region[3];               ///< blocks of a shared stream, all or no zeros [by block size]
  uint32_t proofs;                  ///< not 0: send hashes for clients to check
  double interval;                  ///< intended time between updates [the recent one]
  uint64_t first_update_bytes;      ///< of the first update to a client, 2,048 or more [12,288]
  uint32_t max_clients;             ///< sessions, those of lost connections included [4,096]
  uint32_t max_connections;         ///< those without a Hello included [1,024]
  uint32_t max_waiting;             ///< connections without a Hello [128]
  uint32_t max_unicast;             ///< unicast sessions [32]
  uint32_t max_unicast_per_origin;  ///< [no limit]
  uint32_t max_in_flight;           ///< updates that a client has not acknowledged [24]
  uint64_t max_in_flight_bytes;     ///< of these [16 MiB]
  uint64_t max_message_bytes;       ///< of a client's message [1 MiB]
  uint64_t max_bytes_per_second;    ///< to a client [no limit]
  uint64_t max_total_bytes_per_second;     ///< to all together [no limit]
  double messages_per_second;              ///< of a client, on average [200]
  double resyncs_per_second;               ///< of a client, on average [1]
  double hello_timeout;                    ///< from connection to Hello [5]
  double stall_timeout;                    ///< without an acknowledgement [20]
  double linger_timeout;                   ///< that a session outlives its connection [30]
  const gicodec_backend* const* backends;  ///< besides the built-in ones
  size_t backend_count;
  const gicodec_host* host;  ///< NULL: operator new, one thread
} gicodec_server_options;

/// How a texture is sent.
typedef struct gicodec_streamed_texture {
  uint32_t struct_size;
  uint32_t texture;    ///< its number
  uint32_t interval;   ///< sent in every n-th update; 0: 1
  float threshold;     ///< blocks that are off by no more are not sent
  float max_error;     ///< error bound of records that clients decode
  float source_error;  ///< of the published records themselves
} gicodec_streamed_texture;

typedef struct gicodec_server gicodec_server;

/// `options`: NULL for the defaults. GICODEC_UNKNOWN_BACKEND; GICODEC_INVALID_SETTINGS for a
/// preset, level or host that the backend or machine does not know; GICODEC_INVALID_NAME,
/// GICODEC_INVALID_ARGUMENT, GICODEC_IO_FAILED without randomness.
GICODEC_C_API gicodec_status gicodec_server_create(const gicodec_server_options* options,
                                                   gicodec_server** out);
GICODEC_C_API void gicodec_server_destroy(gicodec_server* server);

/// Adds a volume, also while clients are connected, and stores its number. `name`: UTF-8 of at most
/// 255 bytes; NULL: none. `geometry`: of the first texture group's grid. `textures`: those that
/// do not take the defaults; an array of structs of textures->struct_size.
GICODEC_C_API gicodec_status gicodec_server_add_volume(gicodec_server* server, const char* name,
                                                       const gicodec_volume_desc* desc,
                                                       const gicodec_geometry* geometry,
                                                       const gicodec_streamed_texture* textures,
                                                       size_t texture_count, uint32_t* volume);
GICODEC_C_API gicodec_status gicodec_server_remove_volume(gicodec_server* server, uint32_t volume);
/// Sets a texture's contents from the next update on, reading `view` during the call. `blocks`: all
/// that may have changed; NULL: any.
GICODEC_C_API gicodec_status gicodec_server_publish(gicodec_server* server, uint32_t volume,
                                                    uint32_t texture,
                                                    const gicodec_const_view* view,
                                                    const uint32_t* blocks, size_t block_count);
/// Moves a camera-locked volume; publish its textures before the next update.
GICODEC_C_API gicodec_status gicodec_server_scroll(gicodec_server* server, uint32_t volume,
                                                   int32_t x, int32_t y, int32_t z);
/// Leaves inactive blocks of a group out of all updates: a byte per block, 0 for inactive.
GICODEC_C_API gicodec_status gicodec_server_set_active(gicodec_server* server, uint32_t volume,
                                                       uint32_t group, const uint8_t* active,
                                                       size_t count);

/// Call this for each new connection of a transport. `origin` identifies the peer, NULL: unknown.
/// After an error close the connection.
GICODEC_C_API gicodec_status gicodec_server_connect(gicodec_server* server, double now,
                                                    const char* origin, uint32_t* connection);
/// Takes a message of a client. Drops a connection that breaks the rules; ignores messages of
/// dropped and unknown connections, since they may have been on their way.
GICODEC_C_API gicodec_status gicodec_server_receive(gicodec_server* server, uint32_t connection,
                                                    const void* message, size_t size, double now);
/// Call this when a connection is lost or closed; its session lingers. Ignores unknown ones.
GICODEC_C_API gicodec_status gicodec_server_disconnect(gicodec_server* server, uint32_t connection,
                                                       double now);
/// Ends a connection and its session; `reason` as in gicodec_reason_text().
GICODEC_C_API gicodec_status gicodec_server_drop(gicodec_server* server, uint32_t connection,
                                                 uint32_t reason);
/// Sets which blocks of a group the client sees: a byte per block.
GICODEC_C_API gicodec_status gicodec_server_set_visible(gicodec_server* server, uint32_t connection,
                                                        uint32_t volume, uint32_t group,
                                                        const uint8_t* visible, size_t count);

/// Makes the next packets for all sessions, and the messages that carry them. `time`: of what is
/// shown, seconds. After an error other than GICODEC_INVALID_TIME go on.
GICODEC_C_API gicodec_status gicodec_server_update(gicodec_server* server, double now, double time);
/// Tells how long the last update took and may take, in seconds, to keep within it. Ignores values
/// that are no times.
GICODEC_C_API gicodec_status gicodec_server_report_update_time(gicodec_server* server,
                                                               double elapsed, double budget);
/// Enforces timeouts between updates.
GICODEC_C_API gicodec_status gicodec_server_tick(gicodec_server* server, double now);
/// The oldest message for a client, NULL if there is none; the next call gives the next one. Send
/// them reliably and in this order.
GICODEC_C_API const uint8_t* gicodec_server_message(gicodec_server* server, uint32_t connection,
                                                    size_t* size);

enum {
  GICODEC_EVENT_JOINED = 0,      ///< a new session
  GICODEC_EVENT_RESUMED = 1,     ///< a session continues over this connection
  GICODEC_EVENT_VIEWPOINT = 2,   ///< the client sent a viewpoint
  GICODEC_EVENT_SUBSCRIBED = 3,  ///< the client chose blocks
  GICODEC_EVENT_DROPPED = 4,     ///< send the messages, then close the connection
  GICODEC_EVENT_EXPIRED = 5,     ///< a session without a connection ended
};

typedef struct gicodec_event {
  uint32_t struct_size;
  uint32_t type;
  uint32_t connection;
  uint32_t client;  ///< 0 before the connection has a session
  uint32_t reason;  ///< GICODEC_EVENT_DROPPED: why, gicodec_reason_text(); else 0
} gicodec_event;

/// The oldest event; GICODEC_END if there is none. Take them after each call: beyond some 65,000
/// the oldest are dropped.
GICODEC_C_API gicodec_status gicodec_server_event(gicodec_server* server, gicodec_event* out);
/// The client's last viewpoint. GICODEC_UNKNOWN_CONNECTION; GICODEC_END if it sent none.
GICODEC_C_API gicodec_status gicodec_server_viewpoint(const gicodec_server* server,
                                                      uint32_t connection, gicodec_viewpoint* out);

typedef struct gicodec_connection_state {
  uint32_t struct_size;
  uint32_t client, delivery;
  uint32_t in_flight;               ///< updates not acknowledged
  uint64_t in_flight_bytes;         ///< of these
  uint64_t updates, bytes, blocks;  ///< made for this connection
  uint64_t skipped;                 ///< updates left empty
  uint64_t update_bytes;            ///< that congestion control allows in an update
  uint64_t memory;                  ///< bytes held for the client
  uint32_t resyncs, lagging;
  uint32_t pending;  ///< visible blocks whose contents were not sent
  uint32_t oldest_pending;
} gicodec_connection_state;

/// GICODEC_UNKNOWN_CONNECTION.
GICODEC_C_API gicodec_status gicodec_server_connection(const gicodec_server* server,
                                                       uint32_t connection,
                                                       gicodec_connection_state* out);

#ifdef __cplusplus
}
#endif

#endif
