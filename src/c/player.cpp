// Plays containers from the caller's source, or from memory.
#include "c/container.h"
#include "c/volume_desc.h"

#include <gicodec/player.h>

#include <optional>
#include <utility>

using namespace gicodec;

namespace gicodec::c {
namespace {

/// The caller's source.
class PlayerSource final : public Source {
 public:
  Status set(const gicodec_source* given) {
    if (given == nullptr) return Status::invalid_argument;
    const Status status = take(given, given_);
    if (status != Status::ok) return status;
    const bool whole =
        given_.read != nullptr && (given_.seek == nullptr) == (given_.size == nullptr);
    return whole ? Status::ok : Status::invalid_argument;
  }
  Result<std::size_t> read(std::span<std::byte> into) override {
    std::size_t got = 0;
    const gicodec_status status = given_.read(given_.self, into.data(), into.size(), &got);
    if (status != GICODEC_OK && status != GICODEC_END) return status_of_caller(status);
    if (got > into.size()) return Status::io_failed;
    return got;
  }
  std::optional<std::uint64_t> size() const override {
    if (given_.size == nullptr) return std::nullopt;
    return given_.size(given_.self);
  }
  Status seek(std::uint64_t offset) override {
    return given_.seek == nullptr ? Status::io_failed
                                  : status_of_caller(given_.seek(given_.self, offset));
  }
  bool prefetch(std::span<const ByteRange> ranges) override {
    if (given_.prefetch == nullptr) return false;
    static_assert(sizeof(ByteRange) == sizeof(gicodec_range));
    const auto* const given = reinterpret_cast<const gicodec_range*>(ranges.data());
    return given_.prefetch(given_.self, given, ranges.size()) != 0;
  }

 private:
  gicodec_source given_{};
};

}  // namespace
}  // namespace gicodec::c

struct gicodec_player : c::Handle {
  c::PlayerSource caller;
  std::optional<MemorySource> memory;
  std::optional<ContainerPlayer> player;
  gicodec_container container;
  std::vector<uint64_t> frames;
};

