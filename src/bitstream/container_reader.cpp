#include <gicodec/container.h>
#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/checksum.h"
#include "base/guard.h"
#include "bitstream/container_format.h"
#include "bitstream/packet.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

/// A record is read in growing steps, so that a false length in a short file costs nothing.
constexpr std::size_t kFirstStep = std::size_t{64} << 10;

/// Exactly `size` more bytes at the end of `out`; truncated, with what there is, if there are
/// fewer.
Status read_exactly(Source& source, std::uint64_t size, std::vector<std::byte>& out) {
  for (std::size_t step = kFirstStep; size > 0; step *= 2) {
    const auto want = static_cast<std::size_t>(std::min<std::uint64_t>(step, size));
    const std::size_t before = out.size();
    out.resize(before + want);
    const auto got = source.read(std::span(out).subspan(before));
    if (!got) return got.status();
    if (*got < want) {
      out.resize(before + *got);
      return Status::truncated;
    }
    size -= want;
  }
  return Status::ok;
}

}  // namespace

Result<ContainerReader> ContainerReader::open(Source& source, const DecodeLimits& limits) {
  return guarded([&]() -> Result<ContainerReader> {
    ContainerReader reader(source, limits);
    if (const Status status = reader.read_head(); status != Status::ok) return status;
    if (source.size()) {
      // A missing or damaged index is no error: the packets can still be read in order.
      if (reader.read_index() != Status::ok) reader.index_.clear();
      if (const Status status = source.seek(reader.first_packet_); status != Status::ok) {
        return status;
      }
    }
    return reader;
  });
}

Status ContainerReader::read_head() {
  std::vector<std::byte> header;
  Status status = read_exactly(*source_, kMagic.size(), header);
  if (status != Status::ok && status != Status::truncated) return status;
  // Another kind of file may be shorter than this one's header.
  if (!std::ranges::equal(header, std::as_bytes(std::span(kMagic)).first(header.size()))) {
    return Status::not_gicodec;
  }
  if (status == Status::ok) status = read_exactly(*source_, kFileHeader - kMagic.size(), header);
  if (status != Status::ok) return status;
  ByteReader fields(std::span<const std::byte>(header).subspan(kMagic.size()));
  if (fields.fixed<std::uint8_t>() != kContainerMajor) return Status::unsupported_version;
  (void)fields.fixed<std::uint8_t>();  // Any minor version is readable.
  if (fields.fixed<std::uint16_t>() != 0) return Status::unsupported_feature;

  position_ = kFileHeader;
  std::vector<std::byte> body;
  const auto type = read_record(body);
  if (!type) return type.status();
  if (*type != static_cast<std::uint8_t>(RecordType::description)) return Status::corrupt;
  first_packet_ = position_;
  return read_description(body, limits_, description_);
}

Result<std::uint8_t> ContainerReader::read_record(std::vector<std::byte>& body) {
  std::vector<std::byte> record;
  if (const Status status = read_exactly(*source_, 2, record); status != Status::ok) return status;
  while (std::to_integer<unsigned>(record.back()) >= 0x80) {
    if (record.size() > kMaxVarint) return Status::corrupt;
    if (const Status status = read_exactly(*source_, 1, record); status != Status::ok) {
      return status;
    }
  }
  ByteReader head(record);
  const auto type = head.fixed<std::uint8_t>();
  const std::uint64_t size = head.varint();
  if (!head.ok()) return head.status();

  std::uint64_t limit = limits_.max_packet_bytes;
  if (type == static_cast<std::uint8_t>(RecordType::description)) {
    limit = limits_.max_description_bytes;
  } else if (type == static_cast<std::uint8_t>(RecordType::index)) {
    limit = limits_.max_index_bytes;
  }
  if (size > limit) return Status::limit_exceeded;

  const std::size_t head_size = record.size();
  Status status = read_exactly(*source_, size, record);
  if (status == Status::ok) status = read_exactly(*source_, kRecordChecksum, record);
  if (status != Status::ok) return status;
  const auto summed = std::span(record).first(record.size() - kRecordChecksum);
  ByteReader tail(std::span<const std::byte>(record).subspan(summed.size()));
  if (tail.fixed<std::uint32_t>() != checksum(summed)) return Status::checksum_mismatch;
  position_ += record.size();
  body.assign(summed.begin() + static_cast<std::ptrdiff_t>(head_size), summed.end());
  return type;
}

