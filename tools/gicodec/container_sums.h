// What the packets of a container add up to.
#pragma once

#include <gicodec/gicodec.h>

#include <cstdint>
#include <optional>

namespace gicodec::tools {

/// Of the whole container.
struct Totals {
  std::size_t frames = 0;
  std::optional<std::uint64_t> first_frame, last_frame;
  std::uint64_t packet_bytes = 0;
  /// Full textures, or regions, of all packets; not known if one is of an unknown kind.
  std::optional<std::uint64_t> texture_bytes = 0;
  std::optional<std::uint64_t> file_bytes;  ///< of the dumps it was made from, if that is known
  std::optional<std::uint64_t> bytes;       ///< of the container, if that is known
  bool whole = true;                        ///< all of the container was read

  [[nodiscard]] std::optional<double> times_smaller(std::optional<std::uint64_t> than) const {
    // What was not read does not count.
    const std::uint64_t size = whole ? bytes.value_or(packet_bytes) : packet_bytes;
    if (!than || size == 0) return std::nullopt;
    return static_cast<double>(*than) / static_cast<double>(size);
  }
  [[nodiscard]] std::optional<double> bytes_per_frame() const {
    if (frames == 0) return std::nullopt;
    return static_cast<double>(packet_bytes) / static_cast<double>(frames);
  }
};

/// Blocks in a packet. `desc`: what it was made for; nullptr where the kind is unknown, and with it
/// how many "all" are.
[[nodiscard]] inline std::optional<std::uint64_t> blocks_in(const PacketInfo& info,
                                                            const TextureDesc* desc) {
  if (!info.all_blocks) return info.blocks;
  if (desc == nullptr) return std::nullopt;
  return block_count(*desc);
}

/// Sums over packets. What one of them does not tell is not known.
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
      if (desc->presence == Presence::all) {  // Else packets do not tell how many exist.
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
