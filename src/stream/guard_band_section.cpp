#include "stream/guard_band_section.h"

#include "base/bytes.h"
#include "base/parallel.h"
#include "bitstream/index_buffer.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

// Section: mode of the place buffer, the number of bands, the place buffer's size and bytes, then
// how the differences are coded, and the differences.
enum class BandCoding : std::uint8_t { plain = 0, coded = 1 };
constexpr std::size_t kMaxHead = 1 + 5 + 5 + 1;  // bytes without place buffer and differences
constexpr std::size_t kMaxBand = std::size_t{4} * (kMaxBlockSide + 1) * kMaxRecordBytes;

void xor_into(std::span<std::byte> to, std::span<const std::byte> from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] ^= from[i];
}

/// Predicts the band of a block at index `place` of the update: in keyframes and intra updates by
/// the rule, else the band before the update.
void predict_band(const GuardBandContext& context, std::uint32_t block, std::size_t place,
                  std::span<std::byte> out) {
  if (context.keyframe) {
    band_by_rule(context.desc, context.records[place].data(), out);
  } else if (const auto before = context.before.find(block); !before.empty()) {
    std::copy(before.begin(), before.end(), out.begin());
  } else {
    band_by_rule(context.desc, context.mirror[block].data(), out);
  }
}

std::uint32_t place_of(std::span<const std::uint32_t> blocks, std::uint32_t block) {
  return static_cast<std::uint32_t>(std::lower_bound(blocks.begin(), blocks.end(), block) -
                                    blocks.begin());
}

}  // namespace

std::size_t guard_band_section_bound(const TextureDesc& desc, std::size_t blocks,
                                     std::size_t stale) noexcept {
  return kMaxHead + index_buffer_bound(static_cast<std::uint32_t>(blocks)) +
         stale * band_bytes(desc);
}

Status write_guard_band_section(const GuardBandContext& context, const StaleBands& stale,
                                GuardBandMemory& memory, std::vector<std::byte>& out) {
  auto& [places, bands, place_bytes, packed, differences] = memory;
  places.clear(), bands.clear(), place_bytes.clear(), packed.clear();
  std::array<std::byte, kMaxBand> buffer;
  const auto predicted = std::span(buffer).first(band_bytes(context.desc));
  for (std::size_t i = 0; i < stale.size(); ++i) {
    const std::uint32_t block = stale.blocks()[i];
    const auto place = place_of(context.blocks, block);
    places.push_back(place);
    predict_band(context, block, place, predicted);
    xor_into(predicted, stale.band(i));
    bands.insert(bands.end(), predicted.begin(), predicted.end());
  }
  const auto mode =
      encode_index_buffer(places, static_cast<std::uint32_t>(context.blocks.size()), place_bytes);

  differences.encode(bands, context.desc.record.bytes, packed);
  const bool pays = packed.size() < bands.size();

  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(mode));
  writer.varint(places.size());
  writer.varint(place_bytes.size());
  writer.bytes(place_bytes);
  writer.fixed(static_cast<std::uint8_t>(pays ? BandCoding::coded : BandCoding::plain));
  writer.bytes(pays ? std::span<const std::byte>(packed) : std::span<const std::byte>(bands));
  return Status::ok;
}

namespace {

struct SectionParts {
  IndexMode mode;
  std::uint32_t count;
  std::span<const std::byte> places, bands;
  BandCoding coding;
};

/// All checks that do not need the update's blocks.
Result<SectionParts> parse_section(const TextureDesc& desc, std::uint32_t blocks,
                                   std::span<const std::byte> section) {
  if (band_bytes(desc) == 0) return Status::corrupt;
  ByteReader reader(section);
  const auto mode = static_cast<IndexMode>(reader.fixed<std::uint8_t>());
  const auto count = static_cast<std::uint32_t>(reader.varint(blocks));
  const auto places =
      reader.bytes(static_cast<std::size_t>(reader.varint(index_buffer_bound(blocks))));
  const auto coding = static_cast<BandCoding>(reader.fixed<std::uint8_t>());
  if (!reader.ok()) return reader.status();
  if (mode > IndexMode::runs || count == 0) return Status::corrupt;
  if (coding > BandCoding::coded) return Status::unsupported_feature;
  const Status status = check_index_buffer(mode, count, blocks, places);
  if (status != Status::ok) return status;
  const std::size_t size = reader.rest().size(), bytes = count * band_bytes(desc);
  if (coding == BandCoding::plain && size != bytes) return Status::corrupt;
  if (coding == BandCoding::coded && BandDifferences::most(size) < bytes) return Status::truncated;
  return SectionParts{mode, count, places, reader.rest(), coding};
}

}  // namespace

Status check_guard_band_section(const TextureDesc& desc, std::uint32_t blocks,
                                std::span<const std::byte> section) noexcept {
  return parse_section(desc, blocks, section).status();
}

Status read_guard_band_section(const TextureDesc& desc, std::span<const std::uint32_t> update,
                               std::span<const std::byte> section, GuardBandMemory& memory,
                               StaleBands& differences) {
  const auto blocks = static_cast<std::uint32_t>(update.size());
  const auto parts = parse_section(desc, blocks, section);
  if (!parts) return parts.status();
  auto& places = memory.places;
  const Status status =
      decode_index_buffer(parts->mode, parts->count, blocks, parts->places, places);
  if (status != Status::ok) return status;
  for (std::uint32_t& place : places) place = update[place];
  differences.assign(places, band_bytes(desc));
  if (parts->coding == BandCoding::plain) {
    std::copy(parts->bands.begin(), parts->bands.end(), differences.bytes().begin());
    return Status::ok;
  }
  return memory.differences.decode(parts->bands, desc.record.bytes, differences.bytes());
}

void resolve_guard_bands(const GuardBandContext& context, StaleBands& bands) noexcept {
  constexpr std::size_t kBandsPerThread = 256;
  const auto resolve_range = [&](unsigned, std::size_t first, std::size_t count) {
    std::array<std::byte, kMaxBand> buffer;
    const auto predicted = std::span(buffer).first(band_bytes(context.desc));
    for (std::size_t i = first; i < first + count; ++i) {
      const std::uint32_t block = bands.blocks()[i];
      predict_band(context, block, place_of(context.blocks, block), predicted);
      xor_into(bands.band(i), predicted);
    }
  };
  for_each_range(context.threads, bands.size(), kBandsPerThread, resolve_range);
}

}  // namespace gicodec
