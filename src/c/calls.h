// What every call of the C interface does: takes the caller's structs, keeps exceptions inside,
// fills the caller's memory.
#pragma once

#include "base/guard.h"
#include "base/memory.h"
#include "c/host.h"

#include <gicodec/c/base.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec {
class Backend;
}

/// A backend as C sees it.
struct gicodec_backend {
  const gicodec::Backend* backend = nullptr;
};

namespace gicodec::c {

/// No struct is longer; more is a size that was never set.
inline constexpr std::size_t kMaxStruct = 4096;

/// Copies a caller's struct; null gives zeros. invalid_argument for a size that no version had;
/// unsupported_feature if a longer struct says what this library does not know.
template <typename Struct>
[[nodiscard]] Status take(const Struct* given, Struct& out) noexcept {
  out = {};
  if (given == nullptr) return Status::ok;
  const std::size_t size = given->struct_size;
  if (size < sizeof(Struct) || size > kMaxStruct) return Status::invalid_argument;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + sizeof(Struct), bytes + size, [](auto byte) { return byte != 0; })) {
    return Status::unsupported_feature;
  }
  std::memcpy(&out, given, sizeof(Struct));
  return Status::ok;
}

/// Fills a caller's struct, but for its size. invalid_argument as above, and for null.
template <typename Struct>
[[nodiscard]] Status give(const Struct& value, Struct* out) noexcept {
  if (out == nullptr) return Status::invalid_argument;
  const std::uint32_t size = out->struct_size;
  if (size < sizeof(Struct) || size > kMaxStruct) return Status::invalid_argument;
  *out = value;
  out->struct_size = size;
  return Status::ok;
}

/// Copies a caller's array of structs, all of the first one's size.
template <typename Struct, typename Visit>
[[nodiscard]] Status take_each(const Struct* given, std::size_t count, Visit&& visit) {
  const auto* at = reinterpret_cast<const std::byte*>(given);
  for (std::size_t i = 0; i < count; ++i, at += given->struct_size) {
    const auto* const one = reinterpret_cast<const Struct*>(at);
    if (one->struct_size != given->struct_size) return Status::invalid_argument;
    if (const Status status = visit(one); status != Status::ok) return status;
  }
  return Status::ok;
}

/// Stores a caller's number of something in the library's narrower type; `unknown` if it does not
/// fit.
template <typename Number>
[[nodiscard]] Status narrow(std::uint32_t given, Number& out, Status unknown) noexcept {
  out = static_cast<Number>(given);
  return out == given ? Status::ok : unknown;
}

/// Sets an option unless 0, which is its default, is given.
template <typename Field, typename Value>
void set(Field& field, Value value) noexcept {
  if (value != 0) field = value;
}

[[nodiscard]] constexpr gicodec_status number(Status status) noexcept {
  return static_cast<gicodec_status>(status);
}

/// What a caller's function returned; io_failed for a number that is no error of this library's.
[[nodiscard]] Status status_of_caller(gicodec_status status) noexcept;

/// Runs `body`, which returns a Status, and keeps exceptions inside.
template <typename Body>
[[nodiscard]] gicodec_status call(Body&& body) noexcept {
  return number(guarded(std::forward<Body>(body)));
}

/// A handle that works with memory and threads of its host.
struct Handle {
  Host host;
  std::atomic<bool> cancelled{false};
};

/// The same for a call of a handle; invalid_argument if that is null.
template <typename Any, typename Body>
[[nodiscard]] gicodec_status call(Any* handle, Body&& body) noexcept {
  if (handle == nullptr) return GICODEC_INVALID_ARGUMENT;
  const MemoryScope scope(handle->host.memory());
  return call(std::forward<Body>(body));
}

