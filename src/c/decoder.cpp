// Decoders of textures and volumes.
#include "c/calls.h"
#include "c/volume_desc.h"

#include <gicodec/c/decoder.h>
#include <gicodec/decoder.h>
#include <gicodec/inspect.h>
#include <gicodec/volume_decoder.h>

#include <optional>

using namespace gicodec;

struct gicodec_decoder : c::Handle {
  std::vector<std::byte> presence;  ///< that the decoder refers to
  std::optional<Decoder> decoder;
};

struct gicodec_volume_decoder : c::Handle {
  std::optional<VolumeDecoder> decoder;
};

namespace gicodec::c {
namespace {

/// The options that both types of decoder have.
template <typename Options>
[[nodiscard]] Status take_options(const gicodec_decoder_options& given, const Handle& handle,
                                  Options& out) {
  if (given.texture_id > UINT8_MAX) return Status::invalid_argument;
  out.threads = handle.host.threads();
  out.isa = handle.host.isa();
  out.cancel = &handle.cancelled;
  const Status status = take_limits(given.limits, out.limits);
  if (status != Status::ok) return status;
  return take_backends(given.backends, given.backend_count, out.backends);
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_decoder_create(const gicodec_texture_desc* desc,
                                      const gicodec_decoder_options* options,
                                      gicodec_decoder** out) {
  return c::create(options, out,
                   [&](gicodec_decoder& handle, const gicodec_decoder_options& given) -> Status {
                     TextureDesc texture;
                     DecoderOptions settings;
                     Status status = c::take_desc(desc, texture);
                     if (status == Status::ok) status = c::take_options(given, handle, settings);
                     if (status != Status::ok) return status;
                     return c::keep(Decoder::create(texture, settings), handle.decoder);
                   });
}

void gicodec_decoder_destroy(gicodec_decoder* decoder) { c::destroy(decoder); }

gicodec_status gicodec_decoder_decode(gicodec_decoder* decoder, const void* packet, size_t size,
                                      const gicodec_view* view) {
  return c::call(decoder, [&] {
    if (c::is_missing(packet, size)) return Status::invalid_argument;
    const auto bytes = c::bytes(packet, size);
    if (view == nullptr) return decoder->decoder->decode(bytes);
    TextureView texels;
    const Status status = c::take_view(view, texels);
    return status == Status::ok ? decoder->decoder->decode(bytes, texels) : status;
  });
}

void gicodec_decoder_cancel(gicodec_decoder* decoder, uint32_t cancel) {
  if (decoder != nullptr) decoder->cancelled = cancel != 0;
}

gicodec_status gicodec_decoder_set_presence(gicodec_decoder* decoder, const void* presence,
                                            size_t size) {
  return c::call(decoder, [&] {
    if (c::is_missing(presence, size)) return Status::invalid_argument;
    const auto given = c::bytes(presence, size);
    std::vector<std::byte> copy(given.begin(), given.end());
    const Status status = decoder->decoder->set_presence(copy);
    if (status == Status::ok) decoder->presence = std::move(copy);  // keeps the address
    return status;
  });
}

gicodec_status gicodec_decoder_read(const gicodec_decoder* decoder, const gicodec_view* view,
                                    const uint32_t* blocks, size_t block_count) {
  return c::call(decoder, [&] {
    TextureView texels;
    const Status status = c::take_view(view, texels);
    if (status != Status::ok) return status;
    if (blocks == nullptr) {
      return block_count == 0 ? decoder->decoder->read(texels) : Status::invalid_argument;
    }
    return decoder->decoder->read(texels, c::list(blocks, block_count));
  });
}

const uint32_t* gicodec_decoder_changed(const gicodec_decoder* decoder, size_t* count) {
  return decoder == nullptr ? c::point(std::span<const uint32_t>(), count)
                            : c::point_to_blocks(decoder->decoder->changed(), count);
}

const uint8_t* gicodec_decoder_records(const gicodec_decoder* decoder, size_t* size) {
  return c::point(decoder == nullptr ? std::span<const std::byte>() : decoder->decoder->records(),
                  size);
}

const uint8_t* gicodec_decoder_received(const gicodec_decoder* decoder, size_t* count) {
  return c::point(decoder == nullptr ? std::span<const uint8_t>() : decoder->decoder->received(),
                  count);
}

uint32_t gicodec_decoder_sequence(const gicodec_decoder* decoder) {
  return decoder == nullptr ? 0 : decoder->decoder->sequence();
}

uint64_t gicodec_decoder_state_hash(const gicodec_decoder* decoder) {
  return decoder == nullptr ? 0 : decoder->decoder->state_hash();
}

gicodec_status gicodec_volume_decoder_create(const gicodec_volume_desc* volume,
                                             const gicodec_decoder_options* options,
                                             gicodec_volume_decoder** out) {
  return c::create(
      options, out,
      [&](gicodec_volume_decoder& handle, const gicodec_decoder_options& given) -> Status {
        if (volume == nullptr) return Status::invalid_argument;
        VolumeDecoderOptions settings;
        const Status status = c::take_options(given, handle, settings);
        if (status != Status::ok) return status;
        settings.first_texture = static_cast<uint8_t>(given.texture_id);
        return c::keep(VolumeDecoder::create(volume->desc, settings), handle.decoder);
      });
}

void gicodec_volume_decoder_destroy(gicodec_volume_decoder* decoder) { c::destroy(decoder); }

gicodec_status gicodec_volume_decoder_decode(gicodec_volume_decoder* decoder, const void* packet,
                                             size_t size) {
  return c::call(decoder, [&] {
    if (c::is_missing(packet, size)) return Status::invalid_argument;
    return decoder->decoder->decode(c::bytes(packet, size));
  });
}

void gicodec_volume_decoder_cancel(gicodec_volume_decoder* decoder, uint32_t cancel) {
  if (decoder != nullptr) decoder->cancelled = cancel != 0;
}

gicodec_status gicodec_volume_decoder_read(const gicodec_volume_decoder* decoder, uint32_t texture,
                                           const gicodec_view* view, const uint32_t* blocks,
                                           size_t block_count) {
  return c::call(decoder, [&] {
    TextureView texels;
    const Status status = c::take_view(view, texels);
    if (status != Status::ok) return status;
    if (texture > UINT8_MAX) return Status::unknown_texture;
    const auto id = static_cast<uint8_t>(texture);
    if (blocks == nullptr) {
      return block_count == 0 ? decoder->decoder->read(id, texels) : Status::invalid_argument;
    }
    return decoder->decoder->read(id, texels, c::list(blocks, block_count));
  });
}

const uint32_t* gicodec_volume_decoder_changed(const gicodec_volume_decoder* decoder,
                                               uint32_t texture, size_t* count) {
  const bool there = decoder != nullptr && texture <= UINT8_MAX;
  if (!there) return c::point(std::span<const uint32_t>(), count);
  return c::point_to_blocks(decoder->decoder->changed(static_cast<uint8_t>(texture)), count);
}

const uint8_t* gicodec_volume_decoder_records(const gicodec_volume_decoder* decoder,
                                              uint32_t texture, size_t* size) {
  const bool there = decoder != nullptr && texture <= UINT8_MAX;
  const Decoder* const of_texture =
      there ? decoder->decoder->decoder(static_cast<uint8_t>(texture)) : nullptr;
  return c::point(of_texture == nullptr ? std::span<const std::byte>() : of_texture->records(),
                  size);
}

gicodec_status gicodec_packet_peek(const void* packet, size_t size, gicodec_packet_info* out) {
  if (c::is_missing(packet, size)) return GICODEC_INVALID_ARGUMENT;
  const auto info = peek(c::bytes(packet, size));
  if (!info) return c::number(info.status());
  gicodec_packet_info given{};
  given.version = info->version;
  given.type = static_cast<uint32_t>(info->type);
  given.backend = info->backend;
  given.texture_id = info->texture_id;
  given.lossy = info->lossy ? 1 : 0;
  given.sequence = info->sequence;
  given.reference = info->reference;
  given.all_blocks = info->all_blocks ? 1 : 0;
  given.blocks = info->blocks;
  given.header_size = info->header_size;
  given.index_size = info->index_size;
  given.guard_band_size = info->guard_band_size;
  given.payload_size = info->payload_size;
  return c::number(c::give(given, out));
}

const char* gicodec_backend_name(uint32_t backend) {
  const auto name = backend_name(backend > UINT8_MAX ? UINT8_MAX : static_cast<uint8_t>(backend));
  return name.empty() ? nullptr : name.data();
}

}  // extern "C"
