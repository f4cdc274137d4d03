// Random volumes of every kind: probes, irradiance vectors, and those of a kind of the tests' own,
// whose groups are grids or pools, with presence, names and ranks. And what is published of them.
#pragma once

#include "support.h"

#include <gicodec/kind.h>
#include <gicodec/volume.h>
#include "session/server/distributor.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::test {

/// Any groups of textures of any shape. Blocks that name others have their numbers as u32; the rank
/// of a block is its first byte.
inline constexpr std::uint8_t kKindAny = 200;
extern const Kind kAny;

/// A block, guard band included, out of a texture that is tightly packed.
[[nodiscard]] Bytes block_of(const TextureDesc& desc, std::span<const std::byte> texels,
                             std::uint32_t block);

class AnyVolume {
 public:
  explicit AnyVolume(Random& random);

  [[nodiscard]] const VolumeDesc& desc() const { return desc_; }
  [[nodiscard]] const VolumeGeometry& geometry() const { return geometry_; }
  [[nodiscard]] std::span<const StreamedTexture> streamed() const { return streamed_; }
  [[nodiscard]] const TextureDesc& texture(std::uint8_t id) const { return textures_[id]->desc(); }
  [[nodiscard]] std::uint32_t blocks(std::size_t group) const;
  /// The texture that says which records of another exist; nothing if all do.
  [[nodiscard]] std::optional<std::uint8_t> presence_of(std::uint8_t id) const;

  /// Moves by some cells; returns where to.
  Scroll scroll(Random& random);
  /// Changes some of it, all of it at first, and publishes that: publish(texture, view). What has
  /// entered by scrolling changes.
  void change(Random& random, const std::function<Status(std::uint8_t, ConstTextureView)>& publish);

  /// After an update: those textures whose turn it was were sent as they are now.
  void updated(std::uint64_t update);
  /// What visible blocks of later groups name is wanted, too: one mask per group.
  [[nodiscard]] std::vector<BlockMask> wanted(std::vector<BlockMask> visible,
                                              const std::vector<BlockMask>& active) const;
  /// A block as it was published, as a receiver has it; at the last turn, if `sent`.
  [[nodiscard]] Bytes block(std::uint8_t id, std::uint32_t block, bool sent = false) const;
  /// Those of the named group that a block of a group's first texture names.
  [[nodiscard]] std::vector<std::uint32_t> dependencies(std::size_t group,
                                                        const Bytes& records) const;
  /// The first texture of a group.
  [[nodiscard]] std::uint8_t first_of(std::size_t group) const;

  /// What a receiver has of a block of a texture; nothing if it was not received.
  using Held = std::function<std::optional<Bytes>(std::uint8_t, std::uint32_t)>;
  /// Blocks that are wanted and active and not held as they are. What travels together counts once.
  [[nodiscard]] std::uint32_t missing(const std::vector<BlockMask>& visible,
                                      const std::vector<BlockMask>& active, const Held& held) const;

 private:
  void make_probes(Random& random);
  void make_any(Random& random);
  TextureGroup make_set(Random& random, std::size_t place);
  void finish(Random& random);
  void fill(Random& random, std::size_t group, std::uint8_t id,
            std::span<const std::uint32_t> blocks);

  VolumeDesc desc_;
  VolumeGeometry geometry_;
  std::vector<StreamedTexture> streamed_;
  std::vector<std::unique_ptr<Texture>> textures_;
  std::vector<std::vector<Bytes>> sent_;  ///< by texture and block
  std::vector<std::uint32_t> entered_;
  bool first_ = true;
};

}  // namespace gicodec::test
