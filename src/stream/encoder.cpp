// texture view → select → strip → drop what has not changed → backend → packet, and the mirror
// follows.
#include <gicodec/encoder.h>

#include "base/guard.h"
#include "bitstream/packet.h"
#include "stream/find_backend.h"
#include "stream/mirror.h"
#include "stream/update_writer.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <utility>

namespace gicodec {

struct Encoder::State {
  State(const TextureDesc& desc, const EncoderOptions& options, const Backend& backend,
        std::unique_ptr<BackendEncoder> encoder)
      : mirror(desc),
        chain{backend.id(), options.texture_id},
        isa(options.settings.isa),
        gop(options.gop),
        backend_encoder(std::move(encoder)) {}

  Status select(Selection selection);
  Status select_list(std::span<const std::uint32_t> list);
  void keep_changed(const CheckedView<const std::byte>& view, bool keyframe);
  Status encode(const ConstTextureView& view, Selection selection, std::size_t max_size,
                Packet& out);
  Status snapshot(Packet& out);

  Mirror mirror;
  PacketChain chain;
  Isa isa;
  std::uint32_t gop;
  std::uint32_t since_keyframe = 0;
  bool keyframe_wanted = true;
  std::unique_ptr<BackendEncoder> backend_encoder;
  std::vector<std::uint8_t> active;

  // Scratch of one call, kept for its capacity.
  std::vector<std::uint32_t> probes, stale_places;
  std::vector<std::byte> cores;
  UpdateWriter writer;
};

Status Encoder::State::select_list(std::span<const std::uint32_t> list) {
  probes.assign(list.begin(), list.end());
  if (!std::ranges::is_sorted(probes)) std::ranges::sort(probes);
  if (!probes.empty() && probes.back() >= probe_count(mirror.desc())) {
    return Status::probe_out_of_range;
  }
  return std::ranges::adjacent_find(probes) == probes.end() ? Status::ok : Status::probe_repeated;
}

/// The probes of a selection, without regard to their texels.
Status Encoder::State::select(Selection selection) {
  if (selection.kind() == Selection::Kind::list) return select_list(selection.list());
  probes.resize(probe_count(mirror.desc()));
  std::iota(probes.begin(), probes.end(), 0U);
  if (selection.kind() == Selection::Kind::changed && !active.empty()) {
    std::erase_if(probes, [&](std::uint32_t probe) { return active[probe] == 0; });
  }
  return Status::ok;
}

/// Drops the stripped probes that the decoder has already; a keyframe starts from zeros.
void Encoder::State::keep_changed(const CheckedView<const std::byte>& view, bool keyframe) {
  const std::size_t size = core_bytes(mirror.desc());
  const std::vector<std::byte> zeros(keyframe ? size : 0);
  std::size_t kept = 0, kept_stale = 0, next_stale = 0;
  for (std::size_t place = 0; place < probes.size(); ++place) {
    const std::byte* core = cores.data() + place * size;
    const bool stale = next_stale < stale_places.size() && stale_places[next_stale] == place;
    if (stale) ++next_stale;
    const bool same = keyframe ? !stale && std::memcmp(core, zeros.data(), size) == 0
                               : mirror.equals(view, probes[place], core, stale);
    if (same) continue;
    if (stale) stale_places[kept_stale++] = static_cast<std::uint32_t>(kept);
    if (kept != place) std::memcpy(cores.data() + kept * size, core, size);
    probes[kept++] = probes[place];
  }
  probes.resize(kept);
  cores.resize(kept * size);
  stale_places.resize(kept_stale);
}

Status Encoder::State::encode(const ConstTextureView& texture, Selection selection,
                              std::size_t max_size, Packet& out) {
  const auto& desc = mirror.desc();
  const auto view = check_view(desc, texture);
  if (!view) return view.status();
  const bool keyframe = keyframe_wanted || (gop > 0 && since_keyframe >= gop);
  if (chain.sequence == UINT32_MAX) return Status::limit_exceeded;
  Status status = select(selection);
  if (status != Status::ok) return status;

  cores.resize(probes.size() * core_bytes(desc));
  stale_places.clear();
  strip(isa, desc, *view, probes, cores, stale_places);
  if (selection.kind() == Selection::Kind::changed) keep_changed(*view, keyframe);
  StaleRings stale;
  std::vector<std::uint32_t> stale_probes;
  for (const auto place : stale_places) stale_probes.push_back(probes[place]);
  stale.assign(std::move(stale_probes), ring_bytes(desc));
  for (std::size_t i = 0; i < stale.size(); ++i) {
    gather_ring(desc, *view, stale.probes()[i], stale.ring(i));
  }
  mirror.make_room(stale);

  // What a backend remembers may move on from here: until all is done, a failure means that only a
  // keyframe can follow.
  if (backend_encoder->remembers()) keyframe_wanted = true;
  status = writer.write(mirror, *backend_encoder, chain.next(desc, keyframe),
                        {probes, cores, stale}, out);
  if (status != Status::ok) return status;
  if (out.size() > max_size) return Status::buffer_too_small;

  mirror.commit(keyframe, probes, cores, stale);
  keyframe_wanted = false;
  since_keyframe = keyframe ? 1 : since_keyframe + 1;
  chain.advance(out);
  return Status::ok;
}

Status Encoder::State::snapshot(Packet& out) {
  if (chain.sequence == 0) return Status::invalid_argument;
  if (backend_encoder->remembers()) return Status::unsupported_backend;
  const auto& desc = mirror.desc();
  probes.clear();
  cores.clear();
  StaleRings stale;
  for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
    const auto core = mirror.core(probe);
    const bool zero = std::ranges::all_of(core, [](std::byte b) { return b == std::byte{0}; });
    const auto ring = mirror.stale_ring(probe);
    if (zero && ring.empty()) continue;
    if (!ring.empty()) stale.add(probe, ring);
    probes.push_back(probe);
    cores.insert(cores.end(), core.begin(), core.end());
  }
  return writer.write(mirror, *backend_encoder, chain.snapshot(desc), {probes, cores, stale}, out);
}

