// Container (.gic): packets of the textures of several volumes on disk or in a pipe, with an index
// (FORMAT.md, "Container").
#pragma once

#include <gicodec/api.h>
#include <gicodec/delivery.h>
#include <gicodec/io.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace GICODEC_API gicodec {

/// Names and values of free text (UTF-8 of at most 1 MiB each), kept in order. Names are unique by
/// convention only.
using Metadata = std::vector<std::pair<std::string, std::string>>;
/// nullptr if there is no such name.
[[nodiscard]] const std::string* find_metadata(const Metadata& metadata,
                                               std::string_view name) noexcept;

/// What all text of a container has to be: no overlong forms, no surrogates, nothing above
/// U+10FFFF.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// A texture of a volume; its place in the list of all is the texture_id of its packets.
struct TextureEntry {
  std::string name;          ///< UTF-8 of 1..255 bytes, once in a volume
  TextureDesc desc;          ///< of the whole volume; nothing but its layout if !is_known()
  std::uint32_t volume = 0;  ///< place of its volume
  /// How far records may be from what was published, see error_bound.h. 0: nothing was lost;
  /// infinity: nothing is said.
  float largest_error = 0;
  Metadata metadata;
};
/// False for a texture of a volume whose kind is unknown: its packets can be copied, not decoded.
[[nodiscard]] constexpr bool is_known(const TextureEntry& texture) noexcept {
  return texture.desc.record.bytes != 0;
}

/// Textures of one kind over one or more grids or pools.
struct VolumeEntry {
  std::string name;                        ///< UTF-8 of at most 255 bytes
  std::uint8_t kind = 0;                   ///< Kind::id
  std::vector<std::byte> description;      ///< as the kind wrote it
  std::optional<VolumeGeometry> geometry;  ///< if told; over the first set's grid, if that is known
  /// Blocks of a region along each axis (RegionGrid); zeros: the volume is one region.
  Grid region{};
  std::uint32_t first_texture = 0, textures = 0;  ///< places of its textures
  Metadata metadata;
  VolumeDesc desc;  ///< what the kind read, and layouts; without sets if the kind is unknown
};

struct ContainerDescription {
  std::uint64_t epoch = 0;  ///< frames of one epoch belong to one run of the publisher; 0: not told
  SceneId scene;
  std::vector<VolumeEntry> volumes;    ///< 1..256
  std::vector<TextureEntry> textures;  ///< 1..256, those of the first volume first
  Metadata metadata;
};

/// Adds a volume and its textures, named as in `volume`; geometry, region, errors and metadata are
/// the caller's to add. Errors: unknown_kind, and those of Kind::write().
Status add_volume(ContainerDescription& description, std::string name, const VolumeDesc& volume,
                  std::span<const Kind* const> kinds = {});

/// A texture's part that has packets of its own: a region as RegionGrid counts them, or
/// StreamId::kWholeVolume in a volume that is not cut.
struct TextureRegion {
  std::uint8_t texture_id = 0;
  std::uint32_t region = StreamId::kWholeVolume;
  friend constexpr bool operator==(const TextureRegion&, const TextureRegion&) = default;
};
/// Writes a container front to back, without seeking. A call that fails changes nothing, whether
/// memory or the sink was the cause: it may be repeated, or the container finished without it.
/// After finish() every call answers out_of_order.
class ContainerWriter {
 public:
  /// Writes file header and description. `sink` must outlive the writer. invalid_description
  /// for one that could not be read again.
  [[nodiscard]] static Result<ContainerWriter> create(Sink& sink,
                                                      const ContainerDescription& description,
                                                      std::span<const Kind* const> kinds = {});
  /// Adds the packet of a frame. Frames must not decrease; within a frame a region of a texture has
  /// at most one packet. The packet's texture_id says which texture it belongs to; it may be lossy
  /// only where that one's largest error is not 0. wrong_frame; unknown_texture; unknown_region;
  /// description_mismatch for a keyframe that was not made for the region's texture
  /// (region_texture()), or the whole one, and for what is lossy where nothing may be.
  Status add(std::uint64_t frame, std::span<const std::byte> packet,
             std::uint32_t region = StreamId::kWholeVolume);
  /// Brings the index up to date, for whoever reads the file while it grows; every 1024 packets
  /// this happens by itself.
  Status flush();
  /// Writes the rest of the index and the end. Without it the file is readable, but counts as cut
  /// off or growing.
  Status finish();
  [[nodiscard]] std::uint64_t bytes_written() const noexcept;

  ContainerWriter(ContainerWriter&&) noexcept;
  ContainerWriter& operator=(ContainerWriter&&) noexcept;
  ~ContainerWriter();

 private:
  struct GICODEC_LOCAL State;
  explicit ContainerWriter(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

/// A packet as read from a container.
struct ContainerPacket {
  std::uint64_t frame = 0;
  std::uint32_t region = StreamId::kWholeVolume;  ///< see TextureRegion
  std::uint8_t texture_id = 0;
  bool keyframe = false;
  std::vector<std::byte> bytes;
};

/// Reads a container front to back, or parts of it and from keyframes on if the source can seek and
/// the index is sound. Safe on hostile bytes; a file whose tail is cut off gives every packet
/// before the cut, one that grows those that are there.
class ContainerReader {
 public:
  /// Reads header and description, and the index if the source can seek. `source` must outlive
  /// the reader. A volume of an unknown kind is no error. DecodeLimits::max_texture_bytes holds for
  /// the largest region of a texture. Errors: not_gicodec, unsupported_version, unsupported_format,
  /// truncated, corrupt, limit_exceeded.
  [[nodiscard]] static Result<ContainerReader> open(Source& source, const DecodeLimits& limits = {},
                                                    std::span<const Kind* const> kinds = {});
  [[nodiscard]] const ContainerDescription& description() const noexcept;

  /// Reads the next packet into `packet`; Status::end after the last, Status::truncated where the
  /// file was cut off or goes on to grow: everything before was sound. If the source can seek, a
  /// later call finds what was added. After any other error it stays at the end.
  [[nodiscard]] Status next(ContainerPacket& packet);

  /// From here on next() gives only packets of these; those of others that the index lists are not
  /// even read. None: all packets again. unknown_texture, unknown_region.
  Status select(std::span<const TextureRegion> wanted);

  /// True if seek() works: the source can seek, and an index was found and is sound, or the file
  /// has none yet.
  [[nodiscard]] bool seekable() const noexcept;
  /// True once the end of the container was seen, by open() if the source can seek. A file without
  /// was cut off or grows.
  [[nodiscard]] bool finished() const noexcept;
  /// Continues such that every selected region of a texture can be decoded up to `frame`: next()
  /// gives the packets of each from its last keyframe up to there on. If the file has grown beyond
  /// its index, what is new is read once.
  /// unknown_frame if the container does not have it, or is not seekable().
  Status seek(std::uint64_t frame);

  ContainerReader(ContainerReader&&) noexcept;
  ContainerReader& operator=(ContainerReader&&) noexcept;
  ~ContainerReader();

 private:
  struct GICODEC_LOCAL State;
  explicit ContainerReader(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
