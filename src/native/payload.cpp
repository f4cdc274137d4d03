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
  const std::size_t values = std::size_t{record_count(desc.block)} * layout.planes;
  const auto most = static_cast<std::uint32_t>(std::max<std::size_t>(kChunkValues / values, 64));
  const std::uint32_t half = std::clamp(block_count(desc) / 2, kFewProbes, kManyProbes);
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
  return kMaxHead + probes * (kMaxChunkEntry + block_bytes(desc));
}

void encode_payload(const EncodeJob& job, const PayloadSettings& settings, Isa isa,
                    std::vector<Workspace>& workspaces, std::vector<std::byte>& out) {
  const PlaneLayout layout = plane_layout(job.desc.record);
  const Grid box = settings.box.x != 0 ? settings.box : choose_box(job.desc, layout);
  const Update update{job.desc,   layout,     kernels(isa),  box,
                      job.blocks, job.mirror, !job.keyframe, nullptr};
  ChunkLists lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, box), job.blocks, lists);

  std::vector<std::vector<std::byte>> chunks(lists.chunk.size());
  for_each_chunk(chunks.size(), settings.threads, workspaces, [&](std::size_t i, Workspace& w) {
    encode_chunk(update, positions_of(lists, i), job.records, settings.chunk, w, chunks[i]);
  });
  ByteWriter writer(out);
  writer.fixed(kVersion);
  for (const auto side : {box.x, box.y, box.z}) writer.varint(side);
  for (const auto& chunk : chunks) writer.varint(chunk.size());
  for (const auto& chunk : chunks) writer.bytes(chunk);
}

namespace {

/// The head of a payload, and the bytes of its chunks.
struct PayloadHead {
  Grid box;
  std::vector<std::span<const std::byte>> chunks;
};

/// The sizes say themselves where they end: where they and the chunks together are all there is.
Result<PayloadHead> read_payload_head(const TextureDesc& desc, std::span<const std::byte> payload) {
  ByteReader reader(payload);
  const auto version = reader.fixed<std::uint8_t>();
  if (reader.ok() && version != kVersion) return Status::unsupported_version;
  PayloadHead head;
  for (auto* side : {&head.box.x, &head.box.y, &head.box.z}) {
    *side = static_cast<std::uint32_t>(reader.varint(kMaxGridSide));
  }
  if (!reader.ok()) return reader.status();
  if (!valid_box(desc.grid, head.box)) return Status::corrupt;
  std::vector<std::size_t> sizes;
  for (std::size_t sum = 0; sum < reader.rest().size();) {
    sizes.push_back(static_cast<std::size_t>(reader.varint(payload.size())));
    if (!reader.ok()) return reader.status();
    if (sizes.back() == 0) return Status::corrupt;
    sum += sizes.back();
    if (sum > reader.rest().size()) return Status::truncated;
  }
  for (const std::size_t size : sizes) head.chunks.push_back(reader.bytes(size));
  return head;
}

}  // namespace

Status check_payload(const TextureDesc& desc, std::size_t probes,
                     std::span<const std::byte> payload) {
  const auto head = read_payload_head(desc, payload);
  if (!head) return head.status();
  const std::size_t volume = std::size_t{head->box.x} * head->box.y * head->box.z;
  const std::size_t boxes = chunk_grid(desc.grid, head->box).count();
  const std::size_t chunks = head->chunks.size();
  if (chunks > std::min(probes, boxes)) return Status::corrupt;
  if (chunks < (probes + volume - 1) / volume) return Status::truncated;
  const PlaneLayout layout = plane_layout(desc.record);
  ChunkHead scratch;
  for (const auto bytes : head->chunks) {
    const Status status = check_chunk(desc, layout, bytes, scratch);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status decode_payload(const DecodeJob& job, Isa isa, std::vector<Workspace>& workspaces) {
  const auto head = read_payload_head(job.desc, job.payload);
  if (!head) return head.status();
  const PlaneLayout layout = plane_layout(job.desc.record);
  const Update update{job.desc,   layout,     kernels(isa),  head->box,
                      job.blocks, job.mirror, !job.keyframe, job.cancel};
  ChunkLists lists;
  split(job.desc.grid, chunk_grid(job.desc.grid, head->box), job.blocks, lists);
  const auto& chunks = head->chunks;
  if (chunks.size() != lists.chunk.size()) {
    return chunks.size() < lists.chunk.size() ? Status::truncated : Status::corrupt;
  }

  std::vector<PayloadStatistics> statistics(job.statistics != nullptr ? chunks.size() : 0);
  std::vector<Status> status(chunks.size(), Status::ok);
  for_each_chunk(chunks.size(), job.threads, workspaces, [&](std::size_t i, Workspace& w) {
    status[i] = decode_chunk(update, positions_of(lists, i), chunks[i], job.records, w,
                             statistics.empty() ? nullptr : &statistics[i]);
  });
  const auto bad =
      std::find_if(status.begin(), status.end(), [](Status s) { return s != Status::ok; });
  if (bad != status.end()) return *bad;
  for (const auto& s : statistics) *job.statistics += s;
  if (job.statistics != nullptr) {
    job.statistics->head_bytes += job.payload.size();
    for (const auto& chunk : chunks) job.statistics->head_bytes -= chunk.size();
  }
  return Status::ok;
}

}  // namespace gicodec::native
