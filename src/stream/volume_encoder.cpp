// The steps of an encoder (encoder.cpp) with all textures: commits after all are coded.
#include <gicodec/volume_encoder.h>

#include "base/guard.h"
#include "stream/texture_encoder.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gicodec {

struct VolumeEncoder::State {
  /// The textures of a group.
  [[nodiscard]] std::span<const std::unique_ptr<TextureEncoder>> encoders_of(
      std::size_t group) const noexcept {
    std::size_t first = 0;
    for (std::size_t s = 0; s < group; ++s) first += volume.groups[s].textures.size();
    return std::span(textures).subspan(first, volume.groups[group].textures.size());
  }
  Status select(std::size_t group, std::span<const ConstTextureView> views, Selection selection,
                bool keyframe);
  Status encode(std::span<const ConstTextureView> views, std::span<const Selection> selections,
                std::vector<Packet>& out);

  VolumeDesc volume;
  std::vector<std::unique_ptr<TextureEncoder>> textures;
  std::vector<std::vector<std::uint32_t>> changed;  ///< by group, of bundled ones
};

/// Selects blocks of a group's textures. Also sets their presence, and the group's changed blocks.
Status VolumeEncoder::State::select(std::size_t group, std::span<const ConstTextureView> views,
                                    Selection selection, bool keyframe) {
  const auto own = encoders_of(group);
  std::vector<std::uint32_t>& all = changed[group];
  std::vector<std::uint32_t> merged;
  for (std::size_t t = 0; t < own.size(); ++t) {
    TextureEncoder& texture = *own[t];
    if (texture.desc().presence != Presence::all) {
      const Status taken = texture.take_presence(*own[volume.groups[group].presence]);
      if (taken != Status::ok) return taken;
    }
    if (const Status status = texture.select(views[t], selection); status != Status::ok) {
      return status;
    }
  }
  all.clear();
  for (const auto& texture : own) {
    if (selection.type() == Selection::Type::changed) texture->keep_changed(keyframe);
    if (!volume.groups[group].bundled) continue;
    merged.clear();
    std::set_union(all.begin(), all.end(), texture->blocks().begin(), texture->blocks().end(),
                   std::back_inserter(merged));
    std::swap(all, merged);
  }
  return Status::ok;
}

Status VolumeEncoder::State::encode(std::span<const ConstTextureView> views,
                                    std::span<const Selection> selections,
                                    std::vector<Packet>& out) {
  const bool keyframe = std::any_of(textures.begin(), textures.end(),
                                    [](const auto& texture) { return texture->keyframe_due(); });
  const CancelUncommitted pending(textures);
  for (std::size_t group = 0; group < volume.groups.size(); ++group) {
    const auto own = encoders_of(group);
    const Status status = select(group, views.first(own.size()), selections[group], keyframe);
    if (status != Status::ok) return status;
    views = views.subspan(own.size());
    for (const auto& texture : own) {
      const bool bundled = volume.groups[group].bundled;
      const Status coded = texture->write(
          bundled ? std::span<const std::uint32_t>(changed[group]) : texture->blocks(), keyframe);
      if (coded != Status::ok) return coded;
    }
  }
  out.resize(textures.size());
  // From here on nothing can fail.
  for (std::size_t t = 0; t < textures.size(); ++t) {
    textures[t]->commit(keyframe);
    std::swap(out[t], textures[t]->packet());
  }
  return Status::ok;
}

VolumeEncoder::VolumeEncoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
VolumeEncoder::VolumeEncoder(VolumeEncoder&&) noexcept = default;
VolumeEncoder& VolumeEncoder::operator=(VolumeEncoder&&) noexcept = default;
VolumeEncoder::~VolumeEncoder() = default;

