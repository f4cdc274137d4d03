// The volumes of a Client: from the Welcome of a session, and as they come and go.
#include "session/client/client_frame.h"
#include "session/client/client_limits.h"
#include "session/client/client_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

void make_room(ClientVolume& volume, bool with_texels) {
  for (ClientTexture& texture : volume.textures) {
    if (with_texels) texture.texels.resize(static_cast<std::size_t>(texture_bytes(texture.desc)));
    texture.changed.resize(block_count(texture.desc));
  }
}

const DescribedVolume* find(std::span<const DescribedVolume> volumes, std::uint16_t id,
                            std::uint32_t added) noexcept {
  const auto same = [&](const DescribedVolume& one) { return one.id == id && one.added == added; };
  const auto it = std::find_if(volumes.begin(), volumes.end(), same);
  return it == volumes.end() ? nullptr : &*it;
}

}  // namespace

Status Client::State::take(const Welcome& said) {
  if (welcome || said.sync != sync) {
    ++statistics.stale_messages;
    return Status::ok;
  }
  if (said.delivery != options.delivery) return Status::corrupt;
  const bool goes_on = said.epoch == frame.epoch && said.generation >= generation;
  if (said.resumed && !goes_on) return Status::corrupt;
  const Status status = said.resumed ? follow(said.volumes) : begin(said);
  if (status != Status::ok) return status;
  generation = said.generation;
  welcome = true;
  resumed = said.resumed;
  ticket = said.ticket;
  const Status replied = reply(Acknowledge{sync, 0});
  return replied == Status::ok ? interest.begin(generation, frame.volumes, replies) : replied;
}

/// Begins a session: the client holds nothing, all blocks are zero.
Status Client::State::begin(const Welcome& said) {
  auto volumes = volumes_of(said.volumes, options, frames);
  if (!volumes) return volumes.status();
  // Frees the decoders of the last session first, so that memory stays within the limit.
  chains.clear();
  auto scratch_of_session = DecoderScratch::create();
  if (!scratch_of_session) return scratch_of_session.status();
  decoding = *std::move(scratch_of_session);
  for (ClientVolume& volume : *volumes) make_room(volume, has_texels());
  for (ClientVolume& volume : *volumes) volume.instance = ++instances;
  SceneId scene = said.scene;
  auto descriptions = said.volumes;
  frame.began = frame.serial + 1;
  frame.epoch = said.epoch;
  frame.volumes = *std::move(volumes);
  frame.scene = std::move(scene);
  described = std::move(descriptions);
  return Status::ok;
}

Status Client::State::take(const Volumes& said) {
  if (!welcome || said.generation <= generation) {
    ++statistics.stale_messages;
    return Status::ok;
  }
  const bool was_consistent = std::exchange(consistent, false);
  if (const Status status = follow(said.volumes); status != Status::ok) return status;
  generation = said.generation;
  consistent = was_consistent;
  return interest.change(generation, frame.volumes);
}

/// True if the volumes in both lists have not changed, apart from scrolling.
bool Client::State::describes(std::span<const DescribedVolume> said) const {
  return std::all_of(said.begin(), said.end(), [&](DescribedVolume volume) {
    const DescribedVolume* const held = find(described, volume.id, volume.added);
    if (held == nullptr) return true;
    volume.geometry.scroll = held->geometry.scroll;
    return *held == volume;
  });
}

/// Keeps the contents of volumes in both lists. Drops old volumes before it adds new ones, so that
/// memory stays within the limit. out_of_memory: the new ones are not added.
Status Client::State::follow(std::span<const DescribedVolume> said) {
  if (!describes(said)) return Status::corrupt;
  auto volumes = volumes_of(said, options, frames);
  if (!volumes) return volumes.status();
  std::vector<DescribedVolume> descriptions(said.begin(), said.end());
  const auto gone = [&](const auto& held) { return find(said, held.id, held.added) == nullptr; };
  std::erase_if(described, gone);
  const auto stays = [&](std::uint16_t id) {
    return std::any_of(described.begin(), described.end(),
                       [id](const DescribedVolume& one) { return one.id == id; });
  };
  std::erase_if(chains, [&](const auto& chain) { return !stays(chain.first.volume); });
  std::erase_if(frame.volumes, [&](const ClientVolume& volume) { return !stays(volume.id); });
  for (ClientVolume& volume : *volumes) {
    if (frame.find(volume.id) != nullptr) continue;
    make_room(volume, has_texels());
    volume.instance = ++instances;
  }
  // From here on nothing can fail.
  for (ClientVolume& volume : *volumes) {
    ClientVolume* const held = find_volume(frame.volumes, volume.id);
    if (held != nullptr) volume = std::move(*held);
  }
  frame.volumes = *std::move(volumes);
  described = std::move(descriptions);
  return Status::ok;
}

}  // namespace gicodec
