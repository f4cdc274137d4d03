#include "dump/image.h"

#include "dump/error.h"
#include "dump/file.h"
#include "dump/internal.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace gicodec::tools {
namespace {

/// The code of a `bits`-bit component in a sample of `sample_bits` bits. Writers scale by rounding
/// or by repeating the code's bits; both are undone, anything else is no code.
std::optional<std::uint32_t> unscale(std::uint32_t sample, unsigned sample_bits,
                                     const Component& component) {
  const unsigned bits = component.bits;
  if (bits > sample_bits) return std::nullopt;
  const std::uint32_t code = sample >> (sample_bits - bits);
  std::uint32_t repeated = 0;
  for (int shift = static_cast<int>(sample_bits - bits); shift > -static_cast<int>(bits);
       shift -= static_cast<int>(bits)) {
    repeated |= shift >= 0 ? code << shift : code >> -shift;
  }
  const std::uint64_t max_sample = (std::uint64_t{1} << sample_bits) - 1;
  const auto rounded = static_cast<std::uint32_t>((2 * code * max_sample + max_code(component)) /
                                                  (2 * std::uint64_t{max_code(component)}));
  if (sample != repeated && sample != rounded) return std::nullopt;
  return code;
}

/// How samples lie in the buffer that OpenImageIO fills.
struct Stored {
  OIIO::TypeDesc type;
  std::size_t bytes = 0;
  SampleType as{};  ///< what the samples count as in ChannelLayout
  bool scaled = false;
};

Stored stored_type(const OIIO::ImageSpec& spec, const std::string& path) {
  if (!spec.channelformats.empty()) {
    fail(Exit::bad_input, "{}: channels of different types are not supported here; use EXR", path);
  }
  if (spec.format == OIIO::TypeDesc::UINT8) return {spec.format, 1, SampleType::uint32, true};
  if (spec.format == OIIO::TypeDesc::UINT16) return {spec.format, 2, SampleType::uint32, true};
  if (spec.format == OIIO::TypeDesc::HALF) return {spec.format, 2, SampleType::half, false};
  if (spec.format == OIIO::TypeDesc::FLOAT) return {spec.format, 4, SampleType::float32, false};
  fail(Exit::bad_input, "{}: samples of type {} are not supported", path, spec.format.c_str());
}

std::vector<FoundChannel> channels_of(const OIIO::ImageSpec& spec, SampleType type) {
  std::vector<FoundChannel> found;
  // The only channel of a grey image is the first component.
  if (spec.nchannels == 1) return {{"R", type}};
  for (const std::string& name : spec.channelnames) found.push_back({name, type});
  return found;
}

void require_plain(const OIIO::ImageInput& input, const OIIO::ImageSpec& spec,
                   const std::string& path) {
  const std::string kind = input.format_name();
  if (kind != "png" && kind != "tiff" && kind != "dpx") {
    fail(Exit::bad_input, "{}: {} images are not supported", path, kind);
  }
  if (spec.width < 1 || spec.height < 1 || spec.depth != 1 || spec.width > kMaxImageSide ||
      spec.height > kMaxImageSide || spec.nchannels < 1 || spec.nchannels > 4 ||
      spec.image_bytes() > kMaxImageBytes) {
    fail(Exit::bad_input, "{}: {}x{}x{} texels with {} channels are not supported", path,
         spec.width, spec.height, spec.depth, spec.nchannels);
  }
  if (spec.deep || spec.get_string_attribute("oiio:ColorSpace") == "KodakLog") {
    fail(Exit::bad_input, "{}: does not hold plain values", path);
  }
  // A palette is expanded and a few bits are scaled up before OpenImageIO hands them over.
  const int bits = spec.get_int_attribute("oiio:BitsPerSample", 0);
  if (kind == "tiff" && bits != 0 && bits != static_cast<int>(spec.format.size()) * 8) {
    fail(Exit::bad_input, "{}: {} bits per sample are not supported", path, bits);
  }
}

/// OpenImageIO gives zeros for what a DPX file lacks, so its size is checked against its header.
void require_complete_dpx(const OIIO::ImageSpec& spec, const std::string& path) {
  std::array<unsigned char, 20> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(head.data()), head.size());
  const bool big = head[0] == 'S';  // "SDPX", else "XPDS"
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | head[at + (big ? i : 3 - i)];
    return value;
  };
  constexpr std::uint32_t kUndefined = UINT32_MAX;
  const std::uint32_t data_offset = word(4), claimed = word(16);
  const auto bits = static_cast<std::uint64_t>(
      spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(spec.format.size()) * 8));
  const std::uint64_t least =
      data_offset + spec.image_pixels() * static_cast<std::uint64_t>(spec.nchannels) * bits / 8;
  const std::uint64_t wanted =
      claimed == kUndefined ? least : std::max<std::uint64_t>(least, claimed);
  if (!file || std::filesystem::file_size(path) < wanted) {
    fail(Exit::bad_input, "{}: is truncated", path);
  }
}

}  // namespace

