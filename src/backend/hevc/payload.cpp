#include "backend/hevc/payload.h"

#include "base/bytes.h"
#include "base/compressor.h"
#include "transform/yuv444p16.h"

namespace gicodec::hevc {
namespace {

constexpr std::uint8_t kPackingPlanes = 1, kLayoutPacked = 2, kLossy = 4, kPackingLuma = 8;
constexpr std::uint8_t kKnownFlags = kPackingPlanes | kLayoutPacked | kLossy | kPackingLuma;
constexpr std::size_t kHeadBytes = 9;
constexpr std::size_t kParameterSetBytes = 4096;

constexpr std::size_t packed_alpha_bytes(std::size_t texels) noexcept { return (texels + 3) / 4; }
/// At least what any version of zstd needs.
constexpr std::size_t alpha_section_bound(std::size_t packed) noexcept {
  return packed + packed / 256 + 64;
}

}  // namespace

std::size_t payload_bound(const PictureFormat& picture, std::size_t texels) noexcept {
  // Lossless noise takes up to twice the bits of a sample, plus a small picture's overhead.
  const std::size_t bytes_per_sample = picture.bit_depth > 8 ? 5 : 3;
  const std::size_t samples = picture.planes() * picture.width * picture.height;
  return kHeadBytes + kMaxVarint + alpha_section_bound(packed_alpha_bytes(texels)) +
         kParameterSetBytes + samples * bytes_per_sample;
}

void write_payload(const PayloadHead& head, std::span<const std::byte> alpha_section,
                   std::span<const std::byte> access_unit, std::vector<std::byte>& out) {
  unsigned flags = 0;
  if (head.packing == HevcPacking::planes) flags |= kPackingPlanes;
  if (head.packing == HevcPacking::luma) flags |= kPackingLuma;
  if (head.layout == HevcLayout::packed) flags |= kLayoutPacked;
  if (head.lossy) flags |= kLossy;
  ByteWriter writer(out);
  writer.fixed(kPayloadVersion);
  writer.fixed(static_cast<std::uint8_t>(flags));
  writer.fixed(head.bit_depth);
  writer.fixed(head.size_class);
  writer.fixed(head.alpha);
  writer.fixed(head.hash);
  if (head.alpha == kAlphaCoded) {
    writer.varint(alpha_section.size());
    writer.bytes(alpha_section);
  }
  writer.bytes(access_unit);
}

Result<Payload> read_payload(std::span<const std::byte> bytes) noexcept {
  ByteReader reader(bytes);
  const auto version = reader.fixed<std::uint8_t>();
  if (reader.ok() && version != kPayloadVersion) return Status::unsupported_version;
  const auto flags = reader.fixed<std::uint8_t>();
  if ((flags & ~kKnownFlags) != 0) return Status::unsupported_feature;
  Payload payload;
  PayloadHead& head = payload.head;
  head.packing = (flags & kPackingPlanes) != 0 ? HevcPacking::planes
                 : (flags & kPackingLuma) != 0 ? HevcPacking::luma
                                               : HevcPacking::paper;
  head.layout = (flags & kLayoutPacked) != 0 ? HevcLayout::packed : HevcLayout::atlas;
  head.lossy = (flags & kLossy) != 0;
  // Luma is of what is lossy alone.
  if ((flags & kPackingLuma) != 0 && (!head.lossy || head.packing != HevcPacking::luma))
    return Status::corrupt;
  head.bit_depth = reader.fixed<std::uint8_t>();
  head.size_class = reader.fixed<std::uint8_t>();
  head.alpha = reader.fixed<std::uint8_t>();
  head.hash = reader.fixed<std::uint32_t>();
  if (head.alpha > kAlphaCoded) return Status::corrupt;
  if (head.alpha == kAlphaCoded) {
    payload.alpha_section = reader.bytes(static_cast<std::size_t>(reader.varint(bytes.size())));
  }
  if (!reader.ok()) return reader.status();
  payload.access_unit = reader.rest();
  return payload;
}

Result<std::vector<std::byte>> write_alpha(std::span<const std::byte> texels, PayloadHead& head) {
  if (const auto alpha = constant_alpha(texels)) {
    head.alpha = *alpha;
    return std::vector<std::byte>{};
  }
  head.alpha = kAlphaCoded;
  std::vector<std::byte> packed(packed_alpha_bytes(texels.size() / 4));
  pack_alpha(texels, packed);
  auto compressor = Compressor::create(Compression::zstd, 0);
  if (!compressor) return compressor.status();
  std::vector<std::byte> section;
  if (const Status status = compressor->compress(packed, section); status != Status::ok) {
    return status;
  }
  return section;
}

Status read_alpha(const Payload& payload, std::span<std::byte> texels) {
  if (payload.head.alpha != kAlphaCoded) {
    add_alpha(payload.head.alpha, texels);
    return Status::ok;
  }
  std::vector<std::byte> packed(packed_alpha_bytes(texels.size() / 4));
  auto decompressor = Decompressor::create(Compression::zstd);
  if (!decompressor) return decompressor.status();
  const Status status = decompressor->decompress(payload.alpha_section, packed);
  if (status != Status::ok) return status;
  const unsigned in_last = texels.size() / 4 % 4;  // bits behind the last texel must be zero
  if (in_last != 0 && std::to_integer<unsigned>(packed.back()) >> 2 * in_last != 0) {
    return Status::corrupt;
  }
  unpack_alpha(packed, texels);
  return Status::ok;
}

}  // namespace gicodec::hevc
