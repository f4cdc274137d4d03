// Descriptions of textures and volumes: what fixes the meaning of their bytes.
#ifndef GICODEC_C_DESCRIPTION_H
#define GICODEC_C_DESCRIPTION_H

#include <gicodec/c/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How the blocks of a texture relate in space.
enum {
  GICODEC_SPACE_GRID = 0,  ///< places with neighbours
  GICODEC_SPACE_POOL = 1,  ///< numbered slots without neighbours
};

/// How a texture says which records of a block exist.
enum {
  GICODEC_PRESENCE_ALL = 0,
  GICODEC_PRESENCE_COUNT = 1,  ///< a u16 per block: that many from the first on
  GICODEC_PRESENCE_MASK = 2,   ///< 1 bit per record, lowest first
  GICODEC_PRESENCE_BRICK = 3,  ///< a brick's place, then a mask of its voxels
};

/// What a codec assumes of a texture's blocks.
enum {
  GICODEC_MODEL_NONE = 0,
  GICODEC_MODEL_STACKED = 1,     ///< a block resembles its neighbours, record by record (probes)
  GICODEC_MODEL_CONTINUOUS = 2,  ///< a record resembles its neighbours, also across blocks (tiles)
  GICODEC_MODEL_UNORDERED = 3,   ///< the order of a block's records means nothing
  GICODEC_MODEL_OCTREE = 4,      ///< bricks of voxels that refine coarser ones
  GICODEC_MODEL_HEMISPHERES = 5  ///< light at a vertex from six hemispheres
};

/// Where the tile of block (x, y, z) lies: column, row, slice.
enum {
  GICODEC_TILING_ATLAS_XY_Z = 0,   ///< column x + nx·y, row z
  GICODEC_TILING_ATLAS_XZ_Y = 1,   ///< column x + nx·z, row y
  GICODEC_TILING_ATLAS_X_YZ = 2,   ///< column x, row y + ny·z
  GICODEC_TILING_SLICES_XZ_Y = 3,  ///< column x, row z, slice y
  GICODEC_TILING_SLICES_XY_Z = 4,  ///< column x, row y, slice z: 2D maps, 3D textures
  GICODEC_TILING_BLOCKS = 5,       ///< an array of blocks, each with its own rows and slices
  GICODEC_TILING_ATLAS_YZ_X = 6,   ///< column y + ny·z, row x
  GICODEC_TILING_SLICES_YX_Z = 7,  ///< column y, row x, slice z
};

/// How the bits of a component are read.
enum {
  GICODEC_COMPONENT_UNORM = 0,
  GICODEC_COMPONENT_SNORM = 1,
  GICODEC_COMPONENT_UINT = 2,
  GICODEC_COMPONENT_UFLOAT = 3,
  GICODEC_COMPONENT_SFLOAT = 4,
  GICODEC_COMPONENT_EXPONENT = 5,  ///< shared by the record's mantissas
  GICODEC_COMPONENT_OPAQUE = 6,
};

/// A component of a record; always of this size.
typedef struct gicodec_component {
  char name[8];     ///< A-Z, a-z, 0-9 and _, then zeros
  uint16_t offset;  ///< its lowest bit in the little-endian record
  uint8_t bits;     ///< 1..32, within one aligned 32-bit word
  uint8_t type;     ///< GICODEC_COMPONENT_…
} gicodec_component;

enum { GICODEC_MAX_COMPONENTS = 16 };

/// A texture of blocks. Fill it by one of the functions below, or field by field.
typedef struct gicodec_texture_desc {
  uint32_t struct_size;
  uint32_t format;           ///< VkFormat's number; 0: `components` describe the record
  uint32_t grid[3];          ///< blocks along x, y, z; pools: slots, 1, 1
  uint32_t block[3];         ///< records of a block, without guard band
  uint32_t guard_band;       ///< records around each block that follow from the others, 0 or 1
  uint32_t space;            ///< GICODEC_SPACE_…
  uint32_t presence;         ///< GICODEC_PRESENCE_…
  uint32_t model;            ///< GICODEC_MODEL_…
  uint32_t records[3];       ///< of the texture, if its last blocks are not full; else zeros
  uint32_t tiling;           ///< GICODEC_TILING_…; packets do not depend on it and what follows
  uint32_t pad_before;       ///< untouched records before each block, 0..8
  uint32_t pad_after;        ///< and behind it
  uint32_t slots[3];         ///< pools: slots along each axis in memory; zeros: one row
  uint32_t record_bytes;     ///< 1..64; with a format, the format's or 0
  uint32_t component_count;  ///< 1..16; with a format, the format's or 0
  gicodec_component components[GICODEC_MAX_COMPONENTS];
} gicodec_texture_desc;

