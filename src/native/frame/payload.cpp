#include "native/frame/payload.h"

#include "base/bytes.h"
#include "base/parallel.h"
#include "native/frame/chunk_decoder.h"
#include "native/frame/chunk_head.h"
#include "native/frame/statistics.h"
#include "native/matches/match_chunk.h"
#include "native/matches/match_look.h"
#include "native/planes/steps.h"
#include "native/tokens/token_head.h"

#include <algorithm>
#include <atomic>

namespace gicodec::native {
namespace {

constexpr std::size_t kHead = 1;
constexpr unsigned kPartsShift = 4;                                   // above the version
constexpr std::size_t kMaxHead = kHead + 8 + 2 * kMaxPlanes + 4 + 3;  // box, steps, count
constexpr std::size_t kMaxChunkEntry = 4 + 3 + 1;  // end, padding, raw chunk's head
constexpr std::uint8_t kHasBox = 1, kHasDirectory = 2, kHasSteps = 4, kLargeBox = 8;
constexpr std::size_t kAlignment = 4;
constexpr std::size_t kChunkValues = 1U << 20;  // bounds a thread's memory
constexpr std::uint32_t kMaxBoxSide = 65535;
constexpr std::uint32_t kFewProbes = 1024, kManyProbes = 2048;

constexpr std::size_t aligned(std::size_t at) { return (at + kAlignment - 1) & ~(kAlignment - 1); }

/// Larger chunks fill their lanes better, lose fewer neighbours and share tables; but every core
/// should have one.
Grid box_of_texture(const TextureDesc& desc, const PlaneLayout& layout) {
  const std::size_t values = std::size_t{record_count(desc.block)} * layout.planes;
  const auto most = static_cast<std::uint32_t>(std::max<std::size_t>(kChunkValues / values, 64));
  const std::uint32_t half = std::clamp(block_count(desc) / 2, kFewProbes, kManyProbes);
  return default_box(desc.grid, std::min(half, most));
}

/// Without caring for cores and memory: at a face of a chunk neighbours are missing.
Grid box_of_strong(const TextureDesc& desc, const PlaneLayout& layout) {
  const std::size_t values = std::size_t{record_count(desc.block)} * layout.planes;
  const auto most = std::max<std::size_t>(2 * kChunkValues / values, 64);
  return default_box(desc.grid,
                     static_cast<std::uint32_t>(std::min<std::size_t>(most, kMaxChunkProbes)));
}

Grid large_box(const TextureDesc& desc) { return default_box(desc.grid, kMaxBoxProbes); }

/// Whether blocks are worth the time of adaptive chunks.
bool adapts(const EncodeJob& job, const EncodeSettings& settings) {
  // Cells and buckets, and whatever is as large as a brick.
  constexpr std::uint32_t kTinyBlock = 8, kSmallBlock = 64;
  constexpr std::size_t kMaxTiny = 1U << 26, kMaxSmall = 1U << 18;
  const Adapts when = model_of(job.desc).adapts;
  if (when == Adapts::always) return true;
  if (when == Adapts::never || settings.preset == Preset::turbo || settings.set >= 0 ||
      settings.lanes != 0 || settings.observe) {
    return false;
  }
  if (settings.preset == Preset::strong || when == Adapts::if_strong)
    return settings.preset == Preset::strong;
  const std::uint32_t records = record_count(job.desc.block);
  return records <= kSmallBlock && job.blocks.size() * block_bytes(job.desc) <=
                                       (records <= kTinyBlock ? kMaxTiny : kMaxSmall);
}

/// A 3D texture: each slice tells about the next. What is far off in a map tells nothing.
bool is_deep(const TextureDesc& desc) { return desc.block.z > 1; }

/// The largest that may be rows, up to that size.
Grid box_of_rows(const TextureDesc& desc, const Grid& largest) {
  std::uint32_t blocks = largest.x * largest.y * largest.z;
  Grid box = largest;
  while (!fits_rows(desc, box) && blocks > 1) box = default_box(desc.grid, blocks /= 2);
  return box;
}

/// What was learned in a chunk is lost to the others: each should have enough of the update.
Grid box_of_adaptive(const EncodeJob& job) {
  const bool raster = takes_raster(job.desc);
  const unsigned slices = raster && is_deep(job.desc) ? 2 : 1;
  const std::uint64_t listed = std::max<std::size_t>(1, job.blocks.size());
  const std::uint64_t records = std::uint64_t{slices} * model_of(job.desc).chunk_records;
  const std::uint64_t blocks = std::max<std::uint64_t>(1, records / record_count(job.desc.block));
  const std::uint64_t most = blocks * block_count(job.desc) / listed;
  const Grid large = large_box(job.desc);
  if (!raster && most >= std::uint64_t{large.x} * large.y * large.z) return large;
  const std::uint64_t largest =
      raster ? std::max(1U, blocks_of_raster(job.desc) * slices / 2) : kMaxBoxSide;
  return default_box(job.desc.grid, static_cast<std::uint32_t>(std::min(most, largest)));
}

/// Runs body(item, workspace) for every item.
template <typename Body>
void for_each_chunk(std::size_t items, const Threads& threads, Vector<Workspace>& workspaces,
                    const Body& body) {
  const unsigned workers = thread_count(threads, items);
  if (workspaces.size() < workers) workspaces.resize(workers);
  for_each_item(threads, items,
                [&](unsigned thread, std::size_t i) { body(i, workspaces[thread]); });
}

void hold_bricks(Update& update, PayloadMemory& memory) {
  if (model_of(update.desc).model != Model::octree || !update.mirrored) return;
  find_held_bricks(update, memory.held);
  update.held = &memory.held;
}

std::span<const std::uint32_t> positions_of(const ChunkLists& lists, std::size_t i) {
  return std::span(lists.position).subspan(lists.begin[i], lists.begin[i + 1] - lists.begin[i]);
}

/// Of each plane, and one 0 more if they are odd in number.
std::size_t steps_size(const PlaneLayout& layout) {
  return 4 * std::size_t{(layout.planes + 1) / 2};
}
void write_steps(const PlaneLayout& layout, ByteWriter& writer) {
  for (unsigned p = 0; p < layout.planes; ++p) writer.fixed(layout.plane[p].step);
  if (layout.planes % 2 != 0) writer.fixed(std::uint16_t{0});
}
Status read_steps(ByteReader& reader, PlaneLayout& layout) {
  for (unsigned p = 0; p < layout.planes; ++p) {
    const auto step = reader.fixed<std::uint16_t>();
    if (reader.ok() && !valid_step(layout, p, step)) return Status::corrupt;
    if (reader.ok()) set_step(layout, p, step);
  }
  const std::uint16_t rest = layout.planes % 2 != 0 ? reader.fixed<std::uint16_t>() : 0;
  if (!reader.ok()) return reader.status();
  return layout.stepped && rest == 0 ? Status::ok : Status::corrupt;
}

}  // namespace

std::size_t payload_bound(const TextureDesc& desc, std::size_t probes) noexcept {
  return kMaxHead + probes * (kMaxChunkEntry + block_bytes(desc));
}

namespace {

void encode(const EncodeJob& job, const PayloadSettings& settings, Isa isa, PayloadMemory& memory,
            std::vector<std::byte>& out) {
  PlaneLayout layout = plane_layout(job.desc);
  const Grid implicit_box = box_of_texture(job.desc, layout);
  const bool adaptive = adapts(job, settings.chunk);
  const bool wide = layout.low != 0;
  const bool rows = !adaptive && (settings.chunk.preset != Preset::turbo || wide) &&
                    takes_rows(job.desc) &&
                    (job.keyframe || 2 * job.blocks.size() >= block_count(job.desc));
  // Planes, which are tried for large components, need small boxes.
  const Grid largest = is_deep(job.desc) && !wide
                           ? default_box(job.desc.grid, blocks_of_raster(job.desc))
                           : implicit_box;
  const Grid box = settings.box.x != 0                       ? settings.box
                   : adaptive                                ? box_of_adaptive(job)
                   : settings.chunk.preset == Preset::strong ? box_of_strong(job.desc, layout)
                   : rows                                    ? box_of_rows(job.desc, largest)
                                                             : implicit_box;
  const bool modelled = !adaptive && settings.chunk.preset != Preset::turbo && (!rows || wide);
  if (modelled && settings.chunk.matches_within == 0)
    find_steps(job, kernels(isa), layout, memory.block_values);
  Update update{.desc = job.desc,
                .layout = layout,
                .kernels = kernels(isa),
                .tokens = gicodec::kernels<TokenKernels>(isa),
                .box = box,
                .probes = job.blocks,
                .mirror = job.mirror,
                .update = !job.keyframe,
                .mirrored = !job.keyframe || job.intra,
                .presence = job.presence,
                .adaptive = adaptive};
  hold_bricks(update, memory);
  ChunkLists& lists = memory.lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, box), job.blocks, lists);

