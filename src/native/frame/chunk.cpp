#include "native/frame/chunk.h"

#include <algorithm>
#include <numeric>

namespace gicodec::native {

bool valid_box(const Grid& grid, const Grid& box) noexcept {
  return box.x >= 1 && box.y >= 1 && box.z >= 1 && box.x <= grid.x && box.y <= grid.y &&
         box.z <= grid.z && std::uint64_t{box.x} * box.y * box.z <= kMaxBoxProbes;
}

ChunkGrid chunk_grid(const Grid& grid, const Grid& box) noexcept {
  const auto parts = [](std::uint32_t n, std::uint32_t size) { return (n + size - 1) / size; };
  return {box, {parts(grid.x, box.x), parts(grid.y, box.y), parts(grid.z, box.z)}};
}

Grid default_box(const Grid& grid, std::uint32_t target) noexcept {
  Grid box = grid;
  while (std::uint64_t{box.x} * box.y * box.z > target) {
    std::uint32_t& side = box.z >= box.x && box.z >= box.y ? box.z : box.x >= box.y ? box.x : box.y;
    side = (side + 1) / 2;
  }
  return box;
}

void split(const Grid& grid, const ChunkGrid& chunks, std::span<const std::uint32_t> probes,
           ChunkLists& lists) {
  const auto chunk_of = [&](std::uint32_t probe) {
    const std::uint32_t x = probe % grid.x, y = probe / grid.x % grid.y,
                        z = probe / grid.x / grid.y;
    return x / chunks.box.x +
           chunks.chunks.x * (y / chunks.box.y + chunks.chunks.y * (z / chunks.box.z));
  };
  lists.chunk.clear();
  lists.begin.clear();
  lists.position.resize(probes.size());
  if (chunks.count() == 1) {
    for (std::uint32_t i = 0; i < probes.size(); ++i) lists.position[i] = i;
    if (!probes.empty()) lists.chunk.push_back(0);
    lists.begin.push_back(0);
    if (!probes.empty()) lists.begin.push_back(static_cast<std::uint32_t>(probes.size()));
    return;
  }
  auto& owner = lists.owner;
  owner.resize(probes.size());
  for (std::size_t i = 0; i < probes.size(); ++i) owner[i] = chunk_of(probes[i]);
  if (chunks.count() <= probes.size()) {
    // By counting, which takes memory for every chunk.
    auto& next = lists.next;
    next.assign(chunks.count() + 1, 0);
    for (const std::uint32_t chunk : owner) ++next[chunk + 1];
    for (std::uint32_t c = 0; c < chunks.count(); ++c) next[c + 1] += next[c];
    for (std::uint32_t i = 0; i < probes.size(); ++i) lists.position[next[owner[i]]++] = i;
  } else {
    std::iota(lists.position.begin(), lists.position.end(), 0U);
    std::sort(lists.position.begin(), lists.position.end(), [&](std::uint32_t i, std::uint32_t j) {
      return owner[i] != owner[j] ? owner[i] < owner[j] : i < j;
    });
  }
  for (std::uint32_t i = 0; i < probes.size(); ++i) {
    const std::uint32_t chunk = owner[lists.position[i]];
    if (!lists.chunk.empty() && lists.chunk.back() == chunk) continue;
    lists.chunk.push_back(chunk);
    lists.begin.push_back(i);
  }
  lists.begin.push_back(static_cast<std::uint32_t>(probes.size()));
}

namespace {

constexpr std::int32_t kUnknown = kNoBlock - 1;  ///< a slot of what nothing may be predicted from

}  // namespace

void Chunk::build(const Grid& grid, const Grid& box, std::span<const std::uint32_t> probes,
                  std::span<const std::uint32_t> positions, const MirrorView* mirror,
                  unsigned lanes) {
  coded = static_cast<std::uint32_t>(positions.size());
  blocks.clear();
  // Counting sort by diagonal; positions ascend, so indices ascend within one.
  place_.resize(positions.size());
  count_.assign(box.x + box.y + box.z, 0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Grid l = place_[i] = place_in_box(grid, box, probes[positions[i]]);
    ++count_[l.x + l.y + l.z + 1];
  }
  for (std::size_t d = 1; d < count_.size(); ++d) count_[d] += count_[d - 1];
  order_.resize(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    order_[count_[place_[i].x + place_[i].y + place_[i].z]++] = i;
  }

  slot_.assign(std::size_t{box.x} * box.y * box.z, kNoBlock);
  for (const auto i : order_) {
    slot_[slot_of(box, place_[i])] = static_cast<std::int32_t>(blocks.size());
    blocks.push_back({probes[positions[i]], positions[i], {kNoBlock, kNoBlock, kNoBlock}});
  }
  find_neighbours(grid, box, mirror);
  form_groups(lanes);
}

void Chunk::build_flat(const Grid& grid, const Grid& box, std::span<const std::uint32_t> probes,
                       std::span<const std::uint32_t> positions, const MirrorView* mirror,
                       bool previous, unsigned lanes) {
  coded = static_cast<std::uint32_t>(positions.size());
  blocks.clear();
  for (const auto position : positions) {
    blocks.push_back({probes[position], position, {kNoBlock, kNoBlock, kNoBlock}});
  }
  if (mirror != nullptr) {
    slot_.assign(std::size_t{box.x} * box.y * box.z, kNoBlock);
    for (const auto position : previous ? std::span<const std::uint32_t>() : positions) {
      slot_[slot_of(box, place_in_box(grid, box, probes[position]))] = kUnknown;
    }
    find_neighbours(grid, box, mirror);
  }
  form_groups(lanes);
}

/// Those in slots, and of the others those received.
void Chunk::find_neighbours(const Grid& grid, const Grid& box, const MirrorView* mirror) {
  const std::size_t slot_step[3] = {1, box.x, std::size_t{box.x} * box.y};
  const std::uint32_t step[3] = {1, grid.x, grid.x * grid.y};
  for (std::uint32_t b = 0; b < coded; ++b) {
    const std::uint32_t probe = blocks[b].probe;
    const Grid place = place_in_box(grid, box, probe);
    const std::uint32_t coordinate[3] = {place.x, place.y, place.z};
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (coordinate[axis] == 0) continue;
      std::int32_t& found = slot_[slot_of(box, place) - slot_step[axis]];
      if (found == kNoBlock && mirror != nullptr && mirror->is_received(probe - step[axis])) {
        found = static_cast<std::int32_t>(blocks.size());
        blocks.push_back({probe - step[axis], 0, {kNoBlock, kNoBlock, kNoBlock}});
      }
      if (found != kUnknown) blocks[b].neighbour[axis] = found;
    }
  }
}

void Chunk::form_groups(unsigned lanes) {
  group_begin.assign(1, 0);
  if (coded == 0) return;
  for (std::uint32_t b = 0; b < coded; ++b) {
    const auto first = static_cast<std::int32_t>(group_begin.back());
    const auto in_group = [first, b](std::int32_t n) {
      return n >= first && n < static_cast<std::int32_t>(b);
    };
    const auto& around = blocks[b].neighbour;
    if (b - group_begin.back() == lanes ||
        std::any_of(std::begin(around), std::end(around), in_group)) {
      group_begin.push_back(b);
    }
  }
  group_begin.push_back(coded);
}

std::uint32_t Chunk::widest_group() const noexcept {
  std::uint32_t widest = 0;
  for (std::size_t g = 1; g < group_begin.size(); ++g) {
    widest = std::max(widest, group_begin[g] - group_begin[g - 1]);
  }
  return widest;
}

}  // namespace gicodec::native
