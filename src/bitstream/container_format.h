// Container layout (FORMAT.md, "Container"): entries, description and index parts.
#pragma once

#include <gicodec/container.h>
#include <gicodec/inspect.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gicodec {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'G', 'I', 'C', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::size_t kFileHeader = kMagic.size() + 4;

/// Readers skip unknown types from kSkippable on, and refuse all other unknown types.
enum class EntryType : std::uint8_t {
  description = 1,
  packet = 2,
  index = 3,
  end = 4,
  metadata = 5,
};
inline constexpr std::uint8_t kSkippable = 0x80;

inline constexpr std::size_t kEntryChecksum = 4;
/// Bytes of the end entry's body: the offset of the last index part.
inline constexpr std::size_t kEndBody = 8;
/// Bytes of the end entry: type, size, body, checksum.
inline constexpr std::size_t kEndEntry = 1 + 1 + kEndBody + kEntryChecksum;
inline constexpr std::size_t kMaxTextures = 256;
inline constexpr std::size_t kMaxVolumesOfFile = 256;

/// Appends an entry whose body is `head` and then `body`.
void append_entry(EntryType type, std::span<const std::byte> head, std::span<const std::byte> body,
                  std::vector<std::byte>& out);

/// Replaces `body` by the description entry's. invalid_description unless it reads back as given.
Status write_description(const ContainerDescription& description,
                         std::span<const Kind* const> kinds, std::vector<std::byte>& body);
Status read_description(std::span<const std::byte> body, const DecodeLimits& limits,
                        std::span<const Kind* const> kinds, ContainerDescription& description);

/// The packets that a texture may have.
struct PacketRule {
  std::uint32_t regions = 0;  ///< 0: the texture is not cut
  bool lossless = true;

  [[nodiscard]] constexpr bool has(std::uint32_t region) const noexcept {
    return regions == 0 ? region == StreamId::kWholeVolume : region < regions;
  }
};
/// One rule per texture. Allows any region for a volume of an unknown kind with regions.
[[nodiscard]] std::vector<PacketRule> packet_rules(const ContainerDescription& description);
/// The presence texture of a texture; nullopt if all its records exist, or its kind is unknown.
[[nodiscard]] std::optional<std::uint8_t> presence_texture(const ContainerDescription& description,
                                                           std::uint8_t texture) noexcept;
/// A unique number for a region of a texture.
[[nodiscard]] constexpr std::uint64_t region_key(std::uint8_t texture_id,
                                                 std::uint32_t region) noexcept {
  return std::uint64_t{texture_id} << 32 | region;
}

/// Behind every offset.
inline constexpr auto kNowhere = std::numeric_limits<std::uint64_t>::max();

/// A packet in the index.
struct SeekEntry {
  std::uint64_t frame = 0;
  std::uint64_t offset = 0;  ///< of the packet's entry, from the start of the file
  std::uint32_t region = StreamId::kWholeVolume;
  std::uint8_t texture_id = 0;
  bool keyframe = false;

  [[nodiscard]] constexpr std::uint64_t key() const noexcept {
    return region_key(texture_id, region);
  }
  friend constexpr bool operator==(const SeekEntry&, const SeekEntry&) = default;
};

/// Index parts that follow one another, counted back from a part: the run begins `gap` parts before
/// it, or before the end of the run before.
struct PartRun {
  std::uint64_t gap = 1, length = 1;
  friend constexpr bool operator==(const PartRun&, const PartRun&) = default;
};
/// Runs that a part may state.
inline constexpr std::size_t kMaxPartRuns = 8;

/// An index part as those behind it list it.
struct PartPlace {
  std::uint64_t offset = 0;  ///< of its entry
  std::uint64_t size = 0;    ///< bytes of its entry
  std::uint64_t frame = 0;   ///< of its first packet
  /// The parts before it with the keyframes on which its packets build.
  std::vector<PartRun> needs;

  [[nodiscard]] std::uint64_t end() const noexcept { return offset + size; }
};

struct IndexPart {
  std::vector<SeekEntry> packets;  ///< since the part before
  std::vector<PartRun> needs;
  std::uint64_t directory = 0;   ///< offset of the last part that lists all before it; 0: this one
  std::vector<PartPlace> parts;  ///< those from the directory on; of a directory all
};

/// The last bytes of an index part, behind the offset of its entry.
inline constexpr std::array<std::uint8_t, 8> kIndexMark{'I', 'N', 'D', 'E', 'X', 'P', 'A', 'R'};
inline constexpr std::size_t kIndexTail = 8 + kIndexMark.size();
inline constexpr std::size_t kMinSeekEntry = 5;    ///< least bytes of a packet in a part
inline constexpr std::size_t kPartPackets = 1024;  ///< least packets per part that add() writes

/// Appends the body of the part at `offset`.
void write_index_part(const IndexPart& part, std::uint64_t offset, std::vector<std::byte>& out);
/// True if `tail`, the last kIndexTail bytes of a body, belongs to the part at `offset`.
[[nodiscard]] bool is_index_tail(std::span<const std::byte> tail, std::uint64_t offset) noexcept;
/// Reads the part at `offset`. corrupt unless packets and parts are in order and before it, the
/// packets from `begin` on. It may list `most_parts`.
[[nodiscard]] Result<IndexPart> read_index_part(std::span<const std::byte> body,
                                                std::span<const PacketRule> rules,
                                                std::uint64_t begin, std::uint64_t offset,
                                                std::uint64_t most_parts = UINT64_MAX);

}  // namespace gicodec
