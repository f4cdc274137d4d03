// Encoders of textures and volumes.
#include "c/calls.h"
#include "c/volume_desc.h"

#include <gicodec/c/encoder.h>
#include <gicodec/encoder.h>
#include <gicodec/volume_encoder.h>

#include <limits>
#include <optional>

using namespace gicodec;

struct gicodec_encoder : c::Handle {
  std::optional<Encoder> encoder;
};

struct gicodec_volume_encoder : c::Handle {
  std::optional<VolumeEncoder> encoder;
  std::size_t textures = 0;
  std::vector<Packet> packets;
};

namespace gicodec::c {
namespace {

constexpr std::uint32_t kUsualGop = 30;

/// The options that both types of encoder have; `Options` is EncoderOptions or
/// VolumeEncoderOptions.
template <typename Options>
[[nodiscard]] Status take_options(const gicodec_encoder_options& given, Options& out) {
  if (given.texture_id > UINT8_MAX) return Status::invalid_argument;
  out.backend = text(given.backend, "native");
  out.settings.preset = text(given.preset);
  out.settings.level = given.level;
  out.settings.chunk = given.chunk;
  out.settings.difference = given.no_difference == 0;
  out.gop = given.gop == 0 ? kUsualGop : given.gop == GICODEC_GOP_ON_REQUEST ? 0 : given.gop;
  return take_backends(given.backends, given.backend_count, out.backends);
}

/// One bound for all textures but those that hold the presence of others.
[[nodiscard]] std::vector<float> bounds_of(const VolumeDesc& volume, float bound) {
  std::vector<float> bounds;
  for (const TextureGroup& group : volume.groups) {
    for (std::size_t place = 0; place < group.textures.size(); ++place) {
      bounds.push_back(place == group.presence ? 0 : bound);
    }
  }
  return bounds;
}

[[nodiscard]] Status take_selection(std::uint32_t selection, const std::uint32_t* blocks,
                                    std::size_t count, Selection& out) noexcept {
  switch (selection) {
    case GICODEC_SELECT_CHANGED:
      out = Selection::changed();
      return Status::ok;
    case GICODEC_SELECT_ALL:
      out = Selection::all();
      return Status::ok;
    case GICODEC_SELECT_LIST:
      if (is_missing(blocks, count)) return Status::invalid_argument;
      out = Selection(list(blocks, count));
      return Status::ok;
    default:
      return Status::invalid_argument;
  }
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_encoder_create(const gicodec_texture_desc* desc,
                                      const gicodec_encoder_options* options,
                                      gicodec_encoder** out) {
  return c::create(options, out,
                   [&](gicodec_encoder& handle, const gicodec_encoder_options& given) -> Status {
                     TextureDesc texture;
                     EncoderOptions settings;
                     Status status = c::take_desc(desc, texture);
                     if (status == Status::ok) status = c::take_options(given, settings);
                     if (status != Status::ok) return status;
                     if (given.max_errors != nullptr) return Status::invalid_argument;
                     settings.texture_id = static_cast<uint8_t>(given.texture_id);
                     settings.max_error = given.max_error;
                     settings.settings.threads = handle.host.threads();
                     settings.settings.isa = handle.host.isa();
                     return c::keep(Encoder::create(texture, settings), handle.encoder);
                   });
}

void gicodec_encoder_destroy(gicodec_encoder* encoder) { c::destroy(encoder); }

size_t gicodec_encoder_bound(const gicodec_encoder* encoder, size_t blocks) {
  if (encoder == nullptr) return 0;
  return encoder->encoder->bound(std::min<size_t>(blocks, block_count(encoder->encoder->desc())));
}

gicodec_status gicodec_encoder_encode(gicodec_encoder* encoder, const gicodec_const_view* view,
                                      uint32_t selection, const uint32_t* blocks,
                                      size_t block_count, void* out, size_t capacity,
                                      size_t* size) {
  return c::call(encoder, [&]() -> Status {
    ConstTextureView texels;
    Selection wanted = Selection::changed();
    Status status = c::take_view(view, texels);
    if (status == Status::ok) status = c::take_selection(selection, blocks, block_count, wanted);
    if (status != Status::ok) return status;
    if (size == nullptr || c::is_missing(out, capacity)) return Status::invalid_argument;
    const auto room = std::span(static_cast<std::byte*>(out), capacity);
    const auto coded = encoder->encoder->encode_to(texels, wanted, room);
    if (coded) {
      *size = *coded;
    } else if (coded.status() == Status::buffer_too_small) {
      *size = gicodec_encoder_bound(encoder, std::numeric_limits<size_t>::max());
    }
    return coded.status();
  });
}

gicodec_status gicodec_encoder_snapshot(gicodec_encoder* encoder, void* out, size_t capacity,
                                        size_t* size) {
  return c::call(encoder, [&]() -> Status {
    const auto packet = encoder->encoder->snapshot();
    return packet ? c::copy_out(*packet, out, capacity, size) : packet.status();
  });
}

gicodec_status gicodec_encoder_request_keyframe(gicodec_encoder* encoder) {
  return c::call(encoder, [&] {
    encoder->encoder->request_keyframe();
    return Status::ok;
  });
}

gicodec_status gicodec_encoder_set_preset(gicodec_encoder* encoder, const char* preset) {
  return c::call(encoder, [&] { return encoder->encoder->set_preset(c::text(preset)); });
}

gicodec_status gicodec_encoder_set_active(gicodec_encoder* encoder, const uint8_t* active,
                                          size_t count) {
  return c::call(encoder, [&] {
    if (c::is_missing(active, count)) return Status::invalid_argument;
    return encoder->encoder->set_active(c::list(active, count));
  });
}

gicodec_status gicodec_encoder_set_presence(gicodec_encoder* encoder, const void* presence,
                                            size_t size) {
  return c::call(encoder, [&] {
    if (c::is_missing(presence, size)) return Status::invalid_argument;
    return encoder->encoder->set_presence(c::bytes(presence, size));
  });
}

gicodec_status gicodec_encoder_read(const gicodec_encoder* encoder, const gicodec_view* view) {
  return c::call(encoder, [&] {
    TextureView texels;
    const Status status = c::take_view(view, texels);
    return status == Status::ok ? encoder->encoder->read(texels) : status;
  });
}

uint32_t gicodec_encoder_sequence(const gicodec_encoder* encoder) {
  return encoder == nullptr ? 0 : encoder->encoder->sequence();
}

gicodec_status gicodec_volume_encoder_create(const gicodec_volume_desc* volume,
                                             const gicodec_encoder_options* options,
                                             gicodec_volume_encoder** out) {
  return c::create(
      options, out,
      [&](gicodec_volume_encoder& handle, const gicodec_encoder_options& given) -> Status {
        if (volume == nullptr || c::is_missing(given.max_errors, given.max_error_count)) {
          return Status::invalid_argument;
        }
        VolumeEncoderOptions settings;
        const Status status = c::take_options(given, settings);
        if (status != Status::ok) return status;
        const auto bounds = c::list(given.max_errors, given.max_error_count);
        settings.max_errors.assign(bounds.begin(), bounds.end());
        if (bounds.empty() && given.max_error != 0) {
          settings.max_errors = c::bounds_of(volume->desc, given.max_error);
        }
        settings.first_texture = static_cast<uint8_t>(given.texture_id);
        handle.textures = textures_of(volume->desc).size();
        settings.settings.threads = handle.host.threads();
        settings.settings.isa = handle.host.isa();
        return c::keep(VolumeEncoder::create(volume->desc, settings), handle.encoder);
      });
}

void gicodec_volume_encoder_destroy(gicodec_volume_encoder* encoder) { c::destroy(encoder); }

gicodec_status gicodec_volume_encoder_encode(gicodec_volume_encoder* encoder,
                                             const gicodec_const_view* views, size_t view_count,
                                             uint32_t selection, const uint32_t* blocks,
                                             size_t block_count) {
  return c::call(encoder, [&]() -> Status {
    if (views == nullptr || view_count != encoder->textures) return Status::invalid_argument;
    std::vector<ConstTextureView> texels;
    Status status = c::take_each(views, view_count, [&](const gicodec_const_view* view) {
      return c::take_view(view, texels.emplace_back());
    });
    if (status != Status::ok) return status;
    Selection wanted = Selection::changed();
    status = c::take_selection(selection, blocks, block_count, wanted);
    if (status != Status::ok) return status;
    return c::keep(encoder->encoder->encode(texels, wanted), encoder->packets);
  });
}

gicodec_status gicodec_volume_encoder_snapshot(gicodec_volume_encoder* encoder) {
  return c::call(
      encoder, [&]() -> Status { return c::keep(encoder->encoder->snapshot(), encoder->packets); });
}

uint32_t gicodec_volume_encoder_packets(const gicodec_volume_encoder* encoder) {
  return encoder == nullptr ? 0 : static_cast<uint32_t>(encoder->packets.size());
}

const uint8_t* gicodec_volume_encoder_packet(const gicodec_volume_encoder* encoder, uint32_t packet,
                                             size_t* size) {
  const bool there = packet < gicodec_volume_encoder_packets(encoder);
  return c::point(
      there ? std::span<const std::byte>(encoder->packets[packet]) : std::span<const std::byte>(),
      size);
}

gicodec_status gicodec_volume_encoder_request_keyframe(gicodec_volume_encoder* encoder) {
  return c::call(encoder, [&] {
    encoder->encoder->request_keyframe();
    return Status::ok;
  });
}

gicodec_status gicodec_volume_encoder_set_preset(gicodec_volume_encoder* encoder, uint32_t texture,
                                                 const char* preset) {
  return c::call(encoder, [&] {
    if (texture > UINT8_MAX) return Status::unknown_texture;
    return encoder->encoder->set_preset(static_cast<uint8_t>(texture), c::text(preset));
  });
}

gicodec_status gicodec_volume_encoder_set_active(gicodec_volume_encoder* encoder, uint32_t group,
                                                 const uint8_t* active, size_t count) {
  return c::call(encoder, [&] {
    if (group > UINT8_MAX) return Status::unknown_group;
    if (c::is_missing(active, count)) return Status::invalid_argument;
    return encoder->encoder->set_active(static_cast<uint8_t>(group), c::list(active, count));
  });
}

gicodec_status gicodec_volume_encoder_read(const gicodec_volume_encoder* encoder, uint32_t texture,
                                           const gicodec_view* view) {
  return c::call(encoder, [&] {
    TextureView texels;
    const Status status = c::take_view(view, texels);
    if (status != Status::ok) return status;
    if (texture > UINT8_MAX) return Status::unknown_texture;
    return encoder->encoder->read(static_cast<uint8_t>(texture), texels);
  });
}

}  // extern "C"
