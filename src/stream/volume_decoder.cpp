#include <gicodec/volume_decoder.h>

#include "base/guard.h"
#include "bitstream/packet.h"
#include "stream/texture_decoders.h"

#include <utility>

namespace gicodec {
namespace {

std::vector<TextureDecoders::Texture> whole_textures(const VolumeDesc& volume) {
  std::vector<TextureDecoders::Texture> textures;
  for (const TextureGroup& group : volume.groups) {
    const std::size_t first = textures.size();
    for (const NamedTexture& texture : group.textures) {
      TextureDecoders::Texture& added = textures.emplace_back();
      added.desc = texture.desc;
      if (texture.desc.presence != Presence::all) {
        added.presence = static_cast<std::uint8_t>(first + group.presence);
      }
    }
  }
  return textures;
}

}  // namespace

struct VolumeDecoder::State {
  State(const VolumeDesc& desc, TextureDecoders made, std::uint8_t first)
      : volume(desc), textures(std::move(made)), first_texture(first), updated(textures.size()) {}

  /// The texture of a packet, by its place in the volume. unknown_texture.
  [[nodiscard]] Result<std::uint8_t> place_of(std::span<const std::byte> packet) const noexcept;
  Status decode(std::uint8_t texture, std::span<const std::byte> packet);

  VolumeDesc volume;
  TextureDecoders textures;
  std::uint8_t first_texture;
  std::vector<bool> updated;  ///< textures that had a packet in the last decode()
};

Result<std::uint8_t> VolumeDecoder::State::place_of(
    std::span<const std::byte> packet) const noexcept {
  const auto info = peek(packet);
  if (!info) return info.status();
  const int place = info->texture_id - first_texture;
  if (place < 0 || static_cast<std::size_t>(place) >= textures.size()) {
    return Status::unknown_texture;
  }
  return static_cast<std::uint8_t>(place);
}

Status VolumeDecoder::State::decode(std::uint8_t texture, std::span<const std::byte> packet) {
  const Decoder& decoder = *textures.find(texture, StreamId::kWholeVolume);
  const auto parts = parse_packet(packet);
  const bool held =
      parts.ok() && decoder.sequence() != 0 && decoder.sequence() == parts->info.sequence &&
      decoder.checksum() == checksum_after(*parts, packet) && verify_checksum(packet) == Status::ok;
  const Status status =
      held ? Status::ok : textures.decode(texture, StreamId::kWholeVolume, packet);
  updated[texture] = status == Status::ok;
  return status;
}

VolumeDecoder::VolumeDecoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
VolumeDecoder::VolumeDecoder(VolumeDecoder&&) noexcept = default;
VolumeDecoder& VolumeDecoder::operator=(VolumeDecoder&&) noexcept = default;
VolumeDecoder::~VolumeDecoder() = default;

Result<VolumeDecoder> VolumeDecoder::create(const VolumeDesc& volume,
                                            const VolumeDecoderOptions& options) {
  return guarded([&]() -> Result<VolumeDecoder> {
    if (const Status status = validate(volume); status != Status::ok) return status;
    auto textures = TextureDecoders::create(
        whole_textures(volume),
        {options.limits, options.backends, options.threads, nullptr, options.isa, options.cancel});
    if (!textures) return textures.status();
    if (options.first_texture + textures->size() - 1 > UINT8_MAX) return Status::invalid_argument;
    for (std::size_t t = 0; t < textures->size(); ++t) {
      const auto made = textures->decoder(static_cast<std::uint8_t>(t), StreamId::kWholeVolume);
      if (!made) return made.status();
    }
    return VolumeDecoder(
        std::make_unique<State>(volume, *std::move(textures), options.first_texture));
  });
}

Status VolumeDecoder::decode(std::span<const Packet> update) {
  return guarded([&]() -> Status {
    State& s = *state_;
    std::vector<std::uint8_t> places;
    for (const Packet& packet : update) {
      const auto place = s.place_of(packet);
      if (!place) return place.status();
      if (!places.empty() && *place <= places.back()) return Status::out_of_order;
      places.push_back(*place);
    }
    s.updated.assign(s.updated.size(), false);
    Status status = Status::ok;
    for (std::size_t i = 0; status == Status::ok && i < update.size(); ++i) {
      status = s.decode(places[i], update[i]);
    }
    return status;
  });
}

Status VolumeDecoder::decode(std::span<const std::byte> packet) {
  return guarded([&]() -> Status {
    const auto place = state_->place_of(packet);
    if (!place) return place.status();
    state_->updated.assign(state_->updated.size(), false);
    return state_->decode(*place, packet);
  });
}

Status VolumeDecoder::read(std::uint8_t texture, TextureView view) const {
  const Decoder* const held = decoder(texture);
  return held == nullptr ? Status::unknown_texture : held->read(view);
}

Status VolumeDecoder::read(std::uint8_t texture, TextureView view,
                           std::span<const std::uint32_t> blocks) const {
  const Decoder* const held = decoder(texture);
  return held == nullptr ? Status::unknown_texture : held->read(view, blocks);
}

std::span<const std::uint32_t> VolumeDecoder::changed(std::uint8_t texture) const noexcept {
  const bool there = texture < state_->updated.size() && state_->updated[texture];
  return there ? decoder(texture)->changed() : std::span<const std::uint32_t>();
}

const Decoder* VolumeDecoder::decoder(std::uint8_t texture) const noexcept {
  return state_->textures.find(texture, StreamId::kWholeVolume);
}

const VolumeDesc& VolumeDecoder::desc() const noexcept { return state_->volume; }
std::uint64_t VolumeDecoder::memory() const noexcept { return state_->textures.memory(); }

}  // namespace gicodec
