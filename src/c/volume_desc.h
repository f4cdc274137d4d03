// Descriptions: between the structs of the C interface and the library's.
#pragma once

#include <gicodec/c/description.h>
#include <gicodec/kind.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <memory>
#include <string>
#include <vector>

/// A description under construction, or a finished one.
struct gicodec_volume_desc {
  gicodec::VolumeDesc desc;
  /// The textures by their number.
  [[nodiscard]] const gicodec::NamedTexture* texture(std::uint32_t number) const noexcept;
};

namespace gicodec::c {

/// The result may be invalid. unsupported_format for an unknown format or no record.
[[nodiscard]] Status take_desc(const gicodec_texture_desc* given, TextureDesc& out) noexcept;
/// Of the same size as any gicodec_texture_desc.
[[nodiscard]] gicodec_texture_desc desc_for_c(const TextureDesc& desc) noexcept;
/// The volume as its kind reads it, with what follows from the textures, and its layouts.
/// unknown_kind; invalid_description if the volume is not of its kind.
[[nodiscard]] Result<VolumeDesc> complete(const VolumeDesc& volume);
/// Stores a new handle.
[[nodiscard]] Status give_volume(VolumeDesc desc, gicodec_volume_desc** out);

}  // namespace gicodec::c
