// packet → backend → mirror → reconstruct → texture view: the encoder's steps in reverse.
#include <gicodec/decoder.h>

#include "backend/find_backend.h"
#include "base/guard.h"
#include "base/parallel.h"
#include "bitstream/description.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "stream/decoder_memory.h"
#include "stream/guard_band_section.h"
#include "stream/mirror.h"
#include "stream/state_hash.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gicodec {

/// Memory for decoding a packet, besides the mirror; textures can share it.
struct DecoderScratch::State {
  std::vector<std::pair<std::uint8_t, std::unique_ptr<BackendDecoder>>> backends;  ///< built in
  Vector<std::uint32_t> blocks;
  Vector<std::byte> records;
  Vector<std::byte> presence;
  StaleBands stale, before;
  GuardBandMemory bands;
};

DecoderScratch::DecoderScratch(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
DecoderScratch::~DecoderScratch() = default;

Result<std::shared_ptr<DecoderScratch>> DecoderScratch::create() {
  return guarded([&]() -> Result<std::shared_ptr<DecoderScratch>> {
    return std::shared_ptr<DecoderScratch>(new DecoderScratch(std::make_unique<State>()));
  });
}

struct Decoder::State {
  State(const TextureDesc& desc, const DecoderOptions& options)
      : mirror(desc, options.isa, options.threads), description(description_hash(desc)) {}

  Status apply(std::span<const std::byte> packet, const CheckedView<std::byte>* view);
  Status gather_presence(std::span<const std::byte> whole, std::span<const std::uint32_t> blocks);
  Status check_reference(const PacketParts& parts) const;
  Status check_sections(const PacketParts& parts, std::uint32_t count,
                        const BackendDecoder& decoder) const;
  [[nodiscard]] Result<BackendDecoder*> backend(std::uint8_t id);

  Mirror mirror;
  std::uint32_t description;  ///< its hash
  DecodeLimits limits;
  Threads threads;
  PayloadStatistics* statistics = nullptr;
  Isa isa = best_isa();
  const std::atomic<bool>* cancel = nullptr;
  std::shared_ptr<DecoderScratch> shared;
  DecoderScratch::State* scratch = nullptr;
  std::vector<std::pair<std::uint8_t, std::unique_ptr<BackendDecoder>>> backends;  ///< given
  std::span<const std::byte> presence;  ///< of all blocks; the caller's memory
  std::uint32_t sequence = 0;
  std::uint32_t last_checksum = 0;  ///< of packet `sequence`
  std::uint8_t texture_id = 0;      ///< of the last packet applied

  Vector<std::uint32_t> changed;  ///< by the last packet applied
};

/// The decoder of a backend. Makes those of built-in backends on first use.
Result<BackendDecoder*> Decoder::State::backend(std::uint8_t id) {
  for (auto* list : {&backends, &scratch->backends}) {
    for (const auto& [known, decoder] : *list) {
      if (known == id) return decoder.get();
    }
  }
  const Backend* found = find_backend(id);
  if (found == nullptr) return Status::backend_missing;
  auto decoder = found->make_decoder(mirror.desc());
  if (!decoder) return decoder.status();
  scratch->backends.emplace_back(id, *std::move(decoder));
  return scratch->backends.back().second.get();
}

Status Decoder::State::check_reference(const PacketParts& parts) const {
  if (is_keyframe(parts.info.type)) {
    return parts.base == description ? Status::ok : Status::description_mismatch;
  }
  const bool here = sequence != 0 && parts.info.reference == sequence &&
                    parts.base == last_checksum && parts.info.texture_id == texture_id;
  return here ? Status::ok : Status::reference_missing;
}

/// All checks that need no memory for the packet's blocks.
Status Decoder::State::check_sections(const PacketParts& parts, std::uint32_t count,
                                      const BackendDecoder& decoder) const {
  const auto& desc = mirror.desc();
  Status status = check_index_buffer(parts.index_mode, count, block_count(desc), parts.index);
  if (status == Status::ok && !parts.guard_bands.empty()) {
    status = check_guard_band_section(desc, count, parts.guard_bands);
  }
  return status == Status::ok ? decoder.check(desc, count, parts.payload) : status;
}

/// Gathers the presence of a packet's blocks.
Status Decoder::State::gather_presence(std::span<const std::byte> whole,
                                       std::span<const std::uint32_t> blocks) {
  const std::size_t size = presence_bytes(mirror.desc());
  if (whole.size() != size * block_count(mirror.desc())) return Status::out_of_order;
  scratch->presence.clear();
  if (size == 0) return Status::ok;
  scratch->presence.reserve(blocks.size() * size);
  for (const std::uint32_t block : blocks) {
    const auto exists = whole.subspan(block * size, size);
    scratch->presence.insert(scratch->presence.end(), exists.begin(), exists.end());
  }
  return is_sound(mirror.desc(), scratch->presence) ? Status::ok : Status::corrupt;
}

/// Applies a packet, and writes blocks that may have changed to `view` unless it is null.
Status Decoder::State::apply(std::span<const std::byte> packet,
                             const CheckedView<std::byte>* view) {
  const auto& desc = mirror.desc();
  if (packet.size() > limits.max_packet_bytes) return Status::limit_exceeded;
  const auto parts = parse_packet(packet);
  if (!parts) return parts.status();
  Status status = verify_checksum(packet);
  if (status != Status::ok) return status;
  status = check_reference(*parts);
  if (status != Status::ok) return status;
  if (packet_work(desc, parts->info) > limits.max_work_bytes) return Status::limit_exceeded;
  const auto decoder = backend(parts->info.backend);
  if (!decoder) return decoder.status();
  const auto count = parts->info.all_blocks ? block_count(desc) : parts->info.blocks;
  status = check_sections(*parts, count, **decoder);
  if (status != Status::ok) return status;

  const bool keyframe = is_keyframe(parts->info.type), intra = is_intra(parts->info.type);
  auto& blocks = scratch->blocks;
  auto& records = scratch->records;
  auto& stale = scratch->stale;
  auto& before = scratch->before;
  status = decode_index_buffer(parts->index_mode, count, block_count(desc), parts->index, blocks);
  if (status != Status::ok) return status;
  status = gather_presence(presence, blocks);
  if (status != Status::ok) return status;
  stale.clear();
  before.clear();
  if (!parts->guard_bands.empty()) {
    status = read_guard_band_section(desc, blocks, parts->guard_bands, scratch->bands, stale);
    if (status != Status::ok) return status;
    mirror.make_room(stale);
    for (const std::uint32_t block : stale.blocks()) {
      const auto band = mirror.stale_band(block);
      if (!band.empty()) before.add(block, band);
    }
  }
  records.resize(blocks.size() * block_bytes(desc));
  const bool clears = keyframe && blocks.size() < block_count(desc);
  if (clears) changed.reserve(block_count(desc));
  // A backend may have a state of its own, so that nothing may fail after it.
  const DecodeJob job{.desc = desc,
                      .blocks = blocks,
                      .payload = parts->payload,
                      .mirror = mirror.view(),
                      .records = records,
                      .keyframe = keyframe || intra,
                      .intra = intra,
                      .presence = scratch->presence,
                      .threads = threads,
                      .statistics = statistics,
                      .isa = isa,
                      .cancel = cancel};
  if (job.cancelled()) return Status::cancelled;
  status = (*decoder)->decode(job);
  if (status != Status::ok) return status;
  const BlockTable decoded{records.data(), block_bytes(desc)};
  resolve_guard_bands({.desc = desc,
                       .keyframe = job.keyframe,
                       .blocks = blocks,
                       .records = decoded,
                       .mirror = mirror.blocks(),
                       .before = before,
                       .threads = threads},
                      stale);
  mirror.commit(keyframe, blocks, records, scratch->presence, stale, view);
  if (clears) {
    changed.resize(block_count(desc));
    std::iota(changed.begin(), changed.end(), 0U);
  } else {
    std::swap(changed, blocks);
  }
  sequence = parts->info.sequence;
  last_checksum = checksum_after(*parts, packet);
  texture_id = parts->info.texture_id;
  return Status::ok;
}

std::uint64_t decoder_memory(const TextureDesc& desc, unsigned threads) noexcept {
  return held_memory(desc) + scratch_memory(desc, threads);
}

Decoder::Decoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Result<Decoder> Decoder::create(const TextureDesc& desc, const DecoderOptions& options) {
  return guarded([&]() -> Result<Decoder> {
    if (const Status status = validate(desc); status != Status::ok) return status;
    if (!is_valid(options.threads) || !is_supported(options.isa)) {
      return Status::invalid_settings;
    }
    if (texture_bytes(desc) > options.limits.max_texture_bytes ||
        decoder_memory(desc, options.threads.count) > options.limits.max_total_bytes) {
      return Status::limit_exceeded;
    }
    auto state = std::make_unique<State>(desc, options);
    state->limits = options.limits;
    state->threads = options.threads;
    state->statistics = options.statistics;
    state->isa = options.isa;
    state->cancel = options.cancel;
    state->shared = options.scratch;
    if (state->shared == nullptr) {
      auto own = DecoderScratch::create();
      if (!own) return own.status();
      state->shared = *std::move(own);
    }
    state->scratch = state->shared->state_.get();
    for (const Backend* backend : options.backends) {
      if (backend == nullptr) return Status::invalid_argument;
      auto decoder = backend->make_decoder(desc);
      // It cannot have made a packet for this description.
      const Status status = decoder.status();
      if (status == Status::unsupported_format || status == Status::unsupported_shape) continue;
      if (!decoder) return decoder.status();
      state->backends.emplace_back(backend->id(), *std::move(decoder));
    }
    return Decoder(std::move(state));
  });
}

Status Decoder::decode(std::span<const std::byte> packet) {
  return guarded([&]() -> Status { return state_->apply(packet, nullptr); });
}

Status Decoder::set_presence(std::span<const std::byte> presence) {
  if (presence.size() != presence_bytes(desc()) * block_count(desc())) {
    return Status::mask_mismatch;
  }
  state_->presence = presence;
  return Status::ok;
}

Status Decoder::decode(std::span<const std::byte> packet, TextureView texture) {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  return guarded([&]() -> Status { return state_->apply(packet, &*view); });
}

Status Decoder::read(TextureView texture) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  state_->mirror.write_all(*view);
  return Status::ok;
}

