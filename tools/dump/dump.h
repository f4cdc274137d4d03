// Dumps: one file holds one frame of one texture (docs: gicodec(1), "Dumps"). EXR, DDS, KTX2 and
// raw files keep every bit; PNG, TIFF and DPX are read where each sample is an exact code.
// Everything here throws Error. Independent files may be used by different threads.
#pragma once

#include "dump/file.h"
#include "dump/sample.h"

#include <gicodec/texture.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// An attribute of an EXR header, a key of a KTX2 file, or a member of a sidecar as text that gives
/// back the same: strings as they are if they are UTF-8 and do not begin with 0x, numbers in
/// decimal, everything else as hexadecimal of its bytes in the file, behind 0x.
struct Attribute {
  std::string name;
  std::string type;  ///< OpenEXR's name: "string", "int", "float", "v3f", ...; or "bytes"
  std::string value;
  friend bool operator==(const Attribute&, const Attribute&) = default;
};
using Attributes = std::vector<Attribute>;  ///< ascending by name
/// Of one file. More are refused, since files are compared attribute by attribute.
inline constexpr std::size_t kMaxAttributes = 4096;

[[nodiscard]] const Attribute* find_attribute(const Attributes& attributes,
                                              std::string_view name) noexcept;
/// Replaces the attribute of that name or inserts it in order.
void set_attribute(Attributes& attributes, Attribute attribute);

/// The value of an attribute of `count` finite numbers; nullopt if there is none.
[[nodiscard]] std::optional<std::vector<float>> find_floats(const Attributes& attributes,
                                                            std::string_view name,
                                                            std::size_t count);
/// Where the first probe stands, and how far apart they are: v3f each.
inline constexpr const char* kOriginAttribute = "gicodec:origin";
inline constexpr const char* kSpacingAttribute = "gicodec:spacing";
/// Where and when it was traced: a string, and a float of seconds.
inline constexpr const char* kSceneAttribute = "gicodec:scene";
inline constexpr const char* kTimeAttribute = "gicodec:time";
[[nodiscard]] Attribute time_attribute(double time);
/// How colour is stored, where that is not usual of its format.
inline constexpr const char* kEncodingAttribute = "gicodec:encoding";

/// The image's channels, in the order of FormatInfo::components.
struct ChannelLayout {
  std::array<SampleType, 4> types{};
  std::array<std::string, 4> names{};  ///< in the file; empty: the component's letter
  bool alpha = true;  ///< false: the format has an A component, the image has no channel for it
  /// False: the format has an exponent that others share, and the image the values of these as HALF
  /// or FLOAT instead of mantissas.
  bool exponent = true;
  friend bool operator==(const ChannelLayout& left, const ChannelLayout& right) {
    const auto count = left.alpha && left.exponent ? 4 : 3;
    return left.alpha == right.alpha && left.exponent == right.exponent &&
           left.names == right.names &&
           std::equal(left.types.begin(), left.types.begin() + count, right.types.begin());
  }
};

/// HALF where that holds every code, else FLOAT, else UINT; alpha included.
[[nodiscard]] ChannelLayout default_channels(Format format);
/// Whether the image has a channel of its own for a component.
[[nodiscard]] bool has_channel(const ChannelLayout& channels, const Component& component) noexcept;
/// Whether a channel of a type can hold a component, as its codes or, without an exponent, its
/// values.
[[nodiscard]] bool can_hold(const ChannelLayout& channels, SampleType type,
                            const Component& component, const Record& record) noexcept;
/// What the channel of a component is called in the file.
[[nodiscard]] std::string channel_name(const ChannelLayout& channels, Format format,
                                       std::size_t component);
/// "R:HALF G:HALF B:HALF".
[[nodiscard]] std::string to_string(const ChannelLayout& channels, Format format);
/// The inverse; nullopt for text that is no such list or does not fit the format.
[[nodiscard]] std::optional<ChannelLayout> channels_from_string(std::string_view text,
                                                                Format format);

/// Takes away what follows from the size of a file: it is to be cut or made larger.
void drop_size_fields(Attributes& attributes);

/// What an image says besides its texels.
struct DumpInfo {
  TextureDesc desc;
  ChannelLayout channels;
  Attributes attributes;             ///< everything in the head that size and channels do not imply
  std::vector<std::string> dropped;  ///< names of attributes of types that are not kept: pictures
                                     ///< and types unknown to OpenEXR
  std::vector<std::string> unused;   ///< names of channels that Hints::channels passes over
};

struct Dump {
  DumpInfo info;
  std::vector<std::byte> texels;  ///< the texture, tightly packed, slices one after another
};

