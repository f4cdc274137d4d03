// DDS files (Microsoft, "DDS_HEADER structure" and "DDS_HEADER_DXT10 structure").
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <array>

namespace gicodec::tools {
namespace {

constexpr std::uint32_t four(const char (&code)[5]) {
  std::uint32_t word = 0;
  for (int i = 3; i >= 0; --i) word = word << 8 | static_cast<unsigned char>(code[i]);
  return word;
}
constexpr std::uint32_t kMagic = four("DDS "), kDx10 = four("DX10");
constexpr std::size_t kLegacyBytes = 128, kDx10Bytes = 148;

// Offsets of the fields.
constexpr std::size_t kSize = 4, kFlags = 8, kHeight = 12, kWidth = 16, kPitch = 20, kDepth = 24,
                      kLevels = 28, kPixelSize = 76, kPixelFlags = 80, kFourCc = 84,
                      kPixelBits = 88, kMasks = 92, kCaps = 108, kCaps2 = 112, kDxgiFormat = 128,
                      kDimension = 132, kMisc = 136, kArraySize = 140;

constexpr std::uint32_t kHasSizes = 0x1 | 0x2 | 0x4 | 0x1000;  // caps, height, width, pixel format
constexpr std::uint32_t kHasPitch = 0x8, kHasLevels = 0x20000, kHasBytes = 0x80000,
                        kHasDepth = 0x800000;
constexpr std::uint32_t kByCode = 0x4, kByMasks = 0x40, kGrey = 0x20000, kAlpha = 0x1,
                        kOnlyAlpha = 0x2;
constexpr std::uint32_t kIsTexture = 0x1000, kIsComplex = 0x8, kIsMipmap = 0x400000;
constexpr std::uint32_t kIsCube = 0x200, kAllFaces = 0xFC00, kIsVolume = 0x200000;
constexpr std::uint32_t k1D = 2, k2D = 3, k3D = 4, kMiscCube = 0x4;

struct DxgiRow {
  Format format;
  std::uint32_t dxgi;
};
constexpr std::array<DxgiRow, 49> kDxgi{{
    {Format::R32G32B32A32_SFLOAT, 2},
    {Format::R32G32B32A32_UINT, 3},
    {Format::R32G32B32_SFLOAT, 6},
    {Format::R32G32B32_UINT, 7},
    {Format::R16G16B16A16_SFLOAT, 10},
    {Format::R16G16B16A16_UNORM, 11},
    {Format::R16G16B16A16_UINT, 12},
    {Format::R16G16B16A16_SNORM, 13},
    {Format::R32G32_SFLOAT, 16},
    {Format::R32G32_UINT, 17},
    {Format::A2B10G10R10_UNORM_PACK32, 24},
    {Format::B10G11R11_UFLOAT_PACK32, 26},
    {Format::R8G8B8A8_UNORM, 28},
    {Format::R8G8B8A8_SRGB, 29},
    {Format::R8G8B8A8_UINT, 30},
    {Format::R8G8B8A8_SNORM, 31},
    {Format::R16G16_SFLOAT, 34},
    {Format::R16G16_UNORM, 35},
    {Format::R16G16_UINT, 36},
    {Format::R16G16_SNORM, 37},
    {Format::R32_SFLOAT, 41},
    {Format::R32_UINT, 42},
    {Format::R8G8_UNORM, 49},
    {Format::R8G8_UINT, 50},
    {Format::R8G8_SNORM, 51},
    {Format::R16_SFLOAT, 54},
    {Format::R16_UNORM, 56},
    {Format::R16_UINT, 57},
    {Format::R16_SNORM, 58},
    {Format::R8_UNORM, 61},
    {Format::R8_UINT, 62},
    {Format::R8_SNORM, 63},
    {Format::E5B9G9R9_UFLOAT_PACK32, 67},
    {Format::BC1_RGBA_UNORM_BLOCK, 71},
    {Format::BC1_RGBA_SRGB_BLOCK, 72},
    {Format::BC2_UNORM_BLOCK, 74},
    {Format::BC2_SRGB_BLOCK, 75},
    {Format::BC3_UNORM_BLOCK, 77},
    {Format::BC3_SRGB_BLOCK, 78},
    {Format::BC4_UNORM_BLOCK, 80},
    {Format::BC4_SNORM_BLOCK, 81},
    {Format::BC5_UNORM_BLOCK, 83},
    {Format::BC5_SNORM_BLOCK, 84},
    {Format::B8G8R8A8_UNORM, 87},
    {Format::B8G8R8A8_SRGB, 91},
    {Format::BC6H_UFLOAT_BLOCK, 95},
    {Format::BC6H_SFLOAT_BLOCK, 96},
    {Format::BC7_UNORM_BLOCK, 98},
    {Format::BC7_SRGB_BLOCK, 99},
}};

/// Codes of headers without DX10: numbers of D3DFORMAT or four characters. The first of a format is
/// what headers of ours would have.
constexpr std::array<DxgiRow, 20> kCodes{{
    {Format::R16G16B16A16_UNORM, 36},
    {Format::R16G16B16A16_SNORM, 110},
    {Format::R16_SFLOAT, 111},
    {Format::R16G16_SFLOAT, 112},
    {Format::R16G16B16A16_SFLOAT, 113},
    {Format::R32_SFLOAT, 114},
    {Format::R32G32_SFLOAT, 115},
    {Format::R32G32B32A32_SFLOAT, 116},
    {Format::BC1_RGBA_UNORM_BLOCK, four("DXT1")},
    {Format::BC2_UNORM_BLOCK, four("DXT2")},
    {Format::BC2_UNORM_BLOCK, four("DXT3")},
    {Format::BC3_UNORM_BLOCK, four("DXT4")},
    {Format::BC3_UNORM_BLOCK, four("DXT5")},
    {Format::BC4_UNORM_BLOCK, four("ATI1")},
    {Format::BC4_UNORM_BLOCK, four("BC4U")},
    {Format::BC4_SNORM_BLOCK, four("BC4S")},
    {Format::BC5_UNORM_BLOCK, four("ATI2")},
    {Format::BC5_UNORM_BLOCK, four("BC5U")},
    {Format::BC5_SNORM_BLOCK, four("BC5S")},
    {Format::R8G8B8A8_SNORM, 63},
}};

/// Headers without DX10 that describe texels by masks of R, G, B and A. Some writers swap R and B
/// of 10-bit colour; all bits are kept in any case.
struct MaskRow {
  Format format;
  std::uint32_t flags, bits;
  std::array<std::uint32_t, 4> masks;
};
constexpr std::array<MaskRow, 14> kMaskRows{{
    {Format::R8G8B8A8_UNORM, kByMasks | kAlpha, 32, {0xFF, 0xFF00, 0xFF0000, 0xFF000000}},
    {Format::B8G8R8A8_UNORM, kByMasks | kAlpha, 32, {0xFF0000, 0xFF00, 0xFF, 0xFF000000}},
    {Format::R8G8B8A8_UNORM, kByMasks, 32, {0xFF, 0xFF00, 0xFF0000, 0}},
    {Format::B8G8R8A8_UNORM, kByMasks, 32, {0xFF0000, 0xFF00, 0xFF, 0}},
    {Format::B8G8R8_UNORM, kByMasks, 24, {0xFF0000, 0xFF00, 0xFF, 0}},
    {Format::R8G8B8_UNORM, kByMasks, 24, {0xFF, 0xFF00, 0xFF0000, 0}},
    {Format::R16G16_UNORM, kByMasks, 32, {0xFFFF, 0xFFFF0000, 0, 0}},
    {Format::R8G8_UNORM, kGrey | kAlpha, 16, {0xFF, 0, 0, 0xFF00}},
    {Format::R8_UNORM, kOnlyAlpha, 8, {0, 0, 0, 0xFF}},
    {Format::R8_UNORM, kGrey, 8, {0xFF, 0, 0, 0}},
    {Format::R16_UNORM, kGrey, 16, {0xFFFF, 0, 0, 0}},
    {Format::R8_UNORM, kByMasks, 8, {0xFF, 0, 0, 0}},
    {Format::A2B10G10R10_UNORM_PACK32,
     kByMasks | kAlpha,
     32,
     {0x3FF, 0xFFC00, 0x3FF00000, 0xC0000000}},
    {Format::A2R10G10B10_UNORM_PACK32,
     kByMasks | kAlpha,
     32,
     {0x3FF00000, 0xFFC00, 0x3FF, 0xC0000000}},
}};

template <std::size_t N>
void set_format(TextureHead& head, const std::array<DxgiRow, N>& rows, std::uint32_t number) {
  const auto* row = std::ranges::find(rows, number, &DxgiRow::dxgi);
  if (row != rows.end()) head.format = row->format;
}

/// "D3D format 0x31545844 (DXT1)", or only the number.
std::string code_text(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(code >> (8 * i) & 0xFF);
  const bool letters = std::ranges::all_of(text, [](char c) { return c > ' ' && c <= '~'; });
  return fmt::format("D3D format 0x{:X}{}", code, letters ? fmt::format(" ({})", text) : "");
}

void read_legacy(std::span<const std::byte> bytes, TextureHead& head) {
  const std::uint32_t flags = word_at(bytes, kPixelFlags), code = word_at(bytes, kFourCc);
  if ((flags & kByCode) != 0) {
    head.format_name = code_text(code);
    set_format(head, kCodes, code);
    return;
  }
  head.format_name = fmt::format("pixel format of {} bits with masks", word_at(bytes, kPixelBits));
  for (std::size_t i = 0; i < 4; ++i) {
    head.format_name +=
        fmt::format("{} {} 0x{:X}", i > 0 ? "," : "", "RGBA"[i], word_at(bytes, kMasks + 4 * i));
  }
  for (const MaskRow& row : kMaskRows) {
    bool same = flags == row.flags && word_at(bytes, kPixelBits) == row.bits;
    for (std::size_t i = 0; i < row.masks.size(); ++i) {
      same = same && word_at(bytes, kMasks + 4 * i) == row.masks[i];
    }
    if (same) head.format = row.format;
  }
}

void read_dx10(std::span<const std::byte> bytes, TextureHead& head, const std::string& path) {
  const std::uint32_t dxgi = word_at(bytes, kDxgiFormat), dimension = word_at(bytes, kDimension),
                      elements = word_at(bytes, kArraySize);
  head.format_name = fmt::format("DXGI format {}", dxgi);
  set_format(head, kDxgi, dxgi);
  if (dimension < k1D || dimension > k3D || elements == 0 || (dimension == k3D && elements != 1)) {
    fail(Exit::bad_input, "{}: its DDS header is damaged: dimension {}, {} elements", path,
         dimension, elements);
  }
  head.volume = dimension == k3D;
  if (!head.volume) head.texels.z = elements;
}

/// Precondition: `bytes` begins with a complete header.
TextureHead parse(std::span<const std::byte> bytes, const std::string& path) {
  const bool dx10 = bytes.size() == kDx10Bytes;
  TextureHead head;
  head.texels = {word_at(bytes, kWidth), word_at(bytes, kHeight), 1};
  head.levels = std::max(1U, word_at(bytes, kLevels));
  head.offset = bytes.size();
  const std::uint32_t caps = word_at(bytes, kCaps2);
  if (dx10) {
    read_dx10(bytes, head, path);
    if ((word_at(bytes, kMisc) & kMiscCube) != 0) head.faces = 6;
  } else {
    read_legacy(bytes, head);
    head.volume = (caps & kIsVolume) != 0;
    // A cube without some faces has the others in order.
    if ((caps & kIsCube) != 0) head.faces = static_cast<unsigned>(std::popcount(caps & kAllFaces));
  }
  if (head.volume) head.texels.z = word_at(bytes, kDepth);
  const auto fault = [&]() -> std::string {
    if (word_at(bytes, kSize) != 124) return fmt::format("size {}", word_at(bytes, kSize));
    if (word_at(bytes, kPixelSize) != 32) {
      return fmt::format("pixel format size {}", word_at(bytes, kPixelSize));
    }
    if (head.texels.x == 0 || head.texels.y == 0 || head.texels.z == 0) {
      return fmt::format("{} texels", to_string(head.texels));
    }
    if (head.faces == 0 || (head.faces > 1 && head.volume)) return "a cube without faces, or deep";
    if (head.levels > max_levels(head)) {
      return fmt::format("{} levels of {} texels", head.levels, to_string(head.texels));
    }
    return "";
  }();
  if (!fault.empty()) fail(Exit::bad_input, "{}: its DDS header is damaged: {}", path, fault);
  return head;
}

std::size_t header_bytes(std::span<const std::byte> legacy) {
  const bool dx10 =
      (word_at(legacy, kPixelFlags) & kByCode) != 0 && word_at(legacy, kFourCc) == kDx10;
  return dx10 ? kDx10Bytes : kLegacyBytes;
}

/// The default header of a texture; empty for a format that DDS files cannot hold.
std::vector<std::byte> implied_header(const TextureHead& head, const Record& record) {
  const auto* row = std::ranges::find(kDxgi, record.format, &DxgiRow::format);
  if (row == kDxgi.end()) return {};
  const Grid& texels = head.texels;
  const Grid records = records_of(texels, record.format);
  const bool compressed = is_compressed(record.format), levels = head.levels > 1,
             cube = head.faces > 1;
  const std::uint64_t row_bytes = std::uint64_t{records.x} * record.bytes;
  std::vector<std::byte> header(kDx10Bytes);
  const auto set = [&](std::size_t at, std::uint64_t value) {
    set_word(header, at, static_cast<std::uint32_t>(value));
  };
  set(0, kMagic);
  set(kSize, 124);
  set(kFlags, kHasSizes | (compressed ? kHasBytes : kHasPitch) | (head.volume ? kHasDepth : 0) |
                  (levels ? kHasLevels : 0));
  set(kHeight, texels.y);
  set(kWidth, texels.x);
  set(kPitch, compressed ? row_bytes * records.y : row_bytes);
  set(kDepth, head.volume ? texels.z : 0);
  set(kLevels, head.levels);
  set(kPixelSize, 32);
  set(kPixelFlags, kByCode);
  set(kFourCc, kDx10);
  set(kCaps,
      kIsTexture | (head.volume || cube || levels ? kIsComplex : 0) | (levels ? kIsMipmap : 0));
  set(kCaps2, (head.volume ? kIsVolume : 0) | (cube ? kIsCube | kAllFaces : 0));
  set(kDxgiFormat, row->dxgi);
  set(kDimension, head.volume ? k3D : k2D);
  set(kMisc, cube ? kMiscCube : 0);
  set(kArraySize, head.volume ? 1 : texels.z);
  return header;
}

}  // namespace

bool dds_has_format(Format format) noexcept {
  return std::ranges::find(kDxgi, format, &DxgiRow::format) != kDxgi.end();
}

TextureHead read_dds_head(TextureFile& file) {
  const std::string& path = file.path();
  if (file.size() < 4 || word_at(file.read(0, 4), 0) != kMagic) {
    fail(Exit::bad_input, "{}: is not a DDS file", path);
  }
  const auto legacy = file.read(0, kLegacyBytes);
  const auto header = file.read(0, header_bytes(legacy));
  TextureHead head = parse(header, path);
  head.bytes = file.size() - head.offset;
  head.attributes.push_back(bytes_attribute(kDdsHeader, header));
  return head;
}

void keep_dds_header(const TextureHead& head, DumpInfo& first) {
  TextureHead own = head;
  own.texels = texels_of(first.desc);
  std::erase(first.attributes, bytes_attribute(kDdsHeader, implied_header(own, first.desc.record)));
}

std::vector<std::byte> dds_file(std::span<const Dump> images, const std::string& path) {
  const DumpInfo& first = images.front().info;
  const Record& record = first.desc.record;
  std::vector<std::byte> file;
  TextureHead head;
  if (const Attribute* kept = find_attribute(first.attributes, kDdsHeader)) {
    file = attribute_bytes(*kept, path);
    const bool whole = file.size() >= kLegacyBytes && word_at(file, 0) == kMagic &&
                       file.size() == header_bytes(file);
    if (!whole) fail(Exit::bad_input, "{}: attribute {} is damaged", path, kDdsHeader);
    head = parse(file, path);
    require_fit(head, images, kDdsHeader, path);
  } else {
    head = head_of(images, path);
    file = implied_header(head, record);
    if (file.empty()) {
      fail(Exit::bad_input, "{}: DDS files have no format {}; {}", path,
           find_format(record.format)->name, to_cure(Cure::other_files, "ktx2, exr or raw"));
    }
  }
  const std::size_t start = file.size();
  file.resize(start + static_cast<std::size_t>(all_bytes(head, record.format)));
  for (const Dump& image : images) {
    scatter(image.texels, runs_by_element(head, image.info.place, record.format),
            std::span(file).subspan(start));
  }
  return file;
}

}  // namespace gicodec::tools
