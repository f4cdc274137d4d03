// Statistics of native payloads, for `gicodec info`.
#pragma once

#include "common/container_input.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace gicodec::tools {

/// Limits of memory and work for decoding a container's packets, in proportion to their bytes,
/// because a small packet may hold a large texture.
class LookBudget {
 public:
  void add_packet(std::size_t bytes) noexcept {
    memory_ += kMemoryPerByte * bytes;
    work_ += kWorkPerByte * bytes;
  }
  /// Takes bytes from the budget; false if it has fewer.
  [[nodiscard]] bool take_memory(std::uint64_t bytes) noexcept { return take(memory_, bytes); }
  [[nodiscard]] bool take_work(std::uint64_t bytes) noexcept { return take(work_, bytes); }

 private:
  static constexpr std::uint64_t kMemoryPerByte = 48, kWorkPerByte = 128;
  static bool take(std::uint64_t& rest, std::uint64_t bytes) noexcept {
    if (bytes > rest) return false;
    rest -= bytes;
    return true;
  }
  std::uint64_t memory_ = std::uint64_t{128} << 20;  ///< bytes, for all textures
  std::uint64_t work_ = std::uint64_t{64} << 20;     ///< bytes of decoded blocks
};

/// Decodes the packets of one texture to count their bits. Reports nothing for a texture with
/// packets of other backends, or one that needs a presence texture.
class PayloadReport {
 public:
  /// `desc`: the texture that the packet was made for. `where`: file, frame and texture, for
  /// errors.
  void add(const ContainerPacket& packet, const PacketInfo& info, const TextureDesc& desc,
           const std::string& where, LookBudget& budget);
  void print(const Record& record) const;
  /// Null if there is nothing to report, or the budget is exceeded.
  [[nodiscard]] nlohmann::ordered_json json(const Record& record) const;

 private:
  struct Session {
    std::unique_ptr<PayloadStatistics> last;  ///< of the last packet
    Decoder decoder;
  };
  void give_up() { sessions_.clear(); }

  std::map<std::uint32_t, Session> sessions_;  ///< by region
  PayloadStatistics keyframes_, updates_;
  bool not_told_ = false;
  bool too_much_ = false;
};

}  // namespace gicodec::tools
