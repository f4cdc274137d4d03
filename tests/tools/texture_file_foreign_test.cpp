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

/// A file for ktx-parse: its images, and what of it follows from them.
struct Sent {
  std::string name;
  std::vector<Dump> images;
  TextureHead head;
};

/// All images of a texture; `packed`: by ZLIB.
Sent texture_of(const std::string& name, Format format, const TextureHead& head, bool packed) {
  Sent sent{name, random_images(format, head), head};
  if (packed) {
    set_attribute(sent.images[0].info.attributes, {kKtx2Scheme, "string", "ZLIB"});
  }
  // Of compressed blocks a file has full ones.
  sent.head.texels = texels_of(sent.images[0].info.desc);
  return sent;
}

/// All bytes of its levels, the largest first.
std::vector<std::byte> level_data(const Sent& sent, Format format) {
  std::vector<std::byte> all;
  for (std::uint32_t level = 0; level < sent.head.levels; ++level) {
    std::vector<std::byte> data(level_bytes(sent.head, level, format));
    for (const Dump& image : sent.images) {
      if (image.info.place.level != level) continue;
      scatter(image.texels, runs_by_level(sent.head, image.info.place, format), data);
    }
    all.insert(all.end(), data.begin(), data.end());
  }
  return all;
}

TEST(TextureFileForeign, KtxParseReadsEveryFormatAndShape) {
  const std::string modules = GICODEC_NODE_MODULES;
  if (!std::filesystem::exists(modules + "/ktx-parse") ||
      std::system("node --version >/dev/null")) {
    GTEST_SKIP() << "node or ktx-parse is missing; script/bootstrap ktx2 installs them";
  }
  const TemporaryDirectory directory;
  nlohmann::json manifest;
  std::vector<Sent> all;
  const auto send = [&](Format format, const TextureHead& head, bool packed) {
    const FormatInfo& info = *find_format(format);
    const std::string name = fmt::format("{}-{}{}{}{}", info.name, to_string(head.texels),
                                         head.levels > 1 ? "-mips" : "",
                                         head.faces > 1 ? "-cube" : "", packed ? "-packed" : "");
    const Sent sent = texture_of(name, format, head, packed);
    write_dumps(directory.path(name + ".ktx2"), sent.images);
    write_bytes(directory.path(name + ".texels"), level_data(sent, format));
    const Grid& texels = sent.head.texels;
    const Grid records = records_of(texels, format);
    const bool layers = !head.volume && texels.z > 1;
    manifest.push_back(
        {{"name", name},
         {"format", static_cast<std::uint32_t>(format)},
         {"typeSize", ktx2_type_size(info.record)},
         {"bytes", info.record.bytes},
         {"size", {texels.x, texels.y, head.volume ? texels.z : 0, layers ? texels.z : 0}},
         {"levels", head.levels},
         {"faces", head.faces},
         {"packed", packed},
         {"keys",
          {{"gicodec:vkFormat", fmt::format("VK_FORMAT_{}", info.name)},
           {"gicodec:extent", fmt::format("{} {} {}", records.x, records.y, records.z)}}}});
    all.push_back(sent);
  };
  const auto head_of = [](const Grid& texels, bool volume, std::uint32_t levels,
                          std::uint32_t faces) {
    TextureHead head;
    head.texels = texels;
    head.volume = volume;
    head.levels = levels;
    head.faces = faces;
    return head;
  };
  for (const FormatInfo& format : formats()) {
    send(format.record.format, head_of({13, 7, 1}, false, 1, 1), false);
  }
  for (const Format format : {Format::R8G8B8A8_SRGB, Format::R16G16B16_SFLOAT,
                              Format::BC1_RGBA_UNORM_BLOCK, Format::ASTC_6x5_UNORM_BLOCK}) {
    for (const bool packed : {false, true}) {
      send(format, head_of({24, 20, 1}, false, 5, 1), packed);
      send(format, head_of({30, 30, 2}, false, 3, 6), packed);
      send(format, head_of({24, 20, 3}, false, 2, 1), packed);
      send(format, head_of({24, 20, 7}, true, 3, 1), packed);
    }
  }
  const std::string text = manifest.dump();
  write_bytes(directory.path("manifest.json"), std::as_bytes(std::span(text)));
  const std::string command =
      fmt::format("node '{}' '{}' '{}'", GICODEC_KTX2_FOREIGN, modules, directory.path(""));
  ASSERT_EQ(std::system(command.c_str()), 0);
  // And what it writes is read here.
  for (const Sent& sent : all) {
    const std::vector<Dump> back = read_dumps(directory.path(sent.name + ".again.ktx2"));
    ASSERT_EQ(back.size(), sent.images.size()) << sent.name;
    for (std::size_t i = 0; i < back.size(); ++i) {
      EXPECT_EQ(back[i].info.desc, sent.images[i].info.desc) << sent.name;
      EXPECT_EQ(back[i].texels, sent.images[i].texels) << sent.name;
      EXPECT_EQ(back[i].info.image, sent.images[i].info.image) << sent.name;
    }
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
  std::vector<std::byte> header = dds_file({&dump, 1}, path);
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
    const Dump any = random_dump(map_texture(Format::R32_UINT, {8, 4, 1}, {8, 8, 1}), 1);
    std::vector<std::byte> file = dds_file({&any, 1}, path);
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
  const auto blocks = [](Format format) { return map_texture(format, {2, 1, 1}, {8, 8, 1}); };
  EXPECT_EQ(read(blocks(Format::BC1_RGBA_UNORM_BLOCK), {0x4, 0x31545844, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(read(blocks(Format::BC3_UNORM_BLOCK), {0x4, 0x35545844, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(read(blocks(Format::BC5_UNORM_BLOCK), {0x4, 0x32495441, 0, 0, 0, 0, 0}), "");
  // A code of 24 bytes for 8x4 texels, as of no format.
  why = read(map_texture(Format::R8G8B8_UNORM, {8, 1, 1}, {8, 8, 1}),
             {0x4, 0x59555932, 0, 0, 0, 0, 0});
  EXPECT_NE(why.find("D3D format 0x59555932 (2YUY)"), std::string::npos) << why;
  EXPECT_EQ(why.find("--vk-format"), std::string::npos) << why;
}

}  // namespace
}  // namespace gicodec::tools
