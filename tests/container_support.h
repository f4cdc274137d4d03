// Sources for the container tests, and a container to take apart.
#pragma once

#include "memory_sink.h"
#include "support.h"

#include <gicodec/container.h>
#include <gicodec/probes.h>

#include "bitstream/container_format.h"
#include "bitstream/packet.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

namespace gicodec::test {

/// Behind every frame and byte that there can be.
inline constexpr auto kEnd = std::numeric_limits<std::uint64_t>::max();

/// Memory as a pipe gives it: no size, no seeking. Tells what was asked for at once.
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

/// Memory that grows: nothing beyond `visible` is there yet. Counts what was read.
class GrowingSource final : public Source {
 public:
  GrowingSource(std::span<const std::byte> bytes, std::size_t visible_in)
      : visible(visible_in), bytes_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    const std::size_t size = std::min(into.size(), visible - std::min(visible, at_));
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), size, into.begin());
    at_ += size;
    read_bytes += size;
    return size;
  }
  std::optional<std::uint64_t> size() const override { return visible; }
  Status seek(std::uint64_t offset) override {
    if (offset > visible) return Status::io_failed;
    at_ = static_cast<std::size_t>(offset);
    return Status::ok;
  }
  std::size_t visible;
  std::size_t read_bytes = 0;

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
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

/// What the packets of every region of a texture have come to: the checksum of the last one, which
/// the next one must build on.
using States = std::map<std::uint64_t, std::uint32_t>;

/// Packets as an encoder makes them, of payloads that mean nothing.
class PacketMaker {
 public:
  explicit PacketMaker(const ContainerDescription& description) : description_(&description) {}
  Bytes make(std::uint8_t texture_id, std::uint32_t region, bool keyframe, Random& random,
             std::size_t payload = 20, bool lossy = false);
  [[nodiscard]] States states() const;

 private:
  const ContainerDescription* description_;
  std::map<std::uint64_t, PacketChain> chains_;
};

/// A finished container over frames with gaps: a volume of two textures, and one of a texture that
/// is cut into four regions.
struct Sample {
  ContainerDescription description;
  Bytes bytes;
  std::vector<ContainerPacket> packets;
  std::vector<std::uint64_t> ends;         ///< where each packet's entry ends
  std::vector<std::uint64_t> parts;        ///< where each index part begins
  std::uint64_t end_offset = 0;            ///< of the end entry
  std::map<std::uint64_t, States> frames;  ///< after the last packet of a frame

  /// The packets that a file of so many bytes has whole.
  [[nodiscard]] std::span<const ContainerPacket> packets_before(std::size_t size) const {
    const auto whole = std::upper_bound(ends.begin(), ends.end(), size) - ends.begin();
    return std::span(packets).first(static_cast<std::size_t>(whole));
  }
};

/// A texture of a volume of kind probes, and what a container says of it.
struct ProbeTexture {
  std::string name;
  TextureDesc desc;
  Metadata metadata = {};
  float largest_error = 0;
};
/// A volume for neighbours in the list that have one grid, at most 255 of them, named after its
/// place. No volumes if the textures do not make them.
ContainerDescription probe_description(std::span<const ProbeTexture> textures,
                                       Metadata metadata = {});
ContainerDescription sample_description();
/// Keyframes of a texture every `gop` of its packets; an index part after every `flush` frames;
/// metadata entries of the first textures.
Sample make_sample(std::uint64_t seed, std::uint32_t frames = 9, std::uint32_t gop = 4,
                   std::uint32_t flush = 3, std::span<const Metadata> metadata = {});
/// An entry with its checksum.
Bytes entry(std::uint8_t type, std::span<const std::byte> body);
Bytes packet_entry(const ContainerPacket& packet);
Bytes end_entry(std::uint64_t part);
/// The file header and description entry.
Bytes head_of(const ContainerDescription& description);
Bytes operator+(Bytes a, const Bytes& b);
/// The bytes of a packet's entry.
[[nodiscard]] std::span<const std::byte> packet_of(const Sample& sample, std::size_t packet);
/// The first packets as the index lists them.
[[nodiscard]] std::vector<SeekEntry> index_of(const Sample& sample);

[[nodiscard]] bool same_packet(const ContainerPacket& a, const ContainerPacket& b);
[[nodiscard]] bool same_packets(std::span<const ContainerPacket> a,
                                std::span<const ContainerPacket> b);
/// Reads packets until the end (Status::ok) or an error, which is returned.
Status read_all(ContainerReader& reader, std::vector<ContainerPacket>& packets);
/// Opens and reads to the end; the first status that is not ok.
Status read_through(std::span<const std::byte> file, bool pipe = false,
                    const DecodeLimits& limits = {});

inline constexpr std::uint32_t kWhole = StreamId::kWholeVolume;

/// Follows the chains of all packets that a reader gives.
class Player {
 public:
  /// Frame after frame up to and including `last_frame`. Status::ok there or at the end.
  Status play(ContainerReader& reader, std::uint64_t last_frame);
  /// One packet.
  Status take(const ContainerPacket& packet);
  States states;
  std::size_t packets = 0;
};

}  // namespace gicodec::test
