// Containers read front to back, from memory, as a pipe and as a file that grows, in part, and by
// seeking. Checksums of entries and of the packets in them are put right first.
#include "cost.h"
#include "mutate.h"

#include "base/bytes.h"
#include "bitstream/container_format.h"

#include <map>
#include <optional>

namespace {

using namespace gicodec;

class Pipe final : public Source {
 public:
  explicit Pipe(std::span<const std::byte> bytes) : memory_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override { return memory_.read(into); }

 private:
  MemorySource memory_;
};

/// Memory of which only the first part is there yet.
class Growing final : public Source {
 public:
  Growing(std::span<const std::byte> bytes, std::size_t size_in)
      : visible(size_in), bytes_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    const std::size_t size = std::min(into.size(), visible - at_);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), size, into.begin());
    at_ += size;
    return size;
  }
  std::optional<std::uint64_t> size() const override { return visible; }
  Status seek(std::uint64_t offset) override {
    fuzz::check(offset <= visible, "a reader seeks to what there is");
    at_ = static_cast<std::size_t>(offset);
    return Status::ok;
  }
  std::size_t visible;

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

/// Calls visit(entry, body) for every whole entry; both are spans of `file`.
template <typename Visit>
void for_each_entry(std::span<std::byte> file, const Visit& visit) {
  for (std::size_t at = kFileHeader; at < file.size();) {
    ByteReader reader(file.subspan(at));
    static_cast<void>(reader.fixed<std::uint8_t>());
    const auto length = static_cast<std::size_t>(reader.varint(file.size()));
    if (!reader.ok() || reader.rest().size() < length + kEntryChecksum) return;
    const std::size_t head = file.size() - at - reader.rest().size();
    const auto entry = file.subspan(at, head + length + kEntryChecksum);
    visit(entry, entry.subspan(head, length));
    at += entry.size();
  }
}

bool is(std::span<const std::byte> entry, EntryType type) {
  return entry[0] == static_cast<std::byte>(type);
}

/// A packet stands behind its frame number and its region.
std::size_t packet_at(std::span<const std::byte> body) {
  ByteReader reader(body);
  static_cast<void>(reader.varint());
  static_cast<void>(reader.varint());
  return reader.ok() ? body.size() - reader.rest().size() : body.size();
}

/// The tail of an index part: where the part stands.
void put_offset(std::span<std::byte> body, std::uint64_t offset) {
  if (body.size() < kIndexTail) return;
  std::memcpy(body.last(kIndexTail).data(), &offset, sizeof offset);
  std::memcpy(body.last(kIndexMark.size()).data(), kIndexMark.data(), kIndexMark.size());
}

void put_right(std::span<std::byte> file) {
  for_each_entry(file, [&](std::span<std::byte> entry, std::span<std::byte> body) {
    if (is(entry, EntryType::packet)) fuzz::reseal(body.subspan(packet_at(body)));
    if (is(entry, EntryType::index)) {
      put_offset(body, static_cast<std::uint64_t>(entry.data() - file.data()));
    }
    fuzz::reseal(entry);
  });
}

/// Decodes up to 64 packets; returns how many there were.
std::size_t play(ContainerReader& reader) {
  const ContainerDescription& description = reader.description();
  std::map<std::uint64_t, Decoder> decoders;
  std::size_t packets = 0;
  std::uint64_t frame = 0;
  for (; packets < 64; ++packets) {
    ContainerPacket packet;
    if (const Status status = reader.next(packet); status != Status::ok) {
      const Status after = reader.next(packet);
      const bool waits = after == Status::truncated && status == Status::truncated;
      fuzz::check(after == Status::end || waits, "nothing follows the end or an error");
      break;
    }
    fuzz::check(packet.texture_id < description.textures.size(), "packets belong to a texture");
    fuzz::check(packet.frame >= frame, "frames do not decrease");
    frame = packet.frame;
    const TextureEntry& texture = description.textures[packet.texture_id];
    const Grid& region = description.volumes[texture.volume].region;
    const bool whole = packet.region == StreamId::kWholeVolume;
    fuzz::check(whole == (region.x == 0), "packets belong to a region");
    if (!is_known(texture)) continue;
    const std::uint64_t key = region_key(packet.texture_id, packet.region);
    auto decoder = decoders.find(key);
    if (decoder == decoders.end()) {
      auto made = Decoder::create(whole ? texture.desc
                                        : region_texture(texture.desc, region, packet.region));
      fuzz::check(made.ok(), "descriptions that were read are valid");
      decoder = decoders.emplace(key, *std::move(made)).first;
    }
    (void)decoder->second.decode(packet.bytes);
  }
  return packets;
}

