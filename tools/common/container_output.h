// Writes a container to a file, which gets its name once it is complete.
#pragma once

#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"

#include <gicodec/container.h>
#include <gicodec/io.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gicodec::tools {

class ContainerOutput {
 public:
  /// `existing`: what finish() may replace. `beside`: metadata beside the description, by texture.
  ContainerOutput(const std::string& path, const ContainerDescription& description,
                  Existing existing = Existing::container, std::span<const Metadata> beside = {},
                  AtomicFile::Temporary temporary = AtomicFile::Temporary::partial)
      : name_(path == "-" ? "standard output" : path),
        file_(path, existing, temporary),
        sink_(file_.stream()) {
    auto writer = ContainerWriter::create(sink_, description);
    require(writer.status());
    writer_.emplace(*std::move(writer));
    for (std::size_t i = 0; i < beside.size(); ++i) {
      require(writer_->add_metadata(static_cast<std::uint8_t>(i), beside[i]));
    }
  }
  /// The packet is in the file afterwards, even if the program is killed.
  void add(std::uint64_t frame, const Packet& packet,
           std::uint32_t region = StreamId::kWholeVolume) {
    require(writer_->add(frame, packet, region));
  }
  void finish() {
    require(writer_->finish());
    file_.commit();
  }
  /// Instead of finish(): keeps the incomplete file and returns its name; empty if there is none.
  [[nodiscard]] std::string leave() noexcept { return file_.leave(); }
  [[nodiscard]] std::uint64_t bytes() const { return writer_->bytes_written(); }

 private:
  void require(Status status) {
    if (status == Status::io_failed) {
      fail(Exit::io, "{}: cannot be written: {}", name_, reason(errno));
    }
    check(status, name_);
  }

  std::string name_;
  AtomicFile file_;
  FileSink sink_;
  std::optional<ContainerWriter> writer_;
};

}  // namespace gicodec::tools
