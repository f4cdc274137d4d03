// Containers (.gic): packets of the textures of several volumes in a file, with a seek index.
#ifndef GICODEC_C_CONTAINER_H
#define GICODEC_C_CONTAINER_H

#include <gicodec/c/decoder.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Where a grid of blocks stands. Block (x, y, z) is at origin + spacing · (x, y, z), without
/// scroll.
typedef struct gicodec_geometry {
  uint32_t struct_size;
  uint32_t grid[3];   ///< of the volume's first texture group
  float origin[3];    ///< world units
  float spacing[3];   ///< positive
  int32_t scroll[3];  ///< cells that a camera-locked volume has moved
} gicodec_geometry;

/// The volumes, textures and metadata of a container.
typedef struct gicodec_container gicodec_container;

GICODEC_C_API gicodec_status gicodec_container_create(gicodec_container** out);
GICODEC_C_API void gicodec_container_destroy(gicodec_container* container);
/// Adds a volume with its textures, 1 to 256 of each in all. The description is copied.
/// GICODEC_UNKNOWN_KIND, GICODEC_INVALID_DESCRIPTION, GICODEC_INVALID_NAME.
GICODEC_C_API gicodec_status gicodec_container_add_volume(gicodec_container* container,
                                                          const char* name,
                                                          const gicodec_volume_desc* volume);
/// GICODEC_UNKNOWN_VOLUME; GICODEC_INVALID_GEOMETRY, also for another grid than the volume's.
GICODEC_C_API gicodec_status gicodec_container_set_geometry(gicodec_container* container,
                                                            uint32_t volume,
                                                            const gicodec_geometry* geometry);
/// The largest error of a texture's decoded records; 0: lossless. GICODEC_UNKNOWN_TEXTURE.
GICODEC_C_API gicodec_status gicodec_container_set_largest_error(gicodec_container* container,
                                                                 uint32_t texture, float error);

/// What a pair of name and value belongs to, with an index.
enum {
  GICODEC_METADATA_CONTAINER = 0,  ///< index 0
  GICODEC_METADATA_VOLUME = 1,
  GICODEC_METADATA_TEXTURE = 2,
};
/// Adds a pair of name and value. GICODEC_INVALID_NAME if they are not UTF-8,
/// GICODEC_LIMIT_EXCEEDED if one is longer than 1 MiB.
GICODEC_C_API gicodec_status gicodec_container_add_metadata(gicodec_container* container,
                                                            uint32_t of, uint32_t index,
                                                            const char* name, const char* value);
/// The pairs: their number, and the name and value of one; NULL beyond the last. A value from a
/// file may contain zeros: `size`, if not NULL, has its length.
GICODEC_C_API uint32_t gicodec_container_metadata_count(const gicodec_container* container,
                                                        uint32_t of, uint32_t index);
GICODEC_C_API const char* gicodec_container_metadata_name(const gicodec_container* container,
                                                          uint32_t of, uint32_t index,
                                                          uint32_t pair);
GICODEC_C_API const char* gicodec_container_metadata_value(const gicodec_container* container,
                                                           uint32_t of, uint32_t index,
                                                           uint32_t pair, size_t* size);
/// The scene that the volumes light, for people, and a hash of its geometry; "" and 0: unknown.
GICODEC_C_API gicodec_status gicodec_container_set_scene(gicodec_container* container,
                                                         const char* name, uint64_t geometry);
GICODEC_C_API const char* gicodec_container_scene(const gicodec_container* container,
                                                  uint64_t* geometry);

GICODEC_C_API uint32_t gicodec_container_volumes(const gicodec_container* container);
GICODEC_C_API uint32_t gicodec_container_textures(const gicodec_container* container);
/// NULL for an unknown volume.
GICODEC_C_API const char* gicodec_container_volume_name(const gicodec_container* container,
                                                        uint32_t volume);
/// The volume's description, a copy for the caller. GICODEC_UNKNOWN_VOLUME; GICODEC_UNKNOWN_KIND if
/// this library does not know its kind.
GICODEC_C_API gicodec_status gicodec_container_volume(const gicodec_container* container,
                                                      uint32_t volume, gicodec_volume_desc** out);
/// GICODEC_UNKNOWN_VOLUME; GICODEC_END if the volume has no geometry.
GICODEC_C_API gicodec_status gicodec_container_geometry(const gicodec_container* container,
                                                        uint32_t volume, gicodec_geometry* out);
/// NULL for an unknown texture.
GICODEC_C_API const char* gicodec_container_texture_name(const gicodec_container* container,
                                                         uint32_t texture);
