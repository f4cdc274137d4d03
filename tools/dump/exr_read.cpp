#include "dump/cure.h"
#include "dump/error.h"
#include "dump/exr_chunks.h"
#include "dump/exr_images.h"
#include "dump/exr_types.h"
#include "dump/memory_reserve.h"

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfTiledInputPart.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <new>

namespace gicodec::tools {
namespace {

/// Adds one channel's codes to the texels.
void add_channel(Dump& dump, std::size_t index, const char* sample, const std::string& path) {
  const Record& record = dump.info.desc.record;
  const Component& component = record.components[index];
  const SampleType type = dump.info.channels.types[index];
  const Extent size = image_extent(dump.info.desc);
  std::byte* texel = dump.texels.data();
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, sample, sample_bytes(type));
      const auto code = to_code(type, component, bits);
      if (!code) fail_sample(dump.info, component, type, bits, x, y, path);
      store_component(texel, record.bytes, component, *code);
      sample += sample_bytes(type);
      texel += record.bytes;
    }
  }
}

/// Codes the values of channels R, G and B as texels with a shared exponent.
void add_values(Dump& dump, const std::vector<std::vector<char>>& planes, const std::string& path) {
  const Record& record = dump.info.desc.record;
  const auto& all = dump.info.channels.types;
  const std::array<SampleType, 3> types = {all[0], all[1], all[2]};
  const std::uint64_t width = image_extent(dump.info.desc).width;
  for (std::size_t i = 0; i < dump.texels.size() / record.bytes; ++i) {
    std::array<std::uint32_t, 3> samples{};
    for (std::size_t c = 0; c < samples.size(); ++c) {
      const std::size_t bytes = sample_bytes(types[c]);
      std::memcpy(&samples[c], &planes[c][i * bytes], bytes);
    }
    const auto codes = shared_exponent_codes(types, samples);
    if (!codes) {
      const bool half = std::ranges::count(types, SampleType::half) == 3;
      fail(Exit::bad_input, "{}: {}: R, G and B of {}, {} and {} are no texel of {}; {}", path,
           to_string(locate(dump.info.desc, static_cast<std::uint32_t>(i % width),
                            static_cast<std::uint32_t>(i / width))),
           sample_text(types[0], samples[0]), sample_text(types[1], samples[1]),
           sample_text(types[2], samples[2]), find_format(record.format)->name,
           to_cure(Cure::keep_values, half ? "R16G16B16A16_SFLOAT" : "R32G32B32_SFLOAT"));
    }
    for (std::size_t c = 0; c < codes->size(); ++c) {
      store_component(&dump.texels[i * record.bytes], record.bytes, record.components[c],
                      (*codes)[c]);
    }
  }
}

/// Where an image's samples are read to.
Imf::FrameBuffer frame_buffer(const ExrImage& image, const Imath::Box2i& window,
                              std::vector<std::vector<char>>& planes) {
  const DumpInfo& info = image.info;
  const Record& record = info.desc.record;
  const Extent size = image_extent(info.desc);
  planes.resize(record.count);
  Imf::FrameBuffer target;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!has_channel(info.channels, record.components[i])) continue;
    const SampleType type = info.channels.types[i];
    const std::size_t bytes = sample_bytes(type);
    planes[i].resize(std::size_t{size.width} * size.height * bytes);
    target.insert(
        name_of_text(channel_name(info.channels, record.format, i)),
        Imf::Slice::Make(pixel_type(type), planes[i].data(), window, bytes, bytes * size.width,
                         static_cast<int>(image.x_sampling), static_cast<int>(image.y_sampling)));
  }
  return target;
}

/// Throws unless OpenEXR reads as many texels as there is room for.
void require_window(const Imath::Box2i& window, const Grid& size, const std::string& path) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                     height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width == size.x && height == size.y) return;
  fail(Exit::bad_input, "{}: its data window is damaged: {}x{} texels against {}x{}", path, width,
       height, size.x, size.y);
}

/// Reads an image's samples; throws if some are missing.
std::vector<std::vector<char>> read_samples(Imf::MultiPartInputFile& file, const ExrPart& part,
                                            const ExrImage& image, const std::string& path) {
  const auto place = image.info.place;
  std::vector<std::vector<char>> planes;
  const auto number = static_cast<int>(place.part), level = static_cast<int>(place.level);
  if (part.tiled) {
    Imf::TiledInputPart tiles(file, number);
    const Imath::Box2i window = tiles.dataWindowForLevel(level);
    require_window(window, part.level_size(place.level), path);
    tiles.setFrameBuffer(frame_buffer(image, window, planes));
    tiles.readTiles(0, tiles.numXTiles(level) - 1, 0, tiles.numYTiles(level) - 1, level);
  } else {
    Imf::InputPart lines(file, number);
    const Imath::Box2i window = lines.header().dataWindow();
    require_window(window, part.level_size(0), path);
    lines.setFrameBuffer(frame_buffer(image, window, planes));
    lines.readPixels(window.min.y, window.max.y);
  }
  return planes;
}

void set_texels(Dump& dump, const std::vector<std::vector<char>>& planes, const std::string& path) {
  dump.texels.resize(static_cast<std::size_t>(texture_bytes(dump.info.desc)));
  if (!dump.info.channels.exponent) return add_values(dump, planes, path);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!planes[i].empty()) add_channel(dump, i, planes[i].data(), path);
  }
}

}  // namespace

std::vector<Dump> read_exr(const std::string& path, const Hints& hints, bool texels) {
  const std::vector<ExrPart> parts = read_exr_header(path);
  try {
    const std::vector<ExrImage> images = images_of(parts, hints, path);
    if (texels) check_exr_chunks(path, parts, images);
    Imf::MultiPartInputFile file(path.c_str(), 0);
    std::vector<Dump> dumps;
    for (const ExrImage& image : images) {
      Dump& dump = dumps.emplace_back(Dump{image.info, {}});
      const std::uint32_t part = image.info.place.part;
      // Where the table of places is missing OpenEXR finds lines and tiles by looking, so that only
      // reading shows whether all are there.
      if (texels || !file.partComplete(static_cast<int>(part))) {
        const auto samples = read_samples(file, parts[part], image, path);
        if (texels) set_texels(dump, samples, path);
      }
    }
    return dumps;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  } catch (const std::exception& error) {
    if (memory_ran_out()) fail(Exit::internal, "{}: not enough memory", path);
    fail(Exit::bad_input, "{}: cannot be read: {}", path, error.what());
  }
}

}  // namespace gicodec::tools
