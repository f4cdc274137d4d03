#include "bitstream/container_index.h"

#include "base/bytes.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gicodec {
namespace {

/// The search for the last part: bytes from the file's end, bytes read at once, at first and at
/// most, candidates tried.
constexpr std::uint64_t kSearch = std::uint64_t{16} << 20;
constexpr std::uint64_t kWindow = std::uint64_t{48} << 10, kMaxWindow = std::uint64_t{2} << 20;
constexpr int kTries = 16;
/// Beyond so many packets, parts that were read are dropped for others.
constexpr std::size_t kMaxHeld = std::size_t{1} << 20;
/// Of DecodeLimits::max_index_bytes, for each part that is listed: 64 Ki parts by default.
constexpr std::uint64_t kBytesPerPart = 1024;
/// Bytes of parts that are read together.
constexpr std::uint64_t kTogether = std::uint64_t{64} << 10;

/// Calls visit(number) for the parts that a part needs; false if there are no such parts.
template <typename Visit>
bool for_each_needed(std::size_t part, std::span<const PartRun> runs, const Visit& visit) {
  std::uint64_t at = part;
  for (const PartRun& run : runs) {
    if (run.gap > at || run.length > at - run.gap + 1) return false;
    at -= run.gap;
    for (std::uint64_t i = 0; i < run.length; ++i) visit(static_cast<std::size_t>(at - i));
    at -= run.length - 1;
  }
  return true;
}

/// The part at `offset`; sets the size of its entry.
Result<IndexPart> read_part(EntryReader& reader, std::uint64_t offset, std::uint64_t begin,
                            std::uint64_t above, std::uint64_t& size) {
  FileEntry entry;
  const Status head = reader.read_head(offset, entry);
  // A size beyond the file is a lie; bytes that are not there yet are none.
  if (head == Status::truncated && entry.size != 0) return Status::corrupt;
  if (head != Status::ok) return head;
  if (!entry.is(EntryType::index) || entry.end() > above) return Status::corrupt;
  if (const Status status = reader.read_body(entry); status != Status::ok) return status;
  size = entry.end() - offset;
  return read_index_part(entry.bytes, reader.rules(), begin, offset,
                         reader.limits().max_index_bytes / kBytesPerPart);
}

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
  return read_directory(reader, last, finished_ ? entry.offset : total);
}

