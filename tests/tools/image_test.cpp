// Dumps in PNG, TIFF and DPX: read where no bit is lost, refused elsewhere.
#include "dump/image.h"

#include "dump/dump.h"
#include "sanitizers.h"
#include "tools/dump_support.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string_view>

namespace gicodec::tools {
namespace {

const TextureDesc kColour =
    probe_texture(Format::A2R10G10B10_UNORM_PACK32, {8, 4, 8}, 6, 1, Tiling::atlas_xy_z);

Hints colour_hints() {
  Hints hints;
  hints.grid = kColour.grid;
  hints.format = kColour.record.format;
  return hints;
}

void write_image(const std::string& path, const Extent& size, int channels, OIIO::TypeDesc type,
                 const void* samples, int bits = 0) {
  OIIO::ImageSpec spec(static_cast<int>(size.width), static_cast<int>(size.height), channels, type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("oiio:ColorSpace", "Linear");
  if (bits > 0) spec.attribute("oiio:BitsPerSample", bits);
  const auto output = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(output && output->open(path, spec)) << OIIO::geterror();
  ASSERT_TRUE(output->write_image(type, samples)) << output->geterror();
  ASSERT_TRUE(output->close());
}

/// Codes as 16-bit samples, by rounding or by repeating bits.
std::vector<std::uint16_t> samples_of(const Dump& dump, std::size_t channels, bool rounded) {
  const FormatInfo& format = *find_format(dump.info.desc.record.format);
  std::vector<std::uint16_t> samples;
  for (std::size_t at = 0; at < dump.texels.size(); at += format.record.bytes) {
    for (std::size_t i = 0; i < channels; ++i) {
      const Component& component = format.record.components[i];
      const auto code = load_component(&dump.texels[at], format.record.bytes, component);
      std::uint32_t sample = code * 0x5555U;
      if (component.bits == 10) {
        sample = rounded ? (code * 65535U + 511) / 1023 : code << 6 | code >> 4;
      }
      samples.push_back(static_cast<std::uint16_t>(sample));
    }
  }
  return samples;
}

/// OpenImageIO's PNG reader leaks its message about a file that ends too early.
std::optional<Error> read_without_leak_check(const std::string& path) {
  const test::LeakAllowed not_looked_for;
  return read_error(path, colour_hints());
}

TEST(Image, SixteenBitColour) {
  const TemporaryDirectory directory;
  for (const char* name : {"color.0000.png", "color.0000.tif"}) {
    for (const bool rounded : {false, true}) {
      const std::string path = directory.path(name);
      const Dump opaque = without_alpha(random_dump(kColour, 3));
      write_image(path, image_extent(kColour), 3, OIIO::TypeDesc::UINT16,
                  samples_of(opaque, 3, rounded).data());
      EXPECT_EQ(read_dump(path, colour_hints()).texels, opaque.texels) << name;

      const Dump alpha = random_dump(kColour, 4);
      write_image(path, image_extent(kColour), 4, OIIO::TypeDesc::UINT16,
                  samples_of(alpha, 4, rounded).data());
      const Dump back = read_dump(path, colour_hints());
      EXPECT_EQ(back.texels, alpha.texels) << name;
      EXPECT_EQ(back.info.desc, kColour);
      EXPECT_TRUE(back.info.channels.alpha);
    }
  }
}

// Behind a chunk of one byte.
TEST(Image, FramesOfAnAnimatedPngAreCounted) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("a.png");
  write_image(path, image_extent(kColour), 3, OIIO::TypeDesc::UINT16,
              samples_of(random_dump(kColour, 1), 3, false).data());
  auto bytes = file_bytes(path);
  constexpr std::string_view kChunks(
      "\0\0\0\1sRGB\0\xAE\xCE\x1C\xE9\0\0\0\x08"
      "acTL\0\0\0\3\0\0\0\0\0\0\0\0",
      33);
  const auto chunks = std::as_bytes(std::span(kChunks));
  bytes.insert(bytes.begin() + 33, chunks.begin(), chunks.end());  // behind IHDR
  write_bytes(path, bytes);
  const auto lost = read_dump_info(path, colour_hints()).lost;
  EXPECT_NE(std::ranges::find(lost, "2 more of its frames"), lost.end());
}

TEST(Image, TenBitDpx) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("color.0000.dpx");
  const Dump dump = without_alpha(random_dump(kColour, 5));
  write_image(path, image_extent(kColour), 3, OIIO::TypeDesc::UINT16,
              samples_of(dump, 3, false).data(), 10);
  EXPECT_EQ(read_dump(path, colour_hints()).texels, dump.texels);

