#include "modules/images.h"

#include "modules/module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace gicodec::tools {
namespace {

StoredSamples samples_of(const OIIO::ImageSpec& spec) {
  if (spec.format == OIIO::TypeDesc::UINT8) return StoredSamples::uint8;
  if (spec.format == OIIO::TypeDesc::UINT16) return StoredSamples::uint16;
  if (spec.format == OIIO::TypeDesc::HALF) return StoredSamples::half;
  if (spec.format == OIIO::TypeDesc::FLOAT) return StoredSamples::float32;
  return StoredSamples::other;
}

class Reader final : public ImageReader {
 public:
  explicit Reader(std::unique_ptr<OIIO::ImageInput> input, const OIIO::ImageSpec& spec)
      : input_(std::move(input)), type_(spec.format) {
    head.width = spec.width;
    head.height = spec.height;
    head.depth = spec.depth;
    head.channels.assign(spec.channelnames.begin(), spec.channelnames.end());
    head.samples = samples_of(spec);
    head.type_name = spec.format.c_str();
    head.bits =
        spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(spec.format.size()) * 8);
    head.mixed = !spec.channelformats.empty();
    head.deep = spec.deep;
    head.colour_space = std::string(spec.get_string_attribute("oiio:ColorSpace"));
    head.bytes = spec.image_bytes();
  }

  std::string read(std::span<std::byte> samples) override {
    if (input_->read_image(0, 0, 0, -1, type_, samples.data())) return {};
    return "cannot be read: " + input_->geterror();
  }

 private:
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::TypeDesc type_;
};

/// How many there are from the first on.
template <typename Seek>
int count(Seek&& seek) {
  constexpr int kMax = 1000;
  int found = 1;
  while (found < kMax && seek(found)) ++found;
  return found;
}

std::unique_ptr<ImageReader> open(const char* kind, const std::string& path, std::string& why) {
  OIIO::ImageSpec config, spec;
  config.attribute("oiio:UnassociatedAlpha", 1);  // else colour is multiplied by alpha
  config.attribute("dpx:RawColor", 1);
  auto input = OIIO::ImageInput::create(kind);
  if (!input) {
    why = OIIO::geterror();
    return nullptr;
  }
  if (!input->open(path, spec, config)) {
    why = input->geterror();
    return nullptr;
  }
  const int pages = count([&](int page) { return input->seek_subimage(page, 0); }),
            levels = count([&](int level) { return input->seek_subimage(0, level); });
  if (!input->seek_subimage(0, 0)) {
    why = input->geterror();
    return nullptr;
  }
  (void)input->geterror();  // of counting
  auto reader = std::make_unique<Reader>(std::move(input), spec);
  reader->head.pages = pages;
  reader->head.levels = levels;
  return reader;
}

std::string encode_png(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                       std::span<const std::uint8_t> pixels, std::vector<unsigned char>& bytes) {
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create("png", &memory);
  if (!output) return OIIO::geterror();
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height),
                       static_cast<int>(channels), OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  const bool written = output->open("memory.png", spec) &&
                       output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) && output->close();
  return written ? std::string() : output->geterror();
}

}  // namespace

extern "C" GICODEC_MODULE_EXPORT const ImageModule gicodec_module;
const ImageModule gicodec_module{{"gicodec-images"}, open, encode_png};

}  // namespace gicodec::tools
