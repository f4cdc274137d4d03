#include "dump/error.h"
#include "dump/internal.h"

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <new>

namespace gicodec::tools {
namespace {

SampleType sample_type(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT:
      return SampleType::uint32;
    case Imf::HALF:
      return SampleType::half;
    default:
      return SampleType::float32;
  }
}

std::vector<FoundChannel> channels_of(const Imf::Header& header, const std::string& path) {
  std::vector<FoundChannel> found;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
    const Imf::Channel& channel = at.channel();
    if (channel.xSampling != 1 || channel.ySampling != 1) {
      fail(Exit::bad_input, "{}: channel {} is subsampled", path, at.name());
    }
    found.push_back({at.name(), sample_type(channel.type)});
  }
  return found;
}

Imf::PixelType pixel_type(SampleType type) {
  return type == SampleType::uint32 ? Imf::UINT : type == SampleType::half ? Imf::HALF : Imf::FLOAT;
}

constexpr std::size_t sample_bytes(SampleType type) { return type == SampleType::half ? 2 : 4; }

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
      fail(Exit::bad_input,
           "{}: {}: R, G and B of {}, {} and {} are no texel of {}; --vk-format {} keeps them as "
           "they are",
           path,
           to_string(locate(dump.info.desc, static_cast<std::uint32_t>(i % width),
                            static_cast<std::uint32_t>(i / width))),
           sample_text(types[0], samples[0]), sample_text(types[1], samples[1]),
           sample_text(types[2], samples[2]), find_format(record.format)->name,
           half ? "R16G16B16A16_SFLOAT" : "R32G32B32_SFLOAT");
    }
    for (std::size_t c = 0; c < codes->size(); ++c) {
      store_component(&dump.texels[i * record.bytes], record.bytes, record.components[c],
                      (*codes)[c]);
    }
  }
}

void read_texels(Imf::InputFile& file, Dump& dump, const std::string& path) {
  const Record& record = dump.info.desc.record;
  const Extent size = image_extent(dump.info.desc);
  std::vector<std::vector<char>> planes(record.count);
  Imf::FrameBuffer target;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!has_channel(dump.info.channels, record.components[i])) continue;
    const SampleType type = dump.info.channels.types[i];
    planes[i].resize(std::size_t{size.width} * size.height * sample_bytes(type));
    target.insert(channel_name(dump.info.channels, record.format, i),
                  Imf::Slice(pixel_type(type), planes[i].data(), sample_bytes(type),
                             sample_bytes(type) * size.width));
  }
  file.setFrameBuffer(target);
  file.readPixels(0, static_cast<int>(size.height) - 1);

  dump.texels.resize(static_cast<std::size_t>(texture_bytes(dump.info.desc)));
  if (!dump.info.channels.exponent) return add_values(dump, planes, path);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!planes[i].empty()) add_channel(dump, i, planes[i].data(), path);
  }
}

}  // namespace

Dump read_exr(const std::string& path, const Hints& hints, bool texels) {
  check_exr_header(path);
  try {
    Imf::InputFile file(path.c_str(), 0);
    const Imf::Header& header = file.header();
    const auto window = header.dataWindow();
    Dump dump;
    read_attributes(header, dump.info);
    FoundImage found;
    found.texels = {static_cast<std::uint32_t>(window.max.x + 1),
                    static_cast<std::uint32_t>(window.max.y + 1), 1};
    found.channels = channels_of(header, path);
    resolve(dump.info, found, hints, path);
    if (!file.isComplete()) fail(Exit::bad_input, "{}: is truncated", path);
    if (texels) read_texels(file, dump, path);
    return dump;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  } catch (const std::exception& error) {
    fail(Exit::bad_input, "{}: cannot be read: {}", path, error.what());
  }
}

}  // namespace gicodec::tools