/// Sets `last` to the last part's offset; leaves it if there is none, or none is found soon: the
/// packets are then listed front to back once somebody seeks.
Status ContainerIndex::find_last_part(EntryReader& reader, std::uint64_t total,
                                      std::uint64_t& last) {
  constexpr std::uint64_t kTail = kIndexTail + kEntryChecksum;
  const std::uint64_t floor = std::max(first_entry_, total - std::min(total, kSearch));
  int tries = 0;
  std::uint64_t step = kWindow;
  for (std::uint64_t end = total; end >= floor + kTail;) {
    const std::uint64_t begin = std::max(floor, end - std::min(end, step));
    step = std::min(2 * step, kMaxWindow);
    const ByteRange there{begin, end - begin};
    (void)reader.prefetch({&there, 1});
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

/// Reads the last part and the directory that it names: where all parts are.
Status ContainerIndex::read_directory(EntryReader& reader, std::uint64_t last,
                                      std::uint64_t above) {
  parts_.clear();
  needed_.clear();
  held_ = 0;
  IndexPart part;
  if (last != 0) {
    if (last < first_entry_ || last >= above) return Status::corrupt;
    PartPlace own;
    auto read = read_part(reader, last, first_entry_, above, own.size);
    if (!read) return read.status();
    part = *std::move(read);
    if (part.directory != 0) {
      const ByteRange there{part.directory, part.parts.front().size};
      (void)reader.prefetch({&there, 1});
      std::uint64_t size = 0;
      auto directory = read_part(reader, part.directory, first_entry_, last, size);
      if (!directory) return directory.status();
      if (directory->directory != 0 || size != part.parts.front().size) return Status::corrupt;
      parts_.reserve(directory->parts.size() + part.parts.size() + 2);
      for (PartPlace& place : directory->parts) {
        if (const Status status = add_part(std::move(place), reader.limits()); status != Status::ok)
          return status;
      }
    }
    parts_.reserve(parts_.size() + part.parts.size() + 2);
    for (PartPlace& place : part.parts) {
      if (const Status status = add_part(std::move(place), reader.limits()); status != Status::ok)
        return status;
    }
    own.offset = last;
    if (!part.packets.empty()) {
      if (part.packets.front().offset < end_) return Status::corrupt;
      own.frame = part.packets.front().frame;
      own.needs = std::move(part.needs);
      if (const Status status = add_part(std::move(own), reader.limits()); status != Status::ok)
        return status;
      held_ = part.packets.size();
      parts_.back().packets = std::move(part.packets);
      parts_.back().read = true;
    } else {
      end_ = own.end();
    }
  }
  parts_.push_back({{kNowhere, 0, kNowhere, {}}, end_, {}, true});
  return Status::ok;
}

/// Adds a part behind the others.
Status ContainerIndex::add_part(PartPlace place, const DecodeLimits& limits) {
  if (parts_.size() >= limits.max_index_bytes / kBytesPerPart) return Status::limit_exceeded;
  const bool behind =
      place.offset >= end_ && (parts_.empty() || place.frame >= parts_.back().place.frame);
  if (!behind || !for_each_needed(parts_.size(), place.needs, [](std::size_t) {})) {
    return Status::corrupt;
  }
  const std::uint64_t begin = std::exchange(end_, place.end());
  parts_.push_back({std::move(place), begin, {}, false});
  return Status::ok;
}

/// Reads the packets of parts; a distant source brings them together.
Status ContainerIndex::read(EntryReader& reader, std::span<const std::size_t> numbers) {
  std::vector<ByteRange> ranges;
  std::uint64_t bytes = 0;
  for (const std::size_t number : numbers) {
    const PartPlace& place = parts_[number].place;
    if (parts_[number].read) continue;
    bytes += place.size;
    if (bytes > reader.limits().max_index_bytes) return Status::limit_exceeded;
    ranges.push_back({place.offset, place.size});
  }
  (void)reader.prefetch(ranges);
  for (const std::size_t number : numbers) {
    if (const Status status = read(reader, number); status != Status::ok) return status;
  }
  return Status::ok;
}

Status ContainerIndex::read(EntryReader& reader, std::size_t number) {
  Part& part = parts_[number];
  if (part.read) return Status::ok;
  std::uint64_t size = 0;
  auto read = read_part(reader, part.place.offset, part.begin, part.place.end(), size);
  if (!read) return read.status();
  const auto& packets = read->packets;
  const bool listed = size == part.place.size && !packets.empty() &&
                      packets.front().frame == part.place.frame &&
                      packets.back().frame <= parts_[number + 1].place.frame;
  if (!listed) return Status::corrupt;
  part.packets = std::move(read->packets);
  part.read = true;
  held_ += part.packets.size();
  return Status::ok;
}

/// Reads the packets of a part, and of those behind it that cost little more. `all`: also of those
/// that packets_from() passes over.
Status ContainerIndex::read_some(EntryReader& reader, std::size_t first, bool all) {
  if (parts_[first].read) return Status::ok;
  make_room(reader.limits());
  std::vector<std::size_t> numbers;
  std::uint64_t bytes = 0;
  for (std::size_t number = first; number < parts_.size(); ++number) {
    if (!all && passes_over(number)) continue;
    bytes += parts_[number].place.size;
    if (number != first && bytes > kTogether) break;
    numbers.push_back(number);
  }
  return read(reader, numbers);
}

void ContainerIndex::make_room(const DecodeLimits& limits) noexcept {
  if (held_ <= std::min<std::uint64_t>(kMaxHeld, limits.max_index_bytes / kMinSeekEntry)) return;
  for (Part& part : std::span(parts_).first(parts_.size() - 1)) {
    part.packets = {};
    part.read = false;
  }
  held_ = 0;
}

/// The part that lists the entry at `offset`.
std::size_t ContainerIndex::part_of(std::uint64_t offset) const noexcept {
  const auto at = std::upper_bound(
      parts_.begin(), parts_.end(), offset,
      [](std::uint64_t wanted, const Part& part) { return wanted < part.place.offset; });
  return static_cast<std::size_t>(at - parts_.begin());
}

bool ContainerIndex::passes_over(std::size_t number) const noexcept {
  return !needed_.empty() && number < needed_.back() &&
         !std::binary_search(needed_.begin(), needed_.end(), number);
}

/// The packets of a part from `offset` on.
ContainerIndex::Packets ContainerIndex::part_from(std::size_t number,
                                                  std::uint64_t offset) const noexcept {
  const Packets packets = parts_[number].packets;
  const auto first = std::lower_bound(
      packets.begin(), packets.end(), offset,
      [](const SeekEntry& packet, std::uint64_t wanted) { return packet.offset < wanted; });
  return packets.subspan(static_cast<std::size_t>(first - packets.begin()));
}

Result<ContainerIndex::Packets> ContainerIndex::packets_from(EntryReader& reader,
                                                             std::uint64_t offset) {
  for (std::size_t number = part_of(offset); number < parts_.size(); ++number) {
    if (passes_over(number)) continue;
    if (const Status status = read_some(reader, number, false); status != Status::ok) return status;
    const Packets packets = part_from(number, offset);
    if (!packets.empty()) return packets;
  }
  return Packets{};
}

ContainerIndex::Packets ContainerIndex::held_from(std::uint64_t offset) const noexcept {
  for (std::size_t number = part_of(offset); number < parts_.size(); ++number) {
    if (passes_over(number)) continue;
    const Packets packets = part_from(number, offset);
    if (!packets.empty() || !parts_[number].read) return packets;
  }
  return {};
}

std::optional<std::uint64_t> ContainerIndex::least_frame(std::uint64_t offset) const noexcept {
  for (std::size_t number = part_of(offset); number < parts_.size(); ++number) {
    if (!passes_over(number) && !parts_[number].read) return parts_[number].place.frame;
  }
  return std::nullopt;
}

bool ContainerIndex::is_part(std::uint64_t offset) const noexcept {
  const std::size_t number = part_of(offset);
  return number > 0 && number < parts_.size() && parts_[number - 1].place.offset == offset;
}

std::uint64_t ContainerIndex::end_of(const SeekEntry& packet) const noexcept {
  const std::size_t number = part_of(packet.offset);
  const Packets packets = parts_[number].packets;
  const auto next = std::upper_bound(
      packets.begin(), packets.end(), packet.offset,
      [](std::uint64_t wanted, const SeekEntry& other) { return wanted < other.offset; });
  if (next != packets.end()) return next->offset;
  return std::min(parts_[number].place.offset, end_);
}

/// Ascending: those with packets of the frame, the one in which it begins, and what that needs.
std::vector<std::size_t> ContainerIndex::parts_for(std::uint64_t frame) const {
  const auto before = std::partition_point(
      parts_.begin(), parts_.end(), [&](const Part& part) { return part.place.frame < frame; });
  const auto reached = static_cast<std::size_t>(before - parts_.begin());
  const std::size_t first = reached == 0 ? 0 : reached - 1;
  std::vector<std::size_t> numbers;
  const auto need = [&](std::size_t number) { numbers.push_back(number); };
  if (first + 1 < parts_.size()) {
    (void)for_each_needed(first, parts_[first].place.needs, need);
  } else if (first > 0) {  // Behind the last index part stands what it needs, or itself.
    need(first - 1);
    (void)for_each_needed(first - 1, parts_[first - 1].place.needs, need);
  }
  std::reverse(numbers.begin(), numbers.end());
  for (std::size_t number = first; number < parts_.size(); ++number) {
    if (number != first && parts_[number].place.frame > frame) break;
    numbers.push_back(number);
  }
  return numbers;
}

Result<std::vector<ContainerIndex::Packets>> ContainerIndex::packets_for(EntryReader& reader,
                                                                         std::uint64_t frame) {
  std::vector<std::size_t> numbers = parts_for(frame);
  make_room(reader.limits());
  if (const Status status = read(reader, numbers); status != Status::ok) return status;
  std::vector<Packets> lists;
  lists.reserve(numbers.size());
  for (const std::size_t number : numbers) lists.emplace_back(parts_[number].packets);
  needed_ = std::move(numbers);
  return lists;
}

Status ContainerIndex::extend(EntryReader& reader) {
  const std::uint64_t total = *reader.size();
  const ByteRange rest{end_, std::min(total - std::min(end_, total), kSearch)};
  (void)reader.prefetch({&rest, 1});
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

/// Of the index parts, as far as they were read.
std::uint64_t ContainerIndex::last_frame() const noexcept {
  if (parts_.size() < 2) return 0;
  const Part& part = parts_[parts_.size() - 2];
  return part.read ? part.packets.back().frame : part.place.frame;
}

void ContainerIndex::list(const FileEntry& entry, const DecodeLimits& limits) {
  if (entry.offset != end_ || entry.is(EntryType::end)) return;
  if (entry.is(EntryType::packet)) {
    Part& last = parts_.back();
    if (last.packets.size() >= limits.max_index_bytes / kMinSeekEntry) return;
    const std::uint64_t before = last.packets.empty() ? last_frame() : last.packets.back().frame;
    if (entry.packet.frame < before) return;
    last.packets.push_back(entry.packet);
    if (last.packets.size() == 1) last.place.frame = entry.packet.frame;
  }
  end_ = entry.end();
}

}  // namespace gicodec