/// These fill in `out` also with GICODEC_INVALID_DESCRIPTION and GICODEC_UNSUPPORTED_FORMAT, so
/// that gicodec_texture_desc_problem() can say why.
///
/// A DDGI volume's colour: nx × ny × nz probes of 8 × 8 texels with a guard band, an atlas.
GICODEC_C_API gicodec_status gicodec_ddgi_irradiance(uint32_t nx, uint32_t ny, uint32_t nz,
                                                     uint32_t format, gicodec_texture_desc* out);
/// A DDGI volume's visibility: probes of 16 × 16 texels with a guard band, an atlas.
GICODEC_C_API gicodec_status gicodec_ddgi_visibility(uint32_t nx, uint32_t ny, uint32_t nz,
                                                     uint32_t format, gicodec_texture_desc* out);
/// A 2D map, array or 3D texture of width × height × depth records, cut into blocks of at most
/// block_x × block_y × block_z; an array has blocks of depth 1.
GICODEC_C_API gicodec_status gicodec_map_texture(uint32_t width, uint32_t height, uint32_t depth,
                                                 uint32_t block_x, uint32_t block_y,
                                                 uint32_t block_z, uint32_t format,
                                                 gicodec_texture_desc* out);

/// VkFormat's number by its name, with or without VK_FORMAT_; 0 if unknown.
GICODEC_C_API uint32_t gicodec_format_from_name(const char* name);
/// The name without VK_FORMAT_, NULL if unknown. Static storage.
GICODEC_C_API const char* gicodec_format_name(uint32_t format);
/// The known formats, ascending: their number, and the one at a place, 0 beyond the last.
GICODEC_C_API uint32_t gicodec_format_count(void);
GICODEC_C_API uint32_t gicodec_format_at(uint32_t place);

/// Sizes that follow from a description. Memory sizes are of tightly packed views.
typedef struct gicodec_texture_info {
  uint32_t struct_size;
  uint32_t blocks;
  uint64_t texture_bytes;  ///< guard bands and padding included
  uint64_t width, height,
      slices;               ///< in records; GICODEC_TILING_BLOCKS: of one block, slices of all
  uint32_t block_bytes;     ///< of a block's records, without guard band
  uint32_t presence_bytes;  ///< of presence per block
} gicodec_texture_info;

/// GICODEC_UNSUPPORTED_FORMAT, GICODEC_INVALID_DESCRIPTION.
GICODEC_C_API gicodec_status gicodec_texture_desc_check(const gicodec_texture_desc* desc);
/// Why not, a field first: "guard_band: it is 0 or 1". NULL where the check is ok. Static storage.
GICODEC_C_API const char* gicodec_texture_desc_problem(const gicodec_texture_desc* desc);
GICODEC_C_API gicodec_status gicodec_texture_desc_info(const gicodec_texture_desc* desc,
                                                       gicodec_texture_info* out);
/// Fills in record_bytes and the components that follow from a format.
GICODEC_C_API gicodec_status gicodec_texture_desc_complete(gicodec_texture_desc* desc);
/// Where a block's first record lies in memory: column, row, slice, in records, and with
/// GICODEC_TILING_BLOCKS the block. GICODEC_BLOCK_OUT_OF_RANGE.
GICODEC_C_API gicodec_status gicodec_texture_desc_origin(const gicodec_texture_desc* desc,
                                                         uint32_t block, uint64_t out[4]);

/// The texture groups of a volume. Texture numbers count through the groups in order.
typedef struct gicodec_volume_desc gicodec_volume_desc;

enum { GICODEC_NO_GROUP = 255 };  ///< the group of a texture that does not exist

/// An empty volume of a kind: 1 probes, 2 irradiance vectors, 3 textures, 4 irradiance maps,
/// 5 photons, 6 AO points, 7 voxels (gicodec_kind_name()). Describe probes and textures by hand:
/// probes are one group, whose textures have the same grid, square blocks of depth 1, and
/// GICODEC_MODEL_STACKED, as gicodec_ddgi_irradiance() makes them; textures are groups of any that
/// have no presence. The others have functions of their own below, or are layouts.
GICODEC_C_API gicodec_status gicodec_volume_desc_create(uint32_t kind, gicodec_volume_desc** out);
/// Adds a texture group. `bundled`: not 0 if a block is sent in all its textures or none.
GICODEC_C_API gicodec_status gicodec_volume_desc_add_group(gicodec_volume_desc* volume,
                                                           uint32_t bundled);
