#include "bitstream/index_writer.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Parts grow with the file, so that a list of all parts stays short: one per so many parts of its
/// packets, or one of so many where somebody reads along.
constexpr std::uint64_t kParts = 1024, kFlushedParts = 4096;
/// So many parts are listed by each part; of more, by few of them, see next_part().
constexpr std::size_t kListedByAll = 64;

}  // namespace

IndexWriter::IndexWriter(const ContainerDescription& description) {
  for (std::size_t id = 0; id < description.textures.size(); ++id) {
    presence_.push_back(presence_texture(description, static_cast<std::uint8_t>(id)));
  }
  unlisted_.reserve(kPartPackets);
}

/// Of the part that the next packets belong to.
void IndexWriter::begin_part() {
  std::erase_if(ends_, [](const auto& at) { return at.second.begin == 0 && at.second.end == 0; });
  needs_ = runs();
  ends_.try_emplace(parts_.size());
  ends_.try_emplace(parts_.size() + 1);
}

/// The parts in any span, nearest first.
std::vector<PartRun> IndexWriter::runs() const {
  std::vector<PartRun> runs;
  std::uint64_t open = 0, end = 0, before = parts_.size();
  for (auto at = ends_.rbegin(); at != ends_.rend(); ++at) {
    if (open == 0) end = at->first;
    open += at->second.end;
    open -= std::min(open, at->second.begin);
    if (open != 0 || end == at->first) continue;
    const std::uint64_t begin = at->first;
    if (runs.size() < kMaxPartRuns) {
      runs.push_back({before - (end - 1), end - begin});
    } else {  // The last run reaches as far as the others.
      runs.back().length += before - begin;
    }
    before = begin;
  }
  return runs;
}

void IndexWriter::make_room(const SeekEntry& packet) {
  if (unlisted_.empty()) begin_part();
  if (unlisted_.size() == unlisted_.capacity()) unlisted_.reserve(2 * unlisted_.size());
  spans_.try_emplace(packet.key());
}

void IndexWriter::add(const SeekEntry& packet) noexcept {
  const std::uint64_t part = parts_.size();
  Span& span = spans_.find(packet.key())->second;
  const bool built = span.first != kNone;
  if (built) {
    --ends_.find(span.first)->second.begin;
    --ends_.find(span.last + 1)->second.end;
  }
  if (!built || packet.keyframe) {
    span.first = part;
    if (const auto id = presence_[packet.texture_id]) {
      const auto presence = spans_.find(region_key(*id, packet.region));
      if (presence != spans_.end()) span.first = std::min(span.first, presence->second.first);
    }
  }
  span.last = part;
  ++ends_.find(span.first)->second.begin;
  ++ends_.find(part + 1)->second.end;
  unlisted_.push_back(packet);
}

bool IndexWriter::is_due(std::size_t more) const noexcept {
  return unlisted_.size() + more >= std::max<std::uint64_t>(kPartPackets, listed_ / kParts);
}

bool IndexWriter::is_worth_a_part() const noexcept {
  return !unlisted_.empty() && unlisted_.size() >= listed_ / kFlushedParts;
}

/// A part lists all parts where the last one that does so is so far away that the lists since have
/// cost as much: the root of twice their number.
IndexPart IndexWriter::next_part(const SeekEntry* last, bool all) {
  IndexPart part;
  part.packets.reserve(unlisted_.size() + 1);
  part.packets = unlisted_;
  if (last != nullptr) part.packets.push_back(*last);
  if (!part.packets.empty()) part.needs = needs_;
  const std::size_t count = parts_.size(), since = count - directory_;
  next_is_directory_ = all || count <= kListedByAll || since * since >= 2 * count;
  std::size_t first = 0;
  if (!next_is_directory_) {
    first = directory_ - 1;
    part.directory = parts_[first].offset;
  }
  part.parts.assign(parts_.begin() + static_cast<std::ptrdiff_t>(first), parts_.end());
  parts_.reserve(count + 1);
  return part;
}

void IndexWriter::close(std::uint64_t offset, std::uint64_t size) noexcept {
  const std::uint64_t frame = unlisted_.empty() ? 0 : unlisted_.front().frame;
  parts_.push_back({offset, size, frame, std::move(needs_)});
  if (next_is_directory_) directory_ = parts_.size();
  listed_ += unlisted_.size();
  unlisted_.clear();
  needs_.clear();
}

}  // namespace gicodec
