#include "dump/error.h"
#include "dump/file.h"
#include "dump/internal.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cstring>
#include <exception>
#include <new>

namespace gicodec::tools {
namespace {

class MemoryFile final : public Imf::OStream {
 public:
  explicit MemoryFile(const char* name) : OStream(name) {}
  void write(const char bytes[], int size) override {
    const std::size_t end = position_ + static_cast<std::size_t>(size);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(size));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  std::size_t position_ = 0;
};

Imf::PixelType pixel_type(SampleType type) {
  return type == SampleType::uint32 ? Imf::UINT : type == SampleType::half ? Imf::HALF : Imf::FLOAT;
}

bool keeps_every_bit(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
    case Imf::PIZ_COMPRESSION:
      return true;
    default:
      return false;
  }
}

std::vector<char> channel_samples(const DumpInfo& info, std::span<const std::byte> texels,
                                  std::size_t index) {
  const std::size_t texel_bytes = info.desc.record.bytes;
  const Component& component = info.desc.record.components[index];
  const SampleType type = info.channels.types[index];
  const std::size_t sample_bytes = type == SampleType::half ? 2 : 4;
  const std::size_t count = texels.size() / texel_bytes;
  std::vector<char> samples(count * sample_bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* texel = &texels[i * texel_bytes];
    const std::uint32_t code = load_component(texel, texel_bytes, component);
    const std::uint32_t sample =
        info.channels.exponent
            ? to_sample(type, component, code)
            : shared_exponent_sample(
                  type, code, load_component(texel, texel_bytes, info.desc.record.components[3]));
    std::memcpy(&samples[i * sample_bytes], &sample, sample_bytes);
  }
  return samples;
}

void require_zero_alpha(const DumpInfo& info, std::span<const std::byte> texels,
                        const Component& alpha, const std::string& path) {
  const std::size_t texel_bytes = info.desc.record.bytes;
  const std::uint64_t width = image_extent(info.desc).width;
  for (std::size_t i = 0; i < texels.size() / texel_bytes; ++i) {
    if (load_component(&texels[i * texel_bytes], texel_bytes, alpha) == 0) continue;
    fail(Exit::bad_input, "{}: {} has an alpha that is not 0, but the dump has no channel A", path,
         to_string(locate(info.desc, static_cast<std::uint32_t>(i % width),
                          static_cast<std::uint32_t>(i / width))));
  }
}

}  // namespace

std::vector<std::byte> to_exr(const DumpInfo& info, std::span<const std::byte> texels,
                              const std::string& path_for_messages) {
  const std::string& path = path_for_messages;
  check_texels(info, texels, path);
  try {
    const Extent size = image_extent(info.desc);
    Imf::Header header(static_cast<int>(size.width), static_cast<int>(size.height));
    set_attributes(header, info.attributes, path);
    if (!keeps_every_bit(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;

    Imf::FrameBuffer source;
    std::vector<std::vector<char>> planes;
    const Record& record = info.desc.record;
    for (std::size_t i = 0; i < record.count; ++i) {
      const Component& component = record.components[i];
      const SampleType type = info.channels.types[i];
      if (!has_channel(info.channels, component)) {
        if (letter(component) == 'A') require_zero_alpha(info, texels, component, path);
        continue;
      }
      const std::string name = channel_name(info.channels, info.desc.record.format, i);
      const std::size_t sample_bytes = type == SampleType::half ? 2 : 4;
      header.channels().insert(name, Imf::Channel(pixel_type(type)));
      planes.push_back(channel_samples(info, texels, i));
      source.insert(name, Imf::Slice(pixel_type(type), planes.back().data(), sample_bytes,
                                     sample_bytes * size.width));
    }
    MemoryFile memory(path.c_str());
    {
      Imf::OutputFile file(memory, header, 0);
      file.setFrameBuffer(source);
      file.writePixels(static_cast<int>(size.height));
    }
    return memory.take();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  } catch (const std::exception& error) {
    fail(Exit::bad_input, "{}: cannot be written as EXR: {}", path, error.what());
  }
}

}  // namespace gicodec::tools
