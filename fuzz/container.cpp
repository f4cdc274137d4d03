// Containers read front to back, from memory and as a pipe, and by seeking. Record checksums are
// put right first.
#include "bitstream/container_format.h"
#include "input.h"

namespace {

using namespace gicodec;

class Pipe final : public Source {
 public:
  explicit Pipe(std::span<const std::byte> bytes) : memory_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override { return memory_.read(into); }

 private:
  MemorySource memory_;
};

void put_records_right(std::span<std::byte> file) {
  std::size_t at = kFileHeader;
  while (at + 2 < file.size()) {
    std::size_t end = at + 1;
    std::uint64_t length = 0;
    for (unsigned shift = 0; end < file.size() && shift < 32; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(file[end++]);
      length |= (byte & 0x7F) << shift;
      if (byte < 0x80) break;
    }
    const std::uint64_t whole = end - at + length + kRecordChecksum;
    if (whole > file.size() - at) return;
    fuzz::reseal(file.subspan(at, static_cast<std::size_t>(whole)));
    at += static_cast<std::size_t>(whole);
  }
}

/// Decodes up to 64 packets; returns how many there were.
std::size_t play(ContainerReader& reader) {
  std::vector<std::optional<Decoder>> decoders(reader.description().textures.size());
  std::size_t packets = 0;
  std::uint64_t frame = 0;
  for (; packets < 64; ++packets) {
    ContainerPacket packet;
    if (reader.next(packet) != Status::ok) {
      fuzz::check(reader.next(packet) == Status::end, "nothing follows the end or an error");
      break;
    }
    fuzz::check(packet.texture_id < decoders.size(), "packets belong to a texture");
    fuzz::check(packet.frame >= frame, "frames do not decrease");
    frame = packet.frame;
    auto& decoder = decoders[packet.texture_id];
    if (!decoder) {
      auto made = Decoder::create(reader.description().textures[packet.texture_id].desc);
      fuzz::check(made.ok(), "descriptions that were read are valid");
      decoder = *std::move(made);
    }
    (void)decoder->decode(packet.bytes);
  }
  return packets;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Exact file(std::span(reinterpret_cast<const std::byte*>(data), size));
  if (size > 0 && (data[size - 1] & 1) == 0) put_records_right(file.span());
  DecodeLimits limits;
  limits.max_texture_bytes = 1U << 16;
  MemorySource memory(file.span());
  Pipe pipe(file.span());
  auto seeking = ContainerReader::open(memory, limits);
  auto piped = ContainerReader::open(pipe, limits);
  fuzz::check(seeking.status() == piped.status(), "seeking changes nothing about opening");
  if (!seeking) return 0;
  fuzz::check(play(*seeking) == play(*piped), "the same packets either way");
  for (std::uint64_t frame = 0; frame < 8 && seeking->seekable(); ++frame) {
    if (seeking->seek(frame) == Status::ok) (void)play(*seeking);
  }
  return 0;
}