Status Decoder::read(TextureView texture, std::span<const std::uint32_t> blocks) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  for (const auto block : blocks) {
    if (block >= block_count(desc())) return Status::block_out_of_range;
  }
  state_->mirror.write(blocks, desc(), *view, blocks);
  return Status::ok;
}

Status Decoder::read(std::span<const std::uint32_t> blocks, const TextureDesc& to,
                     TextureView texture, std::span<const std::uint32_t> places) const {
  const bool alike = to.record == desc().record && to.block == desc().block &&
                     to.guard_band == desc().guard_band && blocks.size() == places.size();
  if (!alike || validate(to) != Status::ok) return Status::invalid_argument;
  const auto view = check_view(to, texture);
  if (!view) return view.status();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i] >= block_count(desc()) || places[i] >= block_count(to)) {
      return Status::block_out_of_range;
    }
  }
  state_->mirror.write(blocks, to, *view, places);
  return Status::ok;
}

std::uint64_t Decoder::state_hash() const noexcept {
  StateHash hash;
  const Mirror& mirror = state_->mirror;
  for (std::uint32_t block = 0; block < block_count(desc()); ++block) {
    if (mirror.received()[block] != 0) {
      hash.add(block, mirror.blocks()[block], mirror.stale_band(block));
    }
  }
  return hash.value();
}

std::span<const std::byte> Decoder::records() const noexcept { return state_->mirror.records(); }
std::span<const std::uint8_t> Decoder::received() const noexcept {
  return state_->mirror.received();
}
std::span<const std::uint32_t> Decoder::changed() const noexcept { return state_->changed; }
const TextureDesc& Decoder::desc() const noexcept { return state_->mirror.desc(); }
std::uint32_t Decoder::sequence() const noexcept { return state_->sequence; }
std::uint32_t Decoder::checksum() const noexcept { return state_->last_checksum; }

}  // namespace gicodec