/// Replaces or supplies what the attributes of a file say.
struct Hints {
  std::optional<TextureDesc> desc;  ///< all of it; the fields below but channels do not count then
  bool any_format = false;  ///< with desc: texture files of other formats with as many bytes, too
  /// With desc: whose it is, such as "--layout rtxgi of 8x4x8 probes"; files that say otherwise are
  /// refused. Empty: they are wrong.
  std::string agreed = {};
  std::optional<Format> format;
  std::optional<Grid> grid;
  std::optional<std::uint16_t> core;
  std::optional<std::uint16_t> guard_band;
  std::optional<Tiling> tiling;
  std::optional<Grid> block;   ///< of a map_texture()
  std::optional<Grid> extent;  ///< of such a texture, in texels; for images of stacked slices
  std::map<char, std::string> channels;  ///< component to the file's channel; if not empty, others
                                         ///< are not looked at
};

/// A texture as a hint, whatever format a file tells; of an info also its channels' names.
[[nodiscard]] Hints hints_of(const DumpInfo& info);
[[nodiscard]] Hints hints_of(const TextureDesc& desc);
/// default_channels() and the gicodec:* attributes that make a file of this texture readable
/// without hints, if it is one of probes or a map_texture().
[[nodiscard]] DumpInfo make_info(const TextureDesc& desc);
/// Sets those attributes.
void describe(Attributes& attributes, const TextureDesc& desc);

/// Whether a texture is one of kind probes.
[[nodiscard]] bool is_probes(const TextureDesc& desc) noexcept;

/// What is read, by the ending of a file's name; no ending stands for EXR, nullopt for all others.
enum class ImageKind : std::uint8_t { exr, png, tiff, dpx, dds, ktx2, raw };
/// Whether files of that kind are written: those that hold every texture.
[[nodiscard]] constexpr bool is_written(ImageKind kind) noexcept {
  return kind != ImageKind::png && kind != ImageKind::tiff && kind != ImageKind::dpx;
}
/// Whether files of that kind can have texels of a format; of those that are only read, none.
[[nodiscard]] bool has_format(ImageKind kind, Format format) noexcept;
/// Whether EXR files can have an attribute: not of each name and type.
[[nodiscard]] bool exr_has_attribute(const Attribute& attribute);
[[nodiscard]] std::optional<ImageKind> image_kind(const std::string& path);
/// Throws for those others.
[[nodiscard]] ImageKind require_image_kind(const std::string& path);

/// Reads the header only. Missing and not in `hints`: the format follows from the channels. With a
/// grid the texture is one of probes: the core size follows from the image's size, guard band 1,
/// tiling atlas_xy_z. Else it is a map_texture(), if it is a texture file, or a block or an extent
/// is known: of 8x8x1 records a block, or 4x4x4 of a 3D texture.
[[nodiscard]] DumpInfo read_dump_info(const std::string& path, const Hints& hints = {});
[[nodiscard]] Dump read_dump(const std::string& path, const Hints& hints = {});

/// A scanline EXR with the slices of the texture one below the other. Compression and line order
/// are those of the attributes; ZIP if there is none or if it would lose bits.
[[nodiscard]] std::vector<std::byte> to_exr(const DumpInfo& info, std::span<const std::byte> texels,
                                            const std::string& path_for_messages);
/// What its ending says, written atomically, and the sidecar of a raw file; EXR for images that are
/// read alone. A sidecar that is there already and says the same stays.
void write_dump(const std::string& path, const DumpInfo& info, std::span<const std::byte> texels,
                Existing existing = Existing::refuse);

/// Size of the image: slices one below the other.
[[nodiscard]] Extent image_extent(const TextureDesc& desc) noexcept;  ///< slices = 1

/// "probe", or "block" of a texture of another kind.
[[nodiscard]] const char* block_word(const TextureDesc& desc) noexcept;
/// A texel in words: the block that holds it, a probe's or another.
struct TexelPlace {
  const char* word = "probe";  ///< block_word()
  std::uint32_t x = 0, y = 0;  ///< in the image
  std::uint32_t probe = 0;
  Grid position;                           ///< of the probe in the grid
  std::uint32_t block_x = 0, block_y = 0;  ///< in the probe's block, guard band included
};
[[nodiscard]] TexelPlace locate(const TextureDesc& desc, std::uint32_t x, std::uint32_t y);
/// "texel (12, 40), probe 33 (1, 2, 0)".
[[nodiscard]] std::string to_string(const TexelPlace& place);
[[nodiscard]] Grid block_position(const TextureDesc& desc, std::uint32_t probe) noexcept;

/// All files that a dump at `path` may consist of: it, and its sidecar if it is raw.
[[nodiscard]] std::vector<std::string> files_of(const std::string& path);

/// "16x8x16" or "16,8,16" as a grid; nullopt for anything else.
[[nodiscard]] std::optional<Grid> grid_from_string(std::string_view text, std::uint32_t least = 1);
[[nodiscard]] std::string to_string(const Grid& grid);

}  // namespace gicodec::tools
