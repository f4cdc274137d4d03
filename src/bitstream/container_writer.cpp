#include <gicodec/container.h>
#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/checksum.h"
#include "base/guard.h"
#include "bitstream/container_format.h"

namespace gicodec {

Result<ContainerWriter> ContainerWriter::create(Sink& sink,
                                                const ContainerDescription& description) {
  return guarded([&]() -> Result<ContainerWriter> {
    std::vector<std::byte> body;
    if (const Status status = write_description(description, body); status != Status::ok) {
      return status;
    }
    std::vector<std::byte> header;
    ByteWriter head(header);
    head.bytes(std::as_bytes(std::span(kMagic)));
    head.fixed(kContainerMajor);
    head.fixed(kContainerMinor);
    head.fixed(std::uint16_t{0});

    ContainerWriter writer(sink, description.textures.size());
    if (const Status status = sink.write(header); status != Status::ok) return status;
    writer.written_ = header.size();
    const Status status =
        writer.write_record(static_cast<std::uint8_t>(RecordType::description), {}, body);
    if (status != Status::ok) return status;
    return writer;
  });
}

Status ContainerWriter::write_record(std::uint8_t type, std::span<const std::byte> head,
                                     std::span<const std::byte> body) {
  std::vector<std::byte> record;
  record.reserve(1 + kMaxVarint + head.size() + body.size() + kRecordChecksum);
  ByteWriter writer(record);
  writer.fixed(type);
  writer.varint(head.size() + body.size());
  writer.bytes(head);
  writer.bytes(body);
  writer.fixed(checksum(record));
  if (const Status status = sink_->write(record); status != Status::ok) {
    ended_ = true;
    return status;
  }
  written_ += record.size();
  return Status::ok;
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
    std::vector<std::byte> head;
    ByteWriter(head).varint(frame);
    // In the index first: a failed allocation must not leave a packet that is in no index.
    index_.push_back({frame, written_, info->texture_id, info->keyframe});
    return write_record(static_cast<std::uint8_t>(RecordType::packet), head, packet);
  });
}

Status ContainerWriter::finish() {
  return guarded([&]() -> Status {
    if (ended_) return Status::invalid_argument;
    const std::uint64_t index_offset = written_;
    std::vector<std::byte> body;
    write_index(index_, body);
    const Status status = write_record(static_cast<std::uint8_t>(RecordType::index), {}, body);
    if (status != Status::ok) return status;
    std::vector<std::byte> end;
    ByteWriter(end).fixed(index_offset);
    ended_ = true;
    return write_record(static_cast<std::uint8_t>(RecordType::end), {}, end);
  });
}

}  // namespace gicodec
