#include "recording.h"

#include "common/container_input.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <map>
#include <set>
#include <utility>

namespace gicodec::streaming {
namespace {

/// The state of checking a container.
class Look {
 public:
  explicit Look(const std::string& path) : input_(path) {}

  Recording through() {
    try {
      while (found_.flaw.empty() && input_.skip_frame()) take(input_.packets());
      if (found_.flaw.empty() && input_.cut_off())
        found_.flaw = fmt::format("{}: {}", input_.path(), input_.missing());
    } catch (const tools::Error& damage) {
      found_.flaw = damage.what();
    }
    // The frame with the flaw.
    if (!found_.flaw.empty() && found_.frames > 0 && !last_whole_) --found_.frames;
    for (std::size_t i = 0; i < input_.textures().size(); ++i) {
      const std::string loss = input_.textures()[i].loss();
      if (!loss.empty()) found_.remarks.push_back(fmt::format("{}: {}", input_.path(), loss));
    }
    return std::move(found_);
  }

 private:
  void take(std::span<const ContainerPacket> packets) {
    for (const ContainerPacket& packet : packets) {
      const auto info = peek(packet.bytes);
      Status status = info.status();
      if (status == Status::ok) status = verify_checksum(packet.bytes);
      std::uint32_t& sequence = sequences_[{packet.texture_id, packet.region}];
      if (status == Status::ok && !is_keyframe(info->type) && info->reference != sequence)
        status = Status::reference_missing;
      if (status != Status::ok) {
        found_.flaw = fmt::format("{}: {}", input_.where(packet), to_string(status));
        return;
      }
      sequence = info->sequence;
    }
    ++found_.frames;
    std::set<std::uint8_t> textures;
    for (const ContainerPacket& packet : packets) textures.insert(packet.texture_id);
    last_whole_ = textures.size() == input_.textures().size();
  }

  tools::ContainerInput input_;
  /// Of the last packet of each texture, or region of one.
  std::map<std::pair<std::uint8_t, std::uint32_t>, std::uint32_t> sequences_;
  bool last_whole_ = true;
  Recording found_;
};

}  // namespace

Recording look_through(const std::string& container) { return Look(container).through(); }

Recording look_through(const std::vector<tools::Sequence>& dumps) {
  Recording found;
  std::vector<TextureDesc> descs;
  for (const tools::Sequence& sequence : dumps)
    descs.push_back(tools::read_dump_info(sequence.frames.front().path).desc);
  for (; found.frames < dumps.front().frames.size(); ++found.frames) {
    for (std::size_t i = 0; i < dumps.size(); ++i) {
      const std::string& path = dumps[i].frames[found.frames].path;
      try {
        if (tools::read_dump_info(path).desc == descs[i]) continue;
        found.flaw = fmt::format("{}: is not like the first frame", path);
      } catch (const tools::Error& damage) {
        found.flaw = damage.what();
      }
      return found;
    }
  }
  return found;
}

}  // namespace gicodec::streaming
