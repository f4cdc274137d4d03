#include "native/content.h"

#include "quantise/component_code.h"
#include "quantise/set_order.h"
#include "shapes.h"
#include "texture/presence.h"

#include <algorithm>
#include <cmath>

namespace gicodec::test {
namespace {

/// A component's value in 0..1 for a smooth scene.
double wave(const Grid& block, std::size_t record, unsigned component, unsigned frame) {
  const double t = static_cast<double>(record);
  return 0.5 + 0.4 * std::sin(0.3 * block.x + 0.5 * block.y + 0.7 * block.z + 0.11 * t +
                              0.9 * component + 0.02 * frame);
}

std::uint64_t value(Content content, const Component& c, unsigned index, const Grid& block,
                    std::size_t record, unsigned frame, Random& random) {
  const double top = std::pow(2.0, c.bits) - 1;
  const auto full = static_cast<std::uint64_t>(top);
  const double w = wave(block, record, index, frame);
  switch (content) {
    case Content::smooth:
      return static_cast<std::uint64_t>(top * std::floor(w * 200) / 200);
    case Content::noisy:
      return static_cast<std::uint64_t>(
          top * std::clamp(w + (static_cast<double>(random() % 64) - 32) / 1000, 0.0, 1.0));
    case Content::white:
      return random() & full;
    case Content::constant:
      return full / 3;
    case Content::extremes:
      return random() % 2 == 0 ? 0 : full;
    case Content::alternating:
      return (block.x + block.y + block.z + record + frame) % 2 == 0 ? full : random() & full;
    case Content::shared: {
      // The noise of a few blocks.
      Random same(977 * frame + 31 * record + 7 * index + (block.x + block.z) / 3);
      return record % 4 == 0 ? random() & full : same() & full;
    }
    case Content::stepped: {
      // Multiples, and where they are no powers of two also the largest value; in the mirror
      // others.
      constexpr std::uint64_t kSteps[] = {4, 16, 3, 1};
      const std::uint64_t step = std::min(kSteps[index % 4], full);
      if (step == 3 && random() % 16 == 0) return full;
      const auto v = static_cast<std::uint64_t>(top * w) + random() % 64;
      return frame == 0 ? v & full : std::min(v, full) / step * step;
    }
  }
  return 0;
}

/// Zeros what does not exist of every block.
void clear_absent_of_all(const TextureDesc& desc, std::span<const std::byte> presence,
                         std::span<std::byte> records) {
  const std::size_t size = block_bytes(desc), exists = presence_bytes(desc);
  for (std::size_t b = 0; b < block_count(desc); ++b) {
    clear_absent(desc, presence.subspan(b * exists, exists), records.subspan(b * size, size));
  }
}

}  // namespace

Bytes make_records(const TextureDesc& desc, Content content, unsigned frame, std::uint64_t seed) {
  const Record& format = desc.record;
  const std::size_t records = record_count(desc.block);
  Bytes out(block_count(desc) * records * format.bytes);
  Random random(seed + frame * 977);
  std::byte* record = out.data();
  for (std::uint32_t b = 0; b < block_count(desc); ++b) {
    const Grid at = {b % desc.grid.x, b / desc.grid.x % desc.grid.y, b / desc.grid.x / desc.grid.y};
    for (std::size_t r = 0; r < records; ++r, record += format.bytes) {
      for (unsigned c = 0; c < format.count; ++c) {
        const Component& component = format.components[c];
        const auto v = value(content, component, c, at, r, frame, random);
        for (unsigned i = 0; i < component.bits; ++i) {
          const unsigned bit = component.offset + i;
          if ((v >> i & 1) != 0) record[bit / 8] |= std::byte(1U << bit % 8);
        }
      }
    }
  }
  return out;
}

void forget_some(UpdateCase& u, Random& random) {
  const std::uint32_t blocks = block_count(u.desc);
  const std::size_t size = block_bytes(u.desc);
  u.received.assign(blocks, 1);
  const bool all = chance(random, 2);
  for (std::uint32_t b = 0; b < blocks && !all; ++b) {
    if (!chance(random, 3)) continue;
    u.received[b] = 0;
    if (!u.mirror_presence.empty()) {
      const std::size_t said = presence_bytes(u.desc);
      std::fill_n(u.mirror_presence.begin() + static_cast<std::ptrdiff_t>(b * said), said,
                  std::byte{0});
    }
    std::fill_n(u.mirror.begin() + static_cast<std::ptrdiff_t>(b * size), size, std::byte{0});
  }
}

UpdateCase make_update(const TextureDesc& desc, Content content, bool keyframe,
                       std::uint32_t one_in, std::uint64_t seed) {
  UpdateCase u{desc, {}, {}, {}, {}, keyframe, {}, false};
  Bytes now = make_records(desc, content, 1, seed);
  const std::size_t size = block_bytes(desc), exists = presence_bytes(desc);
  Random random(seed);
  Bytes presence;
  if (desc.presence != Presence::all) {
    presence = any_presence(random, desc);
    clear_absent_of_all(desc, presence, now);
  }
  if (!keyframe) {
    u.mirror = make_records(desc, content, 0, seed);
    // Now and then others existed than do now.
    if (desc.presence != Presence::all) {
      const Bytes before = chance(random, 2) ? presence : any_presence(random, desc);
      clear_absent_of_all(desc, before, u.mirror);
      if (desc.presence == Presence::brick) u.mirror_presence = before;
    }
    forget_some(u, random);
  }
  for (std::uint32_t b = 0; b < block_count(desc); ++b) {
    if (!chance(random, one_in)) continue;
    u.blocks.push_back(b);
    const auto block = std::span(now).subspan(b * size, size);
    u.records.insert(u.records.end(), block.begin(), block.end());
    const auto one = std::span(presence).subspan(b * exists, exists);
    u.presence.insert(u.presence.end(), one.begin(), one.end());
  }
  return u;
}

UpdateCase make_intra(const TextureDesc& desc, Content content, std::uint32_t one_in,
                      std::uint64_t seed) {
  UpdateCase u = make_update(desc, content, false, one_in, seed);
  u.keyframe = u.intra = true;
  const std::size_t size = block_bytes(desc);
  Random random(seed);
  for (const std::uint32_t block : u.blocks) {
    std::generate_n(u.mirror.begin() + static_cast<std::ptrdiff_t>(block * size), size,
                    [&] { return static_cast<std::byte>(random()); });
  }
  return u;
}

void sort_sets(UpdateCase& update) {
  const TextureDesc& desc = update.desc;
  const std::size_t size = block_bytes(desc), exists = presence_bytes(desc);
  for (std::size_t b = 0; b < update.blocks.size(); ++b) {
    const BlockPresence present(desc, std::span(update.presence).subspan(b * exists, exists));
    sort_set(desc.record, std::span(update.records)
                              .subspan(b * size, std::size_t{present.count()} * desc.record.bytes));
  }
}

void make_previous(UpdateCase& u, Random& random, bool sorted) {
  const std::size_t size = block_bytes(u.desc), exists = presence_bytes(u.desc);
  const Record& record = u.desc.record;
  u.mirror.assign(block_count(u.desc) * size, std::byte{0});
  u.received.assign(block_count(u.desc), 1);
  for (std::size_t b = 0; b < u.blocks.size(); ++b) {
    const BlockPresence present(u.desc, std::span(u.presence).subspan(b * exists, exists));
    const auto now = std::span(u.records).subspan(b * size, present.count() * record.bytes);
    const auto previous = std::span(u.mirror).subspan(u.blocks[b] * size, size);
    const std::uint32_t one_in = pick(random, 2, 20);
    std::size_t to = 0;
    for (std::size_t from = 0; from < now.size() && to < size; from += record.bytes) {
      if (chance(random, one_in)) continue;
      std::memcpy(&previous[to], &now[from], record.bytes);
      const std::byte* const other = &now[random() % (now.size() / record.bytes) * record.bytes];
      const Component& component = record.components[random() % record.count];
      if (chance(random, one_in)) {
        set_code(&previous[to], component, record.bytes, code_of(other, component, record.bytes));
      }
      if (chance(random, 2 * one_in)) std::memcpy(&previous[to], other, record.bytes);
      to += record.bytes;
    }
    if (sorted) sort_set(record, previous.first(to));
  }
}

Bytes encode(const UpdateCase& update, const native::PayloadSettings& settings, Isa isa) {
  native::PayloadMemory memory;
  Bytes out;
  native::encode_payload(update.encode_job(), settings, isa, memory, out);
  return out;
}

}  // namespace gicodec::test