Dump read_image(const std::string& path, const Hints& hints, bool texels) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fail(Exit::io, "{}: cannot be opened", path);
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // else colour is multiplied by alpha
  config.attribute("dpx:RawColor", 1);
  const auto input = OIIO::ImageInput::open(path, &config);
  if (!input) fail(Exit::bad_input, "{}: cannot be read: {}", path, OIIO::geterror());
  const OIIO::ImageSpec spec = input->spec();
  require_plain(*input, spec, path);
  if (std::string_view(input->format_name()) == "dpx") require_complete_dpx(spec, path);
  const Stored stored = stored_type(spec, path);

  Dump dump;
  const auto found = channels_of(spec, stored.as);
  resolve(dump.info, found, static_cast<std::uint32_t>(spec.width),
          static_cast<std::uint32_t>(spec.height), hints, path);
  const FormatInfo& format = *find_format(dump.info.desc.format);
  for (const Component& component : format.used()) {
    if (stored.scaled && component.kind != ComponentKind::unorm) {
      fail(Exit::bad_input, "{}: integer samples do not hold {}", path, format.name);
    }
    if (stored.scaled && component.bits > 8 * stored.bytes) {
      fail(Exit::bad_input,
           "{}: holds {} bits per channel, too few for the {} of {}; write it with 16 bits or as "
           "EXR, or keep them as --vk-format R8G8B8A8_UNORM",
           path, 8 * stored.bytes, component.bits, format.name);
    }
  }
  if (!texels) return dump;

  const std::size_t count = static_cast<std::size_t>(spec.image_pixels());
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<std::byte> samples(count * channels * stored.bytes);
  if (!input->read_image(0, 0, 0, -1, stored.type, samples.data())) {
    fail(Exit::bad_input, "{}: cannot be read: {}", path, input->geterror());
  }
  dump.texels.resize(static_cast<std::size_t>(texture_bytes(dump.info.desc)));
  for (const Component& component : format.used()) {
    const auto index = static_cast<std::size_t>(&component - format.components);
    const std::string name = channel_name(dump.info.channels, format.format, index);
    const auto at = std::find_if(found.begin(), found.end(),
                                 [&](const FoundChannel& channel) { return channel.name == name; });
    if (at == found.end()) continue;
    const auto channel = static_cast<std::size_t>(at - found.begin());
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t sample = 0;
      std::memcpy(&sample, &samples[(i * channels + channel) * stored.bytes], stored.bytes);
      const auto code = stored.scaled
                            ? unscale(sample, static_cast<unsigned>(8 * stored.bytes), component)
                            : to_code(stored.as, component, sample);
      if (!code) {
        const auto width = static_cast<std::size_t>(spec.width);
        fail_sample(dump.info, component, stored.as, sample, static_cast<std::uint32_t>(i % width),
                    static_cast<std::uint32_t>(i / width), path);
      }
      store_component(&dump.texels[i * format.texel_bytes], format.texel_bytes, component, *code);
    }
  }
  return dump;
}

void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::uint32_t channels, std::span<const std::uint8_t> pixels) {
  if (pixels.size() != std::size_t{width} * height * channels) {
    fail(Exit::internal, "{}: the picture's size does not match", path);
  }
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create("png", &memory);
  if (!output) fail(Exit::internal, "{}: cannot write PNG: {}", path, OIIO::geterror());
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height),
                       static_cast<int>(channels), OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!output->open("memory.png", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !output->close()) {
    fail(Exit::internal, "{}: cannot write PNG: {}", path, output->geterror());
  }
  write_file(path, std::as_bytes(std::span(bytes)));
}

}  // namespace gicodec::tools
