// The C interface (C99): what all its headers share. One header per purpose is in this folder;
// <gicodec/c/gicodec.h> includes them all. The same rules hold for every call:
//
// - A call that can fail returns a gicodec_status. A failed call changes nothing, unless its
//   comment says otherwise. Nothing is thrown or printed.
// - Handles are opaque. One thread at a time uses a handle; different handles are independent.
//   Destroying NULL does nothing. NULL in place of another handle or of an output is
//   GICODEC_INVALID_ARGUMENT.
// - A struct begins with struct_size: set it to sizeof the struct, and all else that you do not
//   need to 0, which means the default. A library that is newer than its caller takes the shorter
//   struct; one that is older refuses what it does not know by GICODEC_UNSUPPORTED_FEATURE, unless
//   it is 0. A library fills in as much of a struct as struct_size says.
// - Text is UTF-8 and ends with a zero. Pointers that a call returns point into its handle, and are
//   valid until the next call that is not const, unless its comment says otherwise.
// - A call that fills memory of the caller's takes its capacity and stores the size that is needed,
//   also with GICODEC_BUFFER_TOO_SMALL. NULL with capacity 0 asks for the size.
#ifndef GICODEC_C_BASE_H
#define GICODEC_C_BASE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(GICODEC_SHARED)
#ifdef GICODEC_BUILDING
#define GICODEC_C_API __declspec(dllexport)
#else
#define GICODEC_C_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define GICODEC_C_API __attribute__((visibility("default")))
#else
#define GICODEC_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// The outcome of a call. Numbers are stable; the hundreds digit groups them by cause.
typedef int32_t gicodec_status;
enum {
  GICODEC_OK = 0,
  GICODEC_END = 1,  ///< nothing is left to read; not an error

  // 1xx: the caller's arguments.
  GICODEC_INVALID_ARGUMENT = 100,
  GICODEC_INVALID_DESCRIPTION = 101,
  GICODEC_VIEW_TOO_SMALL = 102,
  GICODEC_BLOCK_OUT_OF_RANGE = 103,
  GICODEC_BLOCK_REPEATED = 104,
  GICODEC_UNSUPPORTED_FORMAT = 105,
  GICODEC_UNKNOWN_BACKEND = 106,
  GICODEC_BUFFER_TOO_SMALL = 107,
  GICODEC_UNSUPPORTED_BACKEND = 108,
  GICODEC_UNSUPPORTED_SHAPE = 109,
  GICODEC_UNKNOWN_KIND = 110,
  GICODEC_UNKNOWN_VOLUME = 111,
  GICODEC_UNKNOWN_TEXTURE = 112,
  GICODEC_UNKNOWN_GROUP = 113,
  GICODEC_UNKNOWN_CONNECTION = 114,
  GICODEC_MASK_MISMATCH = 115,
  GICODEC_INVALID_GEOMETRY = 116,
  GICODEC_INVALID_NAME = 117,
  GICODEC_INVALID_TIME = 118,
  GICODEC_INVALID_BOUND = 119,
  GICODEC_INVALID_INTERVAL = 120,
  GICODEC_PRESENCE_MISSING = 121,
  GICODEC_PRESENCE_INVALID = 122,
  GICODEC_UNKNOWN_REGION = 123,
  GICODEC_UNKNOWN_FRAME = 124,
  GICODEC_WRONG_FRAME = 125,
  GICODEC_INVALID_SETTINGS = 126,
  GICODEC_OUT_OF_ORDER = 127,

  // 2xx: resources.
  GICODEC_OUT_OF_MEMORY = 200,
  GICODEC_LIMIT_EXCEEDED = 201,
  GICODEC_CANCELLED = 202,

  // 3xx: input that breaks the format.
  GICODEC_TRUNCATED = 300,
  GICODEC_CORRUPT = 301,
  GICODEC_CHECKSUM_MISMATCH = 302,
  GICODEC_NOT_GICODEC = 303,
  GICODEC_UNSUPPORTED_VERSION = 304,
  GICODEC_UNSUPPORTED_FEATURE = 305,

