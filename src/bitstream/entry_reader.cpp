#include "bitstream/entry_reader.h"

#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/checksum.h"
#include "bitstream/region_field.h"

#include <algorithm>

namespace gicodec {
namespace {

/// First of the growing steps in which bytes are read, so that false sizes cost no memory.
constexpr std::size_t kFirstStep = std::size_t{64} << 10;
/// Bytes of type and size.
constexpr std::size_t kMaxEntryHead = 1 + kMaxVarint;

}  // namespace

Status EntryReader::go_to(std::uint64_t offset) {
  if (at_ == offset) return Status::ok;
  const auto total = source_->size();
  if (!total) return Status::io_failed;
  if (offset > *total) return Status::truncated;
  at_ = kNowhere;
  const Status status = source_->seek(offset);
  if (status == Status::ok) at_ = offset;
  return status;
}

/// Appends exactly `size` bytes to the buffer.
Status EntryReader::more(std::uint64_t size) {
  for (std::size_t step = kFirstStep; size > 0; step *= 2) {
    const auto want = static_cast<std::size_t>(std::min<std::uint64_t>(step, size));
    const std::size_t before = buffer_.size();
    buffer_.resize(before + want);
    const std::uint64_t from = at_;
    at_ = kNowhere;
    const auto got = source_->read(std::span(buffer_).subspan(before));
    if (!got) return got.status();
    if (*got < want) {
      buffer_.resize(before + *got);
      return Status::truncated;
    }
    at_ = from + want;
    size -= want;
  }
  return Status::ok;
}

Status EntryReader::pass(std::uint64_t bytes) {
  if (source_->size()) return go_to(at_ + bytes);
  while (bytes > 0) {
    const std::uint64_t some = std::min<std::uint64_t>(bytes, kFirstStep);
    buffer_.clear();
    if (const Status status = more(some); status != Status::ok) return status;
    bytes -= some;
  }
  return Status::ok;
}

Result<std::span<const std::byte>> EntryReader::bytes(std::uint64_t offset, std::uint64_t size) {
  buffer_.clear();
  Status status = go_to(offset);
  if (status == Status::ok) status = more(size);
  if (status != Status::ok) return status;
  return std::span<const std::byte>(buffer_);
}

Status EntryReader::file_head() {
  buffer_.clear();
  const Status status = more(kFileHeader);
  if (status != Status::ok && status != Status::truncated) return status;
  const auto version = container_version(buffer_);
  if (!version) return version.status();
  if (version->major != kContainerMajor)
    return Status::unsupported_version;  // Any minor is readable.
  if (status != Status::ok) return status;
  ByteReader features(std::span<const std::byte>(buffer_).subspan(ContainerVersion::kBytes));
  return features.fixed<std::uint16_t>() == 0 ? Status::ok : Status::unsupported_feature;
}

Status EntryReader::read_head(std::uint64_t offset, FileEntry& entry) {
  buffer_.clear();
  entry = {};
  if (const Status status = go_to(offset); status != Status::ok) return status;
  if (const Status status = more(2); status != Status::ok) return status;
  while (std::to_integer<unsigned>(buffer_.back()) >= 0x80) {
    if (buffer_.size() == kMaxEntryHead) return Status::corrupt;
    if (const Status status = more(1); status != Status::ok) return status;
  }
  ByteReader head(buffer_);
  entry.offset = offset;
  entry.type = head.fixed<std::uint8_t>();
  entry.size = head.varint();
  entry.body_at = offset + buffer_.size();
  if (!head.ok()) return Status::corrupt;
  // Beyond any file, and sums of such sizes would overflow.
  if (entry.size > kNowhere - entry.body_at - kEntryChecksum) return Status::truncated;
  const auto total = source_->size();
  return total && entry.end() > *total ? Status::truncated : Status::ok;
}

std::uint64_t EntryReader::limit_of(const FileEntry& entry) const noexcept {
  if (entry.is(EntryType::description)) return limits_.max_description_bytes;
  if (entry.is(EntryType::metadata)) return limits_.max_metadata_bytes;
  return entry.is(EntryType::index) ? limits_.max_index_bytes : limits_.max_packet_bytes;
}

Status EntryReader::read_body(FileEntry& entry) {
  if (entry.size > limit_of(entry)) return Status::limit_exceeded;
  const std::size_t head = buffer_.size();
  if (const Status status = more(entry.size); status != Status::ok) return status;
  if (const Status status = more(kEntryChecksum); status != Status::ok) return status;
  const auto summed = std::span<const std::byte>(buffer_).first(buffer_.size() - kEntryChecksum);
  entry.bytes = summed.subspan(head);
  ByteReader tail(std::span<const std::byte>(buffer_).subspan(summed.size()));
  return tail.fixed<std::uint32_t>() == checksum(summed) ? Status::ok : Status::checksum_mismatch;
}

Status EntryReader::read(std::uint64_t offset, FileEntry& entry) {
  Status status = read_head(offset, entry);
  const bool index = entry.is(EntryType::index);
  // An entry beyond the limit is refused before it is complete.
  if (status == Status::truncated && !index && entry.size > limit_of(entry)) {
    return Status::limit_exceeded;
  }
  if ((status == Status::ok || status == Status::truncated) && index && entry.size < kIndexTail) {
    return Status::corrupt;
  }
  if (status != Status::ok) return status;
  if (index) return pass_index_part(entry);
  status = read_body(entry);
  if (status != Status::ok) return status;
  if (entry.is(EntryType::packet)) return take_packet(entry);
  if (entry.is(EntryType::end)) {
    return entry.bytes.size() == kEndBody ? Status::ok : Status::corrupt;
  }
  const bool first = offset == kFileHeader && entry.is(EntryType::description);
  const bool known = first || entry.is(EntryType::metadata) || entry.type >= kSkippable;
  return known ? Status::ok : Status::unsupported_feature;
}

/// Checks the part's tail, which no packet has, so that no packet with a damaged type is skipped.
Status EntryReader::pass_index_part(FileEntry& entry) {
  Status status = pass(entry.size - kIndexTail);
  if (status != Status::ok) return status;
  buffer_.clear();
  status = more(kIndexTail + kEntryChecksum);
  if (status != Status::ok) return status;
  const auto tail = std::span<const std::byte>(buffer_).first(kIndexTail);
  return is_index_tail(tail, entry.offset) ? Status::ok : Status::corrupt;
}

Status EntryReader::take_packet(FileEntry& entry) const {
  ByteReader fields(entry.bytes);
  SeekEntry& packet = entry.packet;
  packet.offset = entry.offset;
  packet.frame = fields.varint();
  packet.region = from_region_field(fields.varint(kMaxRegionField));
  if (!fields.ok()) return Status::corrupt;
  entry.bytes = fields.rest();
  const auto info = peek(entry.bytes);
  if (!info) return info.status() == Status::truncated ? Status::corrupt : info.status();
  if (info->texture_id >= rules_.size()) return Status::corrupt;
  const PacketRule& rule = rules_[info->texture_id];
  if (!rule.has(packet.region) || (info->lossy && rule.lossless)) return Status::corrupt;
  packet.texture_id = info->texture_id;
  packet.keyframe = is_keyframe(info->type);
  return Status::ok;
}

}  // namespace gicodec
