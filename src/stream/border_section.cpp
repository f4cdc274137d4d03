#include "stream/border_section.h"

#include "backend/compressor.h"
#include "base/bytes.h"
#include "bitstream/index_buffer.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

// Section: mode of the place buffer, the number of rings, the place buffer's size and bytes, then
// the compression of the differences and the differences.
constexpr std::size_t kMaxHead = 1 + 5 + 5 + 1;  // All but the place buffer and the differences.
constexpr std::size_t kMaxRing = std::size_t{4} * (kMaxCore + 1) * 16;

void xor_into(std::span<std::byte> to, std::span<const std::byte> from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] ^= from[i];
}

/// The ring that both sides expect for a probe of the update, which stands at `place` in it: in
/// keyframes and fresh updates what the rule gives, else the one before the update.
void predict_ring(const BorderContext& context, std::uint32_t probe, std::size_t place,
                  std::span<std::byte> out) {
  const auto& desc = context.mirror.desc();
  if (context.keyframe) {
    ring_by_rule(desc, context.cores.data() + place * core_bytes(desc), out);
  } else {
    context.mirror.ring(probe, out);
  }
}

std::uint32_t place_of(std::span<const std::uint32_t> probes, std::uint32_t probe) {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(probes, probe) - probes.begin());
}

}  // namespace

std::size_t border_section_bound(const TextureDesc& desc, std::size_t probes,
                                 std::size_t stale) noexcept {
  return kMaxHead + index_buffer_bound(static_cast<std::uint32_t>(probes)) +
         stale * ring_bytes(desc);
}

Status write_border_section(const BorderContext& context, const StaleRings& stale,
                            std::vector<std::byte>& out) {
  const std::size_t ring_size = ring_bytes(context.mirror.desc());
  std::vector<std::uint32_t> places;
  std::vector<std::byte> rings, predicted(ring_size);
  for (std::size_t i = 0; i < stale.size(); ++i) {
    const std::uint32_t probe = stale.probes()[i];
    const auto place = place_of(context.probes, probe);
    places.push_back(place);
    predict_ring(context, probe, place, predicted);
    xor_into(predicted, stale.ring(i));
    rings.insert(rings.end(), predicted.begin(), predicted.end());
  }
  std::vector<std::byte> place_bytes;
  const auto mode =
      encode_index_buffer(places, static_cast<std::uint32_t>(context.probes.size()), place_bytes);

  auto compressor = Compressor::create(Compression::zstd, 0);
  if (!compressor) return compressor.status();
  std::vector<std::byte> packed;
  const Status status = compressor->compress(rings, packed);
  if (status != Status::ok) return status;
  const bool pays = packed.size() < rings.size();

  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(mode));
  writer.varint(places.size());
  writer.varint(place_bytes.size());
  writer.bytes(place_bytes);
  writer.fixed(static_cast<std::uint8_t>(pays ? Compression::zstd : Compression::none));
  writer.bytes(pays ? packed : rings);
  return Status::ok;
}

namespace {

struct SectionParts {
  IndexMode mode;
  std::uint32_t count;
  std::span<const std::byte> places, rings;
  Compression method;
};

Result<SectionParts> parse_section(std::span<const std::byte> section, std::uint32_t probes) {
  ByteReader reader(section);
  const auto mode = reader.fixed<std::uint8_t>();
  const auto count = static_cast<std::uint32_t>(reader.varint(probes));
  const auto places = reader.bytes(reader.varint(index_buffer_bound(probes)));
  const auto method = reader.fixed<std::uint8_t>();
  if (!reader.ok()) return reader.status();
  if (mode > static_cast<std::uint8_t>(IndexMode::runs) || count == 0) return Status::corrupt;
  if (method != static_cast<std::uint8_t>(Compression::none) &&
      method != static_cast<std::uint8_t>(Compression::zstd)) {
    return Status::unsupported_feature;
  }
  return SectionParts{static_cast<IndexMode>(mode), count, places, reader.rest(),
                      static_cast<Compression>(method)};
}

}  // namespace

Status check_border_section(const TextureDesc& desc, std::uint32_t probes,
                            std::span<const std::byte> section) noexcept {
  const std::size_t ring_size = ring_bytes(desc);
  if (ring_size == 0) return Status::corrupt;
  const auto parts = parse_section(section, probes);
  if (!parts) return parts.status();
  const Status status = check_index_buffer(parts->mode, parts->count, probes, parts->places);
  if (status != Status::ok) return status;
  return check_compressed(parts->method, parts->rings, parts->count * ring_size);
}

Status read_border_section(const TextureDesc& desc, std::span<const std::uint32_t> update,
                           std::span<const std::byte> section, StaleRings& differences) {
  const auto probes = static_cast<std::uint32_t>(update.size());
  Status status = check_border_section(desc, probes, section);
  if (status != Status::ok) return status;
  const auto parts = *parse_section(section, probes);
  std::vector<std::uint32_t> places;
  status = decode_index_buffer(parts.mode, parts.count, probes, parts.places, places);
  if (status != Status::ok) return status;
  for (std::uint32_t& place : places) place = update[place];
  auto decompressor = Decompressor::create(parts.method);
  if (!decompressor) return decompressor.status();
  differences.assign(std::move(places), ring_bytes(desc));
  return decompressor->decompress(parts.rings, differences.bytes());
}

void resolve_borders(const BorderContext& context, StaleRings& rings) noexcept {
  std::array<std::byte, kMaxRing> buffer;
  const auto predicted = std::span(buffer).first(ring_bytes(context.mirror.desc()));
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const std::uint32_t probe = rings.probes()[i];
    predict_ring(context, probe, place_of(context.probes, probe), predicted);
    xor_into(rings.ring(i), predicted);
  }
}

}  // namespace gicodec