  // 4xx: sound input that does not fit this session.
  GICODEC_DESCRIPTION_MISMATCH = 400,
  GICODEC_REFERENCE_MISSING = 401,
  GICODEC_BACKEND_MISSING = 402,

  // 5xx: backends, sources and sinks.
  GICODEC_BACKEND_FAILED = 500,
  GICODEC_BACKEND_UNAVAILABLE = 501,
  GICODEC_IO_FAILED = 502,
};

/// A short English sentence without a full stop, for any number. Static storage.
GICODEC_C_API const char* gicodec_status_text(gicodec_status status);

/// The library's version: major << 16 | minor << 8 | patch.
GICODEC_C_API uint32_t gicodec_version(void);
/// The same as text, e.g. "0.1.0". Static storage.
GICODEC_C_API const char* gicodec_version_text(void);

/// Memory and threads that the application gives to a handle. Its functions must not throw; several
/// threads may call them at once. The struct is copied; what `memory` and `executor` point to must
/// outlive the handle.
typedef struct gicodec_host {
  uint32_t struct_size;
  /// Threads that a call uses, the caller's among them, 1..256; 0: 1. Results do not depend on it.
  uint32_t threads;
  /// Returns that many bytes, aligned to a power of two, or NULL, upon which the library's call
  /// fails with GICODEC_OUT_OF_MEMORY. For all memory that grows with textures; small objects and
  /// packets come from operator new. NULL: operator new for all.
  void* (*allocate)(void* memory, size_t bytes, size_t alignment);
  /// Frees what allocate() returned for that alignment. NULL just where allocate is.
  void (*release)(void* memory, void* bytes, size_t alignment);
  void* memory;
  /// Calls work(context, i) once for every i below `count`, on any threads, and returns when all
  /// have returned. NULL: the library's own threads.
  void (*run)(void* executor, uint32_t count, void (*work)(void* context, unsigned i),
              void* context);
  void* executor;
  /// Instruction set of the kernels: "scalar", "sse4", "avx2", "avx512", "neon", "simd128"; NULL:
  /// the best of this machine. Results do not depend on it.
  const char* isa;
} gicodec_host;

/// What a decoder may spend on untrusted bytes, in bytes unless said. 0: the default.
typedef struct gicodec_limits {
  uint32_t struct_size;
  uint32_t max_textures;           ///< in one container, 256
  uint64_t max_texture_bytes;      ///< one texture, tightly packed, 1 GiB
  uint64_t max_packet_bytes;       ///< 1 GiB
  uint64_t max_total_bytes;        ///< peak of a decoder, player or client, 4 GiB
  uint64_t max_work_bytes;         ///< of blocks that one packet or message may write, 2 GiB
  uint64_t max_description_bytes;  ///< of a container, 1 MiB
  uint64_t max_metadata_bytes;     ///< of a container beside its description, 64 MiB
  uint64_t max_index_bytes;        ///< of a container, 64 MiB
} gicodec_limits;

/// A texture in the caller's memory. Pitches are in bytes; 0: tightly packed. The library touches
/// only records, never the bytes between a row's end and the next pitch.
typedef struct gicodec_view {
  uint32_t struct_size;
  void* bytes;
  size_t size;         ///< of `bytes`
  size_t row_pitch;    ///< from a row to the next
  size_t slice_pitch;  ///< from a slice to the next
  size_t block_pitch;  ///< GICODEC_TILING_BLOCKS: from a block to the next
} gicodec_view;

/// The same, not to be written.
typedef struct gicodec_const_view {
  uint32_t struct_size;
  const void* bytes;
  size_t size;
  size_t row_pitch, slice_pitch, block_pitch;
} gicodec_const_view;

/// Which blocks an encoder codes.
enum {
  GICODEC_SELECT_CHANGED = 0,  ///< those that differ from what decoders hold
  GICODEC_SELECT_ALL = 1,
  GICODEC_SELECT_LIST = 2,  ///< those of a list, in any order, each at most once
};

/// A backend beside the built-in ones, e.g. that of <gicodec/c/hevc.h>. Several threads may share
/// it. It must outlive what is created with it.
typedef struct gicodec_backend gicodec_backend;

#ifdef __cplusplus
}
#endif

#endif
