#include "c/calls.h"

#include <gicodec/version.h>

namespace gicodec::c {

Status status_of_caller(gicodec_status status) noexcept {
  const bool known = status > GICODEC_END && status < UINT16_MAX &&
                     to_string(static_cast<Status>(status)) != to_string(Status(UINT16_MAX));
  if (status == GICODEC_OK) return Status::ok;
  return known ? static_cast<Status>(status) : Status::io_failed;
}

Status take_view(const gicodec_view* given, TextureView& out) noexcept {
  if (given == nullptr) return Status::invalid_argument;
  gicodec_view view;
  if (const Status status = take(given, view); status != Status::ok) return status;
  if (is_missing(view.bytes, view.size)) return Status::invalid_argument;
  out = {std::span(static_cast<std::byte*>(view.bytes), view.size), view.row_pitch,
         view.slice_pitch, view.block_pitch};
  return Status::ok;
}

Status take_view(const gicodec_const_view* given, ConstTextureView& out) noexcept {
  if (given == nullptr) return Status::invalid_argument;
  gicodec_const_view view;
  if (const Status status = take(given, view); status != Status::ok) return status;
  if (is_missing(view.bytes, view.size)) return Status::invalid_argument;
  out = {bytes(view.bytes, view.size), view.row_pitch, view.slice_pitch, view.block_pitch};
  return Status::ok;
}

Status take_limits(const gicodec_limits* given, DecodeLimits& out) noexcept {
  gicodec_limits limits;
  if (const Status status = take(given, limits); status != Status::ok) return status;
  const auto set = [](auto& limit, auto value) {
    if (value != 0) limit = value;
  };
  out = {};
  set(out.max_textures, limits.max_textures);
  set(out.max_texture_bytes, limits.max_texture_bytes);
  set(out.max_packet_bytes, limits.max_packet_bytes);
  set(out.max_total_bytes, limits.max_total_bytes);
  set(out.max_work_bytes, limits.max_work_bytes);
  set(out.max_description_bytes, limits.max_description_bytes);
  set(out.max_metadata_bytes, limits.max_metadata_bytes);
  set(out.max_index_bytes, limits.max_index_bytes);
  return Status::ok;
}

Status take_backends(const gicodec_backend* const* given, std::size_t count,
                     std::vector<const Backend*>& out) {
  if (is_missing(given, count)) return Status::invalid_argument;
  out.clear();
  for (const gicodec_backend* const backend : list(given, count)) {
    if (backend == nullptr || backend->backend == nullptr) return Status::invalid_argument;
    out.push_back(backend->backend);
  }
  return Status::ok;
}

}  // namespace gicodec::c

using namespace gicodec;

extern "C" {

const char* gicodec_status_text(gicodec_status status) {
  const bool fits = status >= 0 && status <= UINT16_MAX;
  return to_string(fits ? static_cast<Status>(status) : Status(UINT16_MAX)).data();
}

uint32_t gicodec_version(void) { return kVersionMajor << 16 | kVersionMinor << 8 | kVersionPatch; }
const char* gicodec_version_text(void) { return kVersionString.data(); }

}  // extern "C"
