// Tracks: shared streams for any number of receivers that the publisher does not know, over what
// carries messages by subject and keeps some of them, such as a message broker. A track is a region
// of a texture; a snapshot begins a group of its objects, and updates follow (docs/protocol.md,
// "Tracks"). Safe on hostile messages.
#ifndef GICODEC_C_TRACKS_H
#define GICODEC_C_TRACKS_H

#include <gicodec/c/client.h>
#include <gicodec/c/server.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The stream of a track.
typedef struct gicodec_track {
  uint32_t volume, texture, region;
} gicodec_track;

/// What identifies a track to people and in subjects.
typedef struct gicodec_track_name {
  uint32_t struct_size;
  const char* volume;  ///< both valid until the handle is asked for another name
  const char* texture;
  uint32_t place[3];  ///< of its region among those of the texture
} gicodec_track_name;

typedef struct gicodec_track_publisher_options {
  uint32_t struct_size;
  /// A track that changed gets its next snapshot within so many seconds, or eight times as many
  /// where that keeps to the share; 0: 10.
  double snapshot_seconds;
  double snapshot_share;     ///< of snapshots in all bytes, below 1; 0: 0.25
  const gicodec_host* host;  ///< NULL: operator new
} gicodec_track_publisher_options;

typedef struct gicodec_track_publisher gicodec_track_publisher;

/// Publishes what a server serves. `server`: outlives the publisher; its epoch is not 0 and above
/// that of every publisher before it, since receivers ignore lower ones: the seconds since 1970
/// will do where clocks are right. `options`: NULL for the defaults. GICODEC_INVALID_ARGUMENT;
/// GICODEC_LIMIT_EXCEEDED if max_clients has no room for two more; GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_track_publisher_create(
    gicodec_server* server, const gicodec_track_publisher_options* options,
    gicodec_track_publisher** out);
GICODEC_C_API void gicodec_track_publisher_destroy(gicodec_track_publisher* publisher);

/// In place of gicodec_server_update(), with its errors: also makes the messages of the update.
/// After GICODEC_OUT_OF_MEMORY some of these are missing, and the next update makes up for them.
GICODEC_C_API gicodec_status gicodec_track_publisher_update(gicodec_track_publisher* publisher,
                                                            double now, double time);

enum {
  GICODEC_TRACKS_LIST = 0,    ///< keep the last one
  GICODEC_TRACKS_OBJECT = 1,  ///< keep the last one of each track and number
  GICODEC_TRACKS_TICK = 2,    ///< keep the last one
};

/// A message to publish.
typedef struct gicodec_track_message {
  uint32_t struct_size;
  uint32_t type;
  gicodec_track track;  ///< of objects; else zeros
  uint32_t number;      ///< of objects; 0: a snapshot
  const uint8_t* bytes;
  size_t size;
} gicodec_track_message;

/// The next message of the last update, in the order in which to publish them; GICODEC_END if there
/// is none.
GICODEC_C_API gicodec_status gicodec_track_publisher_message(gicodec_track_publisher* publisher,
                                                             gicodec_track_message* out);
/// GICODEC_UNKNOWN_REGION for a track that does not exist.
GICODEC_C_API gicodec_status gicodec_track_publisher_name(gicodec_track_publisher* publisher,
                                                          const gicodec_track* track,
                                                          gicodec_track_name* out);
/// Seconds for which a transport should keep updates; 0 for NULL.
GICODEC_C_API double gicodec_track_publisher_kept_seconds(const gicodec_track_publisher* publisher);
/// Makes snapshots of all tracks with the next update: the transport may have lost messages.
GICODEC_C_API gicodec_status
gicodec_track_publisher_repeat_snapshots(gicodec_track_publisher* publisher);

typedef struct gicodec_track_receiver_options {
  uint32_t struct_size;
  /// Distance from the viewpoint, in world units, up to which regions of grids are received, the
  /// nearest first. 0: all of them, or those that the client subscribed to.
  float reach;
  uint32_t subscribed_only;    ///< not 0: nothing but the regions that the client subscribed to
  uint32_t max_tracks;         ///< of a list; 0: 131,072
  uint64_t max_waiting_bytes;  ///< of objects that wait for others; 0: 256 MiB
  const gicodec_host* host;    ///< NULL: operator new
} gicodec_track_receiver_options;

