// Interest: what a client wants to see. Each new session gets it.
#pragma once

#include <gicodec/client.h>
#include <gicodec/protocol.h>
#include <gicodec/status.h>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

class Interest {
 public:
  /// Keeps the viewpoint, and appends its message to `out` if there is a session. out_of_memory and
  /// invalid_argument (out of range) change nothing.
  Status set_viewpoint(const Viewpoint& viewpoint, std::vector<Message>& out);
  /// As set_viewpoint(). In a session also: unknown_volume, unknown_group, mask_mismatch.
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks, std::uint8_t group,
                   std::vector<Message>& out);

  /// Begins a session with these volumes: appends the messages of all interest to `out`, and drops
  /// interest that does not fit the volumes.
  Status begin(std::uint32_t generation, std::span<const ClientVolume> volumes,
               std::vector<Message>& out);
  /// The session has other volumes. Drops interest in those that have gone.
  Status change(std::uint32_t generation, std::span<const ClientVolume> volumes);
  /// Ends the session.
  void end() noexcept { there_is_session_ = false; }

 private:
  using Place = std::pair<std::uint16_t, std::uint8_t>;  ///< volume and group
  void learn(std::uint32_t generation, std::span<const ClientVolume> volumes);
  [[nodiscard]] Status check(const Place& place, std::size_t blocks) const noexcept;

  std::optional<Viewpoint> viewpoint_;
  std::map<Place, BlockMask> blocks_;
  bool there_is_session_ = false;
  std::uint32_t generation_ = 0;
  struct Volume {
    std::uint64_t instance = 0;
    std::vector<std::uint32_t> blocks;  ///< of each group
  };
  std::map<std::uint16_t, Volume> volumes_;
};

}  // namespace gicodec
