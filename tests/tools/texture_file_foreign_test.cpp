// Our DDS and KTX2 files as others read them: OpenImageIO, and ktx-parse from npm.
#include "dump/ktx2_format.h"
#include "dump/texture_file.h"
#include "tools/dump_support.h"

#include <OpenImageIO/imageio.h>
#include <gicodec/textures.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

namespace gicodec::tools {
namespace {

TEST(TextureFileForeign, KtxParseReadsEveryFormatAndShape) {
  const std::string modules = GICODEC_NODE_MODULES;
  if (!std::filesystem::exists(modules + "/ktx-parse") ||
      std::system("node --version >/dev/null")) {
    GTEST_SKIP() << "node or ktx-parse is missing; script/bootstrap ktx2 installs them";
  }
  const TemporaryDirectory directory;
  nlohmann::json manifest;
  std::vector<std::pair<std::string, Dump>> dumps;
  for (const FormatInfo& format : formats()) {
    for (const auto& [records, block] : {std::pair(Grid{13, 7, 1}, BlockShape{8, 8, 1}),
                                         {{5, 3, 4}, {8, 8, 1}},
                                         {{5, 9, 7}, {4, 4, 4}}}) {
      const TextureDesc desc = map_texture(format.record, records, block);
      const Dump dump{make_info(desc), random_texels(desc, records.z)};
      const std::string name = fmt::format("{}-{}", format.name, to_string(records));
      write_dump(directory.path(name + ".ktx2"), dump.info, dump.texels);
      write_bytes(directory.path(name + ".texels"), dump.texels);
      const Grid texels = texels_of(desc);
      const bool volume = is_volume(desc);
      manifest.push_back(
          {{"name", name},
           {"format", static_cast<std::uint32_t>(format.record.format)},
           {"typeSize", ktx2_type_size(format.record)},
           {"bytes", format.record.bytes},
           {"size",
            {texels.x, texels.y, volume ? texels.z : 0, volume || texels.z == 1 ? 0 : texels.z}},
           {"keys",
            {{"gicodec:vkFormat", fmt::format("VK_FORMAT_{}", format.name)},
             {"gicodec:extent", fmt::format("{} {} {}", records.x, records.y, records.z)}}}});
      dumps.emplace_back(name, dump);
    }
  }
  const std::string text = manifest.dump();
  write_bytes(directory.path("manifest.json"), std::as_bytes(std::span(text)));
  const std::string command =
      fmt::format("node '{}' '{}' '{}'", GICODEC_KTX2_FOREIGN, modules, directory.path(""));
  ASSERT_EQ(std::system(command.c_str()), 0);
  // And what it writes is read here.
  for (const auto& [name, dump] : dumps) {
    const Dump back = read_dump(directory.path(name + ".again.ktx2"));
    EXPECT_EQ(back.info.desc, dump.info.desc) << name;
    EXPECT_EQ(back.texels, dump.texels) << name;
  }
}

/// All samples of 8 bits or halves, as OpenImageIO has them.
std::vector<std::byte> samples_of(const std::string& path, const Grid& texels,
                                  OIIO::TypeDesc type) {
  const auto in = OIIO::ImageInput::open(path);
  if (in == nullptr) {
    ADD_FAILURE() << OIIO::geterror();
    return {};
  }
  const OIIO::ImageSpec& spec = in->spec();
  EXPECT_EQ(spec.width, static_cast<int>(texels.x));
  EXPECT_EQ(spec.height, static_cast<int>(texels.y));
  EXPECT_EQ(spec.format, type);
  std::vector<std::byte> samples(spec.image_bytes());
  EXPECT_TRUE(in->read_image(0, 0, 0, -1, type, samples.data())) << in->geterror();
  return samples;
}

// It reads no others with the header of DX10: each block is where it is to be.
TEST(TextureFileForeign, OpenImageIoReadsCompressedBlocks) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.dds"), single = directory.path("y.dds");
  for (const auto& [format, type] : {std::pair(Format::BC6H_UFLOAT_BLOCK, OIIO::TypeDesc::HALF),
                                     std::pair(Format::BC6H_SFLOAT_BLOCK, OIIO::TypeDesc::HALF),
                                     std::pair(Format::BC7_UNORM_BLOCK, OIIO::TypeDesc::UINT8)}) {
    const TextureDesc desc = map_texture(format, {3, 2, 1}, {8, 8, 1});
    const TextureDesc block = map_texture(format, {1, 1, 1}, {8, 8, 1});
    const Dump dump = random_dump(desc, 1);
    write_dump(path, dump.info, dump.texels, Existing::replace);
    const auto all = samples_of(path, {12, 8, 1}, type);
    for (std::size_t i = 0; i < 6; ++i) {
      write_dump(single, make_info(block), std::span(dump.texels).subspan(16 * i, 16),
                 Existing::replace);
      const auto own = samples_of(single, {4, 4, 1}, type);
      ASSERT_EQ(6 * own.size(), all.size());
      const std::size_t row = own.size() / 4;
      for (std::size_t y = 0; y < 4; ++y) {
        const auto* at = &all[((i / 3 * 4 + y) * 3 + i % 3) * row];
        EXPECT_TRUE(std::equal(at, at + row, &own[y * row])) << i << " " << y;
      }
    }
  }
}

// Headers of before DX10, which come back as they are.
TEST(TextureFileForeign, OpenImageIoReadsMasks) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.dds");
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {5, 3, 1}, {8, 8, 1});
  Dump dump = random_dump(desc, 1);
  std::vector<std::byte> header = dds_head({desc, {}, {}, {}, {}}, path);
  header.resize(128);
  const std::array<std::uint32_t, 7> masks = {0x41, 0, 32, 0xFF, 0xFF00, 0xFF0000, 0xFF000000};
  for (std::size_t i = 0; i < masks.size(); ++i) set_word(header, 80 + 4 * i, masks[i]);
  dump.info.attributes = {bytes_attribute(kDdsHeader, header)};
  write_dump(path, dump.info, dump.texels);
  EXPECT_EQ(samples_of(path, {5, 3, 1}, OIIO::TypeDesc::UINT8), dump.texels);
  const Dump back = read_dump(path);
  EXPECT_EQ(back.texels, dump.texels);
  EXPECT_EQ(back.info.attributes, dump.info.attributes);
}