/// Metadata beside the description is the same from a pipe, which keeps it, and costs what it says.
void check_metadata(ContainerReader& reader, ContainerReader& piped) {
  for (std::size_t i = 0; i < reader.description().textures.size(); ++i) {
    const auto id = static_cast<std::uint8_t>(i);
    const auto metadata = reader.metadata(id);
    const auto again = piped.metadata(id);
    fuzz::check(metadata.ok() == again.ok(), "metadata of a pipe");
    fuzz::check(!metadata.ok() || *metadata == *again, "the same metadata");
  }
}

/// Every packet that a reader gives, to its end or an error.
std::vector<ContainerPacket> packets_of(ContainerReader& reader) {
  std::vector<ContainerPacket> packets;
  for (ContainerPacket packet; reader.next(packet) == Status::ok;) packets.push_back(packet);
  return packets;
}

bool same_packets(std::span<const ContainerPacket> a, std::span<const ContainerPacket> b) {
  const auto same = [](const ContainerPacket& x, const ContainerPacket& y) {
    return x.frame == y.frame && x.region == y.region && x.texture_id == y.texture_id &&
           x.bytes == y.bytes;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

/// A reader takes 5 times its largest entry and what description and index say, which stand in the
/// file (docs/guarantees.md, "Memory"), for an entry that ends too early the first step that it
/// reads ahead, once in a list that grows, and for textures a constant each. Each entry is read
/// once.
void check_reading(std::span<const std::byte> file, const DecodeLimits& limits) {
  fuzz::check_cost("reading a container costs what it is worth", [&]() -> fuzz::Allowance {
    MemorySource source(file);
    auto reader = ContainerReader::open(source, limits);
    ContainerPacket packet;
    while (reader.ok() && reader->next(packet) == Status::ok) {
    }
    constexpr std::size_t kFirstStep = std::size_t{64} << 10, kTextures = std::size_t{512} << 10;
    return {16 * file.size() + 2 * kFirstStep + kTextures,
            64 * file.size() + 4 * kFirstStep + 4 * kTextures};
  });
}

/// Opened when half of it was there, and read as it grew.
void check_growing(std::span<const std::byte> file, const DecodeLimits& limits,
                   std::span<const ContainerPacket> expected) {
  Growing source(file, file.size() / 2);
  auto reader = ContainerReader::open(source, limits);
  if (!reader) return;
  std::vector<ContainerPacket> packets;
  for (;;) {
    ContainerPacket packet;
    const Status status = reader->next(packet);
    if (status == Status::ok) {
      packets.push_back(std::move(packet));
    } else if (status == Status::truncated && source.visible < file.size()) {
      source.visible = std::min(file.size(), source.visible + 1 + file.size() / 16);
    } else {
      break;
    }
  }
  fuzz::check(same_packets(packets, expected), "the same packets as the file grows");
  for (std::uint64_t frame = 0; frame < 8 && reader->seekable(); ++frame) {
    if (reader->seek(frame) == Status::ok) (void)play(*reader);
  }
}

/// The packets of one region are those that are given of it among all.
void check_selection(std::span<const std::byte> file, const DecodeLimits& limits,
                     std::span<const ContainerPacket> expected) {
  if (expected.empty()) return;
  Pipe source(file);
  auto reader = *ContainerReader::open(source, limits);
  const TextureRegion wanted{expected.back().texture_id, expected.back().region};
  fuzz::check(reader.select(std::span(&wanted, 1)) == Status::ok,
              "what has packets can be selected");
  std::vector<ContainerPacket> own;
  for (const ContainerPacket& packet : expected) {
    if (TextureRegion{packet.texture_id, packet.region} == wanted) own.push_back(packet);
  }
  fuzz::check(same_packets(packets_of(reader), own), "a selection gives what was selected");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Exact file(std::span(reinterpret_cast<const std::byte*>(data), size));
  if (size > 0 && (data[size - 1] & 1) == 0) put_right(file.span());
  DecodeLimits limits;
  limits.max_texture_bytes = limits.max_metadata_bytes = 1U << 16;
  check_reading(file.span(), limits);
  MemorySource memory(file.span());
  Pipe pipe(file.span());
  auto seeking = ContainerReader::open(memory, limits);
  auto piped = ContainerReader::open(pipe, limits);
  fuzz::check(seeking.status() == piped.status(), "seeking changes nothing about opening");
  if (!seeking) return 0;
  check_metadata(*seeking, *piped);
  fuzz::check(play(*seeking) == play(*piped), "the same packets either way");
  for (std::uint64_t frame = 0; frame < 8 && seeking->seekable(); ++frame) {
    if (seeking->seek(frame) == Status::ok) (void)play(*seeking);
  }
  Pipe again(file.span());
  auto in_order = *ContainerReader::open(again, limits);
  const auto packets = packets_of(in_order);
  check_growing(file.span(), limits, packets);
  check_selection(file.span(), limits, packets);
  if (!packets.empty() && seeking->seekable()) {
    const TextureRegion wanted{packets.front().texture_id, packets.front().region};
    if (seeking->select(std::span(&wanted, 1)) == Status::ok &&
        seeking->seek(packets.back().frame) == Status::ok) {
      (void)play(*seeking);
    }
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  fuzz::Random random(seed);
  if (size <= kFileHeader || fuzz::once_in(random, 5))
    return LLVMFuzzerMutate(data, size, max_size);
  // Entries whose sizes are put right, and the offsets of index parts.
  struct Piece {
    std::byte type;
    fuzz::Bytes body;
  };
  const auto file = std::as_writable_bytes(std::span(data, size));
  std::vector<Piece> entries;
  std::size_t whole = kFileHeader;
  for_each_entry(file, [&](std::span<std::byte> entry, std::span<std::byte> body) {
    entries.push_back({entry[0], fuzz::Bytes(body.begin(), body.end())});
    whole += entry.size();
  });
  const std::size_t room = max_size > size ? max_size - size : 0;
  fuzz::mutate_list(entries, random, [&](Piece& entry) {
    if (fuzz::once_in(random, 16)) entry.type = static_cast<std::byte>(fuzz::pick(random, 6));
    const std::size_t keep = is({&entry.type, 1}, EntryType::packet) && fuzz::once_in(random, 2)
                                 ? packet_at(entry.body)
                                 : 0;
    fuzz::Bytes rest(entry.body.begin() + static_cast<std::ptrdiff_t>(keep), entry.body.end());
    fuzz::mutate(rest, rest.size() + room);
    entry.body.resize(keep);
    entry.body.insert(entry.body.end(), rest.begin(), rest.end());
  });
  fuzz::Bytes out(file.begin(), file.begin() + kFileHeader);
  std::uint64_t part = 0;
  for (auto& entry : entries) {
    const std::size_t begin = out.size();
    if (is({&entry.type, 1}, EntryType::index)) {
      put_offset(entry.body, begin);
      part = begin;
    }
    if (is({&entry.type, 1}, EntryType::end) && entry.body.size() == sizeof part) {
      std::memcpy(entry.body.data(), &part, sizeof part);
    }
    ByteWriter writer(out);
    writer.fixed(std::to_integer<std::uint8_t>(entry.type));
    writer.varint(entry.body.size());
    writer.bytes(entry.body);
    out.resize(out.size() + kEntryChecksum);
    fuzz::reseal(std::span(out).subspan(begin));
  }
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(whole), file.end());
  return fuzz::give(out, data, size, max_size);
}
