// Encoder of all textures of a volume.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/encoder.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

/// As EncoderOptions, for every texture.
struct VolumeEncoderOptions {
  std::string_view backend = "native";
  BackendSettings settings = {};
  std::uint32_t gop = 30;  ///< keyframes of all textures every `gop` updates; 0: only on request
  /// The texture_id of the first texture's packets, e.g. VolumeEntry::first_texture; the following
  /// textures have the following ids.
  std::uint8_t first_texture = 0;
  /// EncoderOptions::max_error of each texture, 0 for one that holds the presence of others; empty:
  /// all are lossless.
  std::vector<float> max_errors = {};
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; for create() only
  /// The backend of each texture, null: `backend`; empty: `backend` for all.
  std::vector<const Backend*> texture_backends = {};
};

/// Turns successive contents of a volume of any kind into updates, one packet per texture:
///
///     const VolumeDesc volume = *photon_volume(8, 64);
///     auto encoder = VolumeEncoder::create(volume);
///     auto decoder = VolumeDecoder::create(volume);
///     const ConstTextureView views[] = {counts_view, batches_view, photons_view};
///     const Result<std::vector<Packet>> packets = encoder->encode(views);
///     Status status = packets ? decoder->decode(*packets) : packets.status();
///     if (status == Status::ok) status = decoder->read(2, my_photons, decoder->changed(2));
///
/// The VolumeDesc says which texture holds the presence of others, and which groups are bundled.
/// The caller sorts records whose order means nothing (Kind::sort). One thread at a time per
/// encoder. A moved-from encoder may only be destroyed or assigned to.
class VolumeEncoder {
 public:
  /// Errors: those of validate() and of Encoder::create(); invalid_argument if max_errors or
  /// texture_backends is not empty and does not have one entry per texture, or for texture ids
  /// beyond 255.
  [[nodiscard]] static Result<VolumeEncoder> create(const VolumeDesc& volume,
                                                    const VolumeEncoderOptions& options = {});
  VolumeEncoder(VolumeEncoder&&) noexcept;
  VolumeEncoder& operator=(VolumeEncoder&&) noexcept;
  ~VolumeEncoder();

  /// Codes the selected blocks of `views`, one view per texture. Returns one packet per texture, in
  /// the order in which decoders must apply them. A block of a bundled group that changed in one
  /// texture goes into all packets of the group. A list of blocks applies to every group. An error
  /// leaves all textures as before; with a stateful backend, such as hevc, the next packets are
  /// keyframes. Errors: those of Encoder::encode(); invalid_argument for another number of views;
  /// presence_invalid.
  [[nodiscard]] Result<std::vector<Packet>> encode(std::span<const ConstTextureView> views,
                                                   Selection selection = Selection::changed());
  /// The same with a selection for each group; invalid_argument for another number of them.
  [[nodiscard]] Result<std::vector<Packet>> encode(std::span<const ConstTextureView> views,
                                                   std::span<const Selection> selections);

  /// One keyframe per texture, of its present state, see Encoder::snapshot().
  [[nodiscard]] Result<std::vector<Packet>> snapshot();
  /// Makes the next packets keyframes.
  void request_keyframe() noexcept;
  /// As Encoder::set_preset(); unknown_texture.
  Status set_preset(std::uint8_t texture, std::string_view preset);
  /// Excludes inactive blocks of a group from Selection::changed(), see Encoder::set_active().
  /// unknown_group, mask_mismatch.
  Status set_active(std::uint8_t group, std::span<const std::uint8_t> active);

  /// Writes a texture as decoders hold it after the last packets. unknown_texture, view_too_small.
  Status read(std::uint8_t texture, TextureView view) const;
  [[nodiscard]] const VolumeDesc& desc() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit VolumeEncoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
