#include "stream/border_section.h"

#include "backend/compressor.h"
#include "base/bytes.h"
#include "bitstream/index_buffer.h"
#include "texture/guard_band.h"

#include <algorithm>

namespace gicodec {
namespace {

// Section: mode of the place buffer, its size, the number of rings, the buffer, then the
// compression of the differences and the differences.
constexpr std::size_t kMaxHead = 1 + 5 + 5 + 1;

void xor_into(std::span<std::byte> to, std::span<const std::byte> from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] ^= from[i];
}

/// The ring the decoder would have for the probe at `place` in the update.
void predict_ring(const BorderContext& context, std::uint32_t place, std::span<std::byte> out) {
  const auto& desc = context.mirror.desc();
  if (context.keyframe) {
    ring_by_rule(desc, context.cores.data() + place * core_bytes(desc), out);
  } else {
    context.mirror.ring(context.probes[place], out);
  }
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
  for (const auto& [probe, ring] : stale) {
    const auto it = std::ranges::lower_bound(context.probes, probe);
    const auto place = static_cast<std::uint32_t>(it - context.probes.begin());
    places.push_back(place);
    predict_ring(context, place, predicted);
    xor_into(predicted, ring);
    rings.insert(rings.end(), predicted.begin(), predicted.end());
  }
  std::vector<std::byte> place_bytes;
  const auto mode = encode_index_buffer(
      places, static_cast<std::uint32_t>(context.probes.size()), place_bytes);

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

Status read_border_section(const BorderContext& context, std::span<const std::byte> section,
                           StaleRings& stale) {
  const std::size_t ring_size = ring_bytes(context.mirror.desc());
  if (ring_size == 0) return Status::corrupt;
  const auto probes = static_cast<std::uint32_t>(context.probes.size());

  ByteReader reader(section);
  const auto mode = reader.fixed<std::uint8_t>();
  const auto count = static_cast<std::uint32_t>(reader.varint(probes));
  const auto place_bytes = reader.bytes(reader.varint(index_buffer_bound(probes)));
  const auto method = reader.fixed<std::uint8_t>();
  if (!reader.ok()) return reader.status();
  if (mode > static_cast<std::uint8_t>(IndexMode::runs) || count == 0) return Status::corrupt;
  std::vector<std::uint32_t> places;
  Status status =
      decode_index_buffer(static_cast<IndexMode>(mode), count, probes, place_bytes, places);
  if (status != Status::ok) return status;
  if (method != static_cast<std::uint8_t>(Compression::none) &&
      method != static_cast<std::uint8_t>(Compression::zstd)) {
    return Status::unsupported_feature;
  }
  auto decompressor = Decompressor::create(static_cast<Compression>(method));
  if (!decompressor) return decompressor.status();
  std::vector<std::byte> rings(count * ring_size);
  status = decompressor->decompress(reader.rest(), rings);
  if (status != Status::ok) return status;

  std::vector<std::byte> predicted(ring_size);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto difference = std::span(rings).subspan(i * ring_size, ring_size);
    predict_ring(context, places[i], predicted);
    xor_into(difference, predicted);
    stale.emplace(context.probes[places[i]],
                  std::vector<std::byte>(difference.begin(), difference.end()));
  }
  return Status::ok;
}

}  // namespace gicodec
