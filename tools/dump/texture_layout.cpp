// Where the texels of levels, faces and slices stand in texture files.
#include "dump/error.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <array>
#include <bit>

namespace gicodec::tools {
namespace {

constexpr std::array<const char*, 6> kFaces = {"px", "nx", "py", "ny", "pz", "nz"};
constexpr std::uint32_t kCubeFaces = 6;

std::uint64_t slice_bytes(const TextureHead& head, std::uint32_t level, Format format) {
  const Grid records = records_of(level_texels(head, level), format);
  return std::uint64_t{records.x} * records.y * Record(format).bytes;
}

/// Slices of an image: depth, or elements.
std::uint32_t slices(const TextureHead& head, std::uint32_t level) {
  return level_texels(head, level).z;
}

}  // namespace

std::uint32_t max_levels(const TextureHead& head) noexcept {
  const Grid& all = head.texels;
  const std::uint32_t side = std::max({all.x, all.y, head.volume ? all.z : 1U});
  return static_cast<std::uint32_t>(std::bit_width(side));
}

Grid level_texels(const TextureHead& head, std::uint32_t level) noexcept {
  const auto side = [level](std::uint32_t all) {
    return level >= kMaxLevels ? 1U : std::max(1U, all >> level);
  };
  const Grid& all = head.texels;
  return {side(all.x), side(all.y), head.volume ? side(all.z) : all.z};
}

std::string image_name(const TextureHead& head, const ImagePlace& place) {
  std::string name;
  if (head.faces > 1) {
    name = head.faces == kCubeFaces ? kFaces[place.face] : fmt::format("face{}", place.face);
  }
  if (place.level > 0) name += fmt::format("{}mip{}", name.empty() ? "" : ".", place.level);
  return name;
}

std::vector<ImagePlace> places_of(const TextureHead& head) {
  std::vector<ImagePlace> places;
  for (std::uint32_t level = 0; level < head.levels; ++level) {
    for (std::uint32_t face = 0; face < head.faces; ++face) places.push_back({0, level, face});
  }
  return places;
}

std::uint64_t level_bytes(const TextureHead& head, std::uint32_t level, Format format) noexcept {
  return slice_bytes(head, level, format) * slices(head, level) * head.faces;
}

std::uint64_t all_bytes(const TextureHead& head, Format format) noexcept {
  std::uint64_t bytes = 0;
  for (std::uint32_t level = 0; level < head.levels; ++level) {
    bytes += level_bytes(head, level, format);
  }
  return bytes;
}

Runs runs_by_element(const TextureHead& head, const ImagePlace& place, Format format) {
  const std::uint64_t bytes = slice_bytes(head, place.level, format);
  std::uint64_t before = 0, element = 0;
  for (std::uint32_t level = 0; level < head.levels; ++level) {
    const std::uint64_t own =
        slice_bytes(head, level, format) * (head.volume ? slices(head, level) : std::uint64_t{1});
    if (level < place.level) before += own;
    element += own;
  }
  if (head.volume) {
    return {before, bytes, static_cast<std::size_t>(bytes), slices(head, place.level)};
  }
  return {before + place.face * element, head.faces * element, static_cast<std::size_t>(bytes),
          head.texels.z};
}

Runs runs_by_level(const TextureHead& head, const ImagePlace& place, Format format) {
  const std::uint64_t bytes = slice_bytes(head, place.level, format);
  return {place.face * bytes, head.faces * bytes, static_cast<std::size_t>(bytes),
          slices(head, place.level)};
}

void scatter(std::span<const std::byte> texels, const Runs& runs, std::span<std::byte> into) {
  for (std::uint32_t i = 0; i < runs.count; ++i) {
    std::ranges::copy(texels.subspan(i * runs.bytes, runs.bytes),
                      into.begin() + static_cast<std::ptrdiff_t>(runs.first + i * runs.stride));
  }
}

void gather(std::span<const std::byte> from, const Runs& runs, std::span<std::byte> texels) {
  for (std::uint32_t i = 0; i < runs.count; ++i) {
    std::ranges::copy(from.subspan(runs.first + i * runs.stride, runs.bytes),
                      texels.begin() + static_cast<std::ptrdiff_t>(i * runs.bytes));
  }
}

TextureHead head_of(std::span<const Dump> images, const std::string& path) {
  const TextureDesc& desc = images.front().info.desc;
  TextureHead head;
  head.format = desc.record.format;
  head.texels = texels_of(desc);
  head.volume = is_volume(desc);
  for (const Dump& image : images) {
    head.levels = std::max(head.levels, image.info.place.level + 1);
    head.faces = std::max(head.faces, image.info.place.face + 1);
  }
  require_fit(head, images, nullptr, path);
  return head;
}

void require_fit(const TextureHead& head, std::span<const Dump> images, const char* attribute,
                 const std::string& path) {
  const bool sane = head.levels <= kMaxLevels && head.faces <= kCubeFaces;
  bool fit = sane && images.size() == std::size_t{head.levels} * head.faces;
  for (std::size_t i = 0; fit && i < images.size(); ++i) {
    const DumpInfo& info = images[i].info;
    const auto i32 = static_cast<std::uint32_t>(i);
    const ImagePlace place{0, i32 / head.faces, i32 % head.faces};
    const Record& record = info.desc.record;
    const Grid records = records_of(level_texels(head, place.level), record.format);
    fit = info.place == place && extent(info.desc) == Extent{records.x, records.y, records.z} &&
          record == images.front().info.desc.record &&
          (!head.format || Record(*head.format).bytes == record.bytes);
  }
  if (fit) return;
  if (attribute != nullptr) {
    fail(Exit::bad_input, "{}: attribute {} is of another texture", path, attribute);
  }
  fail(Exit::bad_input, "{}: {} images are no levels and faces of one texture", path,
       images.size());
}

}  // namespace gicodec::tools