  if (memory.chunks.size() < lists.chunk.size()) memory.chunks.resize(lists.chunk.size());
  const auto chunks = std::span(memory.chunks).first(lists.chunk.size());
  for_each_chunk(
      chunks.size(), settings.threads, memory.workspaces, [&](std::size_t i, Workspace& w) {
        chunks[i].clear();
        encode_chunk(update, positions_of(lists, i), job.records, settings.chunk, w, chunks[i]);
      });
  const bool directory = chunks.size() > 1;
  const bool large = box != implicit_box && box == large_box(job.desc);
  const bool explicit_box = box != implicit_box && !large;
  ByteWriter writer(out);
  const auto parts = (explicit_box ? kHasBox : 0U) | (large ? kLargeBox : 0U) |
                     (directory ? kHasDirectory : 0U) | (layout.stepped ? kHasSteps : 0U);
  writer.fixed(static_cast<std::uint8_t>(kVersion | parts << kPartsShift));
  std::size_t at = kHead;
  if (explicit_box) {
    for (const auto side : {box.x, box.y, box.z, 0U})
      writer.fixed(static_cast<std::uint16_t>(side));
    at += 8;
  }
  if (layout.stepped) {
    write_steps(layout, writer);
    at += steps_size(layout);
  }
  if (directory) {
    writer.fixed(static_cast<std::uint32_t>(chunks.size()));
    at += 4 + 4 * chunks.size();
    for (std::size_t end = at; const auto& chunk : chunks) {
      end = aligned(end) + chunk.size();
      writer.fixed(static_cast<std::uint32_t>(end));
    }
  }
  for (const auto& chunk : chunks) {
    for (; directory && at % kAlignment != 0; ++at) writer.fixed(std::uint8_t{0});
    writer.bytes(chunk);
    at += chunk.size();
  }
}