Status ContainerReader::read_index() {
  const std::uint64_t size = *source_->size();
  if (size < first_packet_ + kEndRecord) return Status::truncated;
  const std::uint64_t end_offset = size - kEndRecord;
  std::vector<std::byte> body;

  const std::uint64_t resume = position_;
  const auto read_at = [&](std::uint64_t offset, RecordType wanted) -> Status {
    if (const Status status = source_->seek(offset); status != Status::ok) return status;
    const auto type = read_record(body);
    position_ = resume;
    if (!type) return type.status();
    return *type == static_cast<std::uint8_t>(wanted) ? Status::ok : Status::corrupt;
  };
  if (const Status status = read_at(end_offset, RecordType::end); status != Status::ok) {
    return status;
  }
  ByteReader end(body);
  const auto index_offset = end.fixed<std::uint64_t>();
  if (!end.ok() || !end.rest().empty() || index_offset < first_packet_ ||
      index_offset >= end_offset) {
    return Status::corrupt;
  }
  if (const Status status = read_at(index_offset, RecordType::index); status != Status::ok) {
    return status;
  }
  return read_index_body(body, description_.textures.size(), first_packet_, index_offset, index_);
}

Status ContainerReader::next(ContainerPacket& packet) {
  return guarded([&]() -> Status {
    while (!ended_) {
      ended_ = true;  // Until this record proves sound.
      std::vector<std::byte> body;
      const auto type = read_record(body);
      if (!type) return type.status();
      // The record that the index led to is the packet that it speaks of.
      const auto sought = std::exchange(sought_, std::nullopt);
      const bool is_packet = *type == static_cast<std::uint8_t>(RecordType::packet);
      if (sought && !is_packet) return Status::corrupt;
      if (*type == static_cast<std::uint8_t>(RecordType::end)) {
        return body.size() == kEndBody ? Status::end : Status::corrupt;
      }
      if (is_packet) {
        ByteReader fields(body);
        packet.frame = fields.varint();
        packet.bytes.assign(fields.rest().begin(), fields.rest().end());
        if (!fields.ok() || packet.frame < last_frame_) return Status::corrupt;
        const auto info = peek(packet.bytes);
        if (!info) return info.status() == Status::truncated ? Status::corrupt : info.status();
        if (info->texture_id >= description_.textures.size()) return Status::corrupt;
        packet.texture_id = info->texture_id;
        packet.keyframe = info->keyframe;
        if (sought && (sought->frame != packet.frame || sought->texture_id != packet.texture_id ||
                       sought->keyframe != packet.keyframe)) {
          return Status::corrupt;
        }
        last_frame_ = packet.frame;
        ended_ = false;
        return Status::ok;
      }
      const bool index = *type == static_cast<std::uint8_t>(RecordType::index);
      if (!index && *type < kSkippable) return Status::unsupported_feature;
      if (index && std::exchange(index_passed_, true)) return Status::corrupt;
      ended_ = false;
    }
    return Status::end;
  });
}

Status ContainerReader::seek(std::uint64_t frame) {
  const auto has_frame = [&](const SeekEntry& entry) { return entry.frame == frame; };
  if (std::ranges::none_of(index_, has_frame)) return Status::invalid_argument;
  std::array<std::optional<SeekEntry>, kMaxTextures> last_keyframe;
  for (const auto& entry : index_) {
    if (entry.frame <= frame && entry.keyframe) last_keyframe[entry.texture_id] = entry;
  }
  std::optional<SeekEntry> first;
  for (const auto& entry : last_keyframe) {
    if (entry && (!first || entry->offset < first->offset)) first = entry;
  }
  if (!first) return Status::corrupt;
  if (const Status status = source_->seek(first->offset); status != Status::ok) return status;
  sought_ = first;
  index_passed_ = false;
  last_frame_ = 0;
  ended_ = false;
  return Status::ok;
}

}  // namespace gicodec
