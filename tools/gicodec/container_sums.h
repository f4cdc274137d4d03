// Sums over the packets of a container.
#pragma once

#include <gicodec/gicodec.h>

#include <cstdint>
#include <optional>

namespace gicodec::tools {

/// Sums of a whole container.
struct Totals {
  std::size_t frames = 0;
  std::optional<std::uint64_t> first_frame, last_frame;
  std::uint64_t packet_bytes = 0;
  /// Bytes of the full textures, or regions, of all packets; nullopt if one is of an unknown kind.
  std::optional<std::uint64_t> texture_bytes = 0;
  std::optional<std::uint64_t> file_bytes;  ///< of the dumps it was made from, if known
  std::optional<std::uint64_t> bytes;       ///< of the container, if known
  bool whole = true;                        ///< the whole container was read

  [[nodiscard]] std::optional<double> times_smaller(std::optional<std::uint64_t> than) const {
    // Counts only what was read.
    const std::uint64_t size = whole ? bytes.value_or(packet_bytes) : packet_bytes;
    if (!than || size == 0) return std::nullopt;
    return static_cast<double>(*than) / static_cast<double>(size);
  }
  [[nodiscard]] std::optional<double> bytes_per_frame() const {
    if (frames == 0) return std::nullopt;
    return static_cast<double>(packet_bytes) / static_cast<double>(frames);
  }
};

/// Number of blocks in a packet. `desc`: the texture it was made for, nullptr if the kind is
/// unknown; then nullopt if the packet holds all blocks.
[[nodiscard]] inline std::optional<std::uint64_t> blocks_in(const PacketInfo& info,
                                                            const TextureDesc* desc) {
  if (!info.all_blocks) return info.blocks;
  if (desc == nullptr) return std::nullopt;
  return block_count(*desc);
}

/// Sums over packets. A sum is nullopt if one packet's number is unknown.
struct Sums {
  std::uint64_t packets = 0, bytes = 0;
  std::uint64_t header = 0, index = 0, guard_bands = 0, payload = 0;
  std::optional<std::uint64_t> blocks = 0, full_bytes = 0, records = 0, record_bytes = 0;

  /// `desc` as in blocks_in().
  void add(const PacketInfo& info, std::uint64_t size, const TextureDesc* desc) {
    const auto count = blocks_in(info, desc);
    const auto add_to = [](auto& sum, const auto& value) {
      sum = sum && value ? std::optional(*sum + *value) : std::nullopt;
    };
    std::optional<std::uint64_t> full, own_records, own_bytes;
    if (desc != nullptr) {
      full = texture_bytes(*desc);
      if (desc->presence == Presence::all) {  // else packets do not say how many exist
        own_records = *count * record_count(desc->block);
        own_bytes = *count * block_bytes(*desc);
      }
    }
    ++packets;
    bytes += size;
    header += size - info.index_size - info.guard_band_size - info.payload_size;
    index += info.index_size;
    guard_bands += info.guard_band_size;
    payload += info.payload_size;
    add_to(blocks, count);
    add_to(full_bytes, full);
    add_to(records, own_records);
    add_to(record_bytes, own_bytes);
  }
  /// Adds packets of which the index says bytes, and `full` those of the textures of each.
  void add_listed(std::uint64_t count, std::uint64_t size, std::optional<std::uint64_t> full) {
    packets += count;
    bytes += size;
    full_bytes = full_bytes && full ? std::optional(*full_bytes + count * *full) : std::nullopt;
    blocks = records = record_bytes = std::nullopt;
  }
  [[nodiscard]] static std::optional<double> quotient(std::optional<std::uint64_t> over,
                                                      std::optional<std::uint64_t> under) {
    if (!over || under.value_or(0) == 0) return std::nullopt;
    return static_cast<double>(*over) / static_cast<double>(*under);
  }
  [[nodiscard]] auto full_ratio() const { return quotient(full_bytes, bytes); }
  [[nodiscard]] auto record_ratio() const { return quotient(record_bytes, bytes); }
  [[nodiscard]] auto bits_per_record() const { return quotient(8 * bytes, records); }
};

}  // namespace gicodec::tools
