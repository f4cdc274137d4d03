// Generators and textures for the tests. Buffers are exactly as large as they are said to be, so
// that AddressSanitizer sees the first byte read or written beyond.
#pragma once

#include <gicodec/gicodec.h>

#include <rapidcheck.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace gicodec {

std::ostream& operator<<(std::ostream& out, Status status);
std::ostream& operator<<(std::ostream& out, const TextureDesc& desc);

namespace test {

using Bytes = std::vector<std::byte>;
using Random = std::mt19937_64;

/// True in Release and for `script/test --long`. Sanitizers make programs ten times slower: under
/// them a sweep may take one of its instruction sets and thread counts after the other, case by
/// case, rather than all of them in each case.
[[nodiscard]] bool everything();

/// Uniform in [low, high].
std::uint32_t pick(Random& random, std::uint32_t low, std::uint32_t high);
bool chance(Random& random, std::uint32_t one_in);
Bytes noise(Random& random, std::size_t size);
/// One of those that this machine has, the best in half of the cases: it is the fastest.
Isa any_isa(Random& random);

/// Bytes in a heap block of just their size.
class Exact {
 public:
  explicit Exact(std::size_t size) : data_(new std::byte[size]()), size_(size) {}
  explicit Exact(std::span<const std::byte> bytes);
  [[nodiscard]] std::span<std::byte> span() { return {data_.get(), size_}; }
  [[nodiscard]] std::span<const std::byte> span() const { return {data_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t size_;
};

/// How a texture is filled.
enum class Fill { zero, noise, small, special };

/// A texture in an exactly sized buffer. Bytes between the end of a row and the next pitch are
/// filled with a pattern and poisoned under AddressSanitizer.
class Texture {
 public:
  explicit Texture(const TextureDesc& desc, std::size_t row_padding = 0,
                   std::size_t slice_padding = 0);
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  [[nodiscard]] const TextureDesc& desc() const { return desc_; }
  [[nodiscard]] TextureView view() { return {{data_.get(), size_}, row_pitch_, slice_pitch_}; }
  [[nodiscard]] ConstTextureView view() const {
    return {{data_.get(), size_}, row_pitch_, slice_pitch_};
  }
  /// Texel (x, y) of a probe's block, border included.
  [[nodiscard]] std::span<std::byte> texel(std::uint32_t probe, std::uint32_t x, std::uint32_t y);

  /// Every block in probe order, row by row: the contents whatever tiling and pitch.
  [[nodiscard]] Bytes blocks() const;
  [[nodiscard]] Bytes block(std::uint32_t probe) const;
  void set_block(std::uint32_t probe, std::span<const std::byte> texels);

  /// New core texels for a probe; the border is left alone.
  void fill_core(std::uint32_t probe, Fill fill, Random& random);
  /// The border by the rule of the design notes, written down texel by texel.
  void fill_border(std::uint32_t probe);
  /// Noise everywhere, borders by the rule.
  void fill(Fill fill, Random& random);

  [[nodiscard]] bool padding_untouched() const;

 private:
  void poison(bool on) const;
  template <typename Visit>
  void for_padding(Visit&& visit) const;

  TextureDesc desc_;
  std::size_t row_bytes_, row_pitch_, slice_pitch_, size_;
  std::unique_ptr<std::byte[]> data_;
};

/// What a decoder holds: blocks in probe order.
class Model {
 public:
  explicit Model(const TextureDesc& desc);
  void apply(const Texture& texture, bool keyframe, std::span<const std::uint32_t> probes);
  [[nodiscard]] const Bytes& blocks() const { return blocks_; }

 private:
  std::size_t block_bytes_;
  Bytes blocks_;
};

/// A description with at most about `max_texels` texels: every format, tiling and border, small
/// odd grids, cores of 1 to 64 with small ones more often.
TextureDesc random_desc(Random& random, std::uint32_t max_texels = 20000);
/// Ascending; empty, all, one, sparse, dense and runs.
std::vector<std::uint32_t> random_selection(Random& random, std::uint32_t probes);

[[nodiscard]] Bytes flip_bit(std::span<const std::byte> bytes, std::size_t bit);
/// The checksum at the end of a packet, computed anew.
void reseal(std::span<std::byte> packet);
/// What a decoder or encoder holds, in probe order.
[[nodiscard]] Bytes contents(const Decoder& decoder);
[[nodiscard]] Bytes contents(const Encoder& encoder);

/// The settings under which the byte backends are tested.
struct Coding {
  const char* backend;
  int level;
  bool difference;
  const char* preset = "";
};
[[nodiscard]] std::span<const Coding> codings();
[[nodiscard]] EncoderOptions options_of(const Coding& coding);

}  // namespace test
}  // namespace gicodec
