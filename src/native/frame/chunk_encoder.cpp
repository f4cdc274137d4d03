#include "native/frame/chunk_encoder.h"

#include "native/frame/chunk_head.h"
#include "native/matches/match_chunk.h"
#include "native/planes/mode_search.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec::native {
namespace {

/// Blocks up to which every one has a lane of its own, if it has so many bytes.
constexpr std::size_t kFewBlocks = 64, kMinLaneBytes = 128;
/// Blocks that groups have on average, at least, in chunks with new values of neighbours: updates
/// have previous values too.
constexpr std::size_t kMinFilled = 6, kMinFilledKey = 2;
/// Bytes below which tables of a chunk's own pay for nothing.
constexpr std::uint64_t kFewBytes = 1024;

/// Without new neighbours, lanes are always full. They are worth little to planes, but a quarter of
/// the bytes of noisy pairs: only small updates that have to be fast do without.
bool choose_flat(const Update& u, const EncodeSettings& settings, std::size_t probes) {
  if (!u.neighbours()) return true;
  return u.update && settings.preset != Preset::strong && (!u.layout.pairs || probes <= kFewBlocks);
}

/// Groups whose steps are kept, so that little is modelled twice in a small chunk.
std::size_t most_kept(const Update& u) {
  constexpr std::size_t kGroups = 8, kBytes = 1 << 20;
  return std::min(kGroups, kBytes / (Workspace::steps_of_group(u) * sizeof(Step)));
}

/// Enough lanes to be fast, few enough that their states cost little: below 5 % of the bytes that
/// are expected, or one for eight probes.
unsigned choose_lanes(std::size_t probes, std::uint64_t bytes) {
  constexpr std::uint64_t kBytesOfLane = 80;
  const std::uint64_t lanes = std::max<std::uint64_t>(probes / 8, bytes / kBytesOfLane);
  return std::bit_floor(static_cast<unsigned>(std::clamp<std::uint64_t>(lanes, 1, kLanes)));
}

/// Whether all records of a block that exist have that value in a plane.
bool holds(const Update& u, const BlockPresence& presence, const std::uint16_t* values,
           std::uint16_t value) {
  const auto* const end = values + u.texels();
  const auto other = [value](std::uint16_t x) { return x != value; };
  for (const auto* v = values; (v = std::find_if(v, end, other)) != end; ++v) {
    if (presence.exists(static_cast<std::uint32_t>(v - values))) return false;
  }
  return true;
}

/// Whether many texels equal those of a neighbouring block, but not the previous ones: planes
/// cannot find that each on its own. Records of few bits cost little more without.
bool repeats_pay(const Update& u, std::span<const std::uint32_t> positions,
                 const BlockTable& texels, Chunk& chunk) {
  constexpr std::size_t kLongRecord = 6, kWorth = 16;
  constexpr std::uint32_t kSampled = 64;
  const std::size_t size = u.layout.texel_bytes;
  if (!u.neighbours() || u.partial() || u.layout.pairs || size < kLongRecord) return false;
  constexpr std::size_t kFewTexels = 4096;
  if (positions.size() * u.texels() <= kFewTexels) return false;
  chunk.build(u.desc.grid, u.box, u.probes, positions, u.mirrored ? &u.mirror : nullptr, kLanes);
  const auto records = [&](std::int32_t block) {
    const auto& b = chunk.blocks[static_cast<std::size_t>(block)];
    const bool coded = block < static_cast<std::int32_t>(chunk.coded);
    return (coded ? texels[b.position] : u.mirror.blocks[b.probe]).data();
  };
  std::size_t seen = 0, repeated = 0;
  const std::uint32_t step = std::max(1U, chunk.coded / kSampled);
  for (std::uint32_t b = 0; b < chunk.coded; b += step) {
    const std::byte* const now = texels[chunk.blocks[b].position].data();
    const std::byte* const previous =
        u.update ? u.mirror.blocks[chunk.blocks[b].probe].data() : nullptr;
    for (std::size_t at = 0; at < u.block_bytes(); at += size, ++seen) {
      if (previous != nullptr && std::memcmp(now + at, previous + at, size) == 0) continue;
      const auto& around = chunk.blocks[b].neighbour;
      repeated += std::any_of(std::begin(around), std::end(around), [&](std::int32_t n) {
        return n != kNoBlock && std::memcmp(now + at, records(n) + at, size) == 0;
      });
    }
  }
  return repeated * kWorth > seen;
}

/// Planes that hold one value throughout need no coding.
void find_constants(const Update& u, Workspace& w, ChunkHead& head) {
  const auto presence_of = [&](std::uint32_t b) {
    return BlockPresence(u.desc, u.presence_of(w.chunk.blocks[b].position));
  };
  // The first record that exists; of blocks without any all planes are constant.
  std::uint32_t block = 0, record = 0;
  while (block + 1 < w.chunk.coded && presence_of(block).count() == 0) ++block;
  while (record + 1 < u.texels() && !presence_of(block).exists(record)) ++record;
  head.coded = 0;
  for (unsigned p = 0; p < u.layout.planes; ++p) {
    const std::size_t at = p * u.texels();
    const std::uint16_t value = w.current(block)[at + record];
    bool constant = true;
    for (std::uint32_t b = block; b < w.chunk.coded && constant; ++b) {
      constant = holds(u, presence_of(b), w.current(b) + at, value);
    }
    head.constant[p] = constant ? value : std::uint16_t{0};
    head.coded |= constant ? 0U : 1U << p;
  }
}

/// The most frequent pair of a sample.
void find_frequent(const Update& u, Workspace& w, ChunkHead& head) {
  struct Count {
    std::uint32_t pair, count;
  };
  std::array<Count, 256> counts{};
  const std::size_t texels = u.texels();
  const std::uint32_t step = std::max(1U, w.chunk.coded / 64);
  Count best{0, 0};
  for (std::uint32_t b = 0; b < w.chunk.coded; b += step) {
    for (std::size_t t = b % 8; t < texels; t += 8) {
      const std::uint32_t pair =
          w.current(b)[t] | static_cast<std::uint32_t>(w.current(b)[texels + t]) << 16;
      Count& c = counts[(pair * 2654435761U) >> 24];
      // Majority vote per bucket.
      if (c.count == 0) c.pair = pair;
      c.count += c.pair == pair ? 1U : UINT32_MAX;
      if (c.count > best.count) best = c;
    }
  }
  head.frequent[0] = static_cast<std::uint16_t>(best.pair);
  head.frequent[1] = static_cast<std::uint16_t>(best.pair >> 16);
}

/// Whether rows that reach over blocks are worth their time: where most of their box is listed.
bool rows_pay(const Update& u, const EncodeSettings& settings,
              std::span<const std::uint32_t> positions) {
  if (settings.set >= 0 || settings.lanes != 0 || settings.observe) return false;
  return takes_rows(u.desc) && fits_rows(u.desc, u.box) && fills_rows(u, positions);
}

class ChunkEncoder {
 public:
  ChunkEncoder(const Update& u, const EncodeSettings& settings, ChunkHead& head, Workspace& w)
      : u_(u), settings_(settings), head_(head), w_(w) {}

