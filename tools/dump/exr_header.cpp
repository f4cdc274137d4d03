#include "dump/exr_header.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

namespace gicodec::tools {
namespace {

constexpr std::uint32_t kExrMagic = 20000630;
constexpr std::uint32_t kTiled = 0x200, kNonImage = 0x800, kMultiPart = 0x1000;
constexpr std::int64_t kMaxHeaderBytes = 64 << 20;
constexpr std::size_t kMaxParts = 256;
constexpr std::size_t kMaxExrName = 255;
/// No lossless compression makes an image smaller by more; DWA does, which loses bits.
constexpr std::uint64_t kDwaRatio = 100000;

/// Lines of a chunk by compression: none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab.
constexpr std::array<std::uint32_t, 10> kLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

/// Bytes of a type's value. OpenEXR reads as many whatever the header's size is, and goes on from
/// there. If the two differ, it would read another header than the one checked here.
struct TypeSize {
  std::string_view type;
  std::size_t size;
};
constexpr std::array<TypeSize, 24> kSizes{{
    {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
    {"compression", 1}, {"double", 8},   {"envmap", 1},
    {"float", 4},       {"int", 4},      {"keycode", 28},
    {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
    {"m44d", 128},      {"m44f", 64},    {"rational", 8},
    {"timecode", 8},    {"v2d", 16},     {"v2f", 8},
    {"v2i", 8},         {"v3d", 24},     {"v3f", 12},
    {"v3i", 12},        {"tiledesc", 9}, {"deepImageState", 1},
}};

/// A list of strings, each with its length.
bool are_strings(std::string_view bytes) {
  while (!bytes.empty()) {
    std::uint32_t size = 0;
    if (bytes.size() < sizeof size) return false;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    if (size > bytes.size()) return false;
    bytes.remove_prefix(size);
  }
  return true;
}

/// Width, height, and so many texels of four bytes.
bool is_preview(std::string_view bytes) {
  std::uint32_t size[2] = {};
  if (bytes.size() < sizeof size || bytes.size() % 4 != 0) return false;
  std::memcpy(size, bytes.data(), sizeof size);
  return std::uint64_t{size[0]} * size[1] == (bytes.size() - sizeof size) / 4;
}

class HeaderWalk {
 public:
  explicit HeaderWalk(const std::string& path) : path_(path), file_(open_input(path)) {
    if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, reason(errno));
  }

  std::vector<ExrPart> run() {
    if (word() != kExrMagic) fail(Exit::bad_input, "{}: is not an EXR file", path_);
    const std::uint32_t version = word();
    if ((version & 0xFF) != 2) {
      fail(Exit::bad_input, "{}: EXR version {} is not supported", path_, version & 0xFF);
    }
    const bool several = (version & kMultiPart) != 0;
    if ((version & kNonImage) != 0 && !several) fail_deep("");
    std::vector<ExrPart> parts;
    for (std::string name = text(); !name.empty(); name = several ? text() : "") {
      part_ = {};
      part_.tiled = (version & kTiled) != 0;
      lines_ = 1;
      texel_bytes_ = 0;
      for (; !name.empty(); name = text()) attribute(name);
      finish_part();
      parts.push_back(std::move(part_));
      if (parts.size() > kMaxParts) {
        fail(Exit::bad_input, "{}: has more than {} parts", path_, kMaxParts);
      }
    }
    if (parts.empty()) fail(Exit::bad_input, "{}: its EXR header is empty", path_);
    check_image_bytes(bytes_, dwa_ ? kDwaRatio : kMaxRatio, path_);
    auto places = static_cast<std::uint64_t>(walked_);
    for (ExrPart& part : parts) {
      part.in_several = several;
      part.places = places;
      places += 8 * part.chunk_count();
    }
    return parts;
  }

 private:
  [[noreturn]] void fail_deep(const std::string& part) const {
    fail(Exit::bad_input,
         "{}: {}holds deep data, of several samples a texel, which no texture is; {}", path_,
         part.empty() ? "" : fmt::format("part {} ", part), to_cure(Cure::flatten));
  }
  void finish_part() {
    if (part_.width == 0) fail(Exit::bad_input, "{}: its EXR header lacks dataWindow", path_);
    if (part_.channels.empty()) fail(Exit::bad_input, "{}: has no channels", path_);
    if (!part_.tiled) part_.levels = 1;
    if (part_.levels > 1) {
      const std::uint32_t side = std::max(part_.width, part_.height);
      part_.levels = static_cast<std::uint32_t>(part_.round_up ? std::bit_width(side - 1) + 1
                                                               : std::bit_width(side));
    }
    // OpenEXR holds all lines of a compressed block, even if the image has fewer.
    const std::uint64_t area = std::uint64_t{part_.width} * part_.height;
    const std::uint64_t all =
        part_.levels > 1 ? area + area / 2 + part_.width + part_.height : area;
    const std::uint64_t tile = std::uint64_t{part_.tile.x} * part_.tile.y;
    bytes_ += std::max(all, std::max<std::uint64_t>(lines_ * part_.width, tile)) * texel_bytes_;
    if (part_.tiled && tile == 0) fail(Exit::bad_input, "{}: its EXR header lacks tiles", path_);
  }

  void attribute(const std::string& name) {
    if (++attributes_ > kMaxAttributes) {
      fail(Exit::bad_input, "{}: has more than {} attributes", path_, kMaxAttributes);
    }
    const std::string type = text();
    const auto size = static_cast<std::int32_t>(word());
    if (size < 0 || size > kMaxHeaderBytes) {
      fail(Exit::bad_input, "{}: attribute {} claims {} bytes", path_, name, size);
    }
    // Its parts are packed, so that their sizes are not known here.
    if (type == "idmanifest" || (type == "chlist" && name != "channels")) {
      fail(Exit::bad_input, "{}: attribute {} of type {} is not supported; {}", path_, name, type,
           to_cure(Cure::erase_attribute));
    }
    std::string bytes = take(static_cast<std::size_t>(size));
    if (type != "chlist" && !is_sound_exr_value(type, bytes)) damaged(name);
    if (type == "box2i" && name == "dataWindow") data_window(bytes);
    if (type == "chlist") channels(bytes);
    if (type == "compression") compression(bytes);
    if (type == "tiledesc" && name == "tiles") tiles(bytes);
    if (type == "string" && name == "name") part_.name = bytes;
    if (type == "string" && name == "type") part_type(bytes);
    part_.attributes.push_back({name, type, std::move(bytes)});
  }

  void part_type(const std::string& type) {
    if (type.starts_with("deep")) fail_deep(part_.name);
    part_.tiled = part_.tiled || type == "tiledimage";
  }

  void tiles(std::string_view bytes) {
    std::array<std::uint32_t, 2> size{};
    std::memcpy(size.data(), bytes.data(), sizeof size);
    const auto mode = static_cast<unsigned char>(bytes[8]);
    const unsigned levels = mode & 0xF, rounding = mode >> 4;
    constexpr unsigned kMipmaps = 1, kRipmaps = 2;
    if (size[0] == 0 || size[1] == 0 || size[0] > kMaxImageSide || size[1] > kMaxImageSide ||
        levels > kRipmaps || rounding > 1) {
      damaged("tiles");
    }
    if (levels == kRipmaps) {
      fail(Exit::bad_input, "{}: is ripmapped: it has levels of every width with every height; {}",
           path_, to_cure(Cure::one_level));
    }
    part_.round_up = rounding == 1;
    part_.levels = levels == kMipmaps ? 2 : 1;  // Their number follows from the window.
    part_.tile = {size[0], size[1], 1};
  }

  /// A list of names, each with type, flags and two sampling steps.
  void channels(std::string_view bytes) {
    constexpr std::size_t kFields = 16, kMaxChannels = 256;
    std::uint64_t size = 0;
    part_.channels.clear();
    while (!bytes.empty() && bytes.front() != '\0') {
      const std::size_t name = bytes.find('\0');
      if (name == std::string_view::npos || bytes.size() - name - 1 < kFields) break;
      part_.channels.push_back(channel(bytes.substr(0, name), bytes.substr(name + 1, kFields)));
      size += part_.channels.back().type == SampleType::half ? 2 : 4;
      bytes.remove_prefix(name + 1 + kFields);
      if (part_.channels.size() > kMaxChannels) {
        fail(Exit::bad_input, "{}: has more than {} channels", path_, kMaxChannels);
      }
    }
    if (bytes != std::string_view("\0", 1)) {
      fail(Exit::bad_input, "{}: its list of channels is damaged", path_);
    }
    texel_bytes_ = std::max(texel_bytes_, size);
  }

  ExrChannel channel(std::string_view name, std::string_view fields) const {
    constexpr std::array<SampleType, 3> kTypes = {SampleType::uint32, SampleType::half,
                                                  SampleType::float32};
    std::array<std::uint32_t, 4> words{};
    std::memcpy(words.data(), fields.data(), sizeof words);
    const auto [type, linear, x, y] = words;
    if (type >= kTypes.size() || x == 0 || y == 0 || x > kMaxExrSampling || y > kMaxExrSampling) {
      fail(Exit::bad_input, "{}: its list of channels is damaged: channel {} of type {}, {}x{}",
           path_, name, type, x, y);
    }
    return {std::string(name), kTypes[type], (linear & 0xFF) != 0, x, y};
  }

  void data_window(const std::string& bytes) {
    std::int32_t box[4] = {};
    std::memcpy(box, bytes.data(), sizeof box);
    const std::int64_t width = std::int64_t{box[2]} - box[0] + 1;
    const std::int64_t height = std::int64_t{box[3]} - box[1] + 1;
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
        static_cast<std::uint64_t>(width * height) > kMaxImageBytes / 4) {
      fail(Exit::bad_input, "{}: an image of {}x{} texels is not supported", path_, width, height);
    }
    if (std::abs(std::int64_t{box[0]}) > kMaxExrOrigin ||
        std::abs(std::int64_t{box[1]}) > kMaxExrOrigin) {
      fail(Exit::bad_input, "{}: a data window from ({}, {}) on is not supported", path_, box[0],
           box[1]);
    }
    part_.x = box[0];
    part_.y = box[1];
    part_.width = static_cast<std::uint32_t>(width);
    part_.height = static_cast<std::uint32_t>(height);
  }

  void compression(std::string_view bytes) {
    const std::size_t number = static_cast<unsigned char>(bytes[0]);
    constexpr std::size_t kHtj2k256 = 10, kHtj2k32 = 11;
    if (number == kHtj2k256 || number == kHtj2k32) {
      fail(Exit::bad_input,
           "{}: its compression, HTJ2K, is newer than the OpenEXR that reads it here; {}", path_,
           to_cure(Cure::write_zip));
    }
    if (number >= kLines.size()) {
      fail(Exit::bad_input, "{}: its compression, number {}, is unknown; {}", path_, number,
           to_cure(Cure::write_zip));
    }
    part_.compression = static_cast<std::uint8_t>(number);
    lines_ = std::max<std::uint64_t>(lines_, part_.chunk_lines());
    dwa_ = dwa_ || number >= 8;
  }

  [[noreturn]] void damaged(const std::string& name) const {
    fail(Exit::bad_input, "{}: attribute {} is damaged", path_, name);
  }

  std::string text() {
    std::string text;
    for (;;) {
      char c = 0;
      read(&c, 1);
      if (c == '\0') return text;
      if (text.size() == kMaxExrName) fail(Exit::bad_input, "{}: its EXR header is damaged", path_);
      text += c;
    }
  }

  std::uint32_t word() {
    std::uint32_t word = 0;
    read(&word, sizeof word);
    return word;
  }

  /// Reads in steps, so that memory does not outgrow the file.
  std::string take(std::size_t size) {
    constexpr std::size_t kStep = std::size_t{1} << 20;
    std::string bytes;
    while (bytes.size() < size) {
      const std::size_t before = bytes.size();
      bytes.resize(std::min(size, before + kStep));
      read(&bytes[before], bytes.size() - before);
    }
    return bytes;
  }

  void read(void* into, std::size_t size) {
    if (std::fread(into, 1, size, file_.get()) == size) {
      walked_ += static_cast<std::int64_t>(size);
      if (walked_ > kMaxHeaderBytes) fail(Exit::bad_input, "{}: its EXR header is too big", path_);
      return;
    }
    if (std::ferror(file_.get()) != 0) {
      fail(Exit::io, "{}: cannot be read: {}", path_, reason(errno));
    }
    fail(Exit::bad_input, "{}: ends within its EXR header", path_);
  }

  const std::string& path_;
  OwnedFile file_;
  std::int64_t walked_ = 0;
  std::size_t attributes_ = 0;
  ExrPart part_;
  /// The largest values, if an attribute occurs several times.
  std::uint64_t texel_bytes_ = 0, lines_ = 1;
  std::uint64_t bytes_ = 0;  ///< of the samples of all parts
  bool dwa_ = false;
};

}  // namespace

Grid ExrPart::level_size(std::uint32_t level) const noexcept {
  const auto side = [&](std::uint32_t all) {
    const std::uint64_t up = round_up ? (std::uint64_t{1} << level) - 1 : 0;
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (all + up) >> level));
  };
  return {side(width), side(height), 1};
}

