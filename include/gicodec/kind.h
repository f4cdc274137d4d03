// Kinds: the texture groups of a volume, what their bytes mean, and how a volume is described to
// receivers. Built in: probes, irradiance vectors, textures, irradiance maps, photons, AO points,
// voxels. Applications may add kinds (ids 128..255).
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

/// How two blocks of a texture are compared.
enum class Threshold : std::uint8_t {
  components = 0,  ///< by codes of unorm, snorm, uint and exponents; floats relatively
  exact = 1,       ///< bit by bit
};

/// How a tool draws a texture.
enum class Preview : std::uint8_t { none = 0, color = 1, distance = 2, direction = 3 };

/// A texture of a group.
struct NamedTexture {
  std::string name;  ///< UTF-8 of 1..255 bytes, unique in its volume
  TextureDesc desc;
  Threshold threshold = Threshold::components;
  Preview preview = Preview::none;

  friend bool operator==(const NamedTexture&, const NamedTexture&) = default;
};

/// A texture group: textures over one grid or pool.
struct TextureGroup {
  static constexpr std::uint8_t kNone = 255;

  std::vector<NamedTexture> textures;  ///< all of the same space and grid
  /// The textures are bundled: a block is selected, budgeted, sent and proved in all or in none.
  bool bundled = false;
  /// 0: the first texture's blocks are the presence of others; requires `bundled`. Else kNone.
  std::uint8_t presence = kNone;
  /// Index of an earlier group, or kNone. Blocks of this group depend on blocks of that one, which
  /// are sent first.
  std::uint8_t depends_on = kNone;
  /// Writes the dependencies of a block of the first texture, block indices of group `depends_on`,
  /// to `out`, and returns their number; those beyond `out` count but are not written. The caller
  /// uses at most 16, or as many as that group has blocks, and ignores indices out of range. Null
  /// without `depends_on`.
  std::size_t (*dependencies)(std::span<const std::byte> block,
                              std::span<std::uint32_t> out) = nullptr;
  /// Priority of a block of the first texture, 0 or more: higher ones are sent first, and that of a
  /// pending block rises with age. Null: all are equal.
  float (*rank)(std::span<const std::byte> block) = nullptr;

  friend bool operator==(const TextureGroup&, const TextureGroup&) = default;
};

/// The texture groups of a volume. Texture ids count through the groups in order.
struct VolumeDesc {
  std::uint8_t kind = 0;  ///< Kind::id, 1..255
  std::vector<TextureGroup> groups;

  friend bool operator==(const VolumeDesc&, const VolumeDesc&) = default;
};

/// The textures of a volume in the order of their ids, pointers into it. Throws std::bad_alloc.
[[nodiscard]] std::vector<const NamedTexture*> textures_of(const VolumeDesc& volume);
std::vector<const NamedTexture*> textures_of(const VolumeDesc&& volume) = delete;

inline constexpr std::size_t kMaxGroups = 16;
/// Most bytes of the name of a texture, a volume or a scene.
inline constexpr std::size_t kMaxName = 255;
inline constexpr std::size_t kMaxVolumeTextures = 255;
/// Most bytes of a description.
inline constexpr std::size_t kMaxKindDescription = std::size_t{64} << 10;

/// How a kind describes its volumes. Descriptions do not hold layouts. Functions must be callable
/// by several threads.
struct Kind {
  std::uint8_t id = 0;  ///< 1..127 the library's, 128..255 the application's
  std::string_view name;
  /// Appends the description of a volume to `out`. invalid_description if the volume is not of this
  /// kind; `out` is then unspecified. Must not be null.
  Status (*write)(const VolumeDesc& volume, std::vector<std::byte>& out) = nullptr;
  /// Reads an untrusted description into a volume with names; corrupt. Must not be null.
  Result<VolumeDesc> (*read)(std::span<const std::byte> description) = nullptr;
  /// Sorts the records of a block into their canonical order. Publishers call it for
  /// Model::unordered. Null if the kind has no such texture.
  void (*sort)(const TextureDesc& desc, std::span<std::byte> block) = nullptr;
};

/// The library's kinds; static storage.
[[nodiscard]] std::span<const Kind* const> built_in_kinds() noexcept;
/// Searches the built-in kinds, then `others`. nullptr if unknown, or without `write` or `read`.
[[nodiscard]] const Kind* find_kind(std::uint8_t id,
                                    std::span<const Kind* const> others = {}) noexcept;
[[nodiscard]] const Kind* find_kind(std::string_view name,
                                    std::span<const Kind* const> others = {}) noexcept;

/// True if the volumes differ in nothing but layouts.
[[nodiscard]] bool same_but_layout(const VolumeDesc& a, const VolumeDesc& b) noexcept;

/// ok if the volume has a kind, all textures are valid, those of a group have one space and grid,
/// names are valid and unique, and `bundled`, `presence` and `depends_on` are consistent. Else
/// invalid_description, unsupported_format or limit_exceeded.
Status validate(const VolumeDesc& volume) noexcept;
/// Why not, as that of a texture. A volume without one may still be none of its kind's.
[[nodiscard]] std::string_view problem(const VolumeDesc& volume) noexcept;

}  // namespace gicodec
