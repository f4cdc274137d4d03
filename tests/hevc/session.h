// An encoding session and its textures as the core would drive them, for tests of the backend
// alone.
#pragma once

#include <gicodec/hevc.h>
#include <gicodec/probes.h>

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
  std::vector<std::uint32_t> blocks;
  std::vector<std::byte> records;  ///< what a decoder has to give
  std::vector<std::byte> payload;
  bool keyframe = false;
};

class Sender {
 public:
  Sender(const TextureDesc& desc, const HevcSettings& settings, std::uint32_t seed = 1)
      : desc_(desc), random_(seed), mirror_(block_count(desc) * block_bytes(desc)) {
    auto encoder = HevcBackend(settings).make_encoder(desc, {.preset = "ultrafast"});
    status_ = encoder.status();
    if (encoder) encoder_ = std::move(*encoder);
  }

  Status status() const noexcept { return status_; }
  BackendEncoder& encoder() noexcept { return *encoder_; }
  std::mt19937& random() noexcept { return random_; }

  /// New contents for these blocks. Noise in `bits`-bit steps over a ramp, all bit patterns for 8.
  Update next(std::vector<std::uint32_t> blocks, bool keyframe, unsigned bits = 8) {
    Update update{.blocks = std::move(blocks), .records = {}, .payload = {}, .keyframe = keyframe};
    update.records.resize(update.blocks.size() * block_bytes(desc_));
    for (std::size_t i = 0; i < update.records.size(); ++i) {
      const auto noise = static_cast<unsigned>(random_()) & ((1U << bits) - 1);
      update.records[i] = static_cast<std::byte>(bits < 8 ? noise + i / 64 : noise);
    }
    return send(std::move(update));
  }
  Update send(Update update) {
    if (update.keyframe) std::ranges::fill(mirror_, std::byte{0});
    const std::size_t size = block_bytes(desc_);
    std::vector<std::byte> decoded(encoder_->lossy() ? update.records.size() : 0);
    EncodeJob job{desc_,
                  update.blocks,
                  {update.records.data(), size},
                  {{mirror_.data(), size}},
                  update.keyframe};
    job.decoded = decoded;
    status_ = encoder_->encode(job, update.payload);
    if (encoder_->lossy()) update.records = std::move(decoded);
    store(desc_, update.blocks, update.records, mirror_);
    return update;
  }

  static void store(const TextureDesc& desc, std::span<const std::uint32_t> blocks,
                    std::span<const std::byte> records, std::span<std::byte> mirror) {
    const std::size_t size = block_bytes(desc);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      std::memcpy(&mirror[blocks[i] * size], &records[i * size], size);
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
    records_.assign(update.blocks.size() * block_bytes(desc_), std::byte{0xEE});
    return decoder_->decode({desc_, update.blocks, exact, {}, records_, update.keyframe});
  }
  Status receive(const Update& update) { return receive(update, update.payload); }
  [[nodiscard]] const std::vector<std::byte>& records() const noexcept { return records_; }

 private:
  TextureDesc desc_;
  std::unique_ptr<BackendDecoder> decoder_;
  std::vector<std::byte> records_;
};

[[nodiscard]] inline std::vector<std::uint32_t> all_blocks(const TextureDesc& desc) {
  std::vector<std::uint32_t> blocks(block_count(desc));
  std::iota(blocks.begin(), blocks.end(), 0U);
  return blocks;
}

/// Each block with the given chance, at least one.
[[nodiscard]] inline std::vector<std::uint32_t> some_blocks(const TextureDesc& desc,
                                                            std::mt19937& random, double chance) {
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (std::bernoulli_distribution(chance)(random)) blocks.push_back(block);
  }
  if (blocks.empty()) blocks.push_back(static_cast<std::uint32_t>(random()) % block_count(desc));
  return blocks;
}

}  // namespace gicodec::test
