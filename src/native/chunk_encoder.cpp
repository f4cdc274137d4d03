#include "native/chunk_encoder.h"

#include "native/chunk_head.h"
#include "native/mode_search.h"
#include "native/tables.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec::native {
namespace {

/// Distributions of a chunk's own that the fast preset tries.
constexpr unsigned kFastMembers = 4;

/// Enough lanes to be fast, few enough that their states cost little.
unsigned choose_lanes(std::size_t probes) {
  if (probes >= 8 * kLanes) return kLanes;
  return std::bit_floor(std::max(1U, static_cast<unsigned>(probes) / 8));
}

/// Planes that hold one value throughout need no coding.
void find_constants(const Update& u, Workspace& w, ChunkHead& head) {
  head.coded = 0;
  for (unsigned p = 0; p < u.layout.planes; ++p) {
    const std::size_t at = p * u.texels();
    const std::uint16_t value = w.current(0)[at];
    bool constant = true;
    for (std::uint32_t b = 0; b < w.chunk.coded && constant; ++b) {
      const std::uint16_t* v = w.current(b) + at;
      constant = std::all_of(v, v + u.texels(), [value](std::uint16_t x) { return x == value; });
    }
    head.constant[p] = constant ? value : std::uint16_t{0};
    head.coded = static_cast<std::uint8_t>(head.coded | (constant ? 0U : 1U << p));
  }
}

/// The most frequent pair of a sample.
void find_cap(const Update& u, Workspace& w, ChunkHead& head) {
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
  head.cap[0] = static_cast<std::uint16_t>(best.pair);
  head.cap[1] = static_cast<std::uint16_t>(best.pair >> 16);
}

class ChunkEncoder {
 public:
  ChunkEncoder(const Update& u, const EncodeSettings& settings, ChunkHead& head, Workspace& w)
      : u_(u), settings_(settings), head_(head), w_(w) {}

  /// Chooses tables by some of the groups.
  const Tables& plan() {
    if (settings_.set >= 0) {
      head_.set = static_cast<unsigned>(settings_.set);
      return tables(head_.set, u_.update);
    }
    const std::size_t groups = w_.chunk.group_begin.size() - 1;
    modes_.assign(groups, {});
    const Tables* adapted = &adapt(std::clamp<std::size_t>(groups / 8, 1, 8), nullptr);
    exact_ = settings_.strong && (u_.update || !u_.layout.pairs);
    if (exact_) adapted = &adapt(std::clamp<std::size_t>(groups / 16, 1, 2), adapted);
    return *adapted;
  }
  /// Steps of one group under the tables of plan().
  std::span<const Step> model(std::size_t g, const Tables& planned) {
    return model(g, exact_ ? &planned : nullptr);
  }

 private:
  /// Steps of one group: its modes, then its texels. With `search`, modes are chosen by their exact
  /// cost under these tables.
  std::span<const Step> model(std::size_t g, const Tables* search) {
    Group group = w_.group(u_, head_, g);
    w_.load_current(u_, g);
    if (u_.layout.pairs) w_.load_candidates(u_, g);
    Modes* const modes = modes_.empty() ? nullptr : &modes_[g];
    if (modes != nullptr && modes->chosen && (search == nullptr || modes->exact)) {
      std::copy(std::begin(modes->mode), std::end(modes->mode), &group.mode[0][0]);
      load_modes(u_, g, group, w_);
    } else if (search != nullptr) {
      choose_modes_exactly(u_, g, *search, group, w_);
    } else {
      choose_modes(u_, g, group, w_);
    }
    if (modes != nullptr) {
      modes->chosen = true;
      modes->exact = search != nullptr;
      std::copy(&group.mode[0][0], &group.mode[0][0] + 2 * kLanes, std::begin(modes->mode));
    }
    Step* next = w_.steps.data();
    const unsigned kinds = u_.layout.mode_kinds(u_.update);
    for (unsigned k = 0; k < kinds; ++k, ++next) {
      next->active = group.active;
      next->hit = 0;
      const auto context = static_cast<std::uint16_t>(mode_context(u_.layout.pairs, u_.update, k));
      std::fill(std::begin(next->context), std::end(next->context), context);
      std::copy(std::begin(group.mode[k]), std::end(group.mode[k]), std::begin(next->value));
    }
    next = u_.layout.pairs ? u_.kernels.model_pairs(group, next)
                           : u_.kernels.model_planes(group, next);
    return {w_.steps.data(), next};
  }

