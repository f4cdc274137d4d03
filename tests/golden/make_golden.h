// What the parts of make_golden share.
#pragma once

#include "golden/golden.h"

#include <span>
#include <string>
#include <string_view>

namespace gicodec::golden {

/// Ends the program unless it is ok.
void must(Status status);
/// Writes a file into the folder that main() was given.
void save(const std::string& name, std::span<const std::byte> bytes);

/// A container of the first `most` textures of sequence_textures().
[[nodiscard]] test::Bytes sequence(std::string_view backend, std::uint32_t frames,
                                   std::size_t most);
/// A keyframe of index_blocks(mode).
[[nodiscard]] Packet index_packet(std::string_view mode, std::string_view backend = "raw");
/// With another byte, and unless `sealed` is false the checksum of that.
[[nodiscard]] Packet changed(Packet packet, std::size_t at, int value, bool sealed = true);

void save_damaged_packets();     ///< bad_*.packet
void save_damaged_containers();  ///< *.gic but for sequences, native and volumes

}  // namespace gicodec::golden
