// Checks the bytes of an EXR header before OpenEXR reads them, because OpenEXR allocates by the
// header's sizes.
#include "dump/error.h"
#include "dump/internal.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

namespace gicodec::tools {
namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kTiled = 0x200, kNonImage = 0x800, kMultiPart = 0x1000;
constexpr std::int64_t kMaxHeaderBytes = 16 << 20;
constexpr std::size_t kMaxName = 255;

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

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

class HeaderWalk {
 public:
  explicit HeaderWalk(const std::string& path)
      : path_(path), file_(std::fopen(path.c_str(), "rb")) {
    if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, std::strerror(errno));
  }

  void run() {
    if (word() != kMagic) fail(Exit::bad_input, "{}: is not an EXR file", path_);
    const std::uint32_t version = word();
    if ((version & 0xFF) != 2) {
      fail(Exit::bad_input, "{}: EXR version {} is not supported", path_, version & 0xFF);
    }
    const char* kind = (version & kMultiPart)  ? "multi-part"
                       : (version & kNonImage) ? "deep"
                       : (version & kTiled)    ? "tiled"
                                               : nullptr;
    if (kind != nullptr) {
      fail(Exit::bad_input, "{}: is a {} EXR; a probe dump is a single-part scanline image", path_,
           kind);
    }
    for (std::string name = text(); !name.empty(); name = text()) attribute(name);
    // OpenEXR holds all lines of a compressed block, even if the image has fewer.
    check_image_bytes(std::max(area_, width_ * lines_) * texel_bytes_, path_);
  }

 private:
  void attribute(const std::string& name) {
    if (++attributes_ > kMaxAttributes) {
      fail(Exit::bad_input, "{}: has more than {} attributes", path_, kMaxAttributes);
    }
    const std::string type = text();
    const auto size = static_cast<std::int32_t>(word());
    if (size < 0 || size > kMaxHeaderBytes) {
      fail(Exit::bad_input, "{}: attribute {} claims {} bytes", path_, name, size);
    }
    if (type == "idmanifest") {
      fail(Exit::bad_input, "{}: attribute {} has a type only deep images use", path_, name);
    }
    std::string bytes(static_cast<std::size_t>(size), '\0');
    read(bytes.data(), bytes.size());
    const auto* known = std::ranges::find(kSizes, type, &TypeSize::type);
    if (known != kSizes.end() && known->size != bytes.size()) damaged(name);
    if (type == "floatvector" && bytes.size() % 4 != 0) damaged(name);
    if (type == "stringvector") strings(name, bytes);
    if (type == "box2i" && name == "dataWindow") data_window(bytes);
    if (type == "chlist") channels(bytes);
    if (type == "compression") compression(bytes);
    if (type == "preview") preview(bytes);
  }

  /// A list of names, each with type, flags and two sampling steps.
  void channels(std::string_view bytes) {
    constexpr std::size_t kFields = 16, kMaxChannels = 256;
    std::uint64_t size = 0;
    std::size_t count = 0;
    while (!bytes.empty() && bytes.front() != '\0') {
      const std::size_t name = bytes.find('\0');
      if (name == std::string_view::npos || bytes.size() - name - 1 < kFields) break;
      size += bytes[name + 1] == 1 ? 2 : 4;  // HALF, else UINT or FLOAT
      bytes.remove_prefix(name + 1 + kFields);
      if (++count > kMaxChannels) {
        fail(Exit::bad_input, "{}: has more than {} channels", path_, kMaxChannels);
      }
    }
    if (bytes != std::string_view("\0", 1)) {
      fail(Exit::bad_input, "{}: its list of channels is damaged", path_);
    }
    texel_bytes_ = std::max(texel_bytes_, size);
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
    area_ = std::max(area_, static_cast<std::uint64_t>(width * height));
    width_ = std::max(width_, static_cast<std::uint64_t>(width));
    if (box[0] != 0 || box[1] != 0) {
      fail(Exit::bad_input, "{}: the data window starts at ({}, {}), not at (0, 0)", path_, box[0],
           box[1]);
    }
  }

  /// Lines per block by compression: none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab.
  void compression(std::string_view bytes) {
    constexpr std::array<std::uint64_t, 10> kLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    const std::size_t number = static_cast<unsigned char>(bytes[0]);
    constexpr std::size_t kHtj2k256 = 10, kHtj2k32 = 11;
    if (number == kHtj2k256 || number == kHtj2k32) {
      fail(
          Exit::bad_input,
          "{}: its compression, HTJ2K, is newer than the OpenEXR that reads it here; write it with "
          "ZIP or PIZ, as exrconv or oiiotool --compression zip do",
          path_);
    }
    if (number >= kLines.size()) {
      fail(Exit::bad_input, "{}: its compression, number {}, is unknown; write it with ZIP or PIZ",
           path_, number);
    }
    lines_ = std::max(lines_, kLines[number]);
  }

  void preview(const std::string& bytes) {
    std::uint32_t size[2] = {};
    if (bytes.size() >= sizeof size) std::memcpy(size, bytes.data(), sizeof size);
    if (bytes.size() < sizeof size || std::uint64_t{size[0]} * size[1] != (bytes.size() - 8) / 4 ||
        bytes.size() % 4 != 0) {
      fail(Exit::bad_input, "{}: its preview picture is damaged", path_);
    }
  }

  /// A list of strings, each with its length.
  void strings(const std::string& name, std::string_view bytes) {
    while (!bytes.empty()) {
      std::uint32_t size = 0;
      if (bytes.size() < sizeof size) damaged(name);
      std::memcpy(&size, bytes.data(), sizeof size);
      bytes.remove_prefix(sizeof size);
      if (size > bytes.size()) damaged(name);
      bytes.remove_prefix(size);
    }
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
      if (text.size() == kMaxName) fail(Exit::bad_input, "{}: its EXR header is damaged", path_);
      text += c;
    }
  }

  std::uint32_t word() {
    std::uint32_t word = 0;
    read(&word, sizeof word);
    return word;
  }

  void read(void* into, std::size_t size) {
    if (std::fread(into, 1, size, file_.get()) == size) {
      walked_ += static_cast<std::int64_t>(size);
      if (walked_ > kMaxHeaderBytes) fail(Exit::bad_input, "{}: its EXR header is too big", path_);
      return;
    }
    if (std::ferror(file_.get()) != 0) {
      fail(Exit::io, "{}: cannot be read: {}", path_, std::strerror(errno));
    }
    fail(Exit::bad_input, "{}: ends within its EXR header", path_);
  }

  const std::string& path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::int64_t walked_ = 0;
  std::size_t attributes_ = 0;
  /// The largest values, if an attribute occurs several times.
  std::uint64_t area_ = 0, width_ = 0, texel_bytes_ = 0, lines_ = 1;
};

}  // namespace

void check_image_bytes(std::uint64_t bytes, const std::string& path) {
  constexpr std::uint64_t kFree = std::uint64_t{64} << 20, kRatio = 2000;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error || bytes <= kFree || bytes / kRatio <= size) return;
  fail(Exit::bad_input, "{}: claims {} bytes of samples, more than its {} bytes can hold", path,
       bytes, size);
}

void check_exr_header(const std::string& path) { HeaderWalk(path).run(); }

}  // namespace gicodec::tools
