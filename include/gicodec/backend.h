// Backends turn the records of some blocks into bytes and back. Built in are "raw", "lz4", "zstd"
// and "native". An application derives others from Backend and hands them to Encoder::create and
// Decoder::create, e.g. HevcBackend of <gicodec/hevc.h>.
#pragma once

#include <gicodec/api.h>
#include <gicodec/inspect.h>
#include <gicodec/isa.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/threads.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

/// A view of blocks, each tightly packed.
struct BlockTable {
  const std::byte* records = nullptr;
  std::size_t bytes = 0;                 ///< per block
  const std::uint32_t* place = nullptr;  ///< index of block i in `records`; null: i

  [[nodiscard]] std::span<const std::byte> operator[](std::size_t i) const noexcept {
    return {records + (place == nullptr ? i : place[i]) * bytes, bytes};
  }
};

/// The mirror: what a decoder holds of a texture. Blocks that were not received are zero.
struct MirrorView {
  BlockTable blocks;
  const std::uint8_t* received = nullptr;  ///< per block; null: received if blocks.place is not 0
  /// Presence::brick: the presence that each block was received with; zero if not received.
  BlockTable presence = {};

  [[nodiscard]] bool is_received(std::size_t block) const noexcept {
    return received == nullptr ? blocks.place[block] != 0 : received[block] != 0;
  }
};

/// The blocks of a packet to encode.
struct EncodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> blocks;  ///< ascending, unique, in range
  BlockTable records;                     ///< of `blocks`, in their order; missing records are zero
  MirrorView mirror;                      ///< before this update
  bool keyframe = false;  ///< the payload must not depend on `mirror` or earlier payloads
  /// With `keyframe`: the payload may depend on `mirror`, of blocks that are not in `blocks`.
  /// Never set for a lossy backend.
  bool intra = false;
  /// Presence of `blocks`, in their order, presence_bytes() each. Empty for Presence::all.
  std::span<const std::byte> presence = {};
  std::span<std::byte> decoded = {};  ///< lossy backends write what a decoder gets
};

/// A payload to decode.
struct DecodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> blocks;  ///< ascending, unique, in range
  std::span<const std::byte> payload;     ///< untrusted: validate everything
  MirrorView mirror;             ///< before this update; for a keyframe read it only if `intra`
  std::span<std::byte> records;  ///< of `blocks`; written completely unless an error is returned
  bool keyframe = false;
  bool intra = false;  ///< with `keyframe`: other blocks of `mirror` may be read
  std::span<const std::byte> presence = {};  ///< of `blocks`, already checked
  Threads threads = {};                      ///< threads that the backend may use
  PayloadStatistics* statistics = nullptr;   ///< if set, the backend adds to it
  Isa isa = best_isa();                      ///< kernels; invalid_settings if the machine lacks it
  /// If set and true: stop soon and answer Status::cancelled.
  const std::atomic<bool>* cancel = nullptr;
  [[nodiscard]] bool cancelled() const noexcept {
    return cancel != nullptr && cancel->load(std::memory_order_relaxed);
  }
};

/// State of one encoding session. Used by one thread at a time.
class BackendEncoder {
 public:
  virtual ~BackendEncoder() = default;
  /// Upper bound of the payload's bytes for that many blocks.
  [[nodiscard]] virtual std::size_t bound(std::size_t blocks) const = 0;
  /// True if decoded records may differ from those encoded.
  [[nodiscard]] virtual bool lossy() const { return false; }
  /// True if a payload depends on more of the past than the mirror. Encoder::snapshot() then fails.
  [[nodiscard]] virtual bool is_stateful() const { return false; }
  /// BackendSettings::preset of the next payloads, which the same decoder takes. invalid_settings;
  /// unsupported_backend, the default, if it cannot change.
  virtual Status set_preset(std::string_view /*preset*/) { return Status::unsupported_backend; }
  /// Appends the payload to `out`. After an error of a backend that is_stateful(), the next job is
  /// a keyframe.
  virtual Status encode(const EncodeJob& job, std::vector<std::byte>& out) = 0;
};

/// State of one decoding session. Used by one thread at a time. After an error a backend with its
/// own state answers reference_missing until the next keyframe.
class BackendDecoder {
 public:
  virtual ~BackendDecoder() = default;
  /// Checks a payload for that many blocks by its head and directory, before the caller allocates
  /// memory for its records. Takes time and memory in proportion to the payload.
  [[nodiscard]] virtual Status check(const TextureDesc& /*desc*/, std::size_t /*blocks*/,
                                     std::span<const std::byte> /*payload*/) const {
    return Status::ok;
  }
  /// Decodes the payload into `job.records`.
  virtual Status decode(const DecodeJob& job) = 0;
};

/// Makes the encoders and decoders of one payload format. Immutable; several threads may share it.
/// Encoders and decoders do not refer to it after create().
class Backend {
 public:
  virtual ~Backend() = default;
  /// Number of the payload format in packets; 128..255 are the application's.
  [[nodiscard]] virtual std::uint8_t id() const = 0;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// invalid_settings, or unsupported_format or unsupported_shape if it cannot code `desc`.
  [[nodiscard]] virtual Result<std::unique_ptr<BackendEncoder>> make_encoder(
      const TextureDesc& desc, const BackendSettings& settings) const = 0;
  [[nodiscard]] virtual Result<std::unique_ptr<BackendDecoder>> make_decoder(
      const TextureDesc& desc) const = 0;
};

inline constexpr std::uint8_t kBackendRaw = 0;
inline constexpr std::uint8_t kBackendLz4 = 1;
inline constexpr std::uint8_t kBackendZstd = 2;
inline constexpr std::uint8_t kBackendHevc = 3;
inline constexpr std::uint8_t kBackendNative = 4;

/// The backends of the core library, ascending by id. Never empty; static storage.
[[nodiscard]] std::span<const Backend* const> built_in_backends() noexcept;
/// "raw", "lz4", "zstd", "hevc" or "native"; empty for other ids.
[[nodiscard]] std::string_view backend_name(std::uint8_t id) noexcept;

}  // namespace gicodec
