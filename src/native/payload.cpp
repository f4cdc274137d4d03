#include "native/payload.h"

#include "base/bytes.h"
#include "base/parallel.h"
#include "native/chunk_decoder.h"
#include "native/statistics.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::size_t kMaxHead = 1 + 3 * 3;     // version, box
constexpr std::size_t kMaxChunkEntry = 5 + 1;   // size, raw chunk's head
constexpr std::size_t kChunkValues = 1U << 20;  // bounds a thread's memory
constexpr std::uint32_t kFewProbes = 1024, kManyProbes = 2048;

/// Larger chunks fill their lanes better, lose fewer neighbours and share tables; but every core
/// should have one.
Grid choose_box(const TextureDesc& desc, const PlaneLayout& layout) {
  const std::size_t values = std::size_t{desc.core} * desc.core * layout.planes;
  const auto most = static_cast<std::uint32_t>(std::max<std::size_t>(kChunkValues / values, 64));
  const std::uint32_t half = std::clamp(probe_count(desc) / 2, kFewProbes, kManyProbes);
  return default_box(desc.grid, std::min(half, most));
}

/// Runs body(item, workspace) for every item.
template <typename Body>
void for_each_chunk(std::size_t items, unsigned threads, std::vector<Workspace>& workspaces,
                    const Body& body) {
  const unsigned workers = thread_count(threads, items);
  if (workspaces.size() < workers) workspaces.resize(workers);
  for_each_item(threads, items,
                [&](unsigned thread, std::size_t i) { body(i, workspaces[thread]); });
}

std::span<const std::uint32_t> positions_of(const ChunkLists& lists, std::size_t i) {
  return std::span(lists.position).subspan(lists.begin[i], lists.begin[i + 1] - lists.begin[i]);
}

}  // namespace

std::size_t payload_bound(const TextureDesc& desc, std::size_t probes) noexcept {
  return kMaxHead + probes * (kMaxChunkEntry + core_bytes(desc));
}

void encode_payload(const EncodeJob& job, const PayloadSettings& settings, Isa isa,
                    std::vector<Workspace>& workspaces, std::vector<std::byte>& out) {
  const PlaneLayout layout = plane_layout(*find_format(job.desc.format));
  const Grid box = settings.box.x != 0 ? settings.box : choose_box(job.desc, layout);
  const Update update{job.desc, layout, kernels(isa), box, job.probes, job.mirror, !job.keyframe};
  ChunkLists lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, box), job.probes, lists);

  std::vector<std::vector<std::byte>> chunks(lists.chunk.size());
  for_each_chunk(chunks.size(), settings.threads, workspaces, [&](std::size_t i, Workspace& w) {
    encode_chunk(update, positions_of(lists, i), job.texels, settings.chunk, w, chunks[i]);
  });
  ByteWriter writer(out);
  writer.fixed(kVersion);
  for (const auto side : {box.x, box.y, box.z}) writer.varint(side);
  for (const auto& chunk : chunks) writer.varint(chunk.size());
  for (const auto& chunk : chunks) writer.bytes(chunk);
}

Status decode_payload(const DecodeJob& job, Isa isa, std::vector<Workspace>& workspaces) {
  ByteReader reader(job.payload);
  const auto version = reader.fixed<std::uint8_t>();
  if (reader.ok() && version != kVersion) return Status::unsupported_version;
  Grid box;
  for (auto* side : {&box.x, &box.y, &box.z}) {
    *side = static_cast<std::uint32_t>(reader.varint(kMaxGridSide));
  }
  if (!reader.ok()) return reader.status();
  if (!valid_box(job.desc.grid, box)) return Status::corrupt;

  const PlaneLayout layout = plane_layout(*find_format(job.desc.format));
  const Update update{job.desc, layout, kernels(isa), box, job.probes, job.mirror, !job.keyframe};
  ChunkLists lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, box), job.probes, lists);
  std::vector<std::span<const std::byte>> chunks(lists.chunk.size());
  std::vector<std::size_t> sizes(chunks.size());
  for (auto& size : sizes) size = static_cast<std::size_t>(reader.varint(job.payload.size()));
  for (std::size_t i = 0; i < chunks.size(); ++i) chunks[i] = reader.bytes(sizes[i]);
  if (!reader.ok()) return reader.status();
  if (!reader.rest().empty()) return Status::corrupt;

  std::vector<PayloadStatistics> statistics(job.statistics != nullptr ? chunks.size() : 0);
  std::vector<Status> status(chunks.size(), Status::ok);
  for_each_chunk(chunks.size(), job.threads, workspaces, [&](std::size_t i, Workspace& w) {
    status[i] = decode_chunk(update, positions_of(lists, i), chunks[i], job.texels, w,
                             statistics.empty() ? nullptr : &statistics[i]);
  });
  const auto bad = std::ranges::find_if(status, [](Status s) { return s != Status::ok; });
  if (bad != status.end()) return *bad;
  for (const auto& s : statistics) *job.statistics += s;
  if (job.statistics != nullptr) {
    job.statistics->head_bytes += job.payload.size();
    for (const auto& chunk : chunks) job.statistics->head_bytes -= chunk.size();
  }
  return Status::ok;
}

}  // namespace gicodec::native
