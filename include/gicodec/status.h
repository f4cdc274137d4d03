// Errors as values: a status code in stable numeric families and a value-or-status.
#pragma once

#include <gicodec/api.h>

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace GICODEC_API gicodec {

/// Outcome of every fallible call. The numbers are stable across versions; the hundreds digit
/// tells whose matter it is.
enum class [[nodiscard]] Status : std::uint16_t{
    ok = 0,
    end = 1,  ///< nothing is left to read; the one outcome besides ok that is no error

    // 1xx: what the caller passed in.
    invalid_argument = 100,     ///< a value outside its documented range
    invalid_description = 101,  ///< a TextureDesc, VolumeDesc or ContainerDescription that is none
    view_too_small = 102,       ///< a texture view that does not cover what is described
    block_out_of_range = 103,   ///< a block index beyond the last
    block_repeated = 104,       ///< the same block index twice in one list
    /// No valid record or known format, or one that the backend cannot code (raw, lz4 and zstd code
    /// every one).
    unsupported_format = 105,
    unknown_backend = 106,      ///< no backend of that name was given or built in
    buffer_too_small = 107,     ///< the caller's output buffer cannot hold the result
    unsupported_backend = 108,  ///< this backend cannot do what was asked for
    /// Blocks, neighbours or presence that the backend cannot code (raw, lz4 and zstd code all).
    unsupported_shape = 109,
    unknown_kind = 110,        ///< no kind of that number or name was given or built in
    unknown_volume = 111,      ///< no volume of that number
    unknown_texture = 112,     ///< the volume has no texture of that number or name
    unknown_group = 113,       ///< the volume has no group of that number
    unknown_connection = 114,  ///< no connection of that number, or one without a session
    mask_mismatch = 115,       ///< a mask that is not as long as its group has blocks
    invalid_geometry = 116,    ///< a VolumeGeometry that is out of range or not that of its volume
    invalid_name = 117,        ///< a name that is too long, no UTF-8, or given twice
    invalid_time = 118,        ///< a time that is not finite
    invalid_bound = 119,       ///< a threshold or error bound out of range, or both together
    invalid_interval = 120,    ///< an interval of 0, or others where textures travel together
    presence_missing = 121,    ///< presence was published, and not what it is the presence of
    presence_invalid = 122,  ///< presence that counts more records than there are, or too many bits
    unknown_region = 123,    ///< the texture has no region of that number
    unknown_frame = 124,     ///< the container has no frame of that number, or cannot seek
    wrong_frame = 125,       ///< a frame before the last one, or a second packet of a part of it
    /// A preset, level, chunk, number of threads or instruction set that is not taken.
    invalid_settings = 126,
    out_of_order = 127,  ///< a call that had to come earlier, or has to come later

    // 2xx: resources.
    out_of_memory = 200,   ///< an allocation failed
    limit_exceeded = 201,  ///< more than DecodeLimits, a backend or the format allows
    cancelled = 202,       ///< the caller asked for the end of the call

    // 3xx: bytes from outside that break the format.
    truncated = 300,            ///< the input ends before its structure does
    corrupt = 301,              ///< a field is out of range or two fields contradict each other
    checksum_mismatch = 302,    ///< the bytes are not those that were written
    not_gicodec = 303,          ///< the first bytes are not those of this format
    unsupported_version = 304,  ///< a format version this library does not read
    unsupported_feature = 305,  ///< a reserved bit or value, or an entry that is not known

    // 4xx: bytes that are sound but do not fit this session.
    description_mismatch = 400,  ///< the packet was made for another texture description
    reference_missing = 401,     ///< the packet builds on an update this session does not hold
    backend_missing = 402,       ///< the packet's backend is neither built in nor given

    // 5xx: backends and the world outside.
    backend_failed = 500,       ///< an encoder or decoder failed or broke its promises
    backend_unavailable = 501,  ///< the codec is not present on this machine
    io_failed = 502,            ///< a Source or Sink reported an error
};

/// One short English sentence without a full stop; static storage.
[[nodiscard]] std::string_view to_string(Status status) noexcept;

/// A value, or the status that says why there is none. Never holds Status::ok without a value.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
  /// Precondition: status is not Status::ok (it would be turned into invalid_argument).
  Result(Status status)  // NOLINT(google-explicit-constructor)
      : status_(status == Status::ok ? Status::invalid_argument : status) {}

  [[nodiscard]] bool ok() const noexcept { return value_.has_value(); }
  explicit operator bool() const noexcept { return ok(); }
  Status status() const noexcept { return status_; }

  /// Precondition of all accessors below: ok().
  T& operator*() & noexcept { return *value_; }
  const T& operator*() const& noexcept { return *value_; }
  T&& operator*() && noexcept { return std::move(*value_); }
  [[nodiscard]] T value_or(T other) && noexcept {
    return ok() ? std::move(*value_) : std::move(other);
  }
  T* operator->() noexcept { return &*value_; }
  const T* operator->() const noexcept { return &*value_; }

 private:
  std::optional<T> value_;
  Status status_ = Status::ok;
};

}  // namespace gicodec
