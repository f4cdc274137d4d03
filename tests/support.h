// Generators and textures for the tests. Buffers are exactly as large as they are said to be, so
// that AddressSanitizer sees the first byte read or written beyond.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/gicodec.h>

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

/// Whether sweeps are to try all their cases, and each case on all instruction sets and numbers of
/// threads, rather than on one after the other. That takes hours under sanitizers.
[[nodiscard]] bool everything();
/// Sweeps try one case in so many: all where everything is tried, fewer with sanitizers.
[[nodiscard]] std::size_t one_case_in();

/// The cases of a sweep that are tried: the first, and others here and there.
class Sweep {
 public:
  [[nodiscard]] bool takes();

 private:
  std::uint32_t case_ = 0;
};

/// False where `std::size_t` has 32 bits: textures that no memory can hold are invalid there.
inline constexpr bool kHoldsTheLargest = SIZE_MAX > UINT32_MAX;

/// Uniform in [low, high].
std::uint32_t pick(Random& random, std::uint32_t low, std::uint32_t high);
bool chance(Random& random, std::uint32_t one_in);
Bytes noise(Random& random, std::size_t size);
/// One of those that this machine has, the best in half of the cases: it is the fastest.
Isa any_isa(Random& random);

/// The blocks that the last packet of a decoder listed: of a keyframe those that are received.
std::vector<std::uint32_t> listed_blocks(const Decoder& decoder, std::span<const std::byte> packet);

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

[[nodiscard]] bool same(std::span<const std::byte> a, std::span<const std::byte> b);

/// How a texture is filled.
enum class Fill { zero, noise, small, special };

/// A texture in an exactly sized buffer. Whatever belongs to no record of a block (between rows and
/// slices, padding, beyond the volume's end) is filled with a pattern and poisoned under
/// AddressSanitizer.
class Texture {
 public:
  /// Further bytes between rows, slices and (Tiling::blocks) blocks.
  explicit Texture(const TextureDesc& desc, std::size_t row_padding = 0,
                   std::size_t slice_padding = 0, std::size_t block_padding = 0);
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  [[nodiscard]] const TextureDesc& desc() const { return desc_; }
  [[nodiscard]] TextureView view() {
    return {{data_.get(), size_}, row_pitch_, slice_pitch_, block_pitch_};
  }
  [[nodiscard]] ConstTextureView view() const {
    return {{data_.get(), size_}, row_pitch_, slice_pitch_, block_pitch_};
  }
  /// Record (x, y, z) of a block, counted from its guard band on.
  [[nodiscard]] std::span<std::byte> record(std::uint32_t block, std::uint32_t x, std::uint32_t y,
                                            std::uint32_t z = 0);

  /// Every block in order, row by row, what is beyond the volume as zeros: the contents whatever
  /// layout and pitch.
  [[nodiscard]] Bytes blocks() const;
  [[nodiscard]] Bytes block(std::uint32_t block) const;
  void set_block(std::uint32_t block, std::span<const std::byte> records);

  /// New records for a block; its guard band is left alone.
  void fill_block(std::uint32_t block, Fill fill, Random& random);
  /// The guard band by the rule of FORMAT.md, written down record by record.
  void fill_band(std::uint32_t block);
  /// Noise everywhere, guard bands by the rule.
  void fill(Fill fill, Random& random);
  /// Noise as well, of an eighth of the random numbers.
  void fill_fast(Random& random);

  [[nodiscard]] bool padding_untouched() const;

 private:
  template <typename Visit>
  void for_records(std::uint32_t block, Visit&& visit) const;
  void poison(bool on) const;

  TextureDesc desc_;
  std::size_t row_pitch_, slice_pitch_, block_pitch_, size_;
  std::unique_ptr<std::byte[]> data_;
  std::vector<std::uint8_t> used_;  ///< per byte: part of a record
};

/// What a decoder holds: blocks in order.
class ExpectedMirror {
 public:
  explicit ExpectedMirror(const TextureDesc& desc);
  /// `presence`: of every block of the texture.
  void apply(const Texture& texture, bool keyframe, std::span<const std::uint32_t> blocks,
             std::span<const std::byte> presence = {});
  [[nodiscard]] const Bytes& blocks() const { return blocks_; }
  [[nodiscard]] std::span<const std::byte> block(std::uint32_t block) const;
  /// Without guard bands: Decoder::records().
  [[nodiscard]] Bytes records() const;
  [[nodiscard]] const std::vector<std::uint8_t>& received() const { return received_; }

 private:
  TextureDesc desc_;
  std::size_t block_bytes_;
  Bytes blocks_;
  std::vector<std::uint8_t> received_;
};

/// Bytes of a block with its guard band.
[[nodiscard]] std::size_t guarded_bytes(const TextureDesc& desc);
/// Zeros in such a block what does not exist. For textures without guard bands.
void clear_absent_records(const TextureDesc& desc, std::span<const std::byte> presence,
                          std::span<std::byte> block);

/// Ascending; empty, all, one, sparse, dense and runs.
std::vector<std::uint32_t> random_selection(Random& random, std::uint32_t blocks);

[[nodiscard]] Bytes flip_bit(std::span<const std::byte> bytes, std::size_t bit);
/// The checksum at the end of a packet, computed anew.
void reseal(std::span<std::byte> packet);
/// What a decoder or encoder holds, in block order.
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
