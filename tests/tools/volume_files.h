// Containers that no program writes: textures of any kind, with packets of any region.
#pragma once

#include "container_support.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/textures.h>
#include "tools/cli_support.h"
#include "tools/unknown_volume.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace gicodec::tools {

inline constexpr std::uint8_t kFutureKind = 77;

class VolumeFiles : public testing::Test {
 protected:
  /// Adds a volume of probes: a texture named `texture`, cut into regions if `region` is told.
  void add_probes(const std::string& volume, const std::string& texture, Grid region = {}) {
    const NamedTexture named{texture, kVisDesc, {}, {}};
    ASSERT_EQ(add_volume(description_, volume, *probe_volume({&named, 1})), Status::ok);
    description_.volumes.back().region = region;
  }
  void add_vectors(const std::string& volume) {
    ASSERT_EQ(add_volume(description_, volume, *irradiance_vector_volume({3, 2, 2})), Status::ok);
  }
  /// A volume of two textures whose blocks are rows of six records.
  void add_textures(const std::string& volume) {
    TextureDesc direction;
    direction.record = Format::R8G8B8_SNORM;
    direction.grid = {3, 2, 2};
    direction.block = {6, 1, 1};
    direction.layout = Tiling::blocks;
    TextureDesc color = direction;
    color.record = Format::E5B9G9R9_UFLOAT_PACK32;
    TextureGroup group;
    group.textures = {{"direction", direction, Threshold::components, Preview::direction},
                      {"color", color, Threshold::components, Preview::color}};
    ASSERT_EQ(add_volume(description_, volume, *texture_volume(std::span(&group, 1))), Status::ok);
  }
  /// A volume whose kind is not known yet, with a texture.
  void add_future(const std::string& volume) {
    test::add_unknown_volume(description_, volume, kFutureKind, {std::byte{1}, std::byte{2}});
  }

  /// The texture in a frame, in memory as `desc` says; probes that no frame changes are there.
  [[nodiscard]] static std::vector<std::byte> contents(const TextureDesc& desc, unsigned frame) {
    auto texels = random_texels(desc, desc.block.x);
    for (std::size_t i = frame * 4U; i < texels.size(); i += 997) texels[i] ^= std::byte{0x3C};
    return texels;
  }
  /// The part of the whole texture that a region holds.
  [[nodiscard]] static std::vector<std::byte> cut(const TextureDesc& whole, const Grid& size,
                                                  std::uint32_t region,
                                                  const std::vector<std::byte>& texels) {
    const TextureDesc part = region_texture(whole, size, region);
    std::vector<std::byte> out(static_cast<std::size_t>(texture_bytes(part)));
    const auto blocks = regions_of(whole, size).blocks_of(region);
    const std::size_t side = whole.block.x + 2U * whole.guard_band, bytes = whole.record.bytes;
    const auto at = [&](const TextureDesc& desc, std::uint32_t block, std::size_t row) {
      const BlockOrigin origin = block_origin(desc, block);
      return ((origin.y + row) * extent(desc).width + origin.x) * bytes;
    };
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t row = 0; row < side; ++row) {
        std::copy_n(&texels[at(whole, blocks[i], row)], side * bytes, &out[at(part, i, row)]);
      }
    }
    return out;
  }

  /// Two frames of every texture, to NAME. Packets of future kinds are packets of something.
  std::vector<std::byte> write(const std::string& name) {
    test::MemorySink sink;
    auto writer = ContainerWriter::create(sink, description_);
    EXPECT_TRUE(writer.ok()) << writer.status();
    std::map<std::uint64_t, Encoder> encoders;
    for (unsigned frame = 0; frame < 2; ++frame) {
      for (std::size_t id = 0; id < description_.textures.size(); ++id) {
        const TextureEntry& texture = description_.textures[id];
        const TextureDesc desc = is_known(texture) ? texture.desc : kColourDesc;
        const Grid& size = description_.volumes[texture.volume].region;
        const std::uint32_t regions = size.x == 0 ? 1 : regions_of(desc, size).regions();
        const auto texels = contents(desc, frame);
        for (std::uint32_t i = 0; i < regions; ++i) {
          const bool whole = size.x == 0;
          const TextureDesc part = whole ? desc : region_texture(desc, size, i);
          EncoderOptions options;
          options.backend = "zstd";
          options.texture_id = static_cast<std::uint8_t>(id);
          auto& encoder =
              encoders.try_emplace(i * 256 + id, *Encoder::create(part, options)).first->second;
          const auto own = whole ? texels : cut(desc, size, i, texels);
          const auto packet = encoder.encode(ConstTextureView(own));
          EXPECT_EQ(writer->add(frame, *packet, whole ? StreamId::kWholeVolume : i), Status::ok);
        }
      }
    }
    EXPECT_EQ(writer->finish(), Status::ok);
    write_bytes(program_.path(name), sink.bytes);
    return sink.bytes;
  }
  void expect_probes_in(const std::string& folder, const std::string& texture) const {
    for (unsigned frame = 0; frame < 2; ++frame) {
      const Dump dump =
          read_dump(program_.path(fmt::format("{}/{}.{:04}.exr", folder, texture, frame)));
      EXPECT_EQ(dump.info.desc, kVisDesc);
      EXPECT_EQ(dump.texels, contents(kVisDesc, frame)) << frame;
    }
  }
  static void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) {
      EXPECT_NE(text.find(part), std::string::npos) << text << "lacks " << part;
    }
  }

  ContainerDescription description_;
  Program program_;
};

}  // namespace gicodec::tools
