#include <gicodec/hevc.h>

#include "backend/hevc/session_decoder.h"
#include "backend/hevc/session_encoder.h"
#include "base/guard.h"
#include "transform/yuv444p16.h"

#include <optional>

namespace gicodec {
namespace {

constexpr int kMaxQp = 51;
constexpr unsigned kMaxCodecThreads = 64;
constexpr std::string_view kX265 = "x265";

std::optional<hevc::DecoderKind> decoder_kind(std::string_view name) {
  if (name == "libde265") return hevc::DecoderKind::libde265;
  if (name == "ffmpeg") return hevc::DecoderKind::ffmpeg;
  return std::nullopt;
}

// The FFmpeg encoders before the first "x265"; nullopt if a name is empty.
std::optional<std::vector<std::string>> ffmpeg_encoders(std::string_view list) {
  std::vector<std::string> names;
  for (;;) {
    const std::size_t comma = list.find(',');
    const std::string_view name = list.substr(0, comma);
    if (name.empty()) return std::nullopt;
    if (name == kX265) return names;
    names.emplace_back(name);
    if (comma == std::string_view::npos) return names;
    list.remove_prefix(comma + 1);
  }
}

Result<std::unique_ptr<hevc::SessionEncoder>> open_session(const TextureDesc& desc,
                                                           const HevcSettings& settings,
                                                           const BackendSettings& common) {
  if (const Status status = validate(desc); status != Status::ok) return status;
  auto encoders = ffmpeg_encoders(settings.encoder);
  const auto decoder = decoder_kind(settings.decoder);
  const bool lossy = settings.lossy_qp >= 0;
  if (!encoders || !decoder || settings.lossy_qp > kMaxQp || common.level != 0 ||
      common.chunk != 0 || common.threads.count < 1 || common.threads.count > kMaxCodecThreads ||
      !is_supported(common.isa)) {
    return Status::invalid_settings;
  }
  if (lossy && (!is_a2rgb10(desc.record.format) || !encoders->empty()))
    return Status::invalid_settings;
  if (settings.packing == HevcPacking::luma && !lossy) return Status::invalid_settings;
  const std::uint8_t largest_class = settings.layout == HevcLayout::packed
                                         ? hevc::size_class_of(desc, block_count(desc))
                                         : std::uint8_t{0};
  const auto largest = hevc::frame_shape(desc, settings.packing, settings.layout, largest_class);
  if (!largest) return largest.status();
  auto session = std::make_unique<hevc::SessionEncoder>(
      desc,
      hevc::SessionSettings{.packing = settings.packing,
                            .layout = settings.layout,
                            .encoders = std::move(*encoders),
                            .decoder = *decoder,
                            .coder = {common.preset, common.threads.count, settings.lossy_qp},
                            .isa = common.isa},
      *largest);
  if (const Status status = session->open_first(); status != Status::ok) return status;
  return session;
}

}  // namespace

Result<std::unique_ptr<BackendEncoder>> HevcBackend::make_encoder(
    const TextureDesc& desc, const BackendSettings& settings) const {
  return guarded([&]() -> Result<std::unique_ptr<BackendEncoder>> {
    auto session = open_session(desc, settings_, settings);
    if (!session) return session.status();
    return std::unique_ptr<BackendEncoder>(std::move(*session));
  });
}

Result<std::unique_ptr<BackendDecoder>> HevcBackend::make_decoder(const TextureDesc& desc) const {
  return guarded([&]() -> Result<std::unique_ptr<BackendDecoder>> {
    if (const Status status = validate(desc); status != Status::ok) return status;
    const auto kind = decoder_kind(settings_.decoder);
    if (!kind || settings_.decoder_threads < 1 || settings_.decoder_threads > kMaxCodecThreads) {
      return Status::invalid_settings;
    }
    return std::unique_ptr<BackendDecoder>(
        std::make_unique<hevc::SessionDecoder>(desc, *kind, settings_.decoder_threads));
  });
}

Result<std::string> HevcBackend::encoder_in_use(const TextureDesc& desc,
                                                const BackendSettings& settings) const {
  return guarded([&]() -> Result<std::string> {
    const auto session = open_session(desc, settings_, settings);
    if (!session) return session.status();
    return std::string((*session)->encoder_name());
  });
}

}  // namespace gicodec
