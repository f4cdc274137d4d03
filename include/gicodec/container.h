// Container (.gic): packets of the textures of several volumes in a file or a pipe, with a seek
// index (FORMAT.md, "Container").
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

/// Pairs of name and value, in order; UTF-8 of at most 1 MiB each. Names should be unique.
using Metadata = std::vector<std::pair<std::string, std::string>>;
/// The value of the first entry of that name; nullptr if there is none.
[[nodiscard]] const std::string* find_metadata(const Metadata& metadata,
                                               std::string_view name) noexcept;

/// True for well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF. All text
/// of a container must be.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// A texture of a volume. Its index in ContainerDescription::textures is its packets' texture_id.
struct TextureEntry {
  std::string name;          ///< UTF-8 of 1..255 bytes, unique in its volume
  TextureDesc desc;          ///< of the whole volume; only the layout is set if !is_known()
  std::uint32_t volume = 0;  ///< index in ContainerDescription::volumes
  /// Largest error of decoded records, see error_bound.h. 0: lossless; infinity: unknown.
  float largest_error = 0;
  Metadata metadata;
};
/// False if the kind of the texture's volume is unknown: packets can be copied but not decoded.
[[nodiscard]] constexpr bool is_known(const TextureEntry& texture) noexcept {
  return texture.desc.record.bytes != 0;
}

/// A volume: textures of one kind over one or more grids or pools.
struct VolumeEntry {
  std::string name;                        ///< UTF-8 of at most 255 bytes
  std::uint8_t kind = 0;                   ///< Kind::id
  std::vector<std::byte> description;      ///< written by the kind
  std::optional<VolumeGeometry> geometry;  ///< over the first texture group's grid; none if unknown
  /// Blocks of a region along each axis (RegionGrid); zeros: the volume is not cut into regions.
  Grid region{};
  std::uint32_t first_texture = 0, textures = 0;  ///< indices of its textures
  Metadata metadata;
  VolumeDesc desc;  ///< `description` as read, with layouts; no groups if the kind is unknown
};

/// The volumes and textures of a container. All text is UTF-8.
struct ContainerDescription {
  std::uint64_t epoch = 0;  ///< the publisher's run that frames belong to; 0: unknown
  SceneId scene;
  std::vector<VolumeEntry> volumes;    ///< 1..256
  std::vector<TextureEntry> textures;  ///< 1..256, in the order of volumes
  Metadata metadata;
};

/// Adds a volume and its textures, named as in `volume`. The caller adds geometry, region, errors
/// and metadata. Errors: unknown_kind, and those of Kind::write().
Status add_volume(ContainerDescription& description, std::string name, const VolumeDesc& volume,
                  std::span<const Kind* const> kinds = {});

/// The part of a texture that a packet belongs to: a region by its number in RegionGrid, or
/// StreamId::kWholeVolume of a texture that is not cut.
struct TextureRegion {
  std::uint8_t texture_id = 0;
  std::uint32_t region = StreamId::kWholeVolume;
  friend constexpr bool operator==(const TextureRegion&, const TextureRegion&) = default;
};

/// The parts of a volume's textures that have blocks of the box from `first` to `last`, both
/// included, of its first group's grid; of textures over other grids, and of those that are not
/// cut, all. Empty for an unknown volume. Throws std::bad_alloc.
[[nodiscard]] std::vector<TextureRegion> parts_in_box(const ContainerDescription& description,
                                                      std::uint32_t volume, const Grid& first,
                                                      const Grid& last);

