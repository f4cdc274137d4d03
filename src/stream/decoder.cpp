// packet → backend → mirror → reconstruct → texture view: the encoder's steps in reverse.
#include <gicodec/decoder.h>

#include "base/guard.h"
#include "bitstream/packet.h"
#include "stream/border_section.h"
#include "stream/find_backend.h"
#include "stream/mirror.h"
#include "stream/state_hash.h"

#include <algorithm>
#include <utility>

namespace gicodec {

static constexpr unsigned kMaxThreads = 256;

struct Decoder::State {
  explicit State(const TextureDesc& desc) : mirror(desc) {}

  Status apply(std::span<const std::byte> packet);
  Status check_reference(const PacketParts& parts) const;
  [[nodiscard]] BackendDecoder* backend(std::uint8_t id) const;

  Mirror mirror;
  DecodeLimits limits;
  unsigned threads = 1;
  PayloadStatistics* statistics = nullptr;
  Isa isa = best_isa();
  std::vector<std::pair<std::uint8_t, std::unique_ptr<BackendDecoder>>> backends;
  std::uint32_t sequence = 0;
  std::uint32_t last_checksum = 0;  ///< of packet `sequence`
  std::uint8_t texture_id = 0;      ///< of the last packet applied
  bool keyframe_applied = false;    ///< by the last packet

  std::vector<std::uint32_t> updated;  ///< probes of the last packet applied
  std::vector<std::uint32_t> probes;   ///< scratch of one call
  std::vector<std::byte> cores;
};

BackendDecoder* Decoder::State::backend(std::uint8_t id) const {
  const auto it = std::ranges::find(backends, id, [](const auto& entry) { return entry.first; });
  return it == backends.end() ? nullptr : it->second.get();
}

Status Decoder::State::check_reference(const PacketParts& parts) const {
  if (parts.info.keyframe) {
    return parts.base == description_hash(mirror.desc()) ? Status::ok
                                                         : Status::description_mismatch;
  }
  const bool here = sequence != 0 && parts.info.reference == sequence &&
                    parts.base == last_checksum && parts.info.texture_id == texture_id;
  return here ? Status::ok : Status::reference_missing;
}

Status Decoder::State::apply(std::span<const std::byte> packet) {
  const auto& desc = mirror.desc();
  if (packet.size() > limits.max_packet_bytes) return Status::limit_exceeded;
  const auto parts = parse_packet(packet);
  if (!parts) return parts.status();
  Status status = verify_checksum(packet);
  if (status != Status::ok) return status;
  status = check_reference(*parts);
  if (status != Status::ok) return status;
  auto* const decoder = backend(parts->info.backend);
  if (decoder == nullptr) return Status::backend_missing;

  const bool keyframe = parts->info.keyframe;
  const bool independent = keyframe || parts->info.fresh;
  const auto count = parts->info.all_probes ? probe_count(desc) : parts->info.probes;
  status = decode_index_buffer(parts->index_mode, count, probe_count(desc), parts->index, probes);
  if (status != Status::ok) return status;
  StaleRings stale;
  if (!parts->borders.empty()) {
    status = read_border_section(desc, probes, parts->borders, stale);
    if (status != Status::ok) return status;
  }
  cores.resize(probes.size() * core_bytes(desc));
  // A backend may have a state of its own, so that nothing may fail after it.
  status = decoder->decode(
      {desc, probes, parts->payload, mirror.cores(), cores, independent, threads, statistics, isa});
  if (status != Status::ok) return status;
  resolve_borders({mirror, independent, probes, cores}, stale);
  mirror.commit(keyframe, probes, cores, std::move(stale));
  std::swap(updated, probes);
  sequence = parts->info.sequence;
  last_checksum = parts->info.snapshot ? parts->stands_for : packet_checksum(packet);
  texture_id = parts->info.texture_id;
  keyframe_applied = keyframe;
  return Status::ok;
}

Decoder::Decoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Result<Decoder> Decoder::create(const TextureDesc& desc, const DecoderOptions& options) {
  return guarded([&]() -> Result<Decoder> {
    if (const Status status = validate(desc); status != Status::ok) return status;
    if (options.threads < 1 || options.threads > kMaxThreads || !is_supported(options.isa)) {
      return Status::invalid_argument;
    }
    if (texture_bytes(desc) > options.limits.max_texture_bytes) return Status::limit_exceeded;
    auto state = std::make_unique<State>(desc);
    state->limits = options.limits;
    state->threads = options.threads;
    state->statistics = options.statistics;
    state->isa = options.isa;
    const auto add = [&](const Backend& backend) -> Status {
      if (state->backend(backend.id()) != nullptr) return Status::ok;
      auto decoder = backend.make_decoder(desc);
      // No packet for this description can come from such a backend.
      if (decoder.status() == Status::unsupported_format) return Status::ok;
      if (!decoder) return decoder.status();
      state->backends.emplace_back(backend.id(), *std::move(decoder));
      return Status::ok;
    };
    for (const auto list :
         {std::span<const Backend* const>(options.backends), built_in_backends()}) {
      for (const Backend* backend : list) {
        if (backend == nullptr) return Status::invalid_argument;
        if (const Status status = add(*backend); status != Status::ok) return status;
      }
    }
    return Decoder(std::move(state));
  });
}

Status Decoder::decode(std::span<const std::byte> packet) {
  return guarded([&]() -> Status { return state_->apply(packet); });
}

Status Decoder::decode(std::span<const std::byte> packet, TextureView texture) {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  const Status status = decode(packet);
  if (status != Status::ok) return status;
  // From here on nothing can fail.
  if (state_->keyframe_applied) {
    state_->mirror.write_all(state_->isa, *view);
  } else {
    state_->mirror.write(state_->isa, *view, state_->updated);
  }
  return Status::ok;
}

Status Decoder::read(TextureView texture) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  state_->mirror.write_all(state_->isa, *view);
  return Status::ok;
}

Status Decoder::read(TextureView texture, std::span<const std::uint32_t> probes) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  for (const auto probe : probes) {
    if (probe >= probe_count(desc())) return Status::probe_out_of_range;
  }
  state_->mirror.write(state_->isa, *view, probes);
  return Status::ok;
}

std::uint64_t Decoder::state_hash() const noexcept {
  StateHash hash;
  const Mirror& mirror = state_->mirror;
  for (std::uint32_t probe = 0; probe < probe_count(desc()); ++probe) {
    const auto stale = mirror.stale().find(probe);
    hash.add(probe, mirror.core(probe), stale == mirror.stale().end() ? nullptr : &stale->second);
  }
  return hash.value();
}

std::span<const std::uint32_t> Decoder::updated() const noexcept { return state_->updated; }
const TextureDesc& Decoder::desc() const noexcept { return state_->mirror.desc(); }
std::uint32_t Decoder::sequence() const noexcept { return state_->sequence; }
std::uint32_t Decoder::checksum() const noexcept { return state_->last_checksum; }

}  // namespace gicodec