  // Data of the user that the file does not have.
  auto bytes = file_bytes(path);
  for (std::size_t at = 32; at < 36; ++at) bytes[at] = std::byte{0x80};
  write_bytes(path, bytes);
  EXPECT_THROW((void)read_dump(path, colour_hints()), Error);
}

TEST(Image, FloatingPointTiff) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("vis.0000.tif");
  const TextureDesc desc =
      probe_texture(Format::R32G32B32A32_SFLOAT, {2, 2, 2}, 6, 1, Tiling::atlas_xy_z);
  const Dump dump = random_dump(desc, 6);
  write_image(path, image_extent(desc), 4, OIIO::TypeDesc::FLOAT, dump.texels.data());
  Hints hints = hints_of(desc);
  EXPECT_EQ(read_dump(path, hints).texels, dump.texels);
}

TEST(Image, SamplesThatAreNoCode) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("color.0000.png");
  auto samples = samples_of(without_alpha(random_dump(kColour, 3)), 3, true);
  const std::size_t at = 3 * (9 * image_extent(kColour).width + 20) + 1;
  samples[at] = 0x1234;
  write_image(path, image_extent(kColour), 3, OIIO::TypeDesc::UINT16, samples.data());
  const auto error = read_error(path, colour_hints());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), Exit::bad_input);
  EXPECT_NE(std::string(error->what()).find("channel G, texel (20, 9)"), std::string::npos)
      << error->what();
}

TEST(Image, TooFewBits) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("color.0000.png");
  const Extent size = image_extent(kColour);
  const std::vector<std::uint8_t> samples(std::size_t{size.width} * size.height * 3, 128);
  write_image(path, size, 3, OIIO::TypeDesc::UINT8, samples.data());
  ASSERT_TRUE(read_error(path, colour_hints()));

  // Integers are no floating-point patterns.
  const std::string vis = directory.path("vis.0000.tif");
  const std::vector<std::uint16_t> words(std::size_t{size.width} * size.height * 4);
  write_image(vis, size, 4, OIIO::TypeDesc::UINT16, words.data());
  Hints hints = colour_hints();
  hints.format = Format::R16G16B16A16_SFLOAT;
  const auto error = read_error(vis, hints);
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("integer samples"), std::string::npos);
}

TEST(Image, DamagedFiles) {
  const TemporaryDirectory directory;
  for (const char* name : {"c.0000.png", "c.0000.tif", "c.0000.dpx"}) {
    const std::string path = directory.path(name);
    const Dump dump = without_alpha(random_dump(kColour, 5));
    write_image(path, image_extent(kColour), 3, OIIO::TypeDesc::UINT16,
                samples_of(dump, 3, false).data(), name[7] == 'd' ? 10 : 16);
    const auto bytes = file_bytes(path);
    for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 40 + 1) {
      write_bytes(path, std::span(bytes).first(size));
      const auto error = read_without_leak_check(path);
      ASSERT_TRUE(error) << name << " cut to " << size << " of " << bytes.size();
      EXPECT_EQ(error->code(), Exit::bad_input) << error->what();
    }
  }
}

// Whole images of one kind under the names of others: only the parser that the name asks for sees
// them, though OpenImageIO knows what they are.
TEST(Image, OtherKindsUnderTheName) {
  const TemporaryDirectory directory;
  const auto samples = samples_of(without_alpha(random_dump(kColour, 5)), 3, false);
  for (const char* kind : {"png", "tif", "dpx", "exr", "jpg", "bmp", "tga", "ppm", "hdr", "sgi"}) {
    const std::string whole = directory.path(fmt::format("whole.{}", kind));
    write_image(whole, image_extent(kColour), 3, OIIO::TypeDesc::UINT16, samples.data());
    for (const char* name : {"png", "tif", "tiff", "dpx", "exr", ""}) {
      if (std::string_view(name).starts_with(kind)) continue;
      const std::string path = directory.path(*name == 0 ? "c" : fmt::format("c.{}", name));
      std::filesystem::copy_file(whole, path, std::filesystem::copy_options::overwrite_existing);
      if (*name == 0 && std::string_view(kind) == "exr") continue;  // What no ending stands for.
      const auto error = read_without_leak_check(path);
      ASSERT_TRUE(error) << kind << " named " << name;
      EXPECT_EQ(error->code(), Exit::bad_input);
      const bool image = *name != 0 && std::string_view(name) != "exr";
      EXPECT_EQ(std::string(error->what()).find("rename it") != std::string::npos, image)
          << error->what();
    }
  }
}

TEST(Image, PicturesArePng) {
  const TemporaryDirectory directory;
  const std::vector<std::uint8_t> pixels = {255, 0, 0, 0, 255, 0, 1, 2, 3, 4, 5, 6};
  write_png(directory.path("x.png"), 2, 2, 3, pixels);
  const auto input = OIIO::ImageInput::open(directory.path("x.png"));
  ASSERT_TRUE(input);
  std::vector<std::uint8_t> back(pixels.size());
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, back.data()));
  EXPECT_EQ(back, pixels);
}

}  // namespace
}  // namespace gicodec::tools
