// Kinds of payload: what the texture groups of a volume are, and how a volume is described to those
// who receive it. Built in: probes, irradiance vectors, textures, irradiance maps, photons, AO
// points, voxels. Applications may bring their own (ids 128..255).
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

/// What a difference between two blocks of a texture is measured by.
enum class Threshold : std::uint8_t {
  components = 0,  ///< codes of unorm, snorm, uint and exponents; relative differences of floats
  exact = 1,       ///< every bit counts
};

/// What a picture of a texture shows.
enum class Preview : std::uint8_t { none = 0, color = 1, distance = 2, direction = 3 };

struct NamedTexture {
  std::string name;  ///< UTF-8 of 1..255 bytes, once in a volume
  TextureDesc desc;
  Threshold threshold = Threshold::components;
  Preview preview = Preview::none;

  friend bool operator==(const NamedTexture&, const NamedTexture&) = default;
};

/// Textures over one grid or pool.
struct TextureGroup {
  static constexpr std::uint8_t kNone = 255;

  std::vector<NamedTexture> textures;  ///< of one space and grid
  /// A block travels in all textures or in none: selected, budgeted, sent and proved together.
  bool bundled = false;
  /// 0 if the first texture's blocks are the presence of others, which needs `bundled`; else kNone.
  std::uint8_t presence = kNone;
  /// Place of an earlier group on whose blocks the blocks of this one depend: they are sent before.
  std::uint8_t depends_on = kNone;
  /// Writes the blocks of that group on which a block of the first texture depends to `out` and
  /// returns their number; those beyond `out` count but are not written. No more are taken than the
  /// group has blocks, or 16; those that it does not have are ignored. Null without `depends_on`.
  std::size_t (*dependencies)(std::span<const std::byte> block,
                              std::span<std::uint32_t> out) = nullptr;
  /// How much a block of the first texture matters, 0 or more: higher ones are sent first, and what
  /// is pending rises with age. Null: all the same.
  float (*rank)(std::span<const std::byte> block) = nullptr;

  friend bool operator==(const TextureGroup&, const TextureGroup&) = default;
};

/// What a volume is made of. Texture ids count through the groups in order.
struct VolumeDesc {
  std::uint8_t kind = 0;  ///< Kind::id, 1..255
  std::vector<TextureGroup> groups;

  friend bool operator==(const VolumeDesc&, const VolumeDesc&) = default;
};

inline constexpr std::size_t kMaxGroups = 16;
/// Bytes of the name of a texture, a volume or a scene.
inline constexpr std::size_t kMaxName = 255;
inline constexpr std::size_t kMaxVolumeTextures = 255;
/// Bytes of a description.
inline constexpr std::size_t kMaxKindDescription = std::size_t{64} << 10;

/// A row of the table of kinds. Each function leaves layouts alone: they are no part of a
/// description.
struct Kind {
  std::uint8_t id = 0;  ///< 1..255, from 128 on the application's
  std::string_view name;
  /// Appends the description of a volume. invalid_description for one that is not of this kind;
  /// what an error left in `out` means nothing. Neither this nor `read` may be null.
  Status (*write)(const VolumeDesc& volume, std::vector<std::byte>& out) = nullptr;
  /// The volume of a description from outside, or corrupt. Names are set.
  Result<VolumeDesc> (*read)(std::span<const std::byte> description) = nullptr;
  /// Brings the records of a block into their canonical order, where order means nothing; called by
  /// producers before they publish. Null where it does.
  void (*sort)(const TextureDesc& desc, std::span<std::byte> block) = nullptr;
};

[[nodiscard]] std::span<const Kind* const> built_in_kinds() noexcept;
/// Among those built in, then `others`; nullptr if unknown. A row without `write` or `read` is
/// passed over.
[[nodiscard]] const Kind* find_kind(std::uint8_t id,
                                    std::span<const Kind* const> others = {}) noexcept;
[[nodiscard]] const Kind* find_kind(std::string_view name,
                                    std::span<const Kind* const> others = {}) noexcept;

/// True if they are the same but for layouts.
[[nodiscard]] bool same_but_layout(const VolumeDesc& a, const VolumeDesc& b) noexcept;

/// invalid_description, or unsupported_format, unless it has a kind, all textures are valid, those
/// of a group have one space and grid, names are text and occur once, and what groups say of one
/// another holds.
Status validate(const VolumeDesc& volume) noexcept;

}  // namespace gicodec
