#include "backend/byte_backend.h"

#include "transform/byte_planes.h"

#include <cstring>
#include <utility>

namespace gicodec {
namespace {

// Payload: one head byte, then the compressed texels.
constexpr std::uint8_t kHeadDifference = 0x01;  ///< byte planes hold differences to the mirror
constexpr std::uint8_t kHeadPlanes = 0x02;      ///< byte planes rather than texel order

/// The mirror's texels of the probes of a job, in their order.
std::span<const std::byte> gather_mirror(const TextureDesc& desc,
                                         std::span<const std::uint32_t> probes,
                                         std::span<const std::byte> mirror,
                                         std::vector<std::byte>& buffer) {
  const std::size_t block = core_bytes(desc);
  if (probes.size() * block == mirror.size()) return mirror;  // Every probe, thus in order.
  buffer.resize(probes.size() * block);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::memcpy(buffer.data() + i * block, mirror.data() + probes[i] * block, block);
  }
  return buffer;
}

class ByteEncoder final : public BackendEncoder {
 public:
  ByteEncoder(const TextureDesc& desc, Compression method, const BackendSettings& settings,
              Compressor compressor)
      : block_(core_bytes(desc)),
        method_(method),
        difference_(settings.difference),
        isa_(settings.isa),
        compressor_(std::move(compressor)) {}

  std::size_t bound(std::size_t probes) const override {
    return 1 + compressor_.bound(probes * block_);
  }

  Status encode(const EncodeJob& job, std::vector<std::byte>& out) override {
    const bool difference = difference_ && !job.keyframe;
    // Planes help a compressor; without one and without differences they would only cost time.
    const bool planes = difference || method_ != Compression::none;
    std::uint8_t head = 0;
    if (difference) head |= kHeadDifference;
    if (planes) head |= kHeadPlanes;
    out.push_back(std::byte{head});
    if (!planes) return compressor_.compress(job.texels, out);

    std::span<const std::byte> reference;
    if (difference) reference = gather_mirror(job.desc, job.probes, job.mirror, reference_);
    planes_.resize(job.texels.size());
    to_byte_planes(isa_, job.desc.format, job.texels, reference, planes_);
    return compressor_.compress(planes_, out);
  }

 private:
  std::size_t block_;
  Compression method_;
  bool difference_;
  Isa isa_;
  Compressor compressor_;
  std::vector<std::byte> reference_, planes_;
};

class ByteDecoder final : public BackendDecoder {
 public:
  explicit ByteDecoder(Decompressor decompressor, Compression method)
      : method_(method), decompressor_(std::move(decompressor)) {}

  Status check(const TextureDesc& desc, std::size_t probes,
               std::span<const std::byte> payload) const override {
    if (payload.empty()) return Status::truncated;
    const auto head = std::to_integer<std::uint8_t>(payload[0]);
    if ((head & ~(kHeadDifference | kHeadPlanes)) != 0) return Status::unsupported_feature;
    return check_compressed(method_, payload.subspan(1), probes * core_bytes(desc));
  }

  Status decode(const DecodeJob& job) override {
    if (!is_supported(job.isa)) return Status::invalid_argument;
    const Status status = check(job.desc, job.probes.size(), job.payload);
    if (status != Status::ok) return status;
    const auto head = std::to_integer<std::uint8_t>(job.payload[0]);
    const bool difference = (head & kHeadDifference) != 0;
    const bool planes = (head & kHeadPlanes) != 0;
    if (difference && (job.keyframe || !planes)) return Status::corrupt;
    const auto bytes = job.payload.subspan(1);
    if (!planes) return decompressor_.decompress(bytes, job.texels);

    planes_.resize(job.texels.size());
    if (const Status done = decompressor_.decompress(bytes, planes_); done != Status::ok) {
      return done;
    }
    std::span<const std::byte> reference;
    if (difference) reference = gather_mirror(job.desc, job.probes, job.mirror, reference_);
    from_byte_planes(job.isa, job.desc.format, planes_, reference, job.texels);
    return Status::ok;
  }

 private:
  Compression method_;
  Decompressor decompressor_;
  std::vector<std::byte> reference_, planes_;
};

}  // namespace

Result<std::unique_ptr<BackendEncoder>> ByteBackend::make_encoder(
    const TextureDesc& desc, const BackendSettings& settings) const {
  if (!settings.preset.empty() || !is_supported(settings.isa)) return Status::invalid_argument;
  if (probe_count(desc) * core_bytes(desc) > Compressor::kMaxInput) return Status::limit_exceeded;
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
