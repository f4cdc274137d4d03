// The streaming server.
#include "c/server.h"

#include "c/container.h"
#include "c/volume_desc.h"

#include <gicodec/c/server.h>

#include <optional>
#include <utility>

using namespace gicodec;

namespace gicodec::c {
namespace {

[[nodiscard]] Status take_options(const gicodec_server_options& given, const Host& host,
                                  ServerOptions& out) {
  out.backend = text(given.backend, "native");
  out.settings.preset = text(given.preset);
  out.settings.level = given.level;
  out.settings.isa = host.isa();
  out.threads = host.threads();
  out.region = {given.region[0], given.region[1], given.region[2]};
  out.scene = {std::string(text(given.scene)), given.scene_geometry};
  out.epoch = given.epoch;
  out.interval = given.interval;
  out.proofs = given.proofs != 0;
  set(out.first_update_bytes, given.first_update_bytes);
  out.access.token = text(given.token);
  ServerLimits& limits = out.limits;
  set(limits.max_clients, given.max_clients);
  set(limits.max_connections, given.max_connections);
  set(limits.max_waiting, given.max_waiting);
  set(limits.max_unicast, given.max_unicast);
  set(limits.max_unicast_per_origin, given.max_unicast_per_origin);
  set(limits.max_in_flight, given.max_in_flight);
  set(limits.max_in_flight_bytes, given.max_in_flight_bytes);
  set(limits.max_message_bytes, given.max_message_bytes);
  set(limits.max_bytes_per_second, given.max_bytes_per_second);
  set(limits.max_total_bytes_per_second, given.max_total_bytes_per_second);
  set(limits.messages_per_second, given.messages_per_second);
  set(limits.resyncs_per_second, given.resyncs_per_second);
  set(out.timeouts.hello, given.hello_timeout);
  set(out.timeouts.stall, given.stall_timeout);
  set(out.timeouts.linger, given.linger_timeout);
  return take_backends(given.backends, given.backend_count, out.backends);
}

/// The caller's list of textures, whose structs may be longer than this library's.
[[nodiscard]] Status take_textures(const gicodec_streamed_texture* given, std::size_t count,
                                   const VolumeDesc& volume, std::vector<StreamedTexture>& out) {
  if (is_missing(given, count) || count > kMaxVolumeTextures) return Status::invalid_argument;
  const auto textures = textures_of(volume);
  return take_each(given, count, [&](const gicodec_streamed_texture* one) -> Status {
    gicodec_streamed_texture taken;
    if (const Status status = take(one, taken); status != Status::ok) return status;
    if (taken.texture >= textures.size()) return Status::unknown_texture;
    StreamedTexture texture;
    texture.texture = textures[taken.texture]->name;
    set(texture.interval, taken.interval);
    texture.threshold = taken.threshold;
    texture.max_error = taken.max_error;
    texture.source_error = taken.source_error;
    out.push_back(std::move(texture));
    return Status::ok;
  });
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_server_create(const gicodec_server_options* options, gicodec_server** out) {
  return c::create(options, out,
                   [&](gicodec_server& handle, const gicodec_server_options& given) -> Status {
                     ServerOptions settings;
                     const Status status = c::take_options(given, handle.host, settings);
                     if (status != Status::ok) return status;
                     handle.has_epoch = given.epoch != 0;
                     return c::keep(Server::create(settings), handle.server);
                   });
}

void gicodec_server_destroy(gicodec_server* server) { c::destroy(server); }

gicodec_status gicodec_server_add_volume(gicodec_server* server, const char* name,
                                         const gicodec_volume_desc* desc,
                                         const gicodec_geometry* geometry,
                                         const gicodec_streamed_texture* textures,
                                         size_t texture_count, uint32_t* volume) {
  return c::call(server, [&]() -> Status {
    if (desc == nullptr || volume == nullptr) return Status::invalid_argument;
    VolumeGeometry place;
    std::vector<StreamedTexture> streamed;
    Status status = c::take_geometry(geometry, place);
    if (status == Status::ok) {
      status = c::take_textures(textures, texture_count, desc->desc, streamed);
    }
    if (status != Status::ok) return status;
    const auto completed = c::complete(desc->desc);
    if (!completed) return completed.status();
    const auto added =
        server->server->add_volume(std::string(c::text(name)), *completed, place, streamed);
    if (added) *volume = *added;
    return added.status();
  });
}

gicodec_status gicodec_server_remove_volume(gicodec_server* server, uint32_t volume) {
  return c::call(server, [&] {
    uint16_t id = 0;
    const Status status = c::narrow(volume, id, Status::unknown_volume);
    return status == Status::ok ? server->server->remove_volume(id) : status;
  });
}

gicodec_status gicodec_server_publish(gicodec_server* server, uint32_t volume, uint32_t texture,
                                      const gicodec_const_view* view, const uint32_t* blocks,
                                      size_t block_count) {
  return c::call(server, [&] {
    uint16_t id = 0;
    ConstTextureView texels;
    Status status = c::narrow(volume, id, Status::unknown_volume);
    if (status == Status::ok) status = c::take_view(view, texels);
    if (status != Status::ok) return status;
    if (texture > UINT8_MAX) return Status::unknown_texture;
    const auto place = static_cast<uint8_t>(texture);
    if (blocks == nullptr) {
      return block_count == 0 ? server->server->publish(id, place, texels)
                              : Status::invalid_argument;
    }
    return server->server->publish(id, place, texels, c::list(blocks, block_count));
  });
}

gicodec_status gicodec_server_scroll(gicodec_server* server, uint32_t volume, int32_t x, int32_t y,
                                     int32_t z) {
  return c::call(server, [&] {
    uint16_t id = 0;
    const Status status = c::narrow(volume, id, Status::unknown_volume);
    return status == Status::ok ? server->server->scroll(id, {x, y, z}) : status;
  });
}

gicodec_status gicodec_server_set_active(gicodec_server* server, uint32_t volume, uint32_t group,
                                         const uint8_t* active, size_t count) {
  return c::call(server, [&] {
    uint16_t id = 0;
    const Status status = c::narrow(volume, id, Status::unknown_volume);
    if (status != Status::ok) return status;
    if (group > UINT8_MAX) return Status::unknown_group;
    if (c::is_missing(active, count)) return Status::invalid_argument;
    return server->server->set_active(id, c::list(active, count), static_cast<uint8_t>(group));
  });
}

gicodec_status gicodec_server_connect(gicodec_server* server, double now, const char* origin,
                                      uint32_t* connection) {
  return c::call(server, [&]() -> Status {
    if (connection == nullptr) return Status::invalid_argument;
    const auto connected = server->server->connect(now, c::text(origin));
    if (connected) *connection = *connected;
    return connected.status();
  });
}

gicodec_status gicodec_server_receive(gicodec_server* server, uint32_t connection,
                                      const void* message, size_t size, double now) {
  return c::call(server, [&] {
    if (c::is_missing(message, size)) return Status::invalid_argument;
    server->server->receive(connection, c::bytes(message, size), now);
    return Status::ok;
  });
}

gicodec_status gicodec_server_disconnect(gicodec_server* server, uint32_t connection, double now) {
  return c::call(server, [&] {
    server->outboxes.erase(connection);
    server->server->disconnect(connection, now);
    return Status::ok;
  });
}

gicodec_status gicodec_server_drop(gicodec_server* server, uint32_t connection, uint32_t reason) {
  return c::call(server, [&] {
    if (reason > static_cast<uint32_t>(Reason::unicast_full)) return Status::invalid_argument;
    server->server->drop(connection, static_cast<Reason>(reason));
    return Status::ok;
  });
}

gicodec_status gicodec_server_set_visible(gicodec_server* server, uint32_t connection,
                                          uint32_t volume, uint32_t group, const uint8_t* visible,
                                          size_t count) {
  return c::call(server, [&] {
    uint16_t id = 0;
    const Status status = c::narrow(volume, id, Status::unknown_volume);
    if (status != Status::ok) return status;
    if (group > UINT8_MAX) return Status::unknown_group;
    if (c::is_missing(visible, count)) return Status::invalid_argument;
    return server->server->set_visible(connection, id, c::list(visible, count),
                                       static_cast<uint8_t>(group));
  });
}

gicodec_status gicodec_server_update(gicodec_server* server, double now, double time) {
  return c::call(server, [&] { return server->server->update(now, time); });
}

gicodec_status gicodec_server_report_update_time(gicodec_server* server, double elapsed,
                                                 double budget) {
  return c::call(server, [&] {
    server->server->report_update_time(elapsed, budget);
    return Status::ok;
  });
}

gicodec_status gicodec_server_tick(gicodec_server* server, double now) {
  return c::call(server, [&] {
    server->server->tick(now);
    return Status::ok;
  });
}

const uint8_t* gicodec_server_message(gicodec_server* server, uint32_t connection, size_t* size) {
  std::span<const std::byte> found;
  (void)c::call(server, [&]() -> Status {
    const auto box = server->outboxes.try_emplace(connection).first;
    c::Outbox& outbox = box->second;
    if (outbox.taken == outbox.messages.size()) {
      outbox.messages = server->server->take_messages(connection);
      outbox.taken = 0;
    }
    if (outbox.messages.empty()) {
      server->outboxes.erase(box);
      return Status::end;
    }
    auto joined = outbox.messages[outbox.taken].joined();
    if (!joined) return joined.status();
    outbox.last = *std::move(joined);
    ++outbox.taken;
    found = outbox.last;
    return Status::ok;
  });
  return c::point(found, size);
}

gicodec_status gicodec_server_event(gicodec_server* server, gicodec_event* out) {
  return c::call(server, [&]() -> Status {
    if (server->told == server->events.size()) {
      server->events = server->server->take_events();
      server->told = 0;
    }
    if (server->events.empty()) return Status::end;
    const ServerEvent& event = server->events[server->told];
    gicodec_event given{};
    given.type = static_cast<uint32_t>(event.type);
    given.connection = event.connection;
    given.client = event.client;
    given.reason = static_cast<uint32_t>(event.reason);
    const Status status = c::give(given, out);
    if (status == Status::ok) ++server->told;
    return status;
  });
}

gicodec_status gicodec_server_viewpoint(const gicodec_server* server, uint32_t connection,
                                        gicodec_viewpoint* out) {
  return c::call(server, [&]() -> Status {
    if (!server->server->client(connection)) return Status::unknown_connection;
    const auto viewpoint = server->server->viewpoint(connection);
    if (!viewpoint) return Status::end;
    gicodec_viewpoint given{};
    std::copy(viewpoint->eye.begin(), viewpoint->eye.end(), given.eye);
    std::copy(viewpoint->target.begin(), viewpoint->target.end(), given.target);
    std::copy(viewpoint->up.begin(), viewpoint->up.end(), given.up);
    given.fov_y = viewpoint->fov_y;
    given.aspect = viewpoint->aspect;
    given.time = viewpoint->time;
    return c::give(given, out);
  });
}

gicodec_status gicodec_server_connection(const gicodec_server* server, uint32_t connection,
                                         gicodec_connection_state* out) {
  return c::call(server, [&]() -> Status {
    const auto statistics = server->server->statistics(connection);
    if (!statistics) return Status::unknown_connection;
    gicodec_connection_state given{};
    given.client = statistics->client;
    given.delivery = static_cast<uint32_t>(statistics->delivery);
    given.in_flight = statistics->in_flight;
    given.in_flight_bytes = statistics->in_flight_bytes;
    given.updates = statistics->updates;
    given.bytes = statistics->bytes;
    given.blocks = statistics->blocks;
    given.skipped = statistics->skipped;
    given.update_bytes = statistics->update_bytes;
    given.memory = statistics->memory;
    given.resyncs = statistics->resyncs;
    given.lagging = statistics->lagging ? 1 : 0;
    given.pending = statistics->pending;
    given.oldest_pending = statistics->oldest_pending;
    return c::give(given, out);
  });
}

}  // extern "C"
