// Container layout (FORMAT.md, "Container"): constants, description and seek index.
#pragma once

#include <gicodec/container.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'G', 'I', 'C', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::size_t kFileHeader = kMagic.size() + 4;

/// Record types. Readers skip unknown types from kSkippable on and refuse other unknown ones.
enum class RecordType : std::uint8_t {
  description = 1,
  packet = 2,
  index = 3,
  end = 4,
};
inline constexpr std::uint8_t kSkippable = 0x80;

inline constexpr std::size_t kRecordChecksum = 4;
/// Offset of the index record.
inline constexpr std::size_t kEndBody = 8;
/// Type, length, body, checksum.
inline constexpr std::size_t kEndRecord = 1 + 1 + kEndBody + kRecordChecksum;
inline constexpr std::size_t kMaxTextures = 256;
inline constexpr std::size_t kMaxNameBytes = 255;

Status write_description(const ContainerDescription& description, std::vector<std::byte>& out);
Status read_description(std::span<const std::byte> body, const DecodeLimits& limits,
                        ContainerDescription& description);

void write_index(std::span<const SeekEntry> index, std::vector<std::byte>& out);
/// `begin` is where the first packet's record may stand, `end` where the index record does. Offsets
/// increase from entry to entry.
Status read_index_body(std::span<const std::byte> body, std::size_t textures, std::uint64_t begin,
                       std::uint64_t end, std::vector<SeekEntry>& index);

}  // namespace gicodec
