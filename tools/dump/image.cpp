#include "dump/image.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/internal.h"
#include "dump/text.h"
#include "modules/images.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

namespace gicodec::tools {
namespace {

/// The code of a component in a sample of `sample_bits` bits. Undoes both ways by which writers
/// scale codes, rounding and repeating bits; nullopt for any other sample.
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
  const auto rounded =
      static_cast<std::uint32_t>((std::uint64_t{2} * code * max_sample + max_code(component)) /
                                 (2 * std::uint64_t{max_code(component)}));
  if (sample != repeated && sample != rounded) return std::nullopt;
  return code;
}

/// A file's samples, and their type in ChannelLayout.
struct Stored {
  std::size_t bytes = 0;
  SampleType as{};
  bool scaled = false;
};

Stored stored_type(const ImageHead& head, const std::string& path) {
  if (head.mixed) {
    fail(Exit::bad_input, "{}: channels of different types are not supported here; use EXR", path);
  }
  switch (head.samples) {
    case StoredSamples::uint8:
      return {1, SampleType::uint32, true};
    case StoredSamples::uint16:
      return {2, SampleType::uint32, true};
    case StoredSamples::half:
      return {2, SampleType::half, false};
    case StoredSamples::float32:
      return {4, SampleType::float32, false};
    case StoredSamples::other:
      break;
  }
  fail(Exit::bad_input, "{}: samples of type {} are not supported", path, head.type_name);
}

std::vector<FoundChannel> channels_of(const ImageHead& head, SampleType type) {
  std::vector<FoundChannel> found;
  // Channels of grey images are the first components.
  if (head.channels.size() == 1) return {{"R", type}};
  if (head.channels.size() == 2) return {{"R", type}, {"G", type}};
  for (const std::string& name : head.channels) found.push_back({name, type});
  return found;
}

/// The format of integer samples that nothing describes; 16 bits may be 10-bit codes at first.
std::optional<Format> format_of(const ImageHead& head, const Stored& stored, const Hints& hints) {
  constexpr std::array<Format, 4> kBytes = {Format::R8_UNORM, Format::R8G8_UNORM,
                                            Format::R8G8B8_UNORM, Format::R8G8B8A8_UNORM};
  constexpr std::array<Format, 4> kShorts = {Format::R16_UNORM, Format::R16G16_UNORM,
                                             Format::R16G16B16_UNORM, Format::R16G16B16A16_UNORM};
  const std::size_t channels = head.channels.size();
  if (hints.format || hints.desc || !hints.channels.empty() || !stored.scaled) return hints.format;
  if (stored.bytes == 1) return kBytes[channels - 1];
  return channels > 2 && !hints.plain ? std::nullopt : std::optional(kShorts[channels - 1]);
}

/// The module's parser for a kind. Only the parser of the file's extension reads a file.
const char* parser_of(ImageKind kind) {
  switch (kind) {
    case ImageKind::png:
      return "png";
    case ImageKind::tiff:
      return "tiff";
    case ImageKind::dpx:
      return "dpx";
    default:
      return "";
  }
}

void require_plain(const ImageHead& head, ImageKind kind, const std::string& path) {
  const std::size_t channels = head.channels.size();
  if (head.width < 1 || head.height < 1 || head.depth != 1 || head.width > kMaxImageSide ||
      head.height > kMaxImageSide || channels < 1 || channels > 4 || head.bytes > kMaxImageBytes) {
    fail(Exit::bad_input, "{}: {}x{}x{} texels with {} channels are not supported", path,
         head.width, head.height, head.depth, channels);
  }
  if (head.deep || head.colour_space == "KodakLog") {
    fail(Exit::bad_input, "{}: does not hold plain values", path);
  }
  // OpenImageIO expands palettes and scales up samples of few bits.
  const Stored stored = stored_type(head, path);
  if (kind == ImageKind::tiff && head.bits != static_cast<int>(8 * stored.bytes)) {
    fail(Exit::bad_input, "{}: {} bits per sample are not supported", path, head.bits);
  }
}

/// Sizes in the header of a DPX file, in bytes.
struct DpxSizes {
  std::uint32_t data_offset, claimed, user;
  std::uint64_t file;
};

constexpr std::uint32_t kUndefined = UINT32_MAX;

/// Hint for a file that its extension's parser refuses.
constexpr const char* kRename =
    "files are read as what they are called, so if it is of another kind, rename it";

/// Checks the header first: OpenImageIO allocates the size it gives for user data, and may abort.
DpxSizes read_dpx_sizes(const std::string& path) {
  std::array<unsigned char, 36> head{};
  std::ifstream file(native_path(path), std::ios::binary);
  file.read(reinterpret_cast<char*>(head.data()), head.size());
  const bool big = std::memcmp(head.data(), "SDPX", 4) == 0;
  if (!big && std::memcmp(head.data(), "XPDS", 4) != 0) {
    fail(Exit::bad_input, "{}: cannot be read as dpx: it does not begin as one; {}", path, kRename);
  }
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | head[at + (big ? i : 3 - i)];
    return value;
  };
  const auto size = size_of_file(path);
  if (!file || !size) fail(Exit::bad_input, "{}: is truncated", path);
  const DpxSizes sizes{word(4), word(16), word(32), *size};
  if (sizes.user != kUndefined && sizes.user > sizes.file) {
    fail(Exit::bad_input, "{}: its header claims {} bytes of user data, more than it has", path,
         sizes.user);
  }
  return sizes;
}