namespace gicodec::c {
namespace {

/// Opens a player on the source that choose() gives.
template <typename Choose>
[[nodiscard]] gicodec_status open(const gicodec_player_options* options, gicodec_player** out,
                                  Choose&& choose) {
  return create(options, out,
                [&](gicodec_player& handle, const gicodec_player_options& given) -> Status {
                  PlayerOptions settings;
                  settings.threads = handle.host.threads();
                  settings.isa = handle.host.isa();
                  Status status = take_limits(given.limits, settings.limits);
                  if (status == Status::ok) {
                    status = take_backends(given.backends, given.backend_count, settings.backends);
                  }
                  Source* source = nullptr;
                  if (status == Status::ok) status = choose(handle, source);
                  if (status != Status::ok) return status;
                  auto player = ContainerPlayer::open(*source, settings);
                  if (!player) return player.status();
                  handle.container.description = player->description();
                  handle.player.emplace(*std::move(player));
                  return Status::ok;
                });
}

/// Writes a texture by one of the player's calls.
[[nodiscard]] gicodec_status read(const gicodec_player* player, std::uint32_t texture,
                                  const gicodec_view* view,
                                  Status (ContainerPlayer::*by)(std::uint8_t, TextureView) const) {
  return call(player, [&] {
    TextureView texels;
    std::uint8_t id = 0;
    Status status = take_view(view, texels);
    if (status == Status::ok) status = narrow(texture, id, Status::unknown_texture);
    return status == Status::ok ? (*player->player.*by)(id, texels) : status;
  });
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_player_open(const gicodec_source* source,
                                   const gicodec_player_options* options, gicodec_player** out) {
  return c::open(options, out, [&](gicodec_player& handle, Source*& chosen) {
    chosen = &handle.caller;
    return handle.caller.set(source);
  });
}

gicodec_status gicodec_player_open_memory(const void* bytes, size_t size,
                                          const gicodec_player_options* options,
                                          gicodec_player** out) {
  return c::open(options, out, [&](gicodec_player& handle, Source*& chosen) {
    if (c::is_missing(bytes, size)) return Status::invalid_argument;
    chosen = &handle.memory.emplace(c::bytes(bytes, size));
    return Status::ok;
  });
}

void gicodec_player_destroy(gicodec_player* player) { c::destroy(player); }

const gicodec_container* gicodec_player_container(const gicodec_player* player) {
  return player == nullptr ? nullptr : &player->container;
}

gicodec_status gicodec_player_select(gicodec_player* player, const uint32_t* textures,
                                     size_t count) {
  return c::call(player, [&]() -> Status {
    if (c::is_missing(textures, count)) return Status::invalid_argument;
    std::vector<uint8_t> ids;
    for (const uint32_t texture : c::list(textures, count)) {
      if (texture > UINT8_MAX) return Status::unknown_texture;
      ids.push_back(static_cast<uint8_t>(texture));
    }
    return player->player->select(ids);
  });
}

gicodec_status gicodec_player_select_box(gicodec_player* player, uint32_t volume,
                                         const uint32_t first[3], const uint32_t last[3]) {
  return c::call(player, [&]() -> Status {
    if (first == nullptr || last == nullptr) return Status::invalid_argument;
    const ContainerDescription& description = player->player->description();
    const auto volumes = static_cast<uint32_t>(description.volumes.size());
    if (volume >= volumes) return Status::unknown_volume;
    std::vector<TextureRegion> all;
    for (uint32_t i = 0; i < volumes; ++i) {
      constexpr Grid kEnd{UINT32_MAX, UINT32_MAX, UINT32_MAX};
      const bool boxed = i == volume;
      const auto parts =
          parts_in_box(description, i, boxed ? Grid{first[0], first[1], first[2]} : Grid{},
                       boxed ? Grid{last[0], last[1], last[2]} : kEnd);
      all.insert(all.end(), parts.begin(), parts.end());
    }
    return player->player->select(all);
  });
}

gicodec_status gicodec_player_set_layout(gicodec_player* player, uint32_t texture,
                                         const gicodec_texture_desc* desc) {
  return c::call(player, [&]() -> Status {
    if (texture > UINT8_MAX) return Status::unknown_texture;
    TextureDesc taken;
    Status status = c::take_desc(desc, taken);
    if (status == Status::ok) {
      status = player->player->set_layout(static_cast<uint8_t>(texture), taken.layout);
    }
    if (status == Status::ok) player->container.description = player->player->description();
    return status;
  });
}

gicodec_status gicodec_player_next(gicodec_player* player) {
  return c::call(player, [&] { return player->player->next(); });
}

gicodec_status gicodec_player_set_growing(gicodec_player* player, uint32_t growing) {
  return c::call(player, [&] {
    player->player->set_growing(growing != 0);
    return Status::ok;
  });
}

uint32_t gicodec_player_finished(const gicodec_player* player) {
  return player != nullptr && player->player->finished() ? 1 : 0;
}

uint32_t gicodec_player_seekable(const gicodec_player* player) {
  return player != nullptr && player->player->seekable() ? 1 : 0;
}

uint64_t gicodec_player_memory(const gicodec_player* player) {
  return player == nullptr ? 0 : player->player->memory();
}

gicodec_status gicodec_player_seek(gicodec_player* player, uint64_t frame) {
  return c::call(player, [&] { return player->player->seek(frame); });
}

uint64_t gicodec_player_frame(const gicodec_player* player) {
  return player == nullptr ? 0 : player->player->frame();
}

gicodec_status gicodec_player_frames(gicodec_player* player, const uint64_t** frames,
                                     size_t* count) {
  return c::call(player, [&]() -> Status {
    if (frames == nullptr || count == nullptr) return Status::invalid_argument;
    auto found = player->player->frames();
    if (!found) return found.status();
    player->frames = *std::move(found);
    *frames = c::point(std::span<const uint64_t>(player->frames), count);
    return Status::ok;
  });
}

gicodec_status gicodec_player_read(const gicodec_player* player, uint32_t texture,
                                   const gicodec_view* view) {
  return c::read(player, texture, view, &ContainerPlayer::read);
}

gicodec_status gicodec_player_read_changed(const gicodec_player* player, uint32_t texture,
                                           const gicodec_view* view) {
  return c::read(player, texture, view, &ContainerPlayer::read_changed);
}

const uint32_t* gicodec_player_changed(const gicodec_player* player, uint32_t texture,
                                       size_t* count) {
  const bool there = player != nullptr && texture <= UINT8_MAX;
  if (!there) return c::point(std::span<const uint32_t>(), count);
  return c::point_to_blocks(player->player->changed(static_cast<uint8_t>(texture)), count);
}

}  // extern "C"
