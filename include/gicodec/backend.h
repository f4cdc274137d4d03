// Backends: what turns the records of some blocks into bytes and back. Built in: "raw", "lz4",
// "zstd" and "native". Others are objects of a class derived from Backend and are handed to
// Encoder::create and Decoder::create, e.g. HevcBackend of <gicodec/hevc.h>.
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

/// Blocks of records, each tightly packed.
struct BlockTable {
  const std::byte* records = nullptr;
  std::size_t bytes = 0;                 ///< of a block
  const std::uint32_t* place = nullptr;  ///< where block i stands; null: as the i-th

  [[nodiscard]] std::span<const std::byte> operator[](std::size_t i) const noexcept {
    return {records + (place == nullptr ? i : place[i]) * bytes, bytes};
  }
};

/// What a receiver holds of a texture: every block, zero where none was received.
struct MirrorView {
  BlockTable blocks;
  const std::uint8_t* received = nullptr;  ///< per block; null: those whose place is not 0
  /// Of bricks: the presence that each block was received with, zero where none was.
  BlockTable presence = {};

  [[nodiscard]] bool is_received(std::size_t block) const noexcept {
    return received == nullptr ? blocks.place[block] != 0 : received[block] != 0;
  }
};

struct EncodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> blocks;  ///< ascending, unique, in range
  BlockTable records;                     ///< of `blocks`, in their order; zero if not existing
  MirrorView mirror;                      ///< before this update
  bool keyframe = false;                  ///< the payload must not depend on `mirror` or the past
  /// With `keyframe`: it may depend on what `mirror` holds of other blocks. Never of lossy
  /// backends.
  bool intra = false;
  /// What is to say which records exist, of `blocks` in their order; see presence_bytes().
  std::span<const std::byte> presence = {};
  std::span<std::byte> decoded = {};  ///< of a lossy backend: to be filled with what is decoded
};

struct DecodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> blocks;
  std::span<const std::byte> payload;  ///< hostile: validate everything
  MirrorView mirror;                   ///< as above; not to be read for a keyframe, unless `intra`
  std::span<std::byte> records;        ///< to be written completely, or an error returned
  bool keyframe = false;
  bool intra = false;  ///< with `keyframe`: blocks that are not listed may be read
  std::span<const std::byte> presence = {};  ///< as above, and sound
  Threads threads = {};                      ///< that the backend may use
  PayloadStatistics* statistics = nullptr;   ///< if set, to be added to
  Isa isa = best_isa();  ///< kernels; invalid_settings if the machine lacks them
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
  /// Upper bound of the payload for that many blocks.
  [[nodiscard]] virtual std::size_t bound(std::size_t blocks) const = 0;
  /// True if decoded records may differ from those encoded.
  [[nodiscard]] virtual bool lossy() const { return false; }
  /// True if a payload depends on earlier ones by more than the mirror; Encoder::snapshot() is then
  /// refused.
  [[nodiscard]] virtual bool is_stateful() const { return false; }
  /// Appends the payload to `out`. After an error of one that is_stateful() the next job is a
  /// keyframe.
  virtual Status encode(const EncodeJob& job, std::vector<std::byte>& out) = 0;
};

/// State of one decoding session. Used by one thread at a time. After an error a backend with
/// state of its own answers reference_missing until the next keyframe.
class BackendDecoder {
 public:
  virtual ~BackendDecoder() = default;
  /// What can be told of a payload for that many blocks from its head and directory, in time and
  /// memory of its size: called before anything is allocated for its records.
  [[nodiscard]] virtual Status check(const TextureDesc& /*desc*/, std::size_t /*blocks*/,
                                     std::span<const std::byte> /*payload*/) const {
    return Status::ok;
  }
  virtual Status decode(const DecodeJob& job) = 0;
};

/// A kind of backend. Immutable, may be shared by threads; it is not referred to after create().
class Backend {
 public:
  virtual ~Backend() = default;
  /// Identifies the payload format in packets; 128..255 are free for applications.
  [[nodiscard]] virtual std::uint8_t id() const = 0;
  [[nodiscard]] virtual std::string_view name() const = 0;
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
