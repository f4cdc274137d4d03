#include <gicodec/container.h>
#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/checksum.h"
#include "base/guard.h"
#include "bitstream/container_format.h"

namespace gicodec {
namespace {

void append_record(RecordType type, std::span<const std::byte> head,
                   std::span<const std::byte> body, std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.reserve(start + 1 + kMaxVarint + head.size() + body.size() + kRecordChecksum);
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(type));
  writer.varint(head.size() + body.size());
  writer.bytes(head);
  writer.bytes(body);
  writer.fixed(checksum(std::span(out).subspan(start)));
}

}  // namespace

Result<ContainerWriter> ContainerWriter::create(Sink& sink,
                                                const ContainerDescription& description) {
  return guarded([&]() -> Result<ContainerWriter> {
    std::vector<std::byte> body;
    if (const Status status = write_description(description, body); status != Status::ok) {
      return status;
    }
    std::vector<std::byte> start;
    ByteWriter head(start);
    head.bytes(std::as_bytes(std::span(kMagic)));
    head.fixed(kContainerMajor);
    head.fixed(kContainerMinor);
    head.fixed(std::uint16_t{0});
    append_record(RecordType::description, {}, body, start);

    ContainerWriter writer(sink, description.textures.size());
    if (const Status status = writer.write(start); status != Status::ok) return status;
    return writer;
  });
}

Status ContainerWriter::write(std::span<const std::byte> records) {
  const Status status = sink_->write(records);
  if (status == Status::ok) written_ += records.size();
  return status;
}

Status ContainerWriter::add(std::uint64_t frame, std::span<const std::byte> packet) {
  return guarded([&]() -> Status {
    if (ended_) return Status::invalid_argument;
    const auto info = peek(packet);
    if (!info) return info.status();
    if (info->texture_id >= textures_) return Status::invalid_argument;
    for (auto it = index_.rbegin(); it != index_.rend() && it->frame >= frame; ++it) {
      if (it->frame > frame || it->texture_id == info->texture_id) return Status::invalid_argument;
    }
    // Whatever needs memory comes before the bytes are out.
    std::vector<std::byte> head, record;
    ByteWriter(head).varint(frame);
    append_record(RecordType::packet, head, packet, record);
    if (index_.size() == index_.capacity()) index_.reserve(2 * index_.size() + 16);
    const std::uint64_t offset = written_;
    if (const Status status = write(record); status != Status::ok) return status;
    index_.push_back({frame, offset, info->texture_id, info->keyframe});
    return Status::ok;
  });
}

Status ContainerWriter::finish() {
  return guarded([&]() -> Status {
    if (ended_) return Status::invalid_argument;
    std::vector<std::byte> index, end, records;
    write_index(index_, index);
    ByteWriter(end).fixed(written_);
    append_record(RecordType::index, {}, index, records);
    append_record(RecordType::end, {}, end, records);
    const Status status = write(records);
    ended_ = status == Status::ok;
    return status;
  });
}

}  // namespace gicodec
