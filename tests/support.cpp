#include "support.h"

#include "base/checksum.h"
#include "sanitizers.h"

#if defined(GICODEC_ASAN)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(start, size) (static_cast<void>(start), static_cast<void>(size))
#define ASAN_UNPOISON_MEMORY_REGION(start, size) (static_cast<void>(start), static_cast<void>(size))
#endif

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <numeric>

namespace gicodec {

std::ostream& operator<<(std::ostream& out, Status status) {
  return out << static_cast<int>(status) << " (" << to_string(status) << ")";
}

std::ostream& operator<<(std::ostream& out, const TextureDesc& desc) {
  const auto side = [&](auto a, auto b, auto c) -> std::ostream& {
    return out << unsigned{a} << "x" << unsigned{b} << "x" << unsigned{c};
  };
  if (const auto* info = find_format(desc.record.format)) {
    out << info->name << " ";
  } else {
    out << unsigned{desc.record.bytes} << " bytes:";
    for (const Component& c : desc.record.used()) out << " " << +c.bits << "@" << c.offset;
    out << " ";
  }
  side(desc.grid.x, desc.grid.y, desc.grid.z)
      << (desc.space == Space::pool ? " slots of " : " of ");
  side(desc.block.x, desc.block.y, desc.block.z) << " guard band " << +desc.guard_band << " ";
  side(desc.records.x, desc.records.y, desc.records.z)
      << " records, presence " << static_cast<int>(desc.presence) << " ";
  out << to_string(desc.layout.tiling) << " padding " << +desc.layout.pad_before << "+"
      << +desc.layout.pad_after << " slots ";
  return side(desc.layout.slots.x, desc.layout.slots.y, desc.layout.slots.z);
}

namespace test {

bool everything() { return std::getenv("GICODEC_TEST_EVERYTHING") != nullptr; }

std::size_t one_case_in() {
#if defined(GICODEC_ASAN) || defined(GICODEC_TSAN)
  return everything() ? 1 : 27;
#else
  return everything() ? 1 : 3;
#endif
}

bool Sweep::takes() {
  // Spread (by MurmurHash3's last step): of loops within loops, every n-th would be the same ones
  // of the inner loop.
  std::uint32_t spread = case_++;
  spread = (spread ^ spread >> 16U) * 0x85EBCA6BU;
  spread = (spread ^ spread >> 13U) * 0xC2B2AE35U;
  return (spread ^ spread >> 16U) % one_case_in() == 0;
}

namespace {

std::byte pattern(std::size_t offset) { return static_cast<std::byte>(0xA5 ^ (offset * 29)); }

/// Halves and floats that a conversion would damage: NaN payloads, infinities, denormals, -0.
constexpr std::array<std::uint16_t, 8> kSpecialHalves{0x7C01, 0x7E55, 0xFFFF, 0x7C00,
                                                      0x8000, 0x0001, 0x83FF, 0xFC01};
constexpr std::array<std::uint32_t, 8> kSpecialFloats{
    0x7F800001, 0x7FC0BEEF, 0xFFFFFFFF, 0xFF800000, 0x80000000, 0x00000001, 0x807FFFFF, 0x7FA00000};

void fill_record(std::span<std::byte> record, Fill fill, Random& random) {
  for (auto& byte : record) byte = static_cast<std::byte>(random());
  if (fill == Fill::zero) std::fill(record.begin(), record.end(), std::byte{0});
  if (fill == Fill::small) {
    std::fill(record.begin(), record.end(), std::byte{0});
    record[0] = static_cast<std::byte>(random() % 4);
  }
  if (fill == Fill::special && chance(random, 2)) {
    if (record.size() % 4 == 0 && chance(random, 2)) {
      for (std::size_t i = 0; i < record.size(); i += 4) {
        std::memcpy(&record[i], &kSpecialFloats[random() % kSpecialFloats.size()], 4);
      }
    } else {
      for (std::size_t i = 0; i + 2 <= record.size(); i += 2) {
        std::memcpy(&record[i], &kSpecialHalves[random() % kSpecialHalves.size()], 2);
      }
    }
  }
}

}  // namespace

std::uint32_t pick(Random& random, std::uint32_t low, std::uint32_t high) {
  return low + static_cast<std::uint32_t>(random() % (std::uint64_t{high} - low + 1));
}
bool chance(Random& random, std::uint32_t one_in) { return random() % one_in == 0; }

Isa any_isa(Random& random) {
  return chance(random, 2) ? best_isa() : supported_isas()[random() % supported_isas().size()];
}

std::vector<std::uint32_t> listed_blocks(const Decoder& decoder,
                                         std::span<const std::byte> packet) {
  std::vector<std::uint32_t> blocks(decoder.changed().begin(), decoder.changed().end());
  if (is_keyframe(peek(packet)->type)) {
    std::erase_if(blocks, [&](std::uint32_t block) { return decoder.received()[block] == 0; });
  }
  return blocks;
}

Bytes noise(Random& random, std::size_t size) {
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

bool same(std::span<const std::byte> a, std::span<const std::byte> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

Exact::Exact(std::span<const std::byte> bytes) : Exact(bytes.size()) {
  std::copy(bytes.begin(), bytes.end(), data_.get());
}

Texture::Texture(const TextureDesc& desc, std::size_t row_padding, std::size_t slice_padding,
                 std::size_t block_padding)
    : desc_(desc) {
  const auto size = extent(desc);
  const std::size_t blocks = desc.layout.tiling == Tiling::blocks ? block_count(desc) : 1;
  const auto slices = static_cast<std::size_t>(size.slices / blocks);
  const auto row_bytes = static_cast<std::size_t>(size.width * desc.record.bytes);
  const auto height = static_cast<std::size_t>(size.height);
  row_pitch_ = row_bytes + row_padding;
  slice_pitch_ = height * row_pitch_ + slice_padding;
  block_pitch_ = slices * slice_pitch_ + block_padding;
  size_ = (blocks - 1) * block_pitch_ + (slices - 1) * slice_pitch_ + (height - 1) * row_pitch_ +
          row_bytes;
  data_.reset(new std::byte[size_]());
  used_.resize(size_);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    for_records(block, [&](std::size_t at, std::size_t, std::size_t bytes) {
      std::fill_n(used_.begin() + static_cast<std::ptrdiff_t>(at), bytes, std::uint8_t{1});
    });
  }
  for (std::size_t i = 0; i < size_; ++i) {
    if (used_[i] == 0) data_[i] = pattern(i);
  }
  poison(true);
}

Texture::~Texture() { poison(false); }

/// Visits the rows of a block that are in memory: visit(offset in memory, offset in the block's
/// records, bytes), guard band included.
template <typename Visit>
void Texture::for_records(std::uint32_t block, Visit&& visit) const {
  const auto origin = block_origin(desc_, block);
  const auto inside = block_inside(desc_, block);
  const std::size_t record = desc_.record.bytes, band = 2U * desc_.guard_band;
  const auto first =
      static_cast<std::size_t>(origin.block * block_pitch_ + origin.slice * slice_pitch_ +
                               origin.y * row_pitch_ + origin.x * record);
  for (std::size_t z = 0; z < inside.z; ++z) {
    for (std::size_t y = 0; y < inside.y + band; ++y) {
      visit(first + z * slice_pitch_ + y * row_pitch_,
            (z * desc_.block.y + y) * (desc_.block.x + band) * record, (inside.x + band) * record);
    }
  }
}

void Texture::poison(bool on) const {
  if (!on) {
    ASAN_UNPOISON_MEMORY_REGION(data_.get(), size_);
    return;
  }
  for (std::size_t i = 0; i < size_;) {
    std::size_t end = i;
    while (end < size_ && used_[end] == used_[i]) ++end;
    if (used_[i] == 0) ASAN_POISON_MEMORY_REGION(data_.get() + i, end - i);
    i = end;
  }
}

bool Texture::padding_untouched() const {
  poison(false);
  bool untouched = true;
  for (std::size_t i = 0; i < size_; ++i) untouched &= used_[i] != 0 || data_[i] == pattern(i);
  poison(true);
  return untouched;
}

std::span<std::byte> Texture::record(std::uint32_t block, std::uint32_t x, std::uint32_t y,
                                     std::uint32_t z) {
  const auto origin = block_origin(desc_, block);
  const std::size_t bytes = desc_.record.bytes;
  return {data_.get() + origin.block * block_pitch_ + (origin.slice + z) * slice_pitch_ +
              (origin.y + y) * row_pitch_ + (origin.x + x) * bytes,
          bytes};
}

Bytes Texture::block(std::uint32_t block) const {
  Bytes out(guarded_bytes(desc_));
  for_records(block, [&](std::size_t from, std::size_t to, std::size_t bytes) {
    std::copy_n(data_.get() + from, bytes, out.begin() + static_cast<std::ptrdiff_t>(to));
  });
  return out;
}

Bytes Texture::blocks() const {
  Bytes out;
  for (std::uint32_t block = 0; block < block_count(desc_); ++block) {
    const auto one = this->block(block);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

void Texture::set_block(std::uint32_t block, std::span<const std::byte> records) {
  for_records(block, [&](std::size_t to, std::size_t from, std::size_t bytes) {
    std::copy_n(records.data() + from, bytes, data_.get() + to);
  });
}

void Texture::fill_block(std::uint32_t block, Fill fill, Random& random) {
  const auto inside = block_inside(desc_, block);
  for (std::uint32_t z = 0; z < inside.z; ++z) {
    for (std::uint32_t y = 0; y < inside.y; ++y) {
      for (std::uint32_t x = 0; x < inside.x; ++x) {
        fill_record(record(block, x + desc_.guard_band, y + desc_.guard_band, z), fill, random);
      }
    }
  }
}

void Texture::fill_band(std::uint32_t block) {
  if (desc_.guard_band == 0) return;
  const std::uint32_t n = desc_.block.x + 2U;
  const std::uint32_t i = n - 2;
  const auto copy = [&](std::uint32_t x, std::uint32_t y, std::uint32_t from_x,
                        std::uint32_t from_y) {
    const auto from = record(block, from_x, from_y);
    std::copy(from.begin(), from.end(), record(block, x, y).begin());
  };
  copy(0, 0, i, i);
  copy(n - 1, 0, 1, i);
  copy(0, n - 1, i, 1);
  copy(n - 1, n - 1, 1, 1);
  for (std::uint32_t k = 1; k <= i; ++k) {
    copy(k, 0, n - 1 - k, 1);
    copy(k, n - 1, n - 1 - k, n - 2);
    copy(0, k, 1, n - 1 - k);
    copy(n - 1, k, n - 2, n - 1 - k);
  }
}

void Texture::fill_fast(Random& random) {
  Bytes records(guarded_bytes(desc_));
  for (std::uint32_t block = 0; block < block_count(desc_); ++block) {
    for (std::size_t at = 0; at < records.size(); at += sizeof(std::uint64_t)) {
      const std::uint64_t eight = random();
      std::memcpy(&records[at], &eight, std::min(sizeof eight, records.size() - at));
    }
    set_block(block, records);
    fill_band(block);
  }
}

void Texture::fill(Fill fill, Random& random) {
  for (std::uint32_t block = 0; block < block_count(desc_); ++block) {
    fill_block(block, fill, random);
    fill_band(block);
  }
}

std::vector<std::uint32_t> random_selection(Random& random, std::uint32_t blocks) {
  std::vector<std::uint32_t> all(blocks);
  std::iota(all.begin(), all.end(), 0U);
  const auto kind = random() % 6;
  if (kind == 0) return {};
  if (kind == 1) return all;
  if (kind == 2) return {pick(random, 0, blocks - 1)};
  if (kind == 3) {
    const auto first = pick(random, 0, blocks - 1);
    const auto last = pick(random, first, blocks - 1);
    return {all.begin() + first, all.begin() + last + 1};
  }
  const std::uint32_t keep = kind == 4 ? 2 : 9;
  std::erase_if(all, [&](auto) { return !chance(random, keep); });
  return all;
}

Bytes flip_bit(std::span<const std::byte> bytes, std::size_t bit) {
  Bytes out(bytes.begin(), bytes.end());
  out[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
  return out;
}

void reseal(std::span<std::byte> packet) {
  if (packet.size() < 4) return;
  const std::uint32_t sum = checksum(packet.first(packet.size() - 4));
  std::memcpy(packet.data() + packet.size() - 4, &sum, 4);
}

namespace {
template <typename Session>
Bytes read_all(const Session& session) {
  Texture texture(session.desc());
  return session.read(texture.view()) == Status::ok ? texture.blocks() : Bytes{};
}
}  // namespace

Bytes contents(const Decoder& decoder) { return read_all(decoder); }
Bytes contents(const Encoder& encoder) { return read_all(encoder); }

std::span<const Coding> codings() {
  static constexpr std::array<Coding, 17> kCodings{{{"raw", 0, false},
                                                    {"raw", 0, true},
                                                    {"lz4", 0, true},
                                                    {"lz4", 1, false},
                                                    {"lz4", 2, true},
                                                    {"lz4", 9, false},
                                                    {"lz4", 12, true},
                                                    {"zstd", 0, true},
                                                    {"zstd", 1, false},
                                                    {"zstd", 5, true},
                                                    {"zstd", 12, false},
                                                    {"zstd", 19, true},
                                                    {"lz4", -8, true},
                                                    {"zstd", -5, false},
                                                    {"native", 0, true, "turbo"},
                                                    {"native", 0, true, "fast"},
                                                    {"native", 0, true, "strong"}}};
  return kCodings;
}

EncoderOptions options_of(const Coding& coding) {
  EncoderOptions options;
  options.backend = coding.backend;
  options.settings.level = coding.level;
  options.settings.difference = coding.difference;
  options.settings.preset = coding.preset;
  return options;
}

}  // namespace test
}  // namespace gicodec
