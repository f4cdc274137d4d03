#include "dump/cure.h"
#include "dump/error.h"
#include "dump/exr_memory.h"
#include "dump/exr_types.h"
#include "dump/file.h"
#include "dump/internal.h"
#include "dump/memory_reserve.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

namespace gicodec::tools {
namespace {

using Imath::V2i;

class MemoryFile final : public Imf::OStream {
 public:
  explicit MemoryFile(const char* name) : OStream(name) {}
  void write(const char bytes[], int size) override {
    const std::size_t end = position_ + static_cast<std::size_t>(size);
    try {
      if (end > bytes_.size()) bytes_.resize(end);
    } catch (const std::bad_alloc&) {
      lacks_ = true;  // OpenEXR drops the exception where it closes a file
      throw;
    }
    std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(size));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  [[nodiscard]] std::vector<std::byte> take() {
    if (lacks_) throw std::bad_alloc();
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t position_ = 0;
  bool lacks_ = false;  ///< something that was to be written
};

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
  const std::size_t bytes = sample_bytes(type);
  const std::size_t count = texels.size() / texel_bytes;
  std::vector<char> samples(count * bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* texel = &texels[i * texel_bytes];
    const std::uint32_t code = load_component(texel, texel_bytes, component);
    const std::uint32_t sample =
        info.channels.exponent
            ? to_sample(type, component, code)
            : shared_exponent_sample(
                  type, code, load_component(texel, texel_bytes, info.desc.record.components[3]));
    std::memcpy(&samples[i * bytes], &sample, bytes);
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

namespace {

/// A part of a file: its header, and its images level by level.
struct Part {
  Imf::Header header;
  std::span<const Dump> images;
  bool tiled = false;
};

/// Two whole numbers of an attribute, from `least` to `most`.
V2i v2i_of(const Attributes& attributes, const char* name, int least, int most,
           const V2i& otherwise) {
  if (find_attribute(attributes, name) == nullptr) return otherwise;
  const auto values = find_floats(attributes, name, 2);
  const auto fits = [&](float value) {
    return value >= static_cast<float>(least) && value <= static_cast<float>(most);
  };
  if (!values || !fits((*values)[0]) || !fits((*values)[1])) {
    throw std::invalid_argument(
        fmt::format("attribute {} is no pair of numbers from {} to {}", name, least, most));
  }
  return {static_cast<int>((*values)[0]), static_cast<int>((*values)[1])};
}

/// Where a part's data window begins.
V2i origin_of(const DumpInfo& info) {
  return v2i_of(info.attributes, kExrOrigin, -kMaxExrOrigin, kMaxExrOrigin, {0, 0});
}

V2i sampling_of(const DumpInfo& info) {
  return v2i_of(info.attributes, kExrSampling, 1, static_cast<int>(kMaxExrSampling), {1, 1});
}

bool is_linear(const Attributes& attributes, const std::string& channel) {
  const Attribute* const lines = find_attribute(attributes, kExrLinear);
  return lines != nullptr &&
         ("\n" + lines->value + "\n").find("\n" + channel + "\n") != std::string::npos;
}

Part part_of(std::span<const Dump> images, const std::string& path) {
  const DumpInfo& first = images.front().info;
  const Extent size = image_extent(first.desc);
  const V2i sampling = sampling_of(first), origin = origin_of(first);
  const std::int64_t width = std::int64_t{sampling.x} * static_cast<std::int64_t>(size.width),
                     height = std::int64_t{sampling.y} * static_cast<std::int64_t>(size.height);
  if (width > kMaxImageSide || height > kMaxImageSide) {
    throw std::invalid_argument(fmt::format("{}x{} texels are too many", width, height));
  }
  Part part{Imf::Header(static_cast<int>(width), static_cast<int>(height)), images};
  part.header.dataWindow().min += origin;
  part.header.dataWindow().max += origin;
  set_attributes(part.header, first.attributes, path);
  part.tiled = part.header.hasTileDescription();
  if (!keeps_every_bit(part.header.compression())) {
    part.header.compression() = Imf::ZIP_COMPRESSION;
  }
  for (const Dump& image : images) {
    if (image.info.place.level > 0) continue;
    const Record& record = image.info.desc.record;
    const V2i steps = sampling_of(image.info);
    for (std::size_t i = 0; i < record.count; ++i) {
      if (!has_channel(image.info.channels, record.components[i])) {
        if (letter(record.components[i]) == 'A') {
          require_zero_alpha(image.info, image.texels, record.components[i], path);
        }
        continue;
      }
      const std::string name = channel_name(image.info.channels, record.format, i);
      if (part.header.channels().findChannel(name_of_text(name)) != nullptr) {
        fail(Exit::bad_input, "{}: two of its images have a channel {}; {}", path, name,
             to_cure(Cure::raw_files));
      }
      part.header.channels().insert(name_of_text(name),
                                    Imf::Channel(pixel_type(image.info.channels.types[i]), steps.x,
                                                 steps.y, is_linear(first.attributes, name)));
    }
  }
  return part;
}

/// Throws unless an image has as many samples as its channels have in the window.
void require_samples(const DumpInfo& info, const Imath::Box2i& window, const V2i& steps,
                     std::uint32_t level) {
  const Extent size = image_extent(info.desc);
  if (exr_samples(window.min.x, window.max.x, steps.x) == static_cast<std::int64_t>(size.width) &&
      exr_samples(window.min.y, window.max.y, steps.y) == static_cast<std::int64_t>(size.height)) {
    return;
  }
  throw std::invalid_argument(
      fmt::format("{} has another size than level {} of its part", image_words(info), level));
}

/// The samples of a level's images, and where they are.
Imf::FrameBuffer frame_buffer(const Part& part, std::uint32_t level, const Imath::Box2i& window,
                              std::vector<std::vector<char>>& planes) {
  Imf::FrameBuffer source;
  for (const Dump& image : part.images) {
    const DumpInfo& info = image.info;
    if (info.place.level != level) continue;
    const Record& record = info.desc.record;
    const std::size_t width = image_extent(info.desc).width;
    const V2i steps = sampling_of(info);
    require_samples(info, window, steps, level);
    for (std::size_t i = 0; i < record.count; ++i) {
      if (!has_channel(info.channels, record.components[i])) continue;
      const SampleType type = info.channels.types[i];
      const std::size_t bytes = type == SampleType::half ? 2 : 4;
      planes.push_back(channel_samples(info, image.texels, i));
      source.insert(name_of_text(channel_name(info.channels, record.format, i)),
                    Imf::Slice::Make(pixel_type(type), planes.back().data(), window, bytes,
                                     bytes * width, steps.x, steps.y));
    }
  }
  return source;
}

/// `file`: an OutputFile or OutputPart.
template <typename File>
void write_lines(File& file, const Part& part) {
  for (const Dump& image : part.images) {
    if (image.info.place.level > 0) throw std::invalid_argument("only tiles have levels");
  }
  const Imath::Box2i window = part.header.dataWindow();
  std::vector<std::vector<char>> planes;
  file.setFrameBuffer(frame_buffer(part, 0, window, planes));
  file.writePixels(window.max.y - window.min.y + 1);
}

/// `file`: a TiledOutputFile or TiledOutputPart.
template <typename File>
void write_tiles(File& file, const Part& part, const std::string& path) {
  const int levels = part.header.tileDescription().mode == Imf::ONE_LEVEL ? 1 : file.numLevels();
  std::size_t images = 0;
  for (const Dump& image : part.images) images += image.info.place.level == 0;
  if (part.images.size() != images * static_cast<std::size_t>(levels)) {
    fail(Exit::bad_input, "{}: its tiles have {} levels, and there are {} images", path, levels,
         part.images.size());
  }
  for (int level = 0; level < levels; ++level) {
    std::vector<std::vector<char>> planes;
    const Imath::Box2i window = file.dataWindowForLevel(level);
    file.setFrameBuffer(frame_buffer(part, static_cast<std::uint32_t>(level), window, planes));
    file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  }
}

/// The parts, each of the images that follow one another with its number.
std::vector<Part> parts_of(std::span<const Dump> images, const std::string& path) {
  std::vector<Part> parts;
  while (!images.empty()) {
    const std::uint32_t number = images.front().info.place.part;
    const auto end = std::ranges::find_if(
        images, [&](const Dump& image) { return image.info.place.part != number; });
    const auto count = static_cast<std::size_t>(end - images.begin());
    parts.push_back(part_of(images.first(count), path));
    images = images.subspan(count);
  }
  return parts;
}

void write_parts(MemoryFile& memory, std::vector<Part>& parts, const std::string& path) {
  if (parts.size() == 1) {
    if (parts[0].tiled) {
      Imf::TiledOutputFile file(memory, parts[0].header, 0);
      return write_tiles(file, parts[0], path);
    }
    Imf::OutputFile file(memory, parts[0].header, 0);
    return write_lines(file, parts[0]);
  }
  std::vector<Imf::Header> headers;
  for (Part& part : parts) {
    part.header.setType(part.tiled ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    headers.push_back(part.header);
  }
  Imf::MultiPartOutputFile file(memory, headers.data(), static_cast<int>(headers.size()), false, 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].tiled) {
      Imf::TiledOutputPart tiles(file, static_cast<int>(i));
      write_tiles(tiles, parts[i], path);
    } else {
      Imf::OutputPart lines(file, static_cast<int>(i));
      write_lines(lines, parts[i]);
    }
  }
}

/// Throws if chunks are missing: OpenEXR loses some errors of its compressors.
void require_chunks(std::span<const std::byte> bytes, std::size_t parts) {
  MemoryIn in({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  Imf::MultiPartInputFile file(in, 0);
  for (std::size_t part = 0; part < parts; ++part) {
    if (!file.partComplete(static_cast<int>(part))) throw std::bad_alloc();
  }
}

}  // namespace

std::vector<std::byte> to_exr(std::span<const Dump> images, const std::string& path_for_messages) {
  const std::string& path = path_for_messages;
  for (const Dump& image : images) check_texels(image.info, image.texels, path);
  try {
    std::vector<Part> parts = parts_of(images, path);
    MemoryFile memory(path.c_str());
    write_parts(memory, parts, path);
    std::vector<std::byte> bytes = memory.take();
    require_chunks(bytes, parts.size());
    return bytes;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  } catch (const std::exception& error) {
    if (memory_ran_out()) fail(Exit::internal, "{}: not enough memory", path);
    fail(Exit::bad_input, "{}: cannot be written as EXR: {}", path, error.what());
  }
}

}  // namespace gicodec::tools
