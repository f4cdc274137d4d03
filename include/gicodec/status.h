// Errors are values: a Status, or a Result<T> that holds a value or a Status.
#pragma once

#include <gicodec/api.h>

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace GICODEC_API gicodec {

/// Outcome of every call that can fail. Numbers are stable across versions; the hundreds digit
/// groups them by cause.
enum class [[nodiscard]] Status : std::uint16_t{
    ok = 0,
    end = 1,  ///< nothing is left to read; not an error

    // 1xx: the caller's arguments.
    invalid_argument = 100,     ///< a value outside its documented range
    invalid_description = 101,  ///< an invalid TextureDesc, VolumeDesc or ContainerDescription
    view_too_small = 102,       ///< a texture view that does not cover the described texture
    block_out_of_range = 103,   ///< a block index beyond the last block
    block_repeated = 104,       ///< the same block index twice in one list
    /// A record that is not valid, or that the backend cannot code (raw, lz4 and zstd code all).
    unsupported_format = 105,
    unknown_backend = 106,      ///< no backend of that name, built in or given
    buffer_too_small = 107,     ///< the caller's output buffer cannot hold the result
    unsupported_backend = 108,  ///< the backend does not support the call
    /// Block shape, space or presence that the backend cannot code (raw, lz4 and zstd code all).
    unsupported_shape = 109,
    unknown_kind = 110,        ///< no kind of that number or name, built in or given
    unknown_volume = 111,      ///< no volume of that number
    unknown_texture = 112,     ///< the volume has no texture of that number or name
    unknown_group = 113,       ///< the volume has no texture group of that number
    unknown_connection = 114,  ///< no connection of that number, or one without a session
    mask_mismatch = 115,       ///< a mask whose length is not the number of blocks
    invalid_geometry = 116,    ///< a VolumeGeometry out of range, or for another grid
    invalid_name = 117,        ///< a name that is unknown, too long, not UTF-8 or used twice
    invalid_time = 118,        ///< a time that is not finite
    invalid_bound = 119,       ///< a threshold or error bound out of range, or both at once
    invalid_interval = 120,    ///< an interval of 0, or different ones in a bundled group
    presence_missing = 121,    ///< presence was published without the texture it belongs to
    presence_invalid = 122,    ///< presence of more records than a block has
    unknown_region = 123,      ///< the texture has no region of that number
    unknown_frame = 124,       ///< the container has no frame of that number, or cannot seek
    wrong_frame = 125,         ///< a frame before the last one, or a region's second packet in it
    /// A preset, level, chunk, number of threads or instruction set that the backend or the machine
    /// does not support.
    invalid_settings = 126,
    out_of_order = 127,  ///< a call that comes too early or too late

    // 2xx: resources.
    out_of_memory = 200,   ///< an allocation failed
    limit_exceeded = 201,  ///< a limit of the caller, a backend or the format is exceeded
    cancelled = 202,       ///< the caller cancelled the call

    // 3xx: input that breaks the format.
    truncated = 300,            ///< the input ends before its structure does
    corrupt = 301,              ///< a field is out of range or two fields contradict each other
    checksum_mismatch = 302,    ///< the bytes have changed since they were written
    not_gicodec = 303,          ///< the first bytes are not those of this format
    unsupported_version = 304,  ///< a format version that this library does not read
    unsupported_feature = 305,  ///< a reserved bit or value, or an unknown entry

    // 4xx: sound input that does not fit this session.
    description_mismatch = 400,  ///< the packet was made for another texture description
    reference_missing = 401,     ///< the packet builds on an update that this session does not hold
    backend_missing = 402,       ///< the packet's backend is neither built in nor given

    // 5xx: backends, sources and sinks.
    backend_failed = 500,       ///< an encoder or decoder failed or broke its contract
    backend_unavailable = 501,  ///< the codec is not present on this machine
    io_failed = 502,            ///< a Source or Sink reported an error
};

/// A short English sentence without a full stop; static storage, a zero follows the text.
[[nodiscard]] std::string_view to_string(Status status) noexcept;

/// A value, or the status that says why there is none.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
  /// Precondition: status is not Status::ok, which becomes invalid_argument.
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