/// Adds a texture to the last group; without one, to a new group that is not bundled. Whether it
/// suits the volume says gicodec_volume_desc_check(). GICODEC_INVALID_NAME,
/// GICODEC_UNSUPPORTED_FORMAT.
GICODEC_C_API gicodec_status gicodec_volume_desc_add_texture(gicodec_volume_desc* volume,
                                                             const char* name,
                                                             const gicodec_texture_desc* desc);
/// The volume of an engine's layout, e.g. "rtxgi", "unity-apv", "three". GICODEC_INVALID_NAME for
/// an unknown layout, GICODEC_INVALID_DESCRIPTION for numbers that do not make a volume.
GICODEC_C_API gicodec_status gicodec_volume_desc_from_layout(const char* layout, uint32_t x,
                                                             uint32_t y, uint32_t z,
                                                             gicodec_volume_desc** out);
/// Volumes of kinds whose textures depend on one another, as the header of each kind has them.
GICODEC_C_API gicodec_status gicodec_photon_volume(uint32_t batches, uint32_t capacity,
                                                   uint32_t form, gicodec_volume_desc** out);
GICODEC_C_API gicodec_status gicodec_voxel_volume(uint32_t bricks, uint32_t side, uint32_t form,
                                                  gicodec_volume_desc** out);
GICODEC_C_API gicodec_status gicodec_ao_point_volume(uint32_t cells, uint32_t buckets,
                                                     uint32_t instances, gicodec_volume_desc** out);
GICODEC_C_API gicodec_status gicodec_irradiance_vector_volume(uint32_t nx, uint32_t ny, uint32_t nz,
                                                              uint32_t floats,
                                                              gicodec_volume_desc** out);
/// The layouts: their number, the name of one, a line about it. NULL beyond the last.
GICODEC_C_API uint32_t gicodec_layout_count(void);
GICODEC_C_API const char* gicodec_layout_name(uint32_t layout);
GICODEC_C_API const char* gicodec_layout_summary(uint32_t layout);
/// Reads and writes what a kind says of a volume, layouts aside (FORMAT.md, "Kinds"). Safe on
/// hostile bytes. GICODEC_UNKNOWN_KIND, GICODEC_CORRUPT.
GICODEC_C_API gicodec_status gicodec_volume_desc_read(uint32_t kind, const void* bytes, size_t size,
                                                      gicodec_volume_desc** out);
GICODEC_C_API gicodec_status gicodec_volume_desc_write(const gicodec_volume_desc* volume, void* out,
                                                       size_t capacity, size_t* size);
GICODEC_C_API gicodec_status gicodec_volume_desc_copy(const gicodec_volume_desc* volume,
                                                      gicodec_volume_desc** out);
GICODEC_C_API void gicodec_volume_desc_destroy(gicodec_volume_desc* volume);

/// GICODEC_OK if encoders and decoders take the volume.
GICODEC_C_API gicodec_status gicodec_volume_desc_check(const gicodec_volume_desc* volume);
/// Why not, as gicodec_texture_desc_problem().
GICODEC_C_API const char* gicodec_volume_desc_problem(const gicodec_volume_desc* volume);
GICODEC_C_API uint32_t gicodec_volume_desc_kind(const gicodec_volume_desc* volume);
GICODEC_C_API const char* gicodec_kind_name(uint32_t kind);  ///< NULL if unknown
GICODEC_C_API uint32_t gicodec_volume_desc_groups(const gicodec_volume_desc* volume);
GICODEC_C_API uint32_t gicodec_volume_desc_textures(const gicodec_volume_desc* volume);
/// The group of a texture; GICODEC_NO_GROUP for an unknown texture.
GICODEC_C_API uint32_t gicodec_volume_desc_group_of(const gicodec_volume_desc* volume,
                                                    uint32_t texture);
/// NULL for an unknown texture.
GICODEC_C_API const char* gicodec_volume_desc_texture_name(const gicodec_volume_desc* volume,
                                                           uint32_t texture);
/// GICODEC_UNKNOWN_TEXTURE.
GICODEC_C_API gicodec_status gicodec_volume_desc_texture(const gicodec_volume_desc* volume,
                                                         uint32_t texture,
                                                         gicodec_texture_desc* out);
/// The whole description as JSON, a zero behind it that `size` counts.
GICODEC_C_API gicodec_status gicodec_volume_desc_json(const gicodec_volume_desc* volume, char* out,
                                                      size_t capacity, size_t* size);

#ifdef __cplusplus
}
#endif

#endif
