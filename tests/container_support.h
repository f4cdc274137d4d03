// Sources and sinks for the container tests, and a container to take apart.
#pragma once

#include "memory_sink.h"
#include "support.h"

#include <gicodec/container.h>

#include <algorithm>
#include <map>

namespace gicodec::test {

/// Memory as a pipe gives it: no size, no seeking. Counts what was asked for at once.
class PipeSource final : public Source {
 public:
  explicit PipeSource(std::span<const std::byte> bytes) : memory_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    largest = std::max(largest, into.size());
    return memory_.read(into);
  }
  std::size_t largest = 0;

 private:
  MemorySource memory_;
};

/// Fails at the n-th call of read or seek.
class FailingSource final : public Source {
 public:
  FailingSource(std::span<const std::byte> bytes, int calls, bool seekable)
      : memory_(bytes), calls_(calls), seekable_(seekable) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    if (calls_-- <= 0) return Status::io_failed;
    return memory_.read(into);
  }
  std::optional<std::uint64_t> size() const override {
    return seekable_ ? memory_.size() : std::nullopt;
  }
  Status seek(std::uint64_t offset) override {
    return calls_-- <= 0 ? Status::io_failed : memory_.seek(offset);
  }

 private:
  MemorySource memory_;
  int calls_;
  bool seekable_;
};

/// A finished container of two textures over frames with gaps, and what decoders hold after every
/// packet.
struct Sample {
  ContainerDescription description;
  Bytes bytes;
  std::vector<ContainerPacket> packets;
  std::vector<std::uint64_t> ends;  ///< where each packet's record ends
  std::uint64_t index_offset = 0;
  /// Contents of every texture after the last packet of a frame.
  std::map<std::uint64_t, std::vector<Bytes>> frames;
};

Sample make_sample(std::uint64_t seed, std::uint32_t frames = 9, std::uint32_t gop = 4);
/// A record with its checksum.
Bytes record(std::uint8_t type, std::span<const std::byte> body);

/// Decodes everything a reader gives, until `last_frame`; contents after it.
class Player {
 public:
  explicit Player(const ContainerDescription& description);
  /// Frame after frame up to and including `last_frame`. With `skip`, packets that build on what
  /// was skipped are left out. Status::ok at the end.
  Status play(ContainerReader& reader, std::uint64_t last_frame, bool skip = false);
  [[nodiscard]] std::vector<Bytes> contents() const;
  std::size_t packets = 0;

 private:
  std::vector<Decoder> decoders_;
};

}  // namespace gicodec::test