/// Takes the caller's options, and stores a new handle of their host once fill(handle, options) is
/// ok.
template <typename Options, typename Any, typename Fill>
[[nodiscard]] gicodec_status create(const Options* options, Any** out, Fill&& fill) noexcept {
  if (out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  return call([&]() -> Status {
    Options given;
    Status status = take(options, given);
    if (status != Status::ok) return status;
    auto handle = std::make_unique<Any>();
    status = handle->host.set(given.host);
    if (status != Status::ok) return status;
    const MemoryScope scope(handle->host.memory());
    status = fill(*handle, given);
    if (status == Status::ok) *out = handle.release();
    handle.reset();  // within the scope
    return status;
  });
}

/// Moves a result to where it is kept; its status.
template <typename T>
[[nodiscard]] Status keep(Result<T> made, std::optional<T>& kept) {
  if (!made) return made.status();
  kept.emplace(*std::move(made));
  return Status::ok;
}
template <typename T>
[[nodiscard]] Status keep(Result<T> made, T& kept) {
  if (!made) return made.status();
  kept = *std::move(made);
  return Status::ok;
}

template <typename Any>
void destroy(Any* handle) noexcept {
  if (handle == nullptr) return;
  const MemoryScope scope(handle->host.memory());
  delete handle;
}

/// A caller's array. Null is empty, whatever the count.
template <typename T>
[[nodiscard]] std::span<const T> list(const T* items, std::size_t count) noexcept {
  return items == nullptr ? std::span<const T>() : std::span<const T>(items, count);
}
[[nodiscard]] inline std::span<const std::byte> bytes(const void* memory,
                                                      std::size_t size) noexcept {
  return list(static_cast<const std::byte*>(memory), size);
}
[[nodiscard]] inline std::string_view text(const char* given,
                                           std::string_view usual = {}) noexcept {
  return given == nullptr ? usual : std::string_view(given);
}
/// True if an array has entries but no memory.
template <typename T>
[[nodiscard]] bool is_missing(const T* items, std::size_t count) noexcept {
  return items == nullptr && count != 0;
}

/// Copies to the caller's memory and stores the size. buffer_too_small.
[[nodiscard]] inline Status copy_out(std::span<const std::byte> from, void* out,
                                     std::size_t capacity, std::size_t* size) noexcept {
  if (size == nullptr || is_missing(out, capacity)) return Status::invalid_argument;
  *size = from.size();
  if (from.size() > capacity) return Status::buffer_too_small;
  if (!from.empty()) std::memcpy(out, from.data(), from.size());
  return Status::ok;
}
/// The same with a zero behind it.
[[nodiscard]] inline Status copy_text(std::string_view from, char* out, std::size_t capacity,
                                      std::size_t* size) noexcept {
  if (size == nullptr || is_missing(out, capacity)) return Status::invalid_argument;
  *size = from.size() + 1;
  if (*size > capacity) return Status::buffer_too_small;
  std::memcpy(out, from.data(), from.size());
  out[from.size()] = 0;
  return Status::ok;
}

/// A span as the interface returns it.
template <typename T>
[[nodiscard]] const T* point(std::span<const T> items, std::size_t* count) noexcept {
  if (count != nullptr) *count = items.size();
  return items.data();
}
/// A list of blocks, which is never null: null would mean all blocks to the calls that take one.
[[nodiscard]] inline const std::uint32_t* point_to_blocks(std::span<const std::uint32_t> blocks,
                                                          std::size_t* count) noexcept {
  static constexpr std::uint32_t kNone = 0;
  const std::uint32_t* const first = point(blocks, count);
  return first == nullptr ? &kNone : first;
}
[[nodiscard]] inline const std::uint8_t* point(std::span<const std::byte> memory,
                                               std::size_t* size) noexcept {
  if (size != nullptr) *size = memory.size();
  return reinterpret_cast<const std::uint8_t*>(memory.data());
}

/// Views, limits and backends as the C++ interface takes them.
[[nodiscard]] Status take_view(const gicodec_view* given, TextureView& out) noexcept;
[[nodiscard]] Status take_view(const gicodec_const_view* given, ConstTextureView& out) noexcept;
[[nodiscard]] Status take_limits(const gicodec_limits* given, DecodeLimits& out) noexcept;
[[nodiscard]] Status take_backends(const gicodec_backend* const* given, std::size_t count,
                                   std::vector<const Backend*>& out);

}  // namespace gicodec::c
