// An encoding session and its textures as the core would drive them, for tests of the backend
// alone.
#pragma once

#include <gicodec/hevc.h>
#include <gicodec/texture.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <vector>

namespace gicodec::test {

struct Update {
  std::vector<std::uint32_t> probes;
  std::vector<std::byte> texels;  ///< what a decoder has to give
  std::vector<std::byte> payload;
  bool keyframe = false;
};

class Sender {
 public:
  Sender(const TextureDesc& desc, const HevcSettings& settings, std::uint32_t seed = 1)
      : desc_(desc), random_(seed), mirror_(probe_count(desc) * core_bytes(desc)) {
    auto encoder = HevcBackend(settings).make_encoder(desc, {.preset = "ultrafast"});
    status_ = encoder.status();
    if (encoder) encoder_ = std::move(*encoder);
  }

  Status status() const noexcept { return status_; }
  BackendEncoder& encoder() noexcept { return *encoder_; }
  std::mt19937& random() noexcept { return random_; }

  /// New contents for these probes. Noise in `bits`-bit steps over a ramp, all bit patterns for 8.
  Update next(std::vector<std::uint32_t> probes, bool keyframe, unsigned bits = 8) {
    Update update{.probes = std::move(probes), .texels = {}, .payload = {}, .keyframe = keyframe};
    update.texels.resize(update.probes.size() * core_bytes(desc_));
    for (std::size_t i = 0; i < update.texels.size(); ++i) {
      const auto noise = static_cast<unsigned>(random_()) & ((1U << bits) - 1);
      update.texels[i] = static_cast<std::byte>(bits < 8 ? noise + i / 64 : noise);
    }
    return send(std::move(update));
  }
  Update send(Update update) {
    if (update.keyframe) std::ranges::fill(mirror_, std::byte{0});
    status_ = encoder_->encode({desc_, update.probes, update.texels, mirror_, update.keyframe},
                               update.payload);
    store(desc_, update.probes, update.texels, mirror_);
    return update;
  }

  static void store(const TextureDesc& desc, std::span<const std::uint32_t> probes,
                    std::span<const std::byte> texels, std::span<std::byte> mirror) {
    const std::size_t size = core_bytes(desc);
    for (std::size_t i = 0; i < probes.size(); ++i) {
      std::memcpy(&mirror[probes[i] * size], &texels[i * size], size);
    }
  }

 private:
  TextureDesc desc_;
  std::mt19937 random_;
  std::vector<std::byte> mirror_;
  std::unique_ptr<BackendEncoder> encoder_;
  Status status_ = Status::ok;
};

class Receiver {
 public:
  explicit Receiver(const TextureDesc& desc, const std::string& decoder = "libde265")
      : desc_(desc) {
    HevcSettings settings;
    settings.decoder = decoder;
    auto made = HevcBackend(settings).make_decoder(desc);
    if (made) decoder_ = std::move(*made);
  }

  /// Decodes from a heap copy of exactly the payload's size.
  Status receive(const Update& update, std::span<const std::byte> payload) {
    const std::vector<std::byte> exact(payload.begin(), payload.end());
    texels_.assign(update.probes.size() * core_bytes(desc_), std::byte{0xEE});
    return decoder_->decode({desc_, update.probes, exact, {}, texels_, update.keyframe});
  }
  Status receive(const Update& update) { return receive(update, update.payload); }
  [[nodiscard]] const std::vector<std::byte>& texels() const noexcept { return texels_; }

 private:
  TextureDesc desc_;
  std::unique_ptr<BackendDecoder> decoder_;
  std::vector<std::byte> texels_;
};

[[nodiscard]] inline std::vector<std::uint32_t> all_probes(const TextureDesc& desc) {
  std::vector<std::uint32_t> probes(probe_count(desc));
  std::iota(probes.begin(), probes.end(), 0U);
  return probes;
}

/// Each probe with the given chance, at least one.
[[nodiscard]] inline std::vector<std::uint32_t> some_probes(const TextureDesc& desc,
                                                            std::mt19937& random, double chance) {
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
    if (std::bernoulli_distribution(chance)(random)) probes.push_back(probe);
  }
  if (probes.empty()) probes.push_back(static_cast<std::uint32_t>(random()) % probe_count(desc));
  return probes;
}

}  // namespace gicodec::test
