// Containers read front to back, from memory and as a pipe, and by seeking. Checksums of records
// and of the packets in them are put right first.
#include "cost.h"
#include "mutate.h"

#include "base/bytes.h"
#include "bitstream/container_format.h"

namespace {

using namespace gicodec;

class Pipe final : public Source {
 public:
  explicit Pipe(std::span<const std::byte> bytes) : memory_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override { return memory_.read(into); }

 private:
  MemorySource memory_;
};

/// Calls visit(record, body) for every whole record; both are spans of `file`.
template <typename Visit>
void for_each_record(std::span<std::byte> file, const Visit& visit) {
  for (std::size_t at = kFileHeader; at < file.size();) {
    ByteReader reader(file.subspan(at));
    static_cast<void>(reader.fixed<std::uint8_t>());
    const auto length = static_cast<std::size_t>(reader.varint(file.size()));
    if (!reader.ok() || reader.rest().size() < length + kRecordChecksum) return;
    const std::size_t head = file.size() - at - reader.rest().size();
    const auto record = file.subspan(at, head + length + kRecordChecksum);
    visit(record, record.subspan(head, length));
    at += record.size();
  }
}

bool is(std::span<const std::byte> record, RecordType type) {
  return record[0] == static_cast<std::byte>(type);
}

/// A packet stands behind its frame number.
std::size_t frame_bytes(std::span<const std::byte> body) {
  ByteReader reader(body);
  static_cast<void>(reader.varint());
  return reader.ok() ? body.size() - reader.rest().size() : body.size();
}

void put_right(std::span<std::byte> file) {
  for_each_record(file, [](std::span<std::byte> record, std::span<std::byte> body) {
    if (is(record, RecordType::packet)) fuzz::reseal(body.subspan(frame_bytes(body)));
    fuzz::reseal(record);
  });
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

/// A reader takes 5 times its largest record and what description and index say, which stand in the
/// file (docs/guarantees.md, "Memory"), and for a record that ends too early the first step that it
/// reads ahead, once in a list that grows. Each record is read once.
void check_reading(std::span<const std::byte> file, const DecodeLimits& limits) {
  fuzz::check_cost("reading a container costs what it is worth", [&]() -> fuzz::Allowance {
    MemorySource source(file);
    auto reader = ContainerReader::open(source, limits);
    ContainerPacket packet;
    while (reader.ok() && reader->next(packet) == Status::ok) {
    }
    constexpr std::size_t kFirstStep = std::size_t{64} << 10;
    return {16 * file.size() + 2 * kFirstStep, 64 * file.size() + 4 * kFirstStep};
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Exact file(std::span(reinterpret_cast<const std::byte*>(data), size));
  if (size > 0 && (data[size - 1] & 1) == 0) put_right(file.span());
  DecodeLimits limits;
  limits.max_texture_bytes = 1U << 16;
  check_reading(file.span(), limits);
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

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  fuzz::Random random(seed);
  if (size <= kFileHeader || fuzz::once_in(random, 5))
    return LLVMFuzzerMutate(data, size, max_size);
  // Records whose sizes are put right, and the end record's offset of the index.
  struct Piece {
    std::byte type;
    fuzz::Bytes body;
  };
  const auto file = std::as_writable_bytes(std::span(data, size));
  std::vector<Piece> records;
  std::size_t whole = kFileHeader;
  for_each_record(file, [&](std::span<std::byte> record, std::span<std::byte> body) {
    records.push_back({record[0], fuzz::Bytes(body.begin(), body.end())});
    whole += record.size();
  });
  const std::size_t room = max_size > size ? max_size - size : 0;
  fuzz::mutate_list(records, random, [&](Piece& record) {
    if (fuzz::once_in(random, 16)) record.type = static_cast<std::byte>(fuzz::pick(random, 6));
    const std::size_t keep = is({&record.type, 1}, RecordType::packet) && fuzz::once_in(random, 2)
                                 ? frame_bytes(record.body)
                                 : 0;
    fuzz::Bytes rest(record.body.begin() + static_cast<std::ptrdiff_t>(keep), record.body.end());
    fuzz::mutate(rest, rest.size() + room);
    record.body.resize(keep);
    record.body.insert(record.body.end(), rest.begin(), rest.end());
  });
  fuzz::Bytes out(file.begin(), file.begin() + kFileHeader);
  std::uint64_t index = 0;
  for (auto& record : records) {
    if (is({&record.type, 1}, RecordType::index)) index = out.size();
    if (is({&record.type, 1}, RecordType::end) && record.body.size() == sizeof index) {
      std::memcpy(record.body.data(), &index, sizeof index);
    }
    const std::size_t begin = out.size();
    ByteWriter writer(out);
    writer.fixed(std::to_integer<std::uint8_t>(record.type));
    writer.varint(record.body.size());
    writer.bytes(record.body);
    out.resize(out.size() + kRecordChecksum);
    fuzz::reseal(std::span(out).subspan(begin));
  }
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(whole), file.end());
  return fuzz::give(out, data, size, max_size);
}