/// Writes a container front to back, without seeking. A failed call changes nothing: the caller may
/// repeat it or go on without it. After finish() every call answers out_of_order. One thread at a
/// time.
class ContainerWriter {
 public:
  /// Writes file header and description. `sink` must outlive the writer. invalid_description if a
  /// reader would refuse it.
  [[nodiscard]] static Result<ContainerWriter> create(Sink& sink,
                                                      const ContainerDescription& description,
                                                      std::span<const Kind* const> kinds = {});
  /// Adds metadata of a texture that is long or changes from frame to frame: it is packed, and read
  /// on demand, so that descriptions stay small. At most 64 MiB of all textures together; before
  /// the first packet, by ascending texture_id. Errors: out_of_order; unknown_texture;
  /// invalid_description for a text that is not UTF-8; limit_exceeded.
  Status add_metadata(std::uint8_t texture_id, const Metadata& metadata);
  /// Adds a packet to a frame. Frames must not decrease; a region of a texture has at most one
  /// packet per frame. The packet's own texture_id names its texture.
  /// Errors: wrong_frame; unknown_texture; unknown_region; description_mismatch for a keyframe that
  /// was made for another texture than region_texture() or the whole one, or for a lossy packet of
  /// a texture whose largest_error is 0.
  Status add(std::uint64_t frame, std::span<const std::byte> packet,
             std::uint32_t region = StreamId::kWholeVolume);
  /// Writes the index of all packets so far, for programs that read the file while it grows. add()
  /// does so by itself every 1024 packets.
  Status flush();
  /// Writes the rest of the index and the end mark. A file without it is readable, but counts as
  /// cut off or growing.
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

/// What the index lists of a texture, or of a region of one that is cut.
struct ListedPart {
  TextureRegion part;
  std::uint64_t first_frame = 0, last_frame = 0;
  std::uint64_t packets = 0, keyframes = 0;
  std::uint64_t bytes = 0, keyframe_bytes = 0;  ///< in the file, of what surrounds packets too
};

/// The version that a container's first bytes name.
struct ContainerVersion {
  static constexpr std::size_t kBytes = 10;  ///< where it ends
  std::uint8_t major = 0;                    ///< this library reads kContainerMajor
  std::uint8_t minor = 0;
};
/// Also of one that this library does not read. Errors: truncated, not_gicodec.
[[nodiscard]] Result<ContainerVersion> container_version(std::span<const std::byte> head) noexcept;

/// Reads a container front to back. If the source can seek and the index is sound, it can also read
/// selected textures, and from any frame on. Of a file that was cut off or is growing it reads all
/// packets before the end. Safe on hostile bytes. One thread at a time.
class ContainerReader {
 public:
  /// Reads header and description, and the index if the source can seek. `source` must outlive the
  /// reader. A volume of an unknown kind is no error. DecodeLimits::max_texture_bytes applies to
  /// the largest region of a texture. Errors: not_gicodec, unsupported_version, unsupported_format,
  /// truncated, corrupt, limit_exceeded.
  [[nodiscard]] static Result<ContainerReader> open(Source& source, const DecodeLimits& limits = {},
                                                    std::span<const Kind* const> kinds = {});
  [[nodiscard]] const ContainerDescription& description() const noexcept;

  /// What ContainerWriter::add_metadata() added of a texture; empty if it added nothing. Reads as
  /// far as the first packet. unknown_texture; limit_exceeded if more than
  /// DecodeLimits::max_metadata_bytes are said to be there, before any are allocated.
  [[nodiscard]] Result<Metadata> metadata(std::uint8_t texture_id);

  /// Reads the next packet into `packet`. Status::end after the last one. Status::truncated if the
  /// file was cut off or is growing: all packets before are sound, and if the source can seek, a
  /// later call finds what was added. After any other error only seek() goes on.
  [[nodiscard]] Status next(ContainerPacket& packet);
  /// The frame of the packet that next() will give, or one before it, if the index says it.
  [[nodiscard]] std::optional<std::uint64_t> next_frame() noexcept;

  /// Limits next() to packets of these; it skips others without reading them if the index lists
  /// them. Empty: all packets. Errors: unknown_texture, unknown_region.
  Status select(std::span<const TextureRegion> wanted);

  /// True if seek() works: the source can seek, and the index is sound or not yet written.
  [[nodiscard]] bool seekable() const noexcept;
  /// True once the reader found the end mark; open() finds it if the source can seek. A file
  /// without one was cut off or is growing.
  [[nodiscard]] bool finished() const noexcept;
  /// Moves next() to where decoding has to begin for `frame`. Of each selected region of a texture,
  /// next() then gives the last keyframe that is not after `frame`, and all packets behind it.
  /// First reads the part of a growing file that its index does not list yet. unknown_frame if the
  /// container has no such frame or is not seekable().
  Status seek(std::uint64_t frame);
  /// The numbers of all frames, ascending, as seek() takes them. unknown_frame unless seekable().
  [[nodiscard]] Result<std::vector<std::uint64_t>> frames();
  /// What the index lists, by texture and region; reads no packets but those of a growing file that
  /// its index does not list yet. unknown_frame unless seekable().
  [[nodiscard]] Result<std::vector<ListedPart>> listed();

  ContainerReader(ContainerReader&&) noexcept;
  ContainerReader& operator=(ContainerReader&&) noexcept;
  ~ContainerReader();

 private:
  struct GICODEC_LOCAL State;
  explicit ContainerReader(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
