#include "support.h"

#include "base/checksum.h"

#include <sanitizer/asan_interface.h>

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
  const auto* info = find_format(desc.format);
  return out << (info == nullptr ? "?" : info->name) << " " << desc.grid.x << "x" << desc.grid.y
             << "x" << desc.grid.z << " core " << desc.core << " border " << desc.border << " "
             << to_string(desc.tiling);
}

namespace test {

bool everything() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return std::getenv("GICODEC_TEST_EVERYTHING") != nullptr;
#else
  return true;
#endif
}

namespace {

std::byte pattern(std::size_t offset) { return static_cast<std::byte>(0xA5 ^ (offset * 29)); }

/// Halves and floats that a conversion would damage: NaN payloads, infinities, denormals, -0.
constexpr std::array<std::uint16_t, 8> kSpecialHalves{0x7C01, 0x7E55, 0xFFFF, 0x7C00,
                                                      0x8000, 0x0001, 0x83FF, 0xFC01};
constexpr std::array<std::uint32_t, 8> kSpecialFloats{
    0x7F800001, 0x7FC0BEEF, 0xFFFFFFFF, 0xFF800000, 0x80000000, 0x00000001, 0x807FFFFF, 0x7FA00000};

void fill_texel(std::span<std::byte> texel, Fill fill, Random& random) {
  for (auto& byte : texel) byte = static_cast<std::byte>(random());
  if (fill == Fill::zero) std::ranges::fill(texel, std::byte{0});
  if (fill == Fill::small) {
    std::ranges::fill(texel, std::byte{0});
    texel[0] = static_cast<std::byte>(random() % 4);
  }
  if (fill == Fill::special && chance(random, 2)) {
    if (texel.size() % 4 == 0 && chance(random, 2)) {
      for (std::size_t i = 0; i < texel.size(); i += 4) {
        std::memcpy(&texel[i], &kSpecialFloats[random() % kSpecialFloats.size()], 4);
      }
    } else {
      for (std::size_t i = 0; i < texel.size(); i += 2) {
        std::memcpy(&texel[i], &kSpecialHalves[random() % kSpecialHalves.size()], 2);
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

Bytes noise(Random& random, std::size_t size) {
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

Exact::Exact(std::span<const std::byte> bytes) : Exact(bytes.size()) {
  std::ranges::copy(bytes, data_.get());
}

Texture::Texture(const TextureDesc& desc, std::size_t row_padding, std::size_t slice_padding)
    : desc_(desc) {
  const auto size = extent(desc);
  row_bytes_ = std::size_t{size.width} * texel_bytes(desc);
  row_pitch_ = row_bytes_ + row_padding;
  slice_pitch_ = size.height * row_pitch_ + slice_padding;
  size_ = (size.slices - 1) * slice_pitch_ + (size.height - 1) * row_pitch_ + row_bytes_;
  data_.reset(new std::byte[size_]());
  for_padding([&](std::size_t i) { data_[i] = pattern(i); });
  poison(true);
}

Texture::~Texture() { poison(false); }

template <typename Visit>
void Texture::for_padding(Visit&& visit) const {
  const auto size = extent(desc_);
  for (std::size_t i = 0; i < size_; ++i) {
    const std::size_t in_slice = i % slice_pitch_;
    if (in_slice / row_pitch_ >= size.height || in_slice % row_pitch_ >= row_bytes_) visit(i);
  }
}

void Texture::poison(bool on) const {
  const auto size = extent(desc_);
  if (!on) {
    ASAN_UNPOISON_MEMORY_REGION(data_.get(), size_);
    return;
  }
  for (std::uint32_t slice = 0; slice < size.slices; ++slice) {
    for (std::uint32_t y = 0; y < size.height; ++y) {
      const std::size_t end = slice * slice_pitch_ + y * row_pitch_ + row_bytes_;
      const std::size_t next =
          y + 1 < size.height ? end - row_bytes_ + row_pitch_ : (slice + 1) * slice_pitch_;
      if (std::min(next, size_) > end) {
        ASAN_POISON_MEMORY_REGION(data_.get() + end, std::min(next, size_) - end);
      }
    }
  }
}

bool Texture::padding_untouched() const {
  poison(false);
  bool untouched = true;
  for_padding([&](std::size_t i) { untouched &= data_[i] == pattern(i); });
  poison(true);
  return untouched;
}

std::span<std::byte> Texture::texel(std::uint32_t probe, std::uint32_t x, std::uint32_t y) {
  const auto origin = block_origin(desc_, probe);
  const std::size_t bytes = texel_bytes(desc_);
  return {data_.get() + origin.slice * slice_pitch_ + (origin.y + y) * row_pitch_ +
              (origin.x + x) * bytes,
          bytes};
}

Bytes Texture::block(std::uint32_t probe) const {
  const std::size_t row = block_side(desc_) * texel_bytes(desc_);
  const auto origin = block_origin(desc_, probe);
  Bytes out;
  for (std::uint32_t y = 0; y < block_side(desc_); ++y) {
    const auto* from = data_.get() + origin.slice * slice_pitch_ + (origin.y + y) * row_pitch_ +
                       origin.x * texel_bytes(desc_);
    out.insert(out.end(), from, from + row);
  }
  return out;
}

Bytes Texture::blocks() const {
  Bytes out;
  for (std::uint32_t probe = 0; probe < probe_count(desc_); ++probe) {
    const auto one = block(probe);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

void Texture::set_block(std::uint32_t probe, std::span<const std::byte> texels) {
  for (std::uint32_t y = 0; y < block_side(desc_); ++y) {
    for (std::uint32_t x = 0; x < block_side(desc_); ++x) {
      const auto to = texel(probe, x, y);
      std::ranges::copy(texels.first(to.size()), to.begin());
      texels = texels.subspan(to.size());
    }
  }
}

void Texture::fill_core(std::uint32_t probe, Fill fill, Random& random) {
  for (std::uint32_t y = 0; y < desc_.core; ++y) {
    for (std::uint32_t x = 0; x < desc_.core; ++x) {
      fill_texel(texel(probe, x + desc_.border, y + desc_.border), fill, random);
    }
  }
}

void Texture::fill_border(std::uint32_t probe) {
  if (desc_.border == 0) return;
  const std::uint32_t n = block_side(desc_);
  const std::uint32_t i = n - 2;
  const auto copy = [&](std::uint32_t x, std::uint32_t y, std::uint32_t from_x,
                        std::uint32_t from_y) {
    std::ranges::copy(texel(probe, from_x, from_y), texel(probe, x, y).begin());
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

void Texture::fill(Fill fill, Random& random) {
  for (std::uint32_t probe = 0; probe < probe_count(desc_); ++probe) {
    fill_core(probe, fill, random);
    fill_border(probe);
  }
}

Model::Model(const TextureDesc& desc)
    : block_bytes_(std::size_t{block_side(desc)} * block_side(desc) * texel_bytes(desc)),
      blocks_(probe_count(desc) * block_bytes_) {}

void Model::apply(const Texture& texture, bool keyframe, std::span<const std::uint32_t> probes) {
  if (keyframe) std::ranges::fill(blocks_, std::byte{0});
  for (const auto probe : probes) {
    std::ranges::copy(texture.block(probe),
                      blocks_.begin() + static_cast<std::ptrdiff_t>(probe * block_bytes_));
  }
}

TextureDesc random_desc(Random& random, std::uint32_t max_texels) {
  TextureDesc desc;
  desc.format = formats()[random() % formats().size()].format;
  constexpr std::array<std::uint16_t, 4> kUsual{6, 8, 14, 16};
  desc.core = chance(random, 3)
                  ? kUsual[random() % kUsual.size()]
                  : static_cast<std::uint16_t>(pick(random, 1, chance(random, 4) ? kMaxCore : 9));
  desc.border = static_cast<std::uint16_t>(random() % 2);
  desc.tiling = static_cast<Tiling>(random() % kTilingCount);
  desc.grid = {pick(random, 1, 7), pick(random, 1, 5), pick(random, 1, 5)};
  const std::uint32_t block = block_side(desc) * block_side(desc);
  while (probe_count(desc) > 1 && probe_count(desc) * block > max_texels) {
    auto& grid = desc.grid;
    auto& widest = grid.x >= std::max(grid.y, grid.z)   ? grid.x
                   : std::max(grid.y, grid.z) == grid.y ? grid.y
                                                        : grid.z;
    widest = (widest + 1) / 2;
  }
  return desc;
}

std::vector<std::uint32_t> random_selection(Random& random, std::uint32_t probes) {
  std::vector<std::uint32_t> all(probes);
  std::iota(all.begin(), all.end(), 0U);
  const auto kind = random() % 6;
  if (kind == 0) return {};
  if (kind == 1) return all;
  if (kind == 2) return {pick(random, 0, probes - 1)};
  if (kind == 3) {
    const auto first = pick(random, 0, probes - 1);
    const auto last = pick(random, first, probes - 1);
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
  static constexpr std::array<Coding, 14> kCodings{{{"raw", 0, false},
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
