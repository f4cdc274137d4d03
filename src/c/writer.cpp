// Writes containers into the caller's sink, or into memory.
#include "c/container.h"

#include <optional>
#include <utility>

using namespace gicodec;

namespace gicodec::c {
namespace {

/// The caller's sink; without one, memory.
class WriterSink final : public Sink {
 public:
  Status set(const gicodec_sink* given) {
    const Status status = take(given, given_);
    if (status != Status::ok) return status;
    return given != nullptr && given_.write == nullptr ? Status::invalid_argument : Status::ok;
  }
  Status write(std::span<const std::byte> bytes) override {
    if (given_.write == nullptr) {
      held.insert(held.end(), bytes.begin(), bytes.end());
      return Status::ok;
    }
    return status_of_caller(given_.write(given_.self, bytes.data(), bytes.size()));
  }
  std::vector<std::byte> held;

 private:
  gicodec_sink given_{};
};

}  // namespace
}  // namespace gicodec::c

struct gicodec_writer {
  c::WriterSink sink;
  std::optional<ContainerWriter> writer;
};

extern "C" {

gicodec_status gicodec_writer_create(const gicodec_sink* sink, const gicodec_container* container,
                                     gicodec_writer** out) {
  if (container == nullptr || out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  return c::call([&]() -> Status {
    auto handle = std::make_unique<gicodec_writer>();
    if (const Status status = handle->sink.set(sink); status != Status::ok) return status;
    auto writer = ContainerWriter::create(handle->sink, container->description);
    if (!writer) return writer.status();
    handle->writer.emplace(*std::move(writer));
    *out = handle.release();
    return Status::ok;
  });
}

void gicodec_writer_destroy(gicodec_writer* writer) { delete writer; }

gicodec_status gicodec_writer_add(gicodec_writer* writer, uint64_t frame, const void* packet,
                                  size_t size) {
  if (writer == nullptr || c::is_missing(packet, size)) return GICODEC_INVALID_ARGUMENT;
  return c::number(writer->writer->add(frame, c::bytes(packet, size)));
}

gicodec_status gicodec_writer_flush(gicodec_writer* writer) {
  return writer == nullptr ? GICODEC_INVALID_ARGUMENT : c::number(writer->writer->flush());
}

gicodec_status gicodec_writer_finish(gicodec_writer* writer) {
  return writer == nullptr ? GICODEC_INVALID_ARGUMENT : c::number(writer->writer->finish());
}

const uint8_t* gicodec_writer_bytes(const gicodec_writer* writer, size_t* size) {
  return c::point(writer == nullptr ? std::span<const std::byte>()
                                    : std::span<const std::byte>(writer->sink.held),
                  size);
}

gicodec_status gicodec_writer_take(gicodec_writer* writer) {
  if (writer == nullptr) return GICODEC_INVALID_ARGUMENT;
  writer->sink.held.clear();
  return GICODEC_OK;
}

}  // extern "C"
