// Volumes, kinds and records in words.
#pragma once

#include <gicodec/container.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// The volume's name, or its number if it has none.
[[nodiscard]] std::string volume_name(const ContainerDescription& description, std::size_t volume);
/// The text by which find_volume() finds a volume: its name if unique, else its number.
[[nodiscard]] std::string volume_choice(const ContainerDescription& description,
                                        std::size_t volume);
/// The only volume of that name, or the one of that number. Throws Error of Exit::bad_input that
/// lists all volumes if there is none.
[[nodiscard]] std::size_t find_volume(const ContainerDescription& description,
                                      const std::string& text, const std::string& path);
/// "probes", or "unknown kind 77".
[[nodiscard]] std::string kind_text(std::uint8_t kind);
/// "volume near is of kind 77, which this program does not know"; empty if it knows the kind.
[[nodiscard]] std::string unknown_kind(const ContainerDescription& description, std::size_t volume);
/// True if gi-render draws volumes of this kind: all that the library knows but plain textures.
[[nodiscard]] bool is_drawn(const VolumeEntry& volume) noexcept;
/// Why a texture cannot become a dump, with its volume and a hint; empty if it can.
[[nodiscard]] std::string no_dump(const ContainerDescription& description,
                                  const TextureEntry& texture);
/// "R16G16_SFLOAT", or for a record that an application defines "16 bytes: a 32 sfloat, b 96
/// opaque".
[[nodiscard]] std::string record_text(const Record& record);
/// "4x2x3 probes of 8x8 texels and 1 of guard band", or "blocks of 8x8".
[[nodiscard]] std::string blocks_text(const TextureDesc& desc);
/// "R16G16_SFLOAT, 64x32 in blocks of 8x8, slices_xy_z".
[[nodiscard]] std::string shape_text(const TextureDesc& desc);
/// "8x8", or "6x1x2" for deeper blocks.
[[nodiscard]] std::string block_text(const BlockShape& block);
/// "off by at most 3", "off by at most 0.01 relatively", or that the error is unknown; empty for 0.
[[nodiscard]] std::string error_text(float largest_error);
/// The inverse; infinity for any other text.
[[nodiscard]] float error_of(std::string_view text);
/// The description of a region of a texture, which its packets are made for. Precondition:
/// is_known(texture).
[[nodiscard]] TextureDesc part_of(const ContainerDescription& description,
                                  const TextureEntry& texture, std::uint32_t region);

}  // namespace gicodec::tools
