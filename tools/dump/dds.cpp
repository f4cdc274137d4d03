// DDS files (Microsoft, "DDS_HEADER structure" and "DDS_HEADER_DXT10 structure").
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
constexpr std::uint32_t kHasPitch = 0x8, kHasBytes = 0x80000, kHasDepth = 0x800000;
constexpr std::uint32_t kByCode = 0x4, kByMasks = 0x40, kGrey = 0x20000, kAlpha = 0x1;
constexpr std::uint32_t kIsTexture = 0x1000, kIsComplex = 0x8, kIsCube = 0x200,
                        kIsVolume = 0x200000;
constexpr std::uint32_t k1D = 2, k2D = 3, k3D = 4, kMiscCube = 0x4;

struct DxgiRow {
  Format format;
  std::uint32_t dxgi;
};
constexpr std::array<DxgiRow, 25> kDxgi{{
    {Format::R32G32B32A32_SFLOAT, 2},
    {Format::R32G32B32_SFLOAT, 6},
    {Format::R16G16B16A16_SFLOAT, 10},
    {Format::R16G16B16A16_UNORM, 11},
    {Format::R32G32_SFLOAT, 16},
    {Format::A2B10G10R10_UNORM_PACK32, 24},
    {Format::B10G11R11_UFLOAT_PACK32, 26},
    {Format::R8G8B8A8_UNORM, 28},
    {Format::R8G8B8A8_UINT, 30},
    {Format::R8G8B8A8_SNORM, 31},
    {Format::R16G16_SFLOAT, 34},
    {Format::R32_SFLOAT, 41},
    {Format::R32_UINT, 42},
    {Format::R8G8_UNORM, 49},
    {Format::R16_SFLOAT, 54},
    {Format::R16_UNORM, 56},
    {Format::R16_UINT, 57},
    {Format::R8_UNORM, 61},
    {Format::R8_UINT, 62},
    {Format::E5B9G9R9_UFLOAT_PACK32, 67},
    {Format::B8G8R8A8_UNORM, 87},
    {Format::BC6H_UFLOAT_BLOCK, 95},
    {Format::BC6H_SFLOAT_BLOCK, 96},
    {Format::BC7_UNORM_BLOCK, 98},
    {Format::BC7_SRGB_BLOCK, 99},
}};

/// Numbers of D3DFORMAT, which may stand in place of a four-character code.
constexpr std::array<DxgiRow, 7> kD3d{{
    {Format::R16G16B16A16_UNORM, 36},
    {Format::R16_SFLOAT, 111},
    {Format::R16G16_SFLOAT, 112},
    {Format::R16G16B16A16_SFLOAT, 113},
    {Format::R32_SFLOAT, 114},
    {Format::R32G32_SFLOAT, 115},
    {Format::R32G32B32A32_SFLOAT, 116},
}};

/// Headers without DX10 that describe texels by masks of R, G, B and A. Some writers swap R and B
/// of 10-bit colour; all bits are kept in any case.
struct MaskRow {
  Format format;
  std::uint32_t flags, bits;
  std::array<std::uint32_t, 4> masks;
};
constexpr std::array<MaskRow, 7> kMaskRows{{
    {Format::R8G8B8A8_UNORM, kByMasks | kAlpha, 32, {0xFF, 0xFF00, 0xFF0000, 0xFF000000}},
    {Format::B8G8R8A8_UNORM, kByMasks | kAlpha, 32, {0xFF0000, 0xFF00, 0xFF, 0xFF000000}},
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
    set_format(head, kD3d, code);
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
  head.offset = bytes.size();
  const bool cube =
      (word_at(bytes, kCaps2) & kIsCube) != 0 || (dx10 && (word_at(bytes, kMisc) & kMiscCube) != 0);
  if (cube) {
    fail(Exit::bad_input, "{}: is a cube map; write its faces as a texture array", path);
  }
  if (const std::uint32_t levels = word_at(bytes, kLevels); levels > 1) {
    fail(Exit::bad_input, "{}: has {} mipmaps; write it with one level, as texconv -m 1 does", path,
         levels);
  }
  if (dx10) {
    read_dx10(bytes, head, path);
  } else {
    read_legacy(bytes, head);
    head.volume = (word_at(bytes, kCaps2) & kIsVolume) != 0;
  }
  if (head.volume) head.texels.z = word_at(bytes, kDepth);
  if (word_at(bytes, kSize) != 124 || word_at(bytes, kPixelSize) != 32 || head.texels.x == 0 ||
      head.texels.y == 0 || head.texels.z == 0) {
    fail(Exit::bad_input, "{}: its DDS header is damaged", path);
  }
  return head;
}

std::size_t header_bytes(std::span<const std::byte> legacy) {
  const bool dx10 =
      (word_at(legacy, kPixelFlags) & kByCode) != 0 && word_at(legacy, kFourCc) == kDx10;
  return dx10 ? kDx10Bytes : kLegacyBytes;
}

/// The default header of a texture; empty for a format that DDS files cannot hold.
std::vector<std::byte> implied_header(const TextureDesc& desc) {
  const auto* row = std::ranges::find(kDxgi, desc.record.format, &DxgiRow::format);
  if (row == kDxgi.end()) return {};
  const Grid texels = texels_of(desc);
  const bool volume = is_volume(desc), compressed = texels_of_record(desc.record.format) > 1;
  const std::uint64_t row_bytes = extent(desc).width * desc.record.bytes;
  std::vector<std::byte> header(kDx10Bytes);
  const auto set = [&](std::size_t at, std::uint64_t value) {
    set_word(header, at, static_cast<std::uint32_t>(value));
  };
  set(0, kMagic);
  set(kSize, 124);
  set(kFlags, kHasSizes | (compressed ? kHasBytes : kHasPitch) | (volume ? kHasDepth : 0));
  set(kHeight, texels.y);
  set(kWidth, texels.x);
  set(kPitch, compressed ? row_bytes * extent(desc).height : row_bytes);
  set(kDepth, volume ? texels.z : 0);
  set(kLevels, 1);
  set(kPixelSize, 32);
  set(kPixelFlags, kByCode);
  set(kFourCc, kDx10);
  set(kCaps, kIsTexture | (volume ? kIsComplex : 0));
  set(kCaps2, volume ? kIsVolume : 0);
  set(kDxgiFormat, row->dxgi);
  set(kDimension, volume ? k3D : k2D);
  set(kArraySize, volume ? 1 : texels.z);
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

void drop_implied_dds(DumpInfo& info) {
  const Attribute implied = bytes_attribute(kDdsHeader, implied_header(info.desc));
  std::erase(info.attributes, implied);
}

std::vector<std::byte> dds_head(const DumpInfo& info, const std::string& path) {
  const Attribute* kept = find_attribute(info.attributes, kDdsHeader);
  if (kept == nullptr) {
    auto implied = implied_header(info.desc);
    if (!implied.empty()) return implied;
    fail(Exit::bad_input, "{}: DDS files have no format {}; KTX2, EXR and raw files do", path,
         find_format(info.desc.record.format)->name);
  }
  auto header = attribute_bytes(*kept, path);
  const bool whole = header.size() >= kLegacyBytes && word_at(header, 0) == kMagic &&
                     header.size() == header_bytes(header);
  if (!whole || !fits(parse(header, path), info.desc)) {
    fail(Exit::bad_input, "{}: attribute {} is of another texture", path, kDdsHeader);
  }
  return header;
}

}  // namespace gicodec::tools
