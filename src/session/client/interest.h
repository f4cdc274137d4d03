// What a client wants to see, said to every session that it has.
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
  /// Keeps a wish, and appends its message to `out` if there is a session. After out_of_memory, or
  /// invalid_argument for numbers that are no viewpoint, all is as it was.
  Status set_viewpoint(const Viewpoint& viewpoint, std::vector<Message>& out);
  /// unknown_volume, unknown_group or mask_mismatch if there is a session; else that shows later.
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks, std::uint8_t group,
                   std::vector<Message>& out);

  /// A session with these volumes, of that generation: says all that was wished, but for what does
  /// not fit them any more, which is forgotten.
  Status begin(std::uint32_t generation, std::span<const ClientVolume> volumes,
               std::vector<Message>& out);
  /// It has these now. What was wished of one that has gone is forgotten.
  Status change(std::uint32_t generation, std::span<const ClientVolume> volumes);
  /// Until the next one there is none.
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
