#include "texture_states.h"

#include "volume_words.h"

#include <algorithm>
#include <cstring>

namespace gicodec::tools {
namespace {

/// Rounded up.
std::uint64_t mebibytes(std::uint64_t bytes) { return (bytes >> 20) + 1; }

/// What a further decoder takes that shares its scratch.
std::uint64_t held_by_region(const TextureDesc& desc) {
  constexpr std::uint64_t kFixed = 4096, kBlock = 16;
  return kFixed + texture_bytes(desc) + kBlock * block_count(desc);
}

void add_received(const Decoder& decoder, std::vector<std::uint32_t>& blocks) {
  const auto received = decoder.received();
  for (std::uint32_t block = 0; block < received.size(); ++block) {
    if (received[block] != 0) blocks.push_back(block);
  }
}

[[noreturn]] void fail_backend(std::uint8_t id, const TextureDesc& desc, const std::string& where) {
  const std::string_view name = backend_name(id);
  if (name.empty()) fail(Exit::bad_input, "{}: its backend is unknown here", where);
  const auto all = all_backends();
  const bool here = std::any_of(all.begin(), all.end(),
                                [&](const Backend* backend) { return backend->id() == id; });
  if (!here) fail(Exit::internal, "{}: backend {} is not in this build", where, name);
  fail(Exit::bad_input, "{}: backend {} does not code blocks of {} {}", where, name,
       block_text(desc.block), record_text(desc.record));
}

}  // namespace

TextureStates::TextureStates(const ContainerInput& input, const DecoderFlags& flags)
    : input_(input), flags_(flags), states_(input.textures().size()) {}

void TextureStates::take_memory(std::size_t texture, std::uint64_t bytes) {
  const std::uint64_t wanted = memory_ += bytes;
  if (wanted <= flags_.memory << 20) return;
  fail(Exit::bad_input,
       "{}: texture {}: decoding takes {} MiB with the textures before it, and {} are allowed; "
       "--max-memory {} allows it",
       input_.path(), input_.textures()[texture].name, mebibytes(wanted), flags_.memory,
       mebibytes(wanted));
}

std::span<const std::byte> TextureStates::texels(std::size_t texture) {
  std::vector<std::byte>& texels = states_[texture].texels;
  const StoredTexture& stored = input_.textures()[texture];
  if (texels.empty() && stored.no_dump.empty()) {
    take_memory(texture, texture_bytes(stored.info.desc));
    texels.resize(static_cast<std::size_t>(texture_bytes(stored.info.desc)));
  }
  return texels;
}

Decoder& TextureStates::open(std::size_t texture, std::uint32_t region) {
  State& state = states_[texture];
  const auto found = state.decoders.find(region);
  if (found != state.decoders.end()) return found->second;
  const StoredTexture& stored = input_.textures()[texture];
  const TextureEntry& entry = input_.description().textures[texture];
  TextureDesc desc = part_of(input_.description(), entry, region);
  if (region == 0 && stored.no_dump.empty()) desc.layout = stored.info.desc.layout;
  (void)texels(texture);
  const std::string where = fmt::format("{}: texture {}", input_.path(), stored.name);
  if (state.scratch == nullptr) {
    const TextureDesc largest = part_of(input_.description(), entry, region == 0 ? 0 : 1);
    take_memory(texture, decoder_memory(largest, flags_.threads));
    if (region != 0 && !state.texels.empty()) {
      constexpr std::uint64_t kBlock = 16;  // Of State::blocks, as it grows.
      take_memory(texture, texture_bytes(largest) + kBlock * block_count(largest));
      state.region.resize(static_cast<std::size_t>(texture_bytes(largest)));
    }
    state.scratch = take(DecoderScratch::create(), where);
  } else {
    take_memory(texture, held_by_region(desc));
  }
  return state.decoders.emplace(region, make_decoder(desc, flags_, where, state.scratch))
      .first->second;
}

std::optional<std::size_t> TextureStates::presence_of(std::size_t texture) const {
  const ContainerDescription& description = input_.description();
  const VolumeEntry& volume = description.volumes[description.textures[texture].volume];
  std::size_t first = volume.first_texture;
  for (const BlockSet& set : volume.desc.sets) {
    const std::size_t end = first + set.textures.size();
    if (texture < end) {
      const bool told = description.textures[texture].desc.presence != Presence::all;
      return told && set.presence == 0 ? std::optional(first) : std::nullopt;
    }
    first = end;
  }
  return std::nullopt;
}

std::vector<std::vector<const ContainerPacket*>> TextureStates::independent(
    const std::vector<ContainerPacket>& packets) const {
  std::map<std::size_t, std::vector<const ContainerPacket*>> lists;
  for (const ContainerPacket& packet : packets) {
    lists[presence_of(packet.texture_id).value_or(packet.texture_id)].push_back(&packet);
  }
  std::vector<std::vector<const ContainerPacket*>> all;
  for (auto& [texture, list] : lists) {
    // What says which records exist comes first.
    std::stable_sort(list.begin(), list.end(), [](const auto* left, const auto* right) {
      return left->texture_id < right->texture_id;
    });
    all.push_back(std::move(list));
  }
  return all;
}

void TextureStates::copy_region(State& state, std::size_t texture, std::uint32_t region) {
  const TextureDesc& whole = input_.textures()[texture].info.desc;
  const TextureEntry& entry = input_.description().textures[texture];
  const Grid& size = input_.description().volumes[entry.volume].region;
  const Decoder& decoder = state.decoders.at(region);
  const TextureDesc& part = decoder.desc();
  const std::span room(state.region.data(), static_cast<std::size_t>(texture_bytes(part)));
  check(decoder.read(TextureView{room}, state.blocks), input_.path());
  const std::size_t side = whole.block.x + 2U * whole.guard_band;
  const Extent from_all = extent(part), to_all = extent(whole);
  const auto offset = [](const TextureDesc& desc, const Extent& all, std::uint32_t block) {
    const BlockOrigin at = block_origin(desc, block);
    return (((at.slice + at.block) * all.height + at.y) * all.width + at.x) * desc.record.bytes;
  };
  const Grid first = regions_of(entry.desc, size).first_of(region - 1);
  const auto place = [&](std::uint32_t block) {
    const std::uint32_t x = first.x + block % part.grid.x,
                        y = first.y + block / part.grid.x % part.grid.y,
                        z = first.z + block / (part.grid.x * part.grid.y);
    return x + whole.grid.x * (y + whole.grid.y * z);
  };
  for (const std::uint32_t block : state.blocks) {
    std::byte* to = &state.texels[offset(whole, to_all, place(block))];
    const std::byte* from = &room[offset(part, from_all, block)];
    for (std::size_t row = 0; row < side; ++row) {
      std::memcpy(to, from, side * whole.record.bytes);
      to += to_all.width * whole.record.bytes;
      from += from_all.width * part.record.bytes;
    }
  }
}

void TextureStates::apply(const ContainerPacket& packet) {
  const std::size_t texture = packet.texture_id;
  const auto where = [&] { return input_.where(packet); };
  const auto info = peek(packet.bytes);
  if (!is_known(input_.description().textures[texture])) {
    check(info.status(), where());
    return check(verify_checksum(packet.bytes), where());
  }
  Decoder& decoder = open(texture, packet.region);
  if (const auto presence = presence_of(texture)) {
    check(decoder.set_presence(open(*presence, packet.region).records()), where());
  }
  if (info) load_backend(info->backend);
  State& state = states_[texture];
  const bool cut = packet.region != 0 && !state.texels.empty();
  state.blocks.clear();
  if (cut && info && info->keyframe) add_received(decoder, state.blocks);  // They become zero.
  const Status status = state.texels.empty() || cut
                            ? decoder.decode(packet.bytes)
                            : decoder.decode(packet.bytes, TextureView{state.texels});
  if (status == Status::backend_missing) fail_backend(info->backend, decoder.desc(), where());
  check(status, where());
  if (!cut) return;
  const auto updated = decoder.updated();
  state.blocks.insert(state.blocks.end(), updated.begin(), updated.end());
  copy_region(state, texture, packet.region);
}

}  // namespace gicodec::tools
