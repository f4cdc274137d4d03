#include "backend/byte_backend.h"

#include "base/parts.h"
#include "texture/presence.h"
#include "transform/byte_planes.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

// Payload: one head byte, then the compressed records.
constexpr std::uint8_t kHeadDifference = 0x01;  ///< byte planes hold differences to the mirror
constexpr std::uint8_t kHeadPlanes = 0x02;      ///< byte planes rather than record order

/// The existing records of blocks, side by side: in place if they are so already, else copied to
/// `room`.
std::span<const std::byte> gather(const TextureDesc& desc, std::size_t count,
                                  std::span<const std::byte> presence, const BlockTable& blocks,
                                  Vector<std::byte>& room) {
  const std::size_t size = presence_bytes(desc), bytes = count * blocks.bytes;
  const auto* const place = blocks.place;
  const auto apart = [](std::uint32_t a, std::uint32_t b) { return b != a + 1; };
  const bool together =
      place == nullptr || std::adjacent_find(place, place + count, apart) == place + count;
  if (size == 0 && together) return {count == 0 ? nullptr : blocks[0].data(), bytes};
  room.clear();
  room.reserve(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (size != 0) {
      gather_present(desc, presence.subspan(i * size, size), blocks[i], room);
    } else {
      room.insert(room.end(), blocks[i].begin(), blocks[i].end());
    }
  }
  return room;
}

/// The mirror's records of an update's blocks, in their order.
std::span<const std::byte> gather_mirror(const TextureDesc& desc,
                                         std::span<const std::uint32_t> blocks,
                                         std::span<const std::byte> presence,
                                         const MirrorView& mirror, Vector<std::byte>& room,
                                         Vector<std::uint32_t>& places) {
  places.clear();
  BlockTable held = mirror.blocks;
  if (held.place != nullptr) {
    places.reserve(blocks.size());
    for (const std::uint32_t block : blocks) places.push_back(held.place[block]);
  }
  held.place = held.place == nullptr ? blocks.data() : places.data();
  return gather(desc, blocks.size(), presence, held, room);
}

/// Bytes of an update's existing records.
std::size_t size_of(const TextureDesc& desc, std::size_t blocks,
                    std::span<const std::byte> presence) {
  const std::size_t size = presence_bytes(desc);
  if (size == 0) return blocks * block_bytes(desc);
  std::size_t records = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    records += BlockPresence(desc, presence.subspan(i * size, size)).count();
  }
  return records * desc.record.bytes;
}

class ByteEncoder final : public BackendEncoder {
 public:
  ByteEncoder(const TextureDesc& desc, Compression method, const BackendSettings& settings,
              Compressor compressor)
      : block_(block_bytes(desc)),
        method_(method),
        difference_(settings.difference),
        isa_(settings.isa),
        compressor_(std::move(compressor)) {}

  std::size_t bound(std::size_t blocks) const override {
    return 1 + compressor_.bound(blocks * block_);
  }

  Status encode(const EncodeJob& job, std::vector<std::byte>& out) override {
    const bool difference = difference_ && !job.keyframe;
    // Planes only cost time without a compressor and without differences.
    const bool planes = difference || method_ != Compression::none;
    std::uint8_t head = 0;
    if (difference) head |= kHeadDifference;
    if (planes) head |= kHeadPlanes;
    out.push_back(std::byte{head});
    const auto records = gather(job.desc, job.blocks.size(), job.presence, job.records, records_);
    if (!planes) return compressor_.compress(records, out);

    std::span<const std::byte> reference;
    if (difference) {
      reference =
          gather_mirror(job.desc, job.blocks, job.presence, job.mirror, reference_, places_);
    }
    planes_.resize(records.size());
    to_byte_planes(isa_, job.desc.record, records, reference, planes_);
    return compressor_.compress(planes_, out);
  }

 private:
  std::size_t block_;
  Compression method_;
  bool difference_;
  Isa isa_;
  Compressor compressor_;
  Vector<std::byte> records_, reference_, planes_;
  Vector<std::uint32_t> places_;
};