TEST(TextureFileForeign, HeadersBeforeDx10) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.dds");
  const auto read = [&](const TextureDesc& desc, const std::array<std::uint32_t, 7>& pixels) {
    std::vector<std::byte> file =
        dds_head({map_texture(Format::R32_UINT, {8, 4, 1}, {8, 8, 1}), {}, {}, {}, {}}, path);
    file.resize(128);
    for (std::size_t i = 0; i < pixels.size(); ++i) set_word(file, 80 + 4 * i, pixels[i]);
    const auto texels = random_texels(desc, 1);
    file.insert(file.end(), texels.begin(), texels.end());
    write_bytes(path, file);
    const auto error = read_error(path);
    if (error) return std::string(error->what());
    const Dump back = read_dump(path);
    EXPECT_EQ(back.info.desc, desc);
    write_dump(path, back.info, back.texels, Existing::replace);
    EXPECT_EQ(file_bytes(path), file);
    return std::string();
  };
  const auto of = [](Format format) { return map_texture(format, {8, 4, 1}, {8, 8, 1}); };
  EXPECT_EQ(read(of(Format::A2B10G10R10_UNORM_PACK32),
                 {0x41, 0, 32, 0x3FF, 0xFFC00, 0x3FF00000, 0xC0000000}),
            "");
  EXPECT_EQ(read(of(Format::A2R10G10B10_UNORM_PACK32),
                 {0x41, 0, 32, 0x3FF00000, 0xFFC00, 0x3FF, 0xC0000000}),
            "");
  std::string why = read(of(Format::R32_UINT), {0x41, 0, 32, 0x7FF, 0x3FF800, 0xFFC00000, 0});
  EXPECT_NE(why.find("32 bits with masks R 0x7FF, G 0x3FF800, B 0xFFC00000, A 0x0"),
            std::string::npos)
      << why;
  EXPECT_NE(why.find("--vk-format"), std::string::npos) << why;
  // DXT1: 8 bytes for 4x4 texels, as of no format here.
  why = read(map_texture(Format::R32_UINT, {4, 1, 1}, {8, 8, 1}), {0x4, 0x31545844, 0, 0, 0, 0, 0});
  EXPECT_NE(why.find("D3D format 0x31545844 (DXT1)"), std::string::npos) << why;
  EXPECT_EQ(why.find("--vk-format"), std::string::npos) << why;
}

}  // namespace
}  // namespace gicodec::tools