Encoder::Encoder(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;
Encoder::~Encoder() = default;

Result<Encoder> Encoder::create(const TextureDesc& desc, const EncoderOptions& options) {
  return guarded([&]() -> Result<Encoder> {
    if (const Status status = validate(desc); status != Status::ok) return status;
    const auto* backend = find_backend(options.backends, [&](const Backend& candidate) {
      return candidate.name() == options.backend;
    });
    if (backend == nullptr) return Status::unknown_backend;
    if (!is_supported(options.settings.isa)) return Status::invalid_argument;
    auto encoder = backend->make_encoder(desc, options.settings);
    if (!encoder) return encoder.status();
    return Encoder(std::make_unique<State>(desc, options, *backend, *std::move(encoder)));
  });
}

Status Encoder::encode_to(ConstTextureView view, Selection selection, Packet& out) {
  return guarded([&]() -> Status { return state_->encode(view, selection, SIZE_MAX, out); });
}

Result<Packet> Encoder::encode(ConstTextureView view, Selection selection) {
  Packet packet;
  const Status status = encode_to(view, selection, packet);
  if (status != Status::ok) return status;
  return packet;
}

Result<std::size_t> Encoder::encode_to(ConstTextureView view, Selection selection,
                                       std::span<std::byte> out) {
  return guarded([&]() -> Result<std::size_t> {
    Packet packet;
    const Status status = state_->encode(view, selection, out.size(), packet);
    if (status != Status::ok) return status;
    std::ranges::copy(packet, out.begin());
    return packet.size();
  });
}

Result<Packet> Encoder::snapshot() {
  return guarded([&]() -> Result<Packet> {
    Packet packet;
    const Status status = state_->snapshot(packet);
    if (status != Status::ok) return status;
    return packet;
  });
}

std::size_t Encoder::bound(std::size_t probes) const noexcept {
  const auto& desc = state_->mirror.desc();
  return update_bound(desc, *state_->backend_encoder,
                      std::min<std::size_t>(probes, probe_count(desc)));
}

void Encoder::request_keyframe() noexcept { state_->keyframe_wanted = true; }

Status Encoder::set_active(std::span<const std::uint8_t> active) {
  if (!active.empty() && active.size() != probe_count(state_->mirror.desc())) {
    return Status::invalid_argument;
  }
  return guarded([&]() -> Status {
    state_->active.assign(active.begin(), active.end());
    return Status::ok;
  });
}

Status Encoder::read(TextureView texture) const {
  const auto view = check_view(desc(), texture);
  if (!view) return view.status();
  state_->mirror.write_all(state_->isa, *view);
  return Status::ok;
}

const TextureDesc& Encoder::desc() const noexcept { return state_->mirror.desc(); }
std::uint32_t Encoder::sequence() const noexcept { return state_->chain.sequence; }
bool Encoder::lossy() const noexcept { return state_->backend_encoder->lossy(); }

}  // namespace gicodec
