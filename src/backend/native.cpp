#include "backend/native.h"

#include "base/guard.h"
#include "base/parallel.h"
#include "base/parts.h"
#include "native/frame/payload.h"

#include <optional>
#include <string_view>

namespace gicodec {
namespace {

constexpr std::uint64_t kMaxInput = std::uint64_t{1} << 30;  // as the byte backends

std::optional<native::Preset> find_preset(std::string_view name) noexcept {
  if (name.empty() || name == "fast") return native::Preset::fast;
  if (name == "turbo") return native::Preset::turbo;
  if (name == "strong") return native::Preset::strong;
  return std::nullopt;
}

class NativeEncoder final : public BackendEncoder {
 public:
  NativeEncoder(const TextureDesc& desc, const BackendSettings& settings, native::Preset preset)
      : desc_(desc), isa_(settings.isa) {
    settings_.chunk.preset = preset;
    settings_.threads = settings.threads;
    if (settings.chunk != 0) settings_.box = native::default_box(desc.grid, settings.chunk);
  }
  [[nodiscard]] std::size_t bound(std::size_t blocks) const override {
    return native::payload_bound(desc_, blocks);
  }
  Status set_preset(std::string_view name) override {
    const auto preset = find_preset(name);
    if (!preset) return Status::invalid_settings;
    settings_.chunk.preset = *preset;
    return Status::ok;
  }
  Status encode(const EncodeJob& job, std::vector<std::byte>& out) override {
    return guarded([&] {
      native::encode_payload(job, settings_, isa_, memory_, out);
      return Status::ok;
    });
  }

 private:
  TextureDesc desc_;
  Isa isa_;
  native::PayloadSettings settings_;
  native::PayloadMemory memory_;
};

class NativeDecoder final : public BackendDecoder {
 public:
  [[nodiscard]] Status check(const TextureDesc& desc, std::size_t blocks,
                             std::span<const std::byte> payload) const override {
    return guarded([&] { return native::check_payload(desc, blocks, payload, memory_); });
  }
  Status decode(const DecodeJob& job) override {
    if (!is_supported(job.isa)) return Status::invalid_settings;
    return guarded([&] { return native::decode_payload(job, job.isa, memory_); });
  }

 private:
  mutable native::PayloadMemory memory_;
};

}  // namespace

Result<std::unique_ptr<BackendEncoder>> NativeBackend::make_encoder(
    const TextureDesc& desc, const BackendSettings& settings) const {
  if constexpr (!kEncodes) return Status::unsupported_backend;
  return guarded([&]() -> Result<std::unique_ptr<BackendEncoder>> {
    const Status status = validate(desc);
    if (status != Status::ok) return status;
    const auto preset = find_preset(settings.preset);
    if (!preset || settings.level != 0 || settings.chunk > native::kMaxChunkProbes ||
        !is_valid(settings.threads) || !is_supported(settings.isa)) {
      return Status::invalid_settings;
    }
    if (block_count(desc) * block_bytes(desc) > kMaxInput) return Status::limit_exceeded;
    return std::unique_ptr<BackendEncoder>(
        std::make_unique<NativeEncoder>(desc, settings, *preset));
  });
}

Result<std::unique_ptr<BackendDecoder>> NativeBackend::make_decoder(const TextureDesc& desc) const {
  return guarded([&]() -> Result<std::unique_ptr<BackendDecoder>> {
    const Status status = validate(desc);
    if (status != Status::ok) return status;
    return std::unique_ptr<BackendDecoder>(std::make_unique<NativeDecoder>());
  });
}

}  // namespace gicodec