/// GICODEC_UNKNOWN_TEXTURE; GICODEC_UNKNOWN_KIND as above. `volume`, if not NULL: its volume.
GICODEC_C_API gicodec_status gicodec_container_texture(const gicodec_container* container,
                                                       uint32_t texture, gicodec_texture_desc* out,
                                                       uint32_t* volume);
/// 0: lossless; infinity: unknown.
GICODEC_C_API float gicodec_container_largest_error(const gicodec_container* container,
                                                    uint32_t texture);
/// All of it as JSON, a zero behind it that `size` counts.
GICODEC_C_API gicodec_status gicodec_container_json(const gicodec_container* container, char* out,
                                                    size_t capacity, size_t* size);

/// Takes the bytes of a container, front to back.
typedef struct gicodec_sink {
  uint32_t struct_size;
  void* self;
  /// Writes all bytes and returns GICODEC_OK, or none and another status. The writer's call returns
  /// that status too; GICODEC_IO_FAILED for a number that is none of this library's.
  gicodec_status (*write)(void* self, const void* bytes, size_t size);
} gicodec_sink;

/// Writes a container. A failed call changes nothing: repeat it, or go on without it.
typedef struct gicodec_writer gicodec_writer;

/// `sink`: copied; NULL: into memory, see gicodec_writer_bytes(). GICODEC_INVALID_DESCRIPTION.
GICODEC_C_API gicodec_status gicodec_writer_create(const gicodec_sink* sink,
                                                   const gicodec_container* container,
                                                   gicodec_writer** out);
GICODEC_C_API void gicodec_writer_destroy(gicodec_writer* writer);
/// Adds a packet of a frame. Frames must not decrease; a texture has at most one packet per frame.
/// The packet's texture_id names its texture. Beyond its head a packet is not checked: add what an
/// encoder made, or what a decoder took. GICODEC_WRONG_FRAME, GICODEC_UNKNOWN_TEXTURE,
/// GICODEC_DESCRIPTION_MISMATCH, GICODEC_OUT_OF_ORDER after gicodec_writer_finish().
GICODEC_C_API gicodec_status gicodec_writer_add(gicodec_writer* writer, uint64_t frame,
                                                const void* packet, size_t size);
/// Writes the index so far, for those that read the file while it grows.
GICODEC_C_API gicodec_status gicodec_writer_flush(gicodec_writer* writer);
/// Writes the rest of the index and the end mark.
GICODEC_C_API gicodec_status gicodec_writer_finish(gicodec_writer* writer);
/// Without a sink: the bytes since the last gicodec_writer_take().
GICODEC_C_API const uint8_t* gicodec_writer_bytes(const gicodec_writer* writer, size_t* size);
/// Drops these bytes.
GICODEC_C_API gicodec_status gicodec_writer_take(gicodec_writer* writer);

/// Bytes of a source.
typedef struct gicodec_range {
  uint64_t offset, size;
} gicodec_range;

/// Gives the bytes of a container.
typedef struct gicodec_source {
  uint32_t struct_size;
  void* self;
  /// Fills `into` and stores the number of bytes in `got`. Fewer than asked for: the end, with
  /// GICODEC_OK or GICODEC_END. Other statuses: as those of gicodec_sink.
  gicodec_status (*read)(void* self, void* into, size_t bytes, size_t* got);
  /// The next read() begins at `offset`. NULL: the source cannot seek (a pipe).
  gicodec_status (*seek)(void* self, uint64_t offset);
  /// Total bytes; may grow. NULL just where `seek` is.
  uint64_t (*size)(void* self);
  /// Says which bytes will be read next, so that a source that is far away brings them together.
  /// May be called with none. 0: reading has no delay, and nobody need call it again, as if NULL.
  uint32_t (*prefetch)(void* self, const gicodec_range* ranges, size_t count);
} gicodec_source;

typedef struct gicodec_player_options {
  uint32_t struct_size;
  const gicodec_limits* limits;
  const gicodec_backend* const* backends;  ///< besides the built-in ones
  size_t backend_count;
  const gicodec_host* host;  ///< NULL: operator new, one thread
} gicodec_player_options;

/// Plays a container, in order or from any frame on. Safe on hostile bytes.
typedef struct gicodec_player gicodec_player;

/// `source`: copied. Errors: those of 3xx, GICODEC_LIMIT_EXCEEDED, GICODEC_OUT_OF_MEMORY.
GICODEC_C_API gicodec_status gicodec_player_open(const gicodec_source* source,
                                                 const gicodec_player_options* options,
                                                 gicodec_player** out);
