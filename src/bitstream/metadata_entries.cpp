#include "bitstream/metadata_entries.h"

#include <algorithm>

namespace gicodec {

Status MetadataEntries::find(EntryReader& reader) {
  const bool pipe = !reader.size().has_value();
  while (!complete_) {
    FileEntry entry;
    Status status = pipe ? reader.read(end_, entry) : reader.read_head(end_, entry);
    if (!entry.is(EntryType::metadata)) {
      // A file that grows may get more of them.
      complete_ = pipe || entry.type != 0;
      if (pipe) ahead_ = {entry, status};
      return status == Status::io_failed ? status : Status::ok;
    }
    // Refused before it is complete, as other entries are.
    const bool too_large = entry.size > reader.limits().max_metadata_bytes;
    if (status == Status::truncated && too_large) return Status::limit_exceeded;
    const bool whole = status == Status::ok || status == Status::checksum_mismatch;
    if (whole) status = add(reader, entry, status);
    if (status != Status::ok) return status;
    end_ = entry.end();
  }
  return Status::ok;
}

Status MetadataEntries::add(EntryReader& reader, const FileEntry& entry, Status status) {
  Found found{0, entry.offset, {}, status};
  std::span<const std::byte> start = entry.bytes;
  if (!reader.size()) {
    found.body.assign(start.begin(), start.end());
  } else {
    const auto bytes =
        reader.bytes(entry.body_at, std::min<std::uint64_t>(entry.size, kPackedHead));
    if (!bytes) return bytes.status();
    start = *bytes;
  }
  const auto head = read_packed_head(start);
  if (!head) return head.status();
  found.texture_id = head->texture_id;
  const bool ascends = found_.empty() || found_.back().texture_id < found.texture_id;
  if (!ascends || found.texture_id >= reader.rules().size()) return Status::corrupt;
  const std::uint64_t limit = reader.limits().max_metadata_bytes;
  if (entry.size > limit || head->bytes > limit - bytes_) return Status::limit_exceeded;
  found_.push_back(std::move(found));
  bytes_ += head->bytes;
  return Status::ok;
}

Result<Metadata> MetadataEntries::read(EntryReader& reader, std::uint8_t texture_id) const {
  const auto found = std::find_if(found_.begin(), found_.end(),
                                  [&](const Found& one) { return one.texture_id == texture_id; });
  if (found == found_.end()) return Metadata{};
  if (found->status != Status::ok) return found->status;
  if (!found->body.empty()) return unpack_metadata(found->body);
  FileEntry entry;
  Status status = reader.read(found->offset, entry);
  if (status == Status::ok && !entry.is(EntryType::metadata)) status = Status::corrupt;
  if (status != Status::ok) return status;
  return unpack_metadata(entry.bytes);
}

}  // namespace gicodec
