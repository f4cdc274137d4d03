// Descriptions of containers, field by field.
#pragma once

#include <gicodec/container.h>

#include <gtest/gtest.h>

namespace gicodec::test {

inline void expect_same(const ContainerDescription& a, const ContainerDescription& b) {
  EXPECT_EQ(a.epoch, b.epoch);
  EXPECT_EQ(a.scene, b.scene);
  EXPECT_EQ(a.metadata, b.metadata);
  ASSERT_EQ(a.volumes.size(), b.volumes.size());
  for (std::size_t i = 0; i < a.volumes.size(); ++i) {
    const VolumeEntry &x = a.volumes[i], &y = b.volumes[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.description, y.description);
    EXPECT_EQ(x.geometry, y.geometry);
    EXPECT_EQ(x.region, y.region);
    EXPECT_EQ(x.first_texture, y.first_texture);
    EXPECT_EQ(x.textures, y.textures);
    EXPECT_EQ(x.metadata, y.metadata);
    EXPECT_EQ(x.desc, y.desc);
  }
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    const TextureEntry &x = a.textures[i], &y = b.textures[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.desc, y.desc);
    EXPECT_EQ(x.volume, y.volume);
    EXPECT_EQ(x.largest_error, y.largest_error);
    EXPECT_EQ(x.metadata, y.metadata);
  }
}

}  // namespace gicodec::test
