#include "bitstream/container_index.h"

#include "base/bytes.h"

#include <algorithm>
#include <cstring>

namespace gicodec {
namespace {

/// The search for the last part: bytes from the file's end, bytes read at once, candidates tried.
constexpr std::uint64_t kSearch = std::uint64_t{16} << 20;
constexpr std::uint64_t kWindow = std::uint64_t{48} << 10;
constexpr int kTries = 16;
/// Most bytes of an index part's head: type, size, and the first fields of its body.
constexpr std::uint64_t kPartHead = 8 + kMaxVarint;

}  // namespace

Status ContainerIndex::load(EntryReader& reader, std::uint64_t first_entry) {
  const std::uint64_t total = *reader.size();
  first_entry_ = end_ = first_entry;
  std::uint64_t last = 0;
  FileEntry entry;
  finished_ = total >= first_entry + kEndEntry &&
              reader.read(total - kEndEntry, entry) == Status::ok && entry.is(EntryType::end);
  if (finished_) {
    last = ByteReader(entry.bytes).fixed<std::uint64_t>();
  } else if (const Status status = find_last_part(reader, total, last); status != Status::ok) {
    return status;
  }
  return read_parts(reader, last, finished_ ? entry.offset : total);
}

/// Sets `last` to the last part's offset; leaves it if there is none, or none is found soon: the
/// packets are then listed front to back once somebody seeks.
Status ContainerIndex::find_last_part(EntryReader& reader, std::uint64_t total,
                                      std::uint64_t& last) {
  constexpr std::uint64_t kTail = kIndexTail + kEntryChecksum;
  const std::uint64_t floor = std::max(first_entry_, total - std::min(total, kSearch));
  int tries = 0;
  for (std::uint64_t end = total; end >= floor + kTail;) {
    const std::uint64_t begin = std::max(floor, end - std::min(end, kWindow));
    const auto bytes = reader.bytes(begin, end - begin);
    if (!bytes) return bytes.status();
    const std::vector<std::byte> window(bytes->begin(), bytes->end());
    for (std::size_t at = window.size() - kTail + 1; at-- > 0;) {
      if (std::memcmp(&window[at + 8], kIndexMark.data(), kIndexMark.size()) != 0) continue;
      std::uint64_t offset = 0;
      std::memcpy(&offset, &window[at], sizeof offset);
      const std::uint64_t tail_at = begin + at;
      if (offset < first_entry_ || offset >= tail_at) continue;
      if (++tries > kTries) return Status::ok;
      FileEntry part;
      const Status status = reader.read_head(offset, part);
      if (status == Status::ok && part.is(EntryType::index) && part.end() == tail_at + kTail) {
        last = offset;
        return Status::ok;
      }
    }
    if (begin == floor) break;
    end = begin + kTail - 1;  // A tail may begin in the next window.
  }
  return Status::ok;
}

/// Walks from the last part to the first to count them, then reads them in order.
Status ContainerIndex::read_parts(EntryReader& reader, std::uint64_t last, std::uint64_t above) {
  std::vector<std::uint64_t> parts;
  std::uint64_t packets = 0, bytes = 0;
  for (std::uint64_t at = last; at != 0;) {
    if (at < first_entry_ || at >= above) return Status::corrupt;
    FileEntry part;
    if (const Status status = reader.read_head(at, part); status != Status::ok) return status;
    if (!part.is(EntryType::index) || part.end() > above) return Status::corrupt;
    const std::uint64_t limit = reader.limits().max_index_bytes;
    if (part.size > limit || (bytes += part.end() - at) > limit) return Status::limit_exceeded;
    const auto start = reader.bytes(part.body_at, std::min(part.size, kPartHead));
    if (!start) return start.status();
    const auto head = read_index_part_head(*start);
    if (!head) return head.status();
    if (head->packets > part.size / kMinSeekEntry) return Status::corrupt;
    packets += head->packets;
    parts.push_back(at);
    above = at;
    at = head->before;
  }
  packets_.reserve(static_cast<std::size_t>(packets));
  std::uint64_t before = 0;
  for (auto it = parts.rbegin(); it != parts.rend(); ++it) {
    FileEntry part;
    Status status = reader.read_head(*it, part);
    if (status == Status::ok) status = reader.read_body(part);
    if (status != Status::ok) return status;
    const auto head = read_index_part_head(part.bytes);
    if (!part.is(EntryType::index) || !head || head->before != before) return Status::corrupt;
    status = read_index_part(part.bytes, reader.rules(), end_, *it, packets_);
    if (status != Status::ok) return status;
    before = *it;
    end_ = part.end();
  }
  return Status::ok;
}

Status ContainerIndex::extend(EntryReader& reader) {
  for (;;) {
    FileEntry entry;
    const Status status = reader.read(end_, entry);
    // The index ends before an entry that cannot be read, or not yet.
    if (status != Status::ok) return status == Status::io_failed ? status : Status::ok;
    const std::uint64_t before = end_;
    list(entry, reader.limits());
    if (end_ == before) return Status::ok;
  }
}

void ContainerIndex::list(const FileEntry& entry, const DecodeLimits& limits) {
  if (entry.offset != end_ || entry.is(EntryType::end)) return;
  if (entry.is(EntryType::packet)) {
    if (packets_.size() >= limits.max_index_bytes / kMinSeekEntry) return;
    if (!packets_.empty() && entry.packet.frame < packets_.back().frame) return;
    packets_.push_back(entry.packet);
  }
  end_ = entry.end();
}

}  // namespace gicodec
