// The streaming client.
#include "c/container.h"
#include "c/volume_desc.h"

#include <gicodec/c/client.h>
#include <gicodec/client.h>

#include <optional>
#include <utility>

using namespace gicodec;

struct gicodec_client : c::Handle {
  std::optional<Client> client;
  std::vector<Message> messages;  ///< to send
  std::size_t sent = 0;           ///< of these
  std::vector<uint32_t> changed;

  [[nodiscard]] const ClientVolume* find(uint32_t volume) const noexcept {
    return volume > UINT16_MAX ? nullptr : client->frame().find(static_cast<uint16_t>(volume));
  }
  [[nodiscard]] const ClientTexture* find(uint32_t volume, uint32_t texture) const noexcept {
    const ClientVolume* const found = find(volume);
    const bool there = found != nullptr && texture < found->textures.size();
    return there ? &found->textures[texture] : nullptr;
  }
};

namespace gicodec::c {
namespace {

[[nodiscard]] Status take_viewpoint(const gicodec_viewpoint* given, Viewpoint& out) noexcept {
  if (given == nullptr) return Status::invalid_argument;
  gicodec_viewpoint viewpoint;
  if (const Status status = take(given, viewpoint); status != Status::ok) return status;
  std::copy(std::begin(viewpoint.eye), std::end(viewpoint.eye), out.eye.begin());
  std::copy(std::begin(viewpoint.target), std::end(viewpoint.target), out.target.begin());
  std::copy(std::begin(viewpoint.up), std::end(viewpoint.up), out.up.begin());
  out.fov_y = viewpoint.fov_y;
  out.aspect = viewpoint.aspect;
  out.time = viewpoint.time;
  return Status::ok;
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_client_create(const gicodec_client_options* options, gicodec_client** out) {
  return c::create(
      options, out, [&](gicodec_client& handle, const gicodec_client_options& given) -> Status {
        if (given.delivery > GICODEC_DELIVERY_SHARED) return Status::invalid_argument;
        ClientOptions settings;
        settings.threads = handle.host.threads();
        settings.isa = handle.host.isa();
        settings.cancel = &handle.cancelled;
        settings.delivery = static_cast<Delivery>(given.delivery);
        settings.budget = {given.budget_blocks, given.budget_bytes};
        settings.token = c::text(given.token);
        settings.texels = given.no_texels == 0;
        Status status = c::take_limits(given.limits, settings.limits);
        if (status == Status::ok) {
          status = c::take_backends(given.backends, given.backend_count, settings.backends);
        }
        if (status != Status::ok) return status;
        return c::keep(Client::create(settings), handle.client);
      });
}

void gicodec_client_destroy(gicodec_client* client) { c::destroy(client); }

gicodec_status gicodec_client_hello(gicodec_client* client) {
  return c::call(client, [&]() -> Status {
    auto hello = client->client->hello();
    if (!hello) return hello.status();
    std::vector<Message> messages;
    messages.push_back(*std::move(hello));
    client->messages = std::move(messages);
    client->sent = 0;
    return Status::ok;
  });
}

gicodec_status gicodec_client_receive(gicodec_client* client, const void* message, size_t size) {
  return c::call(client, [&] {
    if (c::is_missing(message, size)) return Status::invalid_argument;
    return client->client->receive(c::bytes(message, size));
  });
}

const uint8_t* gicodec_client_message(gicodec_client* client, size_t* size) {
  std::span<const std::byte> found;
  (void)c::call(client, [&] {
    if (client->sent == client->messages.size()) {
      client->messages = client->client->take_messages();
      client->sent = 0;
    }
    if (client->sent < client->messages.size()) found = client->messages[client->sent++];
    return Status::ok;
  });
  return c::point(found, size);
}

void gicodec_client_cancel(gicodec_client* client, uint32_t cancel) {
  if (client != nullptr) client->cancelled = cancel != 0;
}

gicodec_status gicodec_client_set_viewpoint(gicodec_client* client,
                                            const gicodec_viewpoint* viewpoint) {
  return c::call(client, [&] {
    Viewpoint taken;
    const Status status = c::take_viewpoint(viewpoint, taken);
    return status == Status::ok ? client->client->set_viewpoint(taken) : status;
  });
}

gicodec_status gicodec_client_subscribe(gicodec_client* client, uint32_t volume, uint32_t group,
                                        const uint8_t* blocks, size_t count) {
  return c::call(client, [&] {
    if (c::is_missing(blocks, count)) return Status::invalid_argument;
    if (volume > UINT16_MAX) return Status::unknown_volume;
    if (group > UINT8_MAX) return Status::unknown_group;
    return client->client->subscribe(static_cast<uint16_t>(volume), c::list(blocks, count),
                                     static_cast<uint8_t>(group));
  });
}

gicodec_status gicodec_client_disconnect(gicodec_client* client) {
  return c::call(client, [&] { return client->client->disconnect(); });
}

gicodec_status gicodec_client_get_state(const gicodec_client* client, gicodec_client_state* out) {
  return c::call(client, [&] {
    const Client& from = *client->client;
    const ClientFrame& frame = from.frame();
    const ClientStatistics& statistics = from.statistics();
    gicodec_client_state state{};
    state.connected = from.is_connected() ? 1 : 0;
    state.resumed = from.resumed() ? 1 : 0;
    state.consistent = from.consistent() ? 1 : 0;
    state.epoch = frame.epoch;
    state.serial = frame.serial;
    state.update = frame.update;
    state.time = frame.time;
    state.volumes = static_cast<uint32_t>(frame.volumes.size());
    state.reason = static_cast<uint32_t>(from.goodbye().reason);
    state.messages = statistics.messages;
    state.bytes = statistics.bytes;
    state.packets = statistics.packets;
    state.blocks = statistics.blocks;
    state.gaps = statistics.gaps;
    return c::give(state, out);
  });
}

const char* gicodec_reason_text(uint32_t reason) {
  return to_string(static_cast<Reason>(std::min<uint32_t>(reason, UINT8_MAX))).data();
}

gicodec_status gicodec_client_volume(const gicodec_client* client, uint32_t place, uint32_t* volume,
                                     uint64_t* instance) {
  if (client == nullptr || volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  const auto& volumes = client->client->frame().volumes;
  if (place >= volumes.size()) return GICODEC_UNKNOWN_VOLUME;
  *volume = volumes[place].id;
  if (instance != nullptr) *instance = volumes[place].instance;
  return GICODEC_OK;
}

gicodec_status gicodec_client_volume_desc(const gicodec_client* client, uint32_t volume,
                                          gicodec_volume_desc** out) {
  if (out != nullptr) *out = nullptr;
  return c::call(client, [&] {
    if (out == nullptr) return Status::invalid_argument;
    const ClientVolume* const found = client->find(volume);
    return found == nullptr ? Status::unknown_volume : c::give_volume(found->desc, out);
  });
}

const char* gicodec_client_volume_name(const gicodec_client* client, uint32_t volume) {
  const ClientVolume* const found = client == nullptr ? nullptr : client->find(volume);
  return found == nullptr ? nullptr : found->name.c_str();
}

gicodec_status gicodec_client_geometry(const gicodec_client* client, uint32_t volume,
                                       gicodec_geometry* out) {
  if (client == nullptr) return GICODEC_INVALID_ARGUMENT;
  const ClientVolume* const found = client->find(volume);
  return found == nullptr ? GICODEC_UNKNOWN_VOLUME
                          : c::number(c::give_geometry(found->geometry, out));
}

const uint8_t* gicodec_client_texels(const gicodec_client* client, uint32_t volume,
                                     uint32_t texture, size_t* size) {
  const ClientTexture* const found = client == nullptr ? nullptr : client->find(volume, texture);
  return c::point(
      found == nullptr ? std::span<const std::byte>() : std::span<const std::byte>(found->texels),
      size);
}

gicodec_status gicodec_client_changed(gicodec_client* client, uint32_t volume, uint32_t texture,
                                      uint64_t after, const uint32_t** blocks, size_t* count) {
  return c::call(client, [&] {
    if (blocks == nullptr || count == nullptr) return Status::invalid_argument;
    if (client->find(volume) == nullptr) return Status::unknown_volume;
    const ClientTexture* const found = client->find(volume, texture);
    if (found == nullptr) return Status::unknown_texture;
    const Status status = found->changed_blocks(after, client->changed);
    if (status == Status::ok) {
      *blocks = c::point_to_blocks(client->changed, count);
    }
    return status;
  });
}

gicodec_status gicodec_client_read(const gicodec_client* client, uint32_t volume, uint32_t texture,
                                   uint64_t after, const gicodec_view* view) {
  return c::call(client, [&] {
    TextureView texels;
    const Status status = c::take_view(view, texels);
    if (status != Status::ok) return status;
    if (volume > UINT16_MAX) return Status::unknown_volume;
    if (texture > UINT8_MAX) return Status::unknown_texture;
    return client->client->read(static_cast<uint16_t>(volume), static_cast<uint8_t>(texture), after,
                                texels);
  });
}

}  // extern "C"