/// What fast codes by adaptive chunks too, after it took `size` bytes: tables and states are a
/// large part of so little, and the time is some milliseconds.
bool may_adapt_at_once(const EncodeJob& job, std::size_t size) {
  constexpr std::size_t kTiny = 1U << 14, kSmall = 1U << 18, kLittle = 1024;
  if (size <= kTooFew || !job.keyframe || !takes_raster(job.desc) || job.desc.record.count > 4)
    return false;
  return job.blocks.size() * block_bytes(job.desc) <= (size <= kLittle ? kSmall : kTiny);
}

}  // namespace

void encode_payload(const EncodeJob& job, const PayloadSettings& settings, Isa isa,
                    PayloadMemory& memory, std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  encode(job, settings, isa, memory, out);
  const EncodeSettings& wanted = settings.chunk;
  const bool chosen = wanted.set >= 0 || wanted.lanes != 0 || wanted.observe || !wanted.others;
  if (wanted.preset == Preset::turbo || chosen || job.blocks.empty()) return;
  const auto at = [&](std::size_t i) { return out.begin() + static_cast<std::ptrdiff_t>(i); };
  // Appends another payload and keeps the smaller; the size of the other.
  const auto try_as = [&](const PayloadSettings& other) {
    const std::size_t end = out.size();
    encode(job, other, isa, memory, out);
    const std::size_t size = out.size() - end;
    const bool smaller = size < end - begin;
    out.erase(smaller ? at(begin) : at(end), smaller ? at(end) : out.end());
    return size;
  };
  PayloadSettings other = settings;
  other.chunk.preset = Preset::fast;
  const bool strong = wanted.preset == Preset::strong;
  if (!strong && may_adapt_at_once(job, out.size() - begin)) {
    other.chunk.preset = Preset::strong;
    try_as(other);
    other.chunk.preset = Preset::fast;
  }
  const std::size_t of_fast = strong ? try_as(other) : out.size() - begin;
  if (!takes_matches(job.desc)) return;
  // Strong tries them wherever fast does, too.
  if (!may_match(job, of_fast, false, memory.look) &&
      (!strong || !may_match(job, out.size() - begin, true, memory.look)))
    return;
  other.box = large_box(job.desc);
  other.chunk.matches_within = of_fast;
  try_as(other);
  if (!strong) return;
  other.chunk.preset = Preset::strong;
  other.chunk.matches_within = out.size() - begin;
  try_as(other);
}

namespace {

Status read_box(const Grid& grid, ByteReader& reader, Grid& box) {
  for (auto* side : {&box.x, &box.y, &box.z}) *side = reader.fixed<std::uint16_t>();
  const auto rest = reader.fixed<std::uint16_t>();
  if (!reader.ok()) return reader.status();
  return rest == 0 && valid_box(grid, box) ? Status::ok : Status::corrupt;
}

/// Chunks from ends that ascend and leave a byte to each.
Status read_directory(std::span<const std::byte> payload, ByteReader& reader,
                      Vector<std::span<const std::byte>>& chunks) {
  const auto count = reader.fixed<std::uint32_t>();
  if (!reader.ok()) return reader.status();
  if (count < 2) return Status::corrupt;
  if (count > reader.rest().size() / 4) return Status::truncated;
  std::size_t at = payload.size() - reader.rest().size() + std::size_t{4} * count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t end = reader.fixed<std::uint32_t>(), begin = aligned(at);
    if (end <= begin) return Status::corrupt;
    if (end > payload.size()) return Status::truncated;
    for (; at < begin; ++at) {
      if (payload[at] != std::byte{0}) return Status::corrupt;
    }
    chunks.push_back(payload.subspan(begin, end - begin));
    at = end;
  }
  return at == payload.size() ? Status::ok : Status::corrupt;
}