class ByteDecoder final : public BackendDecoder {
 public:
  explicit ByteDecoder(Decompressor decompressor, Compression method)
      : method_(method), decompressor_(std::move(decompressor)) {}

  Status check(const TextureDesc& desc, std::size_t blocks,
               std::span<const std::byte> payload) const override {
    // The number of existing records depends on the blocks, which are not known yet.
    if (desc.presence != Presence::all) return check_head(payload);
    return check_size(blocks * block_bytes(desc), payload);
  }

  Status decode(const DecodeJob& job) override {
    if (!is_supported(job.isa)) return Status::invalid_settings;
    const std::size_t size = size_of(job.desc, job.blocks.size(), job.presence);
    const Status status = check_size(size, job.payload);
    if (status != Status::ok) return status;
    const auto head = std::to_integer<std::uint8_t>(job.payload[0]);
    const bool difference = (head & kHeadDifference) != 0;
    const bool planes = (head & kHeadPlanes) != 0;
    if (difference && (job.keyframe || !planes)) return Status::corrupt;
    const auto bytes = job.payload.subspan(1);
    const bool all = job.desc.presence == Presence::all;
    if (!all) records_.resize(size);
    const std::span<std::byte> records = all ? job.records : std::span(records_);
    if (!planes) {
      const Status done = decompressor_.decompress(bytes, records);
      if (done == Status::ok && !all) scatter(job);
      return done;
    }

    planes_.resize(size);
    if (const Status done = decompressor_.decompress(bytes, planes_); done != Status::ok) {
      return done;
    }
    std::span<const std::byte> reference;
    if (difference) {
      reference =
          gather_mirror(job.desc, job.blocks, job.presence, job.mirror, reference_, places_);
    }
    from_byte_planes(job.isa, job.desc.record, planes_, reference, records);
    if (!all) scatter(job);
    return Status::ok;
  }

 private:
  static Status check_head(std::span<const std::byte> payload) {
    if (payload.empty()) return Status::truncated;
    const auto head = std::to_integer<std::uint8_t>(payload[0]);
    return (head & ~(kHeadDifference | kHeadPlanes)) == 0 ? Status::ok
                                                          : Status::unsupported_feature;
  }
  Status check_size(std::size_t size, std::span<const std::byte> payload) const {
    const Status status = check_head(payload);
    return status == Status::ok ? check_compressed(method_, payload.subspan(1), size) : status;
  }
  /// Moves existing records to their places.
  void scatter(const DecodeJob& job) const {
    const std::size_t block = block_bytes(job.desc), presence = presence_bytes(job.desc);
    std::size_t at = 0;
    for (std::size_t i = 0; i < job.blocks.size(); ++i) {
      at += scatter_present(job.desc, job.presence.subspan(i * presence, presence),
                            std::span(records_).subspan(at), job.records.subspan(i * block, block));
    }
  }

  Compression method_;
  Decompressor decompressor_;
  Vector<std::byte> records_, reference_, planes_;
  Vector<std::uint32_t> places_;
};

}  // namespace

Result<std::unique_ptr<BackendEncoder>> ByteBackend::make_encoder(
    const TextureDesc& desc, const BackendSettings& settings) const {
  if constexpr (!kEncodes) return Status::unsupported_backend;
  if (!settings.preset.empty() || settings.chunk != 0 || !is_supported(settings.isa)) {
    return Status::invalid_settings;
  }
  if (block_count(desc) * block_bytes(desc) > Compressor::kMaxInput) return Status::limit_exceeded;
  auto compressor = Compressor::create(method_, settings.level);
  if (!compressor) return compressor.status();
  std::unique_ptr<BackendEncoder> encoder =
      std::make_unique<ByteEncoder>(desc, method_, settings, *std::move(compressor));
  return encoder;
}

Result<std::unique_ptr<BackendDecoder>> ByteBackend::make_decoder(const TextureDesc&) const {
  auto decompressor = Decompressor::create(method_);
  if (!decompressor) return decompressor.status();
  std::unique_ptr<BackendDecoder> decoder =
      std::make_unique<ByteDecoder>(*std::move(decompressor), method_);
  return decoder;
}

}  // namespace gicodec