  /// Chooses tables by some of the groups.
  const Tables& plan() {
    head_.tables.clear();
    w_.modelled.clear();
    if (settings_.set >= 0) {
      for (unsigned p = 0; p < kPlaces; ++p) {
        if (!used_place(u_.layout, u_.update, head_, p)) continue;
        head_.tables.set[p] = static_cast<std::uint8_t>(settings_.set);
      }
      return w_.adapted.apply(u_.layout.pairs, u_.update, head_.tables);
    }
    start();
    const Tables* adapted = &adapt(std::clamp<std::size_t>(w_.chunk.groups() / 8, 1, 4), nullptr);
    const std::uint32_t widest = w_.chunk.widest_group();
    head_.lanes = lanes_for(bytes_, widest);
    if (head_.lanes < widest) {
      w_.chunk.form_groups(head_.lanes);
      start();
    }
    exact_ = settings_.preset == Preset::strong && (u_.update || !u_.layout.pairs);
    if (exact_) {
      kept_ = 0;
      adapted = &adapt(std::clamp<std::size_t>(w_.chunk.groups() / 16, 1, 2), adapted);
    }
    return *adapted;
  }
  /// Steps of one group under the tables of plan().
  std::span<const Step> model(std::size_t g, const Tables& planned) {
    return model(g, exact_ ? &planned : nullptr);
  }