Result<VolumeEncoder> VolumeEncoder::create(const VolumeDesc& volume,
                                            const VolumeEncoderOptions& options) {
  return guarded([&]() -> Result<VolumeEncoder> {
    if (const Status status = validate(volume); status != Status::ok) return status;
    auto state = std::make_unique<State>();
    state->volume = volume;
    state->changed.resize(volume.groups.size());
    for (const TextureGroup& group : volume.groups) {
      for (const NamedTexture& texture : group.textures) {
        const std::size_t place = state->textures.size();
        const auto& errors = options.max_errors;
        const auto& chosen = options.texture_backends;
        if (options.first_texture + place > UINT8_MAX) return Status::invalid_argument;
        if (!errors.empty() && place >= errors.size()) return Status::invalid_argument;
        if (!chosen.empty() && place >= chosen.size()) return Status::invalid_argument;
        const Backend* const own = chosen.empty() ? nullptr : chosen[place];
        const float error = errors.empty() ? 0 : errors[place];
        if (error != 0 && &texture - group.textures.data() == group.presence) {
          return Status::invalid_bound;
        }
        auto made = TextureEncoder::create(
            texture.desc, {.backend = own == nullptr ? options.backend : own->name(),
                           .settings = options.settings,
                           .gop = options.gop,
                           .texture_id = static_cast<std::uint8_t>(options.first_texture + place),
                           .max_error = error,
                           .backends = own == nullptr ? options.backends : std::vector{own}});
        if (!made) return made.status();
        state->textures.push_back(*std::move(made));
      }
    }
    const std::size_t count = state->textures.size();
    if (options.max_errors.size() > count || options.texture_backends.size() > count) {
      return Status::invalid_argument;
    }
    return VolumeEncoder(std::move(state));
  });
}

Result<std::vector<Packet>> VolumeEncoder::encode(std::span<const ConstTextureView> views,
                                                  Selection selection) {
  return guarded([&]() -> Result<std::vector<Packet>> {
    return encode(views, std::vector<Selection>(desc().groups.size(), selection));
  });
}

Result<std::vector<Packet>> VolumeEncoder::encode(std::span<const ConstTextureView> views,
                                                  std::span<const Selection> selections) {
  if (views.size() != state_->textures.size() || selections.size() != desc().groups.size()) {
    return Status::invalid_argument;
  }
  return guarded([&]() -> Result<std::vector<Packet>> {
    std::vector<Packet> packets;
    const Status status = state_->encode(views, selections, packets);
    if (status != Status::ok) return status;
    return packets;
  });
}

Result<std::vector<Packet>> VolumeEncoder::snapshot() {
  return guarded([&]() -> Result<std::vector<Packet>> {
    std::vector<Packet> packets(state_->textures.size());
    for (std::size_t t = 0; t < packets.size(); ++t) {
      const Status status = state_->textures[t]->snapshot(packets[t]);
      if (status != Status::ok) return status;
    }
    return packets;
  });
}

void VolumeEncoder::request_keyframe() noexcept {
  for (const auto& texture : state_->textures) texture->request_keyframe();
}

Status VolumeEncoder::set_preset(std::uint8_t texture, std::string_view preset) {
  if (texture >= state_->textures.size()) return Status::unknown_texture;
  return guarded([&] { return state_->textures[texture]->set_preset(preset); });
}

Status VolumeEncoder::set_active(std::uint8_t group, std::span<const std::uint8_t> active) {
  if (group >= desc().groups.size()) return Status::unknown_group;
  const auto own = state_->encoders_of(group);
  if (!active.empty() && active.size() != block_count(own.front()->desc())) {
    return Status::mask_mismatch;
  }
  return guarded([&]() -> Status {
    std::vector<Vector<std::uint8_t>> copies(own.size(), {active.begin(), active.end()});
    for (std::size_t t = 0; t < own.size(); ++t) own[t]->set_active(std::move(copies[t]));
    return Status::ok;
  });
}

Status VolumeEncoder::read(std::uint8_t texture, TextureView view) const {
  if (texture >= state_->textures.size()) return Status::unknown_texture;
  return state_->textures[texture]->read(view);
}

const VolumeDesc& VolumeEncoder::desc() const noexcept { return state_->volume; }

}  // namespace gicodec
