// Dumps: one file holds one frame of one texture, or of several: parts, layers, mip levels, faces
// (gicodec(1), "Dumps"). EXR, DDS, KTX2 and raw files keep every bit. PNG, TIFF and DPX are only
// read, if each sample is an exact code. All functions throw Error. Several threads may use
// different files.
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

/// An attribute of an EXR header, a key of a KTX2 file, or a member of a sidecar, as text. UTF-8
/// strings that do not begin with 0x stay as they are, numbers are decimal, all else is 0x and the
/// hexadecimal bytes of the file.
struct Attribute {
  std::string name;
  std::string type;  ///< OpenEXR's name: "string", "int", "float", "v3f", ...; or "bytes"
  std::string value;
  friend bool operator==(const Attribute&, const Attribute&) = default;
};
using Attributes = std::vector<Attribute>;  ///< ascending by name
/// Most attributes of a file: files are compared attribute by attribute.
inline constexpr std::size_t kMaxAttributes = 4096;

[[nodiscard]] const Attribute* find_attribute(const Attributes& attributes,
                                              std::string_view name) noexcept;
/// Replaces the attribute of that name, or inserts it in order.
void set_attribute(Attributes& attributes, Attribute attribute);

/// The value of an attribute of `count` finite numbers; nullopt if there is none.
[[nodiscard]] std::optional<std::vector<float>> find_floats(const Attributes& attributes,
                                                            std::string_view name,
                                                            std::size_t count);
/// Position of the first probe, and distance of probes along each axis: v3f each.
inline constexpr const char* kOriginAttribute = "gicodec:origin";
inline constexpr const char* kSpacingAttribute = "gicodec:spacing";
/// Scene and time of tracing: a string, and a float in seconds.
inline constexpr const char* kSceneAttribute = "gicodec:scene";
inline constexpr const char* kTimeAttribute = "gicodec:time";
[[nodiscard]] Attribute time_attribute(double time);
/// Encoding of colour, if it is not the format's usual one.
inline constexpr const char* kEncodingAttribute = "gicodec:encoding";

/// The image's channels, in the order of FormatInfo::components.
struct ChannelLayout {
  std::array<SampleType, 4> types{};
  std::array<std::string, 4> names{};  ///< in the file; empty: the component's letter
  bool alpha = true;  ///< false: the image lacks a channel for the format's A component
  /// False: the format has a shared exponent, and the image holds values, HALF or FLOAT, not
  /// mantissas.
  bool exponent = true;
  friend bool operator==(const ChannelLayout& left, const ChannelLayout& right) {
    const auto count = left.alpha && left.exponent ? 4 : 3;
    return left.alpha == right.alpha && left.exponent == right.exponent &&
           left.names == right.names &&
           std::equal(left.types.begin(), left.types.begin() + count, right.types.begin());
  }
};

/// Channels for all components: HALF if it holds every code, else FLOAT, else UINT.
[[nodiscard]] ChannelLayout default_channels(Format format);
/// True if the image has a channel for a component.
[[nodiscard]] bool has_channel(const ChannelLayout& channels, const Component& component) noexcept;
/// True if a channel of a type can hold a component: its codes or, without an exponent channel, its
/// values.
[[nodiscard]] bool can_hold(const ChannelLayout& channels, SampleType type,
                            const Component& component, const Record& record) noexcept;
/// Name in the file of a component's channel.
[[nodiscard]] std::string channel_name(const ChannelLayout& channels, Format format,
                                       std::size_t component);
/// "R:HALF G:HALF B:HALF".
[[nodiscard]] std::string to_string(const ChannelLayout& channels, Format format);
/// The inverse; nullopt for any other text, or one that does not fit the format.
[[nodiscard]] std::optional<ChannelLayout> channels_from_string(std::string_view text,
                                                                Format format);

/// Removes attributes that depend on the size of the file, which is about to change. Returns the
/// names of those that do not follow from the new size.
std::vector<std::string> drop_size_fields(Attributes& attributes);

/// Where an image stands in its file. Images of one place have channels of different names.
struct ImagePlace {
  std::uint32_t part = 0;   ///< of an EXR
  std::uint32_t level = 0;  ///< mip level
  std::uint32_t face = 0;   ///< of a cube map, in the file's order
  friend auto operator<=>(const ImagePlace&, const ImagePlace&) = default;
};

/// An image's contents besides texels.
struct DumpInfo {
  TextureDesc desc;
  ChannelLayout channels;
  Attributes attributes;          ///< those that size and channels do not imply
  std::vector<std::string> lost;  ///< what is not kept, in words: "channel Z", "its metadata"
  /// The image's name in its file, unique there: "py", "mip1", "diffuse". Empty: the main one.
  std::string image = {};
  ImagePlace place = {};
  /// False: it has no attributes, since an image before it has those of the file, or part.
  bool head = true;
  bool guessed = false;    ///< its format is the 10-bit codes that its values may be
  bool fell_back = false;  ///< by Hints::plain it is not
};

struct Dump {
  DumpInfo info;
  std::vector<std::byte> texels;  ///< the texture, tightly packed, slice after slice
};

/// Replaces or adds to a file's attributes.
struct Hints {
  std::optional<TextureDesc> desc;  ///< all of it; of the fields below only `channels` then counts
  bool any_format = false;  ///< with desc: accept texture files of other formats of the same size
  /// With desc: its origin, such as "--layout rtxgi of 8x4x8 probes". Files that contradict it are
  /// refused. Empty: `desc` overrides them.
  std::string agreed = {};
  std::optional<Format> format;
  std::optional<Grid> grid;
  std::optional<std::uint16_t> core;
  std::optional<std::uint16_t> guard_band;
  std::optional<Tiling> tiling;
  std::optional<Grid> block;   ///< records, of a map_texture()
  std::optional<Grid> extent;  ///< texels, of a map_texture(); for images of stacked slices
  std::map<char, std::string>
      channels;  ///< component → the file's channel; if not empty, others are ignored
  /// With desc: the image to read; `channels` are then exactly its own.
  std::optional<ImagePlace> place;
  std::string image = {};
  bool head = true;
  /// Formats that follow from channels are floats or integers, not 10-bit codes.
  bool plain = false;
};