/// Frames of an animated PNG, of which the first is read; 1 of any other.
int png_frames(const std::string& path) {
  constexpr int kMagic = 8, kChecksum = 4;
  std::ifstream file(native_path(path), std::ios::binary);
  file.seekg(kMagic);
  const auto word = [&] {
    std::array<unsigned char, 4> bytes{};
    file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
           std::uint32_t{bytes[2]} << 8 | bytes[3];
  };
  while (file) {
    const std::uint32_t size = word(), type = word();
    if (type == 0x49444154) break;  // IDAT
    if (type == 0x6163544C)
      return static_cast<int>(std::min<std::uint32_t>(word(), INT32_MAX));  // acTL
    file.seekg(std::streamoff{size} + kChecksum, std::ios::cur);
  }
  return 1;
}

/// Checks a DPX file's size by its header, because OpenImageIO gives zeros for missing bytes.
void require_complete_dpx(const ImageHead& image, const DpxSizes& sizes, const std::string& path) {
  const std::uint64_t samples = static_cast<std::uint64_t>(image.width) *
                                static_cast<std::uint64_t>(image.height) * image.channels.size();
  const std::uint64_t least =
      sizes.data_offset + samples * static_cast<std::uint64_t>(image.bits) / 8;
  const std::uint64_t wanted =
      sizes.claimed == kUndefined ? least : std::max<std::uint64_t>(least, sizes.claimed);
  if (sizes.file < wanted) fail(Exit::bad_input, "{}: is truncated", path);
}

}  // namespace

