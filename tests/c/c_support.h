// Textures and structs for tests of the C interface.
#pragma once

#include <gicodec/c/gicodec.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gicodec::test {

inline constexpr gicodec_status kInvalid = GICODEC_INVALID_ARGUMENT;

/// A struct of its own size, all else zero.
template <typename Struct>
[[nodiscard]] Struct sized() {
  Struct out{};
  out.struct_size = sizeof(Struct);
  return out;
}

/// Destroys a handle at the end of a scope.
template <typename Handle, void (*destroy)(Handle*)>
struct Destroy {
  void operator()(Handle* handle) const { destroy(handle); }
};
template <typename Handle, void (*destroy)(Handle*)>
using Owned = std::unique_ptr<Handle, Destroy<Handle, destroy>>;

using OwnedEncoder = Owned<gicodec_encoder, gicodec_encoder_destroy>;
using OwnedDecoder = Owned<gicodec_decoder, gicodec_decoder_destroy>;
using OwnedVolume = Owned<gicodec_volume_desc, gicodec_volume_desc_destroy>;
using OwnedVolumeEncoder = Owned<gicodec_volume_encoder, gicodec_volume_encoder_destroy>;
using OwnedVolumeDecoder = Owned<gicodec_volume_decoder, gicodec_volume_decoder_destroy>;
using OwnedContainer = Owned<gicodec_container, gicodec_container_destroy>;
using OwnedWriter = Owned<gicodec_writer, gicodec_writer_destroy>;
using OwnedPlayer = Owned<gicodec_player, gicodec_player_destroy>;
using OwnedClient = Owned<gicodec_client, gicodec_client_destroy>;
using OwnedServer = Owned<gicodec_server, gicodec_server_destroy>;
using OwnedPublisher = Owned<gicodec_track_publisher, gicodec_track_publisher_destroy>;
using OwnedReceiver = Owned<gicodec_track_receiver, gicodec_track_receiver_destroy>;

/// What create() stores, e.g. made<OwnedClient>([&](auto out) { return gicodec_client_create(…,
/// out); }).
template <typename Owner, typename Create>
[[nodiscard]] Owner made(const Create& create) {
  typename Owner::pointer handle = nullptr;
  return create(&handle) == GICODEC_OK ? Owner(handle) : Owner();
}

/// Tightly packed texels of a description, and views of them.
struct CTexture {
  explicit CTexture(const gicodec_texture_desc& of) : desc(of) {
    auto info = sized<gicodec_texture_info>();
    if (gicodec_texture_desc_info(&desc, &info) == GICODEC_OK) {
      bytes.resize(static_cast<std::size_t>(info.texture_bytes));
      blocks = info.blocks;
    }
  }
  [[nodiscard]] gicodec_view view() {
    auto out = sized<gicodec_view>();
    out.bytes = bytes.data();
    out.size = bytes.size();
    return out;
  }
  [[nodiscard]] gicodec_const_view const_view() const {
    auto out = sized<gicodec_const_view>();
    out.bytes = bytes.data();
    out.size = bytes.size();
    return out;
  }
  /// Some texels change.
  void paint(unsigned frame) {
    for (std::size_t i = frame; i < bytes.size(); i += 97) {
      bytes[i] = static_cast<std::uint8_t>(i + frame);
    }
  }

  gicodec_texture_desc desc;
  std::vector<std::uint8_t> bytes;
  std::uint32_t blocks = 0;
};

[[nodiscard]] inline gicodec_texture_desc irradiance(std::uint32_t nx = 4, std::uint32_t ny = 3,
                                                     std::uint32_t nz = 2) {
  auto desc = sized<gicodec_texture_desc>();
  (void)gicodec_ddgi_irradiance(nx, ny, nz, gicodec_format_from_name("A2B10G10R10_UNORM_PACK32"),
                                &desc);
  return desc;
}

/// Probes with one texture, "color".
[[nodiscard]] inline OwnedVolume room(const gicodec_texture_desc& desc) {
  auto volume = made<OwnedVolume>([](auto out) { return gicodec_volume_desc_create(1, out); });
  if (gicodec_volume_desc_add_texture(volume.get(), "color", &desc) != GICODEC_OK) volume.reset();
  return volume;
}

[[nodiscard]] inline gicodec_geometry geometry_of(const gicodec_texture_desc& desc) {
  auto geometry = sized<gicodec_geometry>();
  for (int axis = 0; axis < 3; ++axis) {
    geometry.grid[axis] = desc.grid[axis];
    geometry.spacing[axis] = 1;
  }
  return geometry;
}

}  // namespace gicodec::test