  /// Bytes, by the groups that plan() has seen and by the set alone.
  [[nodiscard]] std::uint64_t expected() const { return bytes_; }

 private:
  void start() {
    w_.modelled.assign(w_.chunk.groups(), {});
    kept_ = 0;
  }
  [[nodiscard]] unsigned lanes_for(std::uint64_t bytes, std::uint32_t widest) const {
    if (settings_.lanes != 0 ||
        (settings_.preset != Preset::strong && w_.chunk.coded <= kFewBlocks)) {
      return head_.lanes;
    }
    unsigned lanes = choose_lanes(w_.chunk.coded, settings_.preset == Preset::strong ? 0 : bytes);
    lanes = std::min(lanes, std::bit_ceil(widest));
    while (!enough_lanes(lanes, w_.chunk.coded)) lanes *= 2;
    return lanes;
  }

  /// Steps of one group: its modes, then its texels. With `search`, modes are chosen by their exact
  /// cost under these tables. Valid until the next call, if they are not kept.
  std::span<const Step> model(std::size_t g, const Tables* search) {
    Modelled* const known = w_.modelled.empty() ? nullptr : &w_.modelled[g];
    const bool chosen = known != nullptr && known->chosen && (search == nullptr || known->exact);
    if (chosen && !known->steps.empty()) return known->steps;
    Group group = w_.group(u_, g);
    w_.load_current(u_, g);
    if (u_.layout.pairs || head_.repeats) w_.load_candidates(u_, g);
    if (chosen) {
      std::copy(std::begin(known->mode), std::end(known->mode), &group.mode[0][0]);
      load_modes(u_, g, group, w_);
    } else if (search != nullptr) {
      choose_modes_exactly(u_, g, *search, group, w_);
    } else {
      choose_modes(u_, g, group, w_);
    }
    // The first place is for those that are not kept, and for searches.
    const bool keep = known != nullptr && kept_ < most_kept(u_);
    Step* const first = w_.steps.data() + (keep ? ++kept_ : 0) * Workspace::steps_of_group(u_);
    Step* next = first;
    const unsigned kinds = u_.layout.mode_kinds(u_.update);
    for (unsigned k = 0; k < kinds; ++k, ++next) {
      next->active = group.active;
      next->repeat = 0;
      next->place = kModePlace;
      const auto context = static_cast<std::uint16_t>(mode_context(u_.layout.pairs, u_.update, k));
      std::fill(std::begin(next->context), std::end(next->context), context);
      std::copy(std::begin(group.mode[k]), std::end(group.mode[k]), std::begin(next->value));
    }
    next = u_.layout.pairs ? u_.kernels.model_pairs(group, next)
                           : u_.kernels.model_planes(group, next);
    const std::span<const Step> steps(first, next);
    if (known != nullptr) {
      known->chosen = true;
      known->exact = search != nullptr;
      std::copy(&group.mode[0][0], &group.mode[0][0] + 2 * kLanes, std::begin(known->mode));
      known->steps = keep ? steps : std::span<const Step>();
    }
    return steps;
  }