Status read_payload_head(const TextureDesc& desc, std::span<const std::byte> payload,
                         PayloadHead& head) {
  ByteReader reader(payload);
  const unsigned first = reader.fixed<std::uint8_t>(), parts = first >> kPartsShift;
  if (!reader.ok()) return reader.status();
  if ((first & ((1U << kPartsShift) - 1)) != kVersion) return Status::unsupported_version;
  constexpr unsigned kBoxes = kHasBox | kLargeBox;
  if ((parts & kBoxes) == kBoxes) return Status::corrupt;
  head.layout = plane_layout(desc);
  head.chunks.clear();
  head.box = (parts & kLargeBox) != 0 ? large_box(desc) : box_of_texture(desc, head.layout);
  if ((parts & kHasBox) != 0) {
    const Status status = read_box(desc.grid, reader, head.box);
    if (status != Status::ok) return status;
  }
  if ((parts & kHasSteps) != 0) {
    const Status status = read_steps(reader, head.layout);
    if (status != Status::ok) return status;
  }
  if ((parts & kHasDirectory) != 0) return read_directory(payload, reader, head.chunks);
  if (!reader.rest().empty()) head.chunks.push_back(reader.rest());
  return Status::ok;
}

}  // namespace

Status check_payload(const TextureDesc& desc, std::size_t probes,
                     std::span<const std::byte> payload, PayloadMemory& memory) {
  const PayloadHead& head = memory.head;
  if (const Status read = read_payload_head(desc, payload, memory.head); read != Status::ok)
    return read;
  const std::size_t volume = std::size_t{head.box.x} * head.box.y * head.box.z;
  const std::size_t boxes = chunk_grid(desc.grid, head.box).count();
  const std::size_t chunks = head.chunks.size();
  if (chunks > std::min(probes, boxes)) return Status::corrupt;
  if (chunks < (probes + volume - 1) / volume) return Status::truncated;
  for (const auto bytes : head.chunks) {
    const unsigned kind = std::to_integer<unsigned>(bytes[0]) & 3;
    const bool small = kind == kModelledChunk || kind == kTokenChunk;
    if (small && !is_small_box(head.box)) return Status::corrupt;
    // Heads of updates have all that those of keyframes have.
    const Status status = check_chunk(desc, head.layout, true, bytes, memory.chunk_head);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status decode_payload(const DecodeJob& job, Isa isa, PayloadMemory& memory) {
  const PayloadHead& head = memory.head;
  if (const Status read = read_payload_head(job.desc, job.payload, memory.head); read != Status::ok)
    return read;
  Update update{.desc = job.desc,
                .layout = head.layout,
                .kernels = kernels(isa),
                .tokens = gicodec::kernels<TokenKernels>(isa),
                .box = head.box,
                .probes = job.blocks,
                .mirror = job.mirror,
                .update = !job.keyframe,
                .mirrored = !job.keyframe || job.intra,
                .cancel = job.cancel,
                .presence = job.presence};
  hold_bricks(update, memory);
  ChunkLists& lists = memory.lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, head.box), job.blocks, lists);
  const auto& chunks = head.chunks;
  if (chunks.size() != lists.chunk.size()) {
    return chunks.size() < lists.chunk.size() ? Status::truncated : Status::corrupt;
  }

  std::vector<PayloadStatistics> statistics(job.statistics != nullptr ? chunks.size() : 0);
  auto& status = memory.status;
  status.assign(chunks.size(), Status::ok);
  std::atomic<std::size_t> refused{chunks.size()};  // nothing behind it is worth the work
  for_each_chunk(chunks.size(), job.threads, memory.workspaces, [&](std::size_t i, Workspace& w) {
    if (i > refused) return;
    status[i] = decode_chunk(update, positions_of(lists, i), chunks[i], job.records, w,
                             statistics.empty() ? nullptr : &statistics[i]);
    if (status[i] == Status::ok) return;
    for (std::size_t first = refused; i < first && !refused.compare_exchange_weak(first, i);) {
    }
  });
  if (refused < chunks.size()) return status[refused];
  for (const auto& s : statistics) *job.statistics += s;
  if (job.statistics != nullptr) {
    const std::uint32_t volume = head.box.x * head.box.y * head.box.z;
    job.statistics->chunk_blocks = std::max(job.statistics->chunk_blocks, volume);
    job.statistics->head_bytes += job.payload.size();
    for (const auto& chunk : chunks) job.statistics->head_bytes -= chunk.size();
  }
  return Status::ok;
}

}  // namespace gicodec::native