std::vector<Dump> read_image(const std::string& path, ImageKind kind, const Hints& hints,
                             bool texels) {
  std::error_code error;
  if (!std::filesystem::exists(native_path(path), error))
    fail(Exit::io, "{}: cannot be opened", path);
  std::string why;
  std::optional<DpxSizes> dpx;
  if (kind == ImageKind::dpx) dpx = read_dpx_sizes(path);
  const auto image = image_module().open(parser_of(kind), path, why);
  if (!image) {
    fail(Exit::bad_input, "{}: cannot be read as {}: {}; {}", path, parser_of(kind), why, kRename);
  }
  const ImageHead& head = image->head;
  require_plain(head, kind, path);
  if (dpx) require_complete_dpx(head, *dpx, path);
  check_image_bytes(head.bytes, kMaxRatio, path);
  const Stored stored = stored_type(head, path);

  Dump dump;
  const auto found = channels_of(head, stored.as);
  const auto width = static_cast<std::uint32_t>(head.width);
  FoundImage image_found;
  image_found.texels = {width, static_cast<std::uint32_t>(head.height), 1};
  image_found.channels = found;
  Hints own = hints;
  own.format = format_of(head, stored, hints);
  const auto others = resolve(dump.info, image_found, own, path);
  if (!others.empty() && hints.channels.empty()) {
    fail(Exit::bad_input, "{}: channel {} does not belong to {}; {}", path, others.front().name,
         find_format(dump.info.desc.record.format)->name, to_cure(Cure::pick_channels));
  }
  for (const FoundChannel& channel : others) dump.info.lost.push_back("channel " + channel.name);
  const auto lose_others = [&](int count, const char* what) {
    if (count > 1) dump.info.lost.push_back(fmt::format("{} more of its {}", count - 1, what));
  };
  lose_others(head.pages, "pages");
  lose_others(head.levels, "mip levels");
  if (kind == ImageKind::png) lose_others(png_frames(path), "frames");
  dump.info.lost.push_back(
      fmt::format("its metadata and that it is {} (decode writes EXR)", parser_of(kind)));
  const FormatInfo& format = *find_format(dump.info.desc.record.format);
  if (!dump.info.channels.exponent) {
    fail(Exit::bad_input, "{}: only EXR files can hold values that share an exponent", path);
  }
  for (const Component& component : format.record.used()) {
    if (stored.scaled && component.type != ComponentType::unorm) {
      fail(Exit::bad_input, "{}: integer samples do not hold {}", path, format.name);
    }
    if (stored.scaled && component.bits > 8 * stored.bytes) {
      fail(Exit::bad_input, "{}: holds {} bits per channel, too few for the {} of {}; {}", path,
           8 * stored.bytes, component.bits, format.name, to_cure(Cure::more_bits));
    }
  }
  if (!texels) return {std::move(dump)};

  const std::size_t channels = found.size();
  const std::size_t count = std::size_t{width} * static_cast<std::size_t>(head.height);
  std::vector<std::byte> samples(count * channels * stored.bytes);
  if (why = image->read(samples); !why.empty()) fail(Exit::bad_input, "{}: {}", path, why);
  dump.texels.resize(static_cast<std::size_t>(texture_bytes(dump.info.desc)));
  for (const Component& component : format.record.used()) {
    const auto index = static_cast<std::size_t>(&component - format.record.components.data());
    const std::string name = channel_name(dump.info.channels, format.record.format, index);
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
        fail_sample(dump.info, component, stored.as, sample, static_cast<std::uint32_t>(i % width),
                    static_cast<std::uint32_t>(i / width), path);
      }
      store_component(&dump.texels[i * format.record.bytes], format.record.bytes, component, *code);
    }
  }
  return {std::move(dump)};
}

void check_png_size(const std::string& path, std::uint64_t width, std::uint64_t height) {
  constexpr std::uint64_t kMaxPngSide = 1000000;  // PNG_USER_WIDTH_MAX
  const std::uint64_t side = std::max(width, height);
  if (side <= kMaxPngSide) return;
  fail(Exit::bad_input, "{}: {}x{} texels do not fit in a PNG, whose sides have {} at most; {}",
       path, width, height, kMaxPngSide,
       side <= kMaxImageSide ? "a picture of a part can be made with \"gicodec crop\", from dumps, "
                               "which \"gicodec decode\" makes of a container"
                             : "only its writer can lay out its probes in another way, such as "
                               "slices_xy_z");
}

void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::uint32_t channels, std::span<const std::uint8_t> pixels, Existing existing,
               void (*before_writing)()) {
  if (pixels.size() != std::size_t{width} * height * channels) {
    fail(Exit::internal, "{}: the picture's size does not match", path);
  }
  check_png_size(path, width, height);
  std::vector<unsigned char> bytes;
  if (const auto why = image_module().encode_png(width, height, channels, pixels, bytes);
      !why.empty()) {
    fail(Exit::internal, "{}: cannot write PNG: {}", path, why);
  }
  if (before_writing != nullptr) before_writing();
  write_file(path, std::as_bytes(std::span(bytes)), existing);
}

}  // namespace gicodec::tools
