// The name of a track as C sees it.
#pragma once

#include "c/calls.h"

#include <gicodec/c/tracks.h>
#include <gicodec/delivery.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace gicodec::c {

/// The texts of the last name that was asked for.
struct TrackTexts {
  std::string volume, texture;
};

/// nullopt for numbers that no stream has.
[[nodiscard]] inline std::optional<StreamId> stream_of(const gicodec_track& track) noexcept {
  if (track.volume > UINT16_MAX || track.texture > UINT8_MAX) return std::nullopt;
  return StreamId{static_cast<std::uint16_t>(track.volume),
                  static_cast<std::uint8_t>(track.texture), track.region};
}
[[nodiscard]] constexpr gicodec_track track_of(StreamId stream) noexcept {
  return {stream.volume, stream.texture, stream.region};
}

/// Stores the name of a track of `from`, a publisher or a receiver.
template <typename From>
[[nodiscard]] Status give_name(const From& from, const gicodec_track* track, TrackTexts& texts,
                               gicodec_track_name* out) {
  if (track == nullptr) return Status::invalid_argument;
  const auto stream = stream_of(*track);
  const auto name = stream ? from.name(*stream) : std::nullopt;
  if (!name) return Status::unknown_region;
  TrackTexts copies{std::string(name->volume), std::string(name->texture)};
  const gicodec_track_name given{0,
                                 copies.volume.c_str(),
                                 copies.texture.c_str(),
                                 {name->place.x, name->place.y, name->place.z}};
  const Status status = give(given, out);
  if (status != Status::ok) return status;
  texts = std::move(copies);
  out->volume = texts.volume.c_str();
  out->texture = texts.texture.c_str();
  return Status::ok;
}

}  // namespace gicodec::c