typedef struct gicodec_track_receiver gicodec_track_receiver;

/// Stands between messages of tracks and a client of GICODEC_DELIVERY_SHARED, for which it is the
/// server: give it what gicodec_client_hello() and later calls prepare, by
/// gicodec_track_receiver_take(), and the client what gicodec_track_receiver_message() has.
/// `options`: NULL for the defaults. GICODEC_INVALID_ARGUMENT, GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_track_receiver_create(
    const gicodec_track_receiver_options* options, gicodec_track_receiver** out);
GICODEC_C_API void gicodec_track_receiver_destroy(gicodec_track_receiver* receiver);

/// Takes a message of the publisher. Missing, repeated, reordered and damaged ones are no errors.
/// GICODEC_OUT_OF_MEMORY, and for a list: GICODEC_UNKNOWN_KIND, GICODEC_LIMIT_EXCEEDED,
/// GICODEC_CORRUPT; it is then ignored.
GICODEC_C_API gicodec_status gicodec_track_receiver_receive(gicodec_track_receiver* receiver,
                                                            const void* message, size_t size);
/// Takes a message of the client, see gicodec_client_message(). GICODEC_INVALID_ARGUMENT for what a
/// server would drop a client for.
GICODEC_C_API gicodec_status gicodec_track_receiver_take(gicodec_track_receiver* receiver,
                                                         const void* message, size_t size);
/// The next message for the client, NULL if there is none. Call it when no more can be received
/// without waiting: all updates that have come make one message.
GICODEC_C_API const uint8_t* gicodec_track_receiver_message(gicodec_track_receiver* receiver,
                                                            size_t* size);

/// The tracks to receive updates of, the nearest first; receive lists and ticks always.
GICODEC_C_API gicodec_status gicodec_track_receiver_wanted(gicodec_track_receiver* receiver,
                                                           const gicodec_track** tracks,
                                                           size_t* count);
/// An object of a track; of number 0 its last snapshot.
typedef struct gicodec_track_object {
  gicodec_track track;
  uint32_t number;
} gicodec_track_object;

/// What to fetch, once, after each message: what does not come is asked for again some ticks later.
/// `list`, not 0 for the last list and the last tick, and objects, those of
/// the nearest tracks first. Subscribe to the wanted tracks before; receive the answers in any
/// order.
GICODEC_C_API gicodec_status gicodec_track_receiver_requests(gicodec_track_receiver* receiver,
                                                             uint32_t* list,
                                                             const gicodec_track_object** objects,
                                                             size_t* count);
/// GICODEC_UNKNOWN_REGION for a track that does not exist.
GICODEC_C_API gicodec_status gicodec_track_receiver_name(gicodec_track_receiver* receiver,
                                                         const gicodec_track* track,
                                                         gicodec_track_name* out);

typedef struct gicodec_track_receiver_state {
  uint32_t struct_size;
  /// Not 0 if there is a publisher of a later epoch, and what is wanted of it has come: call
  /// gicodec_client_hello(). Until then the client keeps the last state.
  uint32_t wants_hello;
  uint32_t complete;        ///< not 0 if the client has all wanted tracks as of the last tick
  uint64_t wanted_changes;  ///< counts changes of the wanted tracks
  uint64_t ticks;           ///< each later than the one before
  uint64_t objects;         ///< of wanted tracks, received for the first time
  uint64_t repeated;        ///< received again
  uint64_t earlier;         ///< of an earlier epoch or generation, and ignored
  uint64_t damaged;         ///< messages that could not be read
  uint64_t requests;        ///< of objects
} gicodec_track_receiver_state;

GICODEC_C_API gicodec_status gicodec_track_receiver_get_state(
    const gicodec_track_receiver* receiver, gicodec_track_receiver_state* out);

#ifdef __cplusplus
}
#endif

#endif