  /// Set and overrides by the counts of every `stride`-th group.
  const Tables& adapt(std::size_t stride, const Tables* search) {
    const std::size_t groups = w_.chunk.group_begin.size() - 1;
    w_.histogram.clear();
    std::uint32_t seen = 0;
    for (std::size_t g = stride / 2; g < groups; g += stride) {
      w_.histogram.add(model(g, search));
      seen += w_.chunk.group_begin[g + 1] - w_.chunk.group_begin[g];
    }
    head_.set = w_.histogram.best_set(u_.update);
    const Tables& set = tables(head_.set, u_.update);
    w_.histogram.choose(set, (w_.chunk.coded + seen / 2) / std::max(1U, seen),
                        settings_.strong ? kMaxMembers : kFastMembers, head_.overrides);
    return w_.adapted.apply(set, head_.overrides);
  }

  const Update& u_;
  const EncodeSettings& settings_;
  ChunkHead& head_;
  Workspace& w_;
  struct Modes {
    bool chosen = false, exact = false;
    std::uint16_t mode[2 * kLanes] = {};
  };
  std::vector<Modes> modes_;  // of every group, so that nothing is searched twice
  bool exact_ = false;        // modes by their exact cost
};

void encode_raw(const Update& u, std::span<const std::uint32_t> positions,
                std::span<const std::byte> texels, std::vector<std::byte>& out) {
  out.push_back(std::byte{kRawChunk});
  for (const auto position : positions) {
    const auto block = texels.subspan(position * u.block_bytes(), u.block_bytes());
    out.insert(out.end(), block.begin(), block.end());
  }
}

}  // namespace

void encode_chunk(const Update& u, std::span<const std::uint32_t> positions,
                  std::span<const std::byte> texels, const EncodeSettings& settings, Workspace& w,
                  std::vector<std::byte>& out) {
  ChunkHead head;
  head.lanes = settings.lanes != 0 ? settings.lanes : choose_lanes(positions.size());
  while (!enough_lanes(head.lanes, positions.size())) head.lanes *= 2;
  w.prepare(u, positions, head.lanes);
  for (std::uint32_t b = 0; b < w.chunk.coded; ++b) {
    u.unpack(texels.data() + w.chunk.blocks[b].position * u.block_bytes(), w.current(b));
  }
  if (u.layout.pairs) {
    find_cap(u, w, head);
    head.coded = 3;
  } else {
    find_constants(u, w, head);
  }
  w.set_head(u, head);
  w.reserve_steps(u);

  ChunkEncoder encoder(u, settings, head, w);
  const Tables& set = encoder.plan();

  // Groups and steps backwards, words from the end of the buffer to its begin. Beyond the size of
  // raw texels there is room for one more group, whatever it holds.
  const std::size_t raw_size = positions.size() * u.block_bytes();
  const std::size_t group_room = w.steps.size() * kMaxStepBytes + kSlack;
  w.bytes.resize(raw_size + group_room);
  Output output{};
  std::fill(std::begin(output.state), std::end(output.state), kStateLow);
  auto* const begin = reinterpret_cast<std::uint8_t*>(w.bytes.data());
  auto* const end = begin + w.bytes.size();
  output.next = end;
  const std::size_t head_size = out.size();
  for (std::size_t g = w.chunk.group_begin.size() - 1; g-- > 0;) {
    const auto steps = encoder.model(g, set);
    if (settings.observe) settings.observe(steps.data(), steps.data() + steps.size());
    u.kernels.encode_steps(steps.data(), steps.data() + steps.size(), set, output);
    if (static_cast<std::size_t>(end - output.next) >= raw_size) break;
  }
  const auto size = static_cast<std::size_t>(end - output.next);
  write_head(u.layout, head, out);
  ByteWriter writer(out);
  for (unsigned l = 0; l < head.lanes; ++l) writer.fixed(output.state[l]);
  if (out.size() - head_size + size > raw_size) {
    out.resize(head_size);
    return encode_raw(u, positions, texels, out);
  }
  writer.bytes(std::as_bytes(std::span(output.next, size)));
}

}  // namespace gicodec::native
