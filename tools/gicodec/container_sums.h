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
  std::uint64_t texture_bytes = 0;          ///< full textures, or regions, of all packets
  std::optional<std::uint64_t> file_bytes;  ///< of the dumps it was made from, if that is known
  std::optional<std::uint64_t> bytes;       ///< of the container

  /// A pipe's size is not known; its packets are all but a few bytes of it.
  [[nodiscard]] std::uint64_t size() const { return bytes.value_or(packet_bytes); }
  [[nodiscard]] std::optional<double> times_smaller(std::optional<std::uint64_t> than) const {
    if (!than || size() == 0) return std::nullopt;
    return static_cast<double>(*than) / static_cast<double>(size());
  }
  [[nodiscard]] std::optional<double> bytes_per_frame() const {
    if (frames == 0) return std::nullopt;
    return static_cast<double>(packet_bytes) / static_cast<double>(frames);
  }
};

/// Sums over packets.
struct Sums {
  std::uint64_t packets = 0, blocks = 0, bytes = 0;
  std::uint64_t header = 0, index = 0, guard_bands = 0, payload = 0;
  std::uint64_t full_bytes = 0, records = 0, record_bytes = 0;

  /// `desc`: what the packet was made for; nullptr where the kind is unknown.
  void add(const PacketInfo& info, std::uint64_t size, const TextureDesc* desc) {
    const std::uint64_t count =
        info.all_blocks && desc != nullptr ? block_count(*desc) : info.blocks;
    ++packets;
    blocks += count;
    bytes += size;
    header += size - info.index_size - info.guard_band_size - info.payload_size;
    index += info.index_size;
    guard_bands += info.guard_band_size;
    payload += info.payload_size;
    if (desc == nullptr) return;
    full_bytes += texture_bytes(*desc);
    records += count * record_count(desc->block);
    record_bytes += count * block_bytes(*desc);
  }
  [[nodiscard]] static std::optional<double> quotient(double over, std::uint64_t under) {
    if (under == 0) return std::nullopt;
    return over / static_cast<double>(under);
  }
  [[nodiscard]] auto full_ratio() const { return quotient(static_cast<double>(full_bytes), bytes); }
  [[nodiscard]] auto record_ratio() const {
    return quotient(static_cast<double>(record_bytes), bytes);
  }
  [[nodiscard]] auto bits_per_record() const {
    return quotient(8 * static_cast<double>(bytes), records);
  }
};

}  // namespace gicodec::tools