/// "its main image", or its name, for messages.
[[nodiscard]] std::string image_words(const DumpInfo& info);

/// Hints that demand a texture, in any format of the file; from an info also its image.
[[nodiscard]] Hints hints_of(const DumpInfo& info);
[[nodiscard]] Hints hints_of(const TextureDesc& desc);
/// An info with default_channels() and the gicodec:* attributes by which a file of this texture is
/// read without hints, if it is of probes or a map_texture().
[[nodiscard]] DumpInfo make_info(const TextureDesc& desc);
/// Sets these attributes.
void describe(Attributes& attributes, const TextureDesc& desc);

/// True if a texture can be one of kind probes.
[[nodiscard]] bool is_probes(const TextureDesc& desc) noexcept;

/// Kinds of files that are read.
enum class ImageKind : std::uint8_t { exr, png, tiff, dpx, dds, ktx2, raw };
/// True if files of that kind are also written.
[[nodiscard]] constexpr bool is_written(ImageKind kind) noexcept {
  return kind != ImageKind::png && kind != ImageKind::tiff && kind != ImageKind::dpx;
}
/// True if files of that kind can be written with texels of a format.
[[nodiscard]] bool has_format(ImageKind kind, Format format) noexcept;
/// True if EXR files can hold an attribute: OpenEXR limits names and types.
[[nodiscard]] bool exr_has_attribute(const Attribute& attribute);
/// By the number in an EXR file's attribute "compression". The first five keep all bits.
inline constexpr std::array<const char*, 10> kExrCompressions = {
    "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
/// Throws Error of Exit::bad_input for an attribute with a value that none of its type has.
void require_exr_attributes(const Attributes& attributes, const std::string& path);
/// The kind of a file by its extension: EXR if it has none; nullopt if unknown.
[[nodiscard]] std::optional<ImageKind> image_kind(const std::string& path);
/// The same; throws if unknown.
[[nodiscard]] ImageKind require_image_kind(const std::string& path);

/// Reads the header. A format that is neither in the file nor in `hints` follows from the channels.
/// With a grid the texture is of probes: the core follows from the image's size, guard band 1,
/// tiling atlas_xy_z. Without one it is a map_texture() if it is a texture file or has a block or
/// extent; blocks are 8x8x1 records by default, 4x4x4 of a 3D texture.
[[nodiscard]] std::vector<DumpInfo> read_dump_infos(const std::string& path,
                                                    const Hints& hints = {});
[[nodiscard]] std::vector<Dump> read_dumps(const std::string& path, const Hints& hints = {});
/// The same of a file with one image, or of the one that the hints name; throws if there are
/// others.
[[nodiscard]] DumpInfo read_dump_info(const std::string& path, const Hints& hints = {});
[[nodiscard]] Dump read_dump(const std::string& path, const Hints& hints = {});

/// Hints by which the files' colours are read: 10-bit codes if nothing says what they are and all
/// values of all files are such; else floats or integers as the files have them (Hints::plain).
[[nodiscard]] Hints settle_formats(std::span<const std::string> paths, Hints hints);

/// An EXR with slices below each other. Attributes set tiles, compression and line order; ZIP if
/// they name no compression or a lossy one.
[[nodiscard]] std::vector<std::byte> to_exr(std::span<const Dump> images,
                                            const std::string& path_for_messages);
/// Writes a file of the kind of its extension atomically, EXR for kinds that are only read. Writes
/// the sidecar of a raw file, unless one with the same contents exists. `images`: all of the file,
/// in its order.
void write_dumps(const std::string& path, std::span<const Dump> images,
                 Existing existing = Existing::refuse);
/// The same of one image.
void write_dump(const std::string& path, const DumpInfo& info, std::span<const std::byte> texels,
                Existing existing = Existing::refuse);

/// Size of the image with slices below each other.
[[nodiscard]] Extent image_extent(const TextureDesc& desc) noexcept;  ///< slices = 1

/// "probe", or "block" for other textures.
[[nodiscard]] const char* block_word(const TextureDesc& desc) noexcept;
/// The place of a texel, for messages.
struct TexelPlace {
  const char* word = "probe";  ///< block_word()
  std::uint32_t x = 0, y = 0;  ///< in the image
  std::uint32_t probe = 0;
  Grid position;                           ///< of the block in the grid
  std::uint32_t block_x = 0, block_y = 0;  ///< in the block, guard band included
};
[[nodiscard]] TexelPlace locate(const TextureDesc& desc, std::uint32_t x, std::uint32_t y);
/// "texel (12, 40), probe 33 (1, 2, 0)".
[[nodiscard]] std::string to_string(const TexelPlace& place);
[[nodiscard]] Grid block_position(const TextureDesc& desc, std::uint32_t probe) noexcept;

/// All files of a dump at `path`: itself, and the sidecar of a raw file.
[[nodiscard]] std::vector<std::string> files_of(const std::string& path);

/// Parses "16x8x16" or "16,8,16"; nullopt for any other text.
[[nodiscard]] std::optional<Grid> grid_from_string(std::string_view text, std::uint32_t least = 1);
[[nodiscard]] std::string to_string(const Grid& grid);

}  // namespace gicodec::tools