  /// Set and overrides by the counts of every `stride`-th group.
  const Tables& adapt(std::size_t stride, const Tables* search) {
    w_.histogram.clear();
    std::uint32_t seen = 0;
    for (std::size_t g = stride / 2; g < w_.chunk.groups(); g += stride) {
      w_.histogram.add(model(g, search));
      seen += w_.chunk.group_begin[g + 1] - w_.chunk.group_begin[g];
    }
    const bool pairs = u_.layout.pairs;
    const std::uint32_t scale = (w_.chunk.coded + seen / 2) / std::max(1U, seen);
    head_.tables.clear();
    bytes_ = w_.histogram.choose_sets(pairs, u_.update, head_.tables) * scale;
    if (settings_.preset == Preset::strong || bytes_ > kFewBytes) {
      w_.histogram.choose_overrides(pairs, u_.update, scale, head_.tables);
    }
    if (head_.repeats) w_.histogram.fit_repeats(u_.update, scale, head_.tables.repeats);
    return w_.adapted.apply(pairs, u_.update, head_.tables);
  }

  const Update& u_;
  const EncodeSettings& settings_;
  ChunkHead& head_;
  Workspace& w_;
  std::size_t kept_ = 0;  // groups whose steps are kept
  std::uint64_t bytes_ = 0;
  bool exact_ = false;  // modes by their exact cost
};

void encode_raw(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& texels,
                std::vector<std::byte>& out) {
  out.push_back(std::byte{kRawChunk});
  for (const auto position : positions) {
    const auto block = texels[position];
    if (u.partial()) {
      gather_present(u.desc, u.presence_of(position), block, out);
    } else {
      out.insert(out.end(), block.begin(), block.end());
    }
  }
}

/// Appends a modelled chunk unless it would have more than `most` bytes; false then.
bool encode_modelled(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& texels, const EncodeSettings& settings, std::size_t most,
                     Workspace& w, std::vector<std::byte>& out) {
  ChunkHead& head = w.head;
  // All of them until it is known what the chunk takes.
  const auto blocks = static_cast<unsigned>(positions.size());
  const bool few = blocks <= kFewBlocks && settings.preset != Preset::strong;
  const auto worth =
      static_cast<unsigned>(std::clamp<std::size_t>(most / kMinLaneBytes, 1, blocks));
  const unsigned planned = few                 ? std::min(std::bit_ceil(worth), kLanes)
                           : settings.set >= 0 ? choose_lanes(blocks, 0)
                                               : kLanes;
  head.lanes = settings.lanes != 0 ? settings.lanes : planned;
  while (!enough_lanes(head.lanes, positions.size())) head.lanes *= 2;
  head.repeats = settings.set < 0 && repeats_pay(u, positions, texels, w.chunk);
  head.flat = !head.repeats && choose_flat(u, settings, positions.size());
  w.prepare(u, positions, head.lanes, head.flat);
  // In a row of blocks each depends on the one before, and is alone in its group; in a small box
  // most are.
  const std::size_t groups = w.chunk.groups(), least = u.update ? kMinFilled : kMinFilledKey;
  if (!head.flat && !head.repeats && settings.preset != Preset::strong && least * groups > blocks) {
    head.flat = true;
    w.prepare(u, positions, head.lanes, head.flat);
  }
  for (std::uint32_t b = 0; b < w.chunk.coded; ++b) {
    u.unpack(texels[w.chunk.blocks[b].position].data(), w.current(b));
  }
  if (u.layout.pairs) {
    find_frequent(u, w, head);
    head.coded = 3;
  } else {
    find_constants(u, w, head);
  }
  w.set_head(u);
  w.reserve_steps(u, 1 + most_kept(u));
  ChunkEncoder encoder(u, settings, head, w);
  const Tables& set = encoder.plan();
  if (settings.preset != Preset::strong && encoder.expected() > most + most / 16 + kFewBytes)
    return false;

  // Groups and steps backwards, words from the end of the buffer to its begin. Beyond the size of
  // raw texels there is room for one more group, whatever it holds.
  const std::size_t group_room = Workspace::steps_of_group(u) * kMaxStepBytes + kSlack;
  w.bytes.resize(most + group_room);
  Output output{};
  std::fill(std::begin(output.state), std::end(output.state), kStateLow);
  auto* const begin = reinterpret_cast<std::uint8_t*>(w.bytes.data());
  auto* const end = begin + w.bytes.size();
  output.next = end;
  const std::size_t head_size = out.size();
  for (std::size_t g = w.chunk.groups(); g-- > 0;) {
    const auto steps = encoder.model(g, set);
    if (settings.observe) settings.observe(steps.data(), steps.data() + steps.size());
    u.kernels.encode_steps(steps.data(), steps.data() + steps.size(), set, output);
    if (static_cast<std::size_t>(end - output.next) >= most) break;
  }
  const auto size = static_cast<std::size_t>(end - output.next);
  write_head(u.layout, head, out);
  ByteWriter writer(out);
  for (unsigned l = 0; l < head.lanes; ++l) writer.fixed(output.state[l]);
  if (out.size() - head_size + size > most) {
    out.resize(head_size);
    return false;
  }
  writer.bytes(std::as_bytes(std::span(output.next, size)));
  return true;
}

/// Of raw records: what may be tried in several ways.
constexpr std::size_t kLittleRaw = 1 << 16;

/// Where rows have tables that cost much, or steps of large components that they do not see.
bool planes_may_pay(const Update& u, std::size_t raw_size) {
  return raw_size <= kLittleRaw || u.layout.low != 0;
}
}  // namespace

