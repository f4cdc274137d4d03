// Volumes, kinds and records of a container in words.
#pragma once

#include <gicodec/container.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// Its name, or its number if it has none.
[[nodiscard]] std::string volume_name(const ContainerDescription& description, std::size_t volume);
/// What find_volume() finds it by: its name where no other has it, else its number.
[[nodiscard]] std::string volume_choice(const ContainerDescription& description,
                                        std::size_t volume);
/// The only volume of that name, or that of the number; throws Error of Exit::bad_input that names
/// all there are if there is none.
[[nodiscard]] std::size_t find_volume(const ContainerDescription& description,
                                      const std::string& text, const std::string& path);
/// "probes", or "unknown kind 77".
[[nodiscard]] std::string kind_text(std::uint8_t kind);
/// "volume near is of kind 77, which this program does not know"; empty if it knows it.
[[nodiscard]] std::string unknown_kind(const ContainerDescription& description, std::size_t volume);
/// Whether gi-render draws it, and it is not of probes.
[[nodiscard]] bool is_drawn_alone(const VolumeEntry& volume) noexcept;
/// Why no dump can be made of a texture, which names its volume, and what can be done with it;
/// empty if one can.
[[nodiscard]] std::string no_dump(const ContainerDescription& description,
                                  const TextureEntry& texture);
/// The same for what draws and replays probes alone.
[[nodiscard]] std::string no_probes(const ContainerDescription& description,
                                    const TextureEntry& texture);
/// "R16G16_SFLOAT", or of a record of an application's own "16 bytes: a 32 sfloat, b 96 opaque".
[[nodiscard]] std::string record_text(const Record& record);
/// "8x8", or "6x1x2" of blocks that are deeper.
[[nodiscard]] std::string block_text(const BlockShape& block);
/// "off by at most 3", or "0.01 relatively", or that nothing is said; empty for 0, where nothing
/// was lost.
[[nodiscard]] std::string error_text(float largest_error);
/// The inverse; infinity if that is not what a text says.
[[nodiscard]] float error_of(std::string_view text);
/// The texture that the packets of a region are made for. Precondition: is_known(texture).
[[nodiscard]] TextureDesc part_of(const ContainerDescription& description,
                                  const TextureEntry& texture, std::uint32_t region);

}  // namespace gicodec::tools
