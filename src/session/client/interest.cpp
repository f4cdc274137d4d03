#include "session/client/interest.h"

#include "base/guard.h"

#include <utility>

namespace gicodec {
namespace {

Status say(const AnyMessage& message, std::vector<Message>& out) {
  Message bytes;
  const Status status = write_message(message, bytes);
  if (status == Status::ok) out.push_back(std::move(bytes));
  return status;
}

}  // namespace

Status Interest::set_viewpoint(const Viewpoint& viewpoint, std::vector<Message>& out) {
  return guarded([&]() -> Status {
    std::vector<Message> said;
    if (const Status fits = say(viewpoint, said); fits != Status::ok) return fits;
    if (there_is_session_) out.push_back(std::move(said.front()));
    viewpoint_ = viewpoint;
    return Status::ok;
  });
}

Status Interest::check(const Place& place, std::size_t blocks) const noexcept {
  const auto volume = volumes_.find(place.first);
  if (volume == volumes_.end()) return Status::unknown_volume;
  const auto& groups = volume->second.blocks;
  if (place.second >= groups.size()) return Status::unknown_group;
  return blocks == 0 || blocks == groups[place.second] ? Status::ok : Status::mask_mismatch;
}

Status Interest::subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                           std::uint8_t group, std::vector<Message>& out) {
  return guarded([&]() -> Status {
    const Place place{volume, group};
    BlockMask mask(blocks.begin(), blocks.end());
    if (there_is_session_) {
      if (const Status fits = check(place, mask.size()); fits != Status::ok) return fits;
    }
    BlockMask& kept = blocks_[place];
    const Status said =
        there_is_session_ ? say(Subscribe{generation_, volume, group, mask}, out) : Status::ok;
    if (said == Status::ok) kept = std::move(mask);
    return said;
  });
}

void Interest::learn(std::uint32_t generation, std::span<const ClientVolume> volumes) {
  std::map<std::uint16_t, Volume> known;
  for (const ClientVolume& volume : volumes) {
    Volume& of = known[volume.id];
    of.instance = volume.instance;
    for (const TextureGroup& group : volume.desc.groups) {
      of.blocks.push_back(block_count(group.textures[0].desc));
    }
  }
  volumes_ = std::move(known);
  generation_ = generation;
}

Status Interest::begin(std::uint32_t generation, std::span<const ClientVolume> volumes,
                       std::vector<Message>& out) {
  return guarded([&]() -> Status {
    learn(generation, volumes);
    there_is_session_ = true;
    if (viewpoint_) {
      if (const Status said = say(*viewpoint_, out); said != Status::ok) return said;
    }
    std::erase_if(blocks_, [&](const auto& wish) {
      return check(wish.first, wish.second.size()) != Status::ok;
    });
    for (auto& [place, mask] : blocks_) {
      if (mask.empty()) mask.resize(volumes_.at(place.first).blocks[place.second]);
      const Status said = say(Subscribe{generation_, place.first, place.second, mask}, out);
      if (said != Status::ok) return said;
    }
    return Status::ok;
  });
}

Status Interest::change(std::uint32_t generation, std::span<const ClientVolume> volumes) {
  return guarded([&]() -> Status {
    const auto before = volumes_;
    learn(generation, volumes);
    std::erase_if(blocks_, [&](const auto& wish) {
      const auto was = before.find(wish.first.first);
      const auto is = volumes_.find(wish.first.first);
      return was == before.end() || is == volumes_.end() ||
             was->second.instance != is->second.instance;
    });
    return Status::ok;
  });
}

}  // namespace gicodec