void encode_chunk(const Update& u, std::span<const std::uint32_t> positions,
                  const BlockTable& texels, const EncodeSettings& settings, Workspace& w,
                  std::vector<std::byte>& out) {
  const std::size_t raw_size = u.present_bytes(positions), begin = out.size();
  bool done = false;
  // The smallest form so far is what the chunk has; one that is tried must be smaller.
  const auto tried = [&](const auto& encode) {
    const std::size_t end = out.size();
    if (!encode(done ? end - begin - 1 : raw_size)) return;
    out.erase(out.begin() + static_cast<std::ptrdiff_t>(begin),
              out.begin() + static_cast<std::ptrdiff_t>(end));
    done = true;
  };
  const auto try_rows = [&](bool places) {
    tried([&](std::size_t most) {
      const RowChoice choice{settings.preset != Preset::turbo, places};
      return encode_rows(u, positions, texels, choice, most, w.rows, w.models.values, out);
    });
  };
  const bool by_rows = rows_pay(u, settings, positions);
  if (settings.matches_within != 0) {
    done = encode_matches(u, positions, texels, std::min(raw_size, settings.matches_within),
                          settings.preset == Preset::strong, w.matches, out);
  } else if (u.adaptive) {
    done = encode_adaptive(u, positions, texels, raw_size, w.models, out);
    if (by_rows && settings.others) try_rows(false);
  } else if (settings.preset == Preset::turbo && takes_tokens(u.desc)) {
    // Floats of few values are for palettes, which rows have.
    if (by_rows && u.layout.low != 0) try_rows(false);
    if (!done)
      done = encode_tokens(u, positions, texels, settings.streams, raw_size, w.tokens, out);
  } else {
    if (by_rows) try_rows(false);
    if (by_rows && raw_size <= kLittleRaw && w.rows.planes.places_left_out()) try_rows(true);
    const bool tries = !done || (settings.others && planes_may_pay(u, raw_size));
    if (tries && is_small_box(u.box)) {
      tried([&](std::size_t most) {
        return encode_modelled(u, positions, texels, settings, most, w, out);
      });
    }
  }
  if (!done) encode_raw(u, positions, texels, out);
}

}  // namespace gicodec::native
