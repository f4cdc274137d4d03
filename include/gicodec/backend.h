// Backends: what turns the core texels of some probes into bytes and back. Built in: "raw", "lz4",
// "zstd" and "native". Others are objects of a class derived from Backend and are handed to
// Encoder::create and Decoder::create, e.g. HevcBackend of <gicodec/hevc.h>.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec {

/// Settings common to all encoders; each backend says which it reads and refuses values outside
/// its range with Status::invalid_argument.
struct BackendSettings {
  int level = 0;  ///< lz4: 1..12, above 2 is LZ4HC; zstd: 1..22; 0 is the backend's default
  /// native: "fast" (the default) or "strong"; hevc: x265 preset; empty is the backend's default
  std::string preset = {};
  bool difference = true;  ///< raw, lz4, zstd: code differences to the mirror in updates
  /// native: threads per update, 1..256, with no influence on the bytes; hevc: threads of an
  /// encoder of FFmpeg's, x265 keeps to one
  unsigned threads = 1;
  Isa isa = best_isa();  ///< every kernel, with no influence on the bytes; the machine must have it
};

/// Core texels are passed block after block in the order of `probes`; a block is core × core
/// texels, row by row, tightly packed.
struct EncodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> probes;  ///< ascending, unique, in range
  std::span<std::byte> texels;            ///< a lossy backend replaces them by what is decoded
  std::span<const std::byte> mirror;      ///< core texels of every probe before this update
  bool keyframe = false;                  ///< the payload must not depend on `mirror` or the past
};

/// Where the bits of decoded payloads went, in sums. Only "native" tells.
struct PayloadStatistics {
  static constexpr unsigned kPlanes = 8;
  std::uint64_t chunks = 0, raw_chunks = 0;
  std::uint64_t head_bytes = 0;     ///< of payloads and chunks, entropy coder states included
  std::uint64_t table_bytes = 0;    ///< tables that chunks bring along
  std::uint64_t raw_bytes = 0;      ///< texels of raw chunks
  std::uint64_t word_bytes = 0;     ///< what the entropy coder wrote; the bits below, rounded up
  double mode_bits = 0;             ///< choice of modes
  double repeat_bits = 0;           ///< which candidate a texel repeats, if any
  double plane_bits[kPlanes] = {};  ///< residuals by plane (docs/native.md, "Planes")
  std::uint64_t plane_symbols[kPlanes] = {};  ///< residuals coded
  std::uint64_t repeats[3] = {};              ///< first guess, second guess, escape
  std::uint64_t modes[2][8] = {};             ///< blocks by mode, of the pair model by plane

  PayloadStatistics& operator+=(const PayloadStatistics& other) noexcept;
};

struct DecodeJob {
  const TextureDesc& desc;
  std::span<const std::uint32_t> probes;
  std::span<const std::byte> payload;  ///< hostile: validate everything
  std::span<const std::byte> mirror;   ///< as above; not to be read for a keyframe
  std::span<std::byte> texels;         ///< to be written completely, or an error returned
  bool keyframe = false;
  unsigned threads = 1;                     ///< that the backend may use
  PayloadStatistics* statistics = nullptr;  ///< if set, to be added to
  Isa isa = best_isa();                     ///< kernels; invalid_argument if the machine lacks them
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
  /// Upper bound of the payload for that many probes.
  [[nodiscard]] virtual std::size_t bound(std::size_t probes) const = 0;
  /// True if decoded texels may differ from those encoded.
  [[nodiscard]] virtual bool lossy() const { return false; }
  /// True if a payload depends on earlier ones by more than the mirror; Encoder::snapshot() is then
  /// refused.
  [[nodiscard]] virtual bool remembers() const { return false; }
  /// Appends the payload to `out`. After an error of one that remembers() the next job is a
  /// keyframe.
  virtual Status encode(const EncodeJob& job, std::vector<std::byte>& out) = 0;
};

/// State of one decoding session. Used by one thread at a time. After an error a backend with
/// state of its own answers reference_missing until the next keyframe.
class BackendDecoder {
 public:
  virtual ~BackendDecoder() = default;
  /// What can be told of a payload for that many probes from its head and directory, in time and
  /// memory of its size: called before anything is allocated for its texels.
  [[nodiscard]] virtual Status check(const TextureDesc& /*desc*/, std::size_t /*probes*/,
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