/// The version that a container's first 10 bytes name, also of one that this library does not read,
/// upon which gicodec_player_open() says GICODEC_UNSUPPORTED_VERSION; it reads `readable`.
/// GICODEC_TRUNCATED, GICODEC_NOT_GICODEC.
GICODEC_C_API gicodec_status gicodec_container_version(const void* head, size_t size,
                                                       uint32_t* major, uint32_t* minor,
                                                       uint32_t* readable);
/// Plays from memory, which must outlive the player.
GICODEC_C_API gicodec_status gicodec_player_open_memory(const void* bytes, size_t size,
                                                        const gicodec_player_options* options,
                                                        gicodec_player** out);
GICODEC_C_API void gicodec_player_destroy(gicodec_player* player);
/// Valid as long as the player.
GICODEC_C_API const gicodec_container* gicodec_player_container(const gicodec_player* player);
/// Plays only these textures, and those that hold their presence. GICODEC_UNKNOWN_TEXTURE;
/// GICODEC_OUT_OF_ORDER after the first frame.
GICODEC_C_API gicodec_status gicodec_player_select(gicodec_player* player, const uint32_t* textures,
                                                   size_t count);
/// Of this volume, if it is cut into regions, plays only those with blocks from `first` to `last`,
/// of other volumes all. GICODEC_UNKNOWN_VOLUME; GICODEC_OUT_OF_ORDER after the first frame.
GICODEC_C_API gicodec_status gicodec_player_select_box(gicodec_player* player, uint32_t volume,
                                                       const uint32_t first[3],
                                                       const uint32_t last[3]);
/// Sets where the blocks of a texture's views lie: tiling, padding and slots of `desc`.
/// GICODEC_OUT_OF_ORDER after the texture's first packet.
GICODEC_C_API gicodec_status gicodec_player_set_layout(gicodec_player* player, uint32_t texture,
                                                       const gicodec_texture_desc* desc);
/// Applies the next frame. GICODEC_END after the last one; GICODEC_TRUNCATED if the file was cut
/// off or is growing. After another error the frame is incomplete, and the next call goes on behind
/// it: after GICODEC_OUT_OF_MEMORY seek to the frame to apply it in whole.
GICODEC_C_API gicodec_status gicodec_player_next(gicodec_player* player);
/// Not 0 while the source grows: gicodec_player_next() then ends no frame whose packets may not all
/// have arrived; it returns GICODEC_TRUNCATED, and goes on with that frame when it is called again.
GICODEC_C_API gicodec_status gicodec_player_set_growing(gicodec_player* player, uint32_t growing);
/// Not 0 once the player found the container's end mark, which gicodec_player_open() does if the
/// source can seek. A container without one was cut off, or is growing.
GICODEC_C_API uint32_t gicodec_player_finished(const gicodec_player* player);
/// Not 0 if gicodec_player_seek() works: the source can seek, and its index is sound.
GICODEC_C_API uint32_t gicodec_player_seekable(const gicodec_player* player);
/// Peak bytes that it holds, as max_total_bytes counts them.
GICODEC_C_API uint64_t gicodec_player_memory(const gicodec_player* player);
/// The next gicodec_player_next() applies that frame. GICODEC_UNKNOWN_FRAME.
GICODEC_C_API gicodec_status gicodec_player_seek(gicodec_player* player, uint64_t frame);
/// The frame of the last gicodec_player_next().
GICODEC_C_API uint64_t gicodec_player_frame(const gicodec_player* player);
/// The frames of a container that can be sought, ascending.
GICODEC_C_API gicodec_status gicodec_player_frames(gicodec_player* player, const uint64_t** frames,
                                                   size_t* count);
/// Writes a texture as of this frame, guard bands included; with a list just those blocks.
/// GICODEC_UNKNOWN_TEXTURE, GICODEC_VIEW_TOO_SMALL.
GICODEC_C_API gicodec_status gicodec_player_read(const gicodec_player* player, uint32_t texture,
                                                 const gicodec_view* view);
/// The same, for the blocks that the frame may have changed.
GICODEC_C_API gicodec_status gicodec_player_read_changed(const gicodec_player* player,
                                                         uint32_t texture,
                                                         const gicodec_view* view);
/// Blocks that the frame may have changed, ascending; all after a seek. Not NULL, also for none.
GICODEC_C_API const uint32_t* gicodec_player_changed(const gicodec_player* player, uint32_t texture,
                                                     size_t* count);

#ifdef __cplusplus
}
#endif

#endif