std::uint32_t ExrPart::chunk_lines() const noexcept { return kLines[compression]; }

std::uint64_t ExrPart::chunk_count() const noexcept {
  const auto parts_of = [](std::uint64_t all, std::uint64_t one) { return (all - 1) / one + 1; };
  if (!tiled) return parts_of(height, chunk_lines());
  std::uint64_t count = 0;
  for (std::uint32_t level = 0; level < levels; ++level) {
    const Grid size = level_size(level);
    count += parts_of(size.x, tile.x) * parts_of(size.y, tile.y);
  }
  return count;
}

std::int64_t exr_samples(std::int64_t first, std::int64_t last, std::int64_t step) noexcept {
  const auto below = [step](std::int64_t at) {
    return at >= 0 ? at / step : -((-at + step - 1) / step);
  };
  return below(last) - below(first - 1);
}

void check_image_bytes(std::uint64_t bytes, std::uint64_t ratio, const std::string& path) {
  constexpr std::uint64_t kFree = std::uint64_t{64} << 20;
  if (bytes <= kFree) return;
  const auto size = size_of_file(path);
  if (!size || (bytes / ratio <= *size && bytes <= kMaxImageBytes)) return;
  fail(Exit::bad_input,
       "{}: claims {} bytes of samples; its {} bytes hold {} at most, and images may have {}", path,
       bytes, *size, *size * ratio, kMaxImageBytes);
}

bool is_sound_exr_value(std::string_view type, std::string_view bytes) noexcept {
  const auto* known = std::ranges::find(kSizes, type, &TypeSize::type);
  if (known != kSizes.end()) return known->size == bytes.size();
  if (type == "floatvector") return bytes.size() % 4 == 0;
  if (type == "stringvector") return are_strings(bytes);
  if (type == "preview") return is_preview(bytes);
  return type != "idmanifest" && type != "chlist";
}

std::vector<ExrPart> read_exr_header(const std::string& path) { return HeaderWalk(path).run(); }

}  // namespace gicodec::tools
