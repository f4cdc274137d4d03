// What is read of a DDS, KTX2 or raw file is written and read as the same: for tests and fuzzing.
#pragma once

#include "dump/internal.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <string>
#include <vector>

namespace gicodec::tools {

/// The file of its images, without a sidecar.
inline std::vector<std::byte> texture_file_bytes(std::span<const Dump> images, ImageKind kind) {
  if (kind == ImageKind::dds) return dds_file(images, "x");
  if (kind == ImageKind::ktx2) return ktx2_file(images, "x");
  return images.front().texels;
}

/// What is wrong with a DDS or KTX2 file's way in, out and in again; empty if nothing is. Throws
/// Error where it is refused. A `File` has a path() at which are the bytes it is made of.
template <typename File>
std::string texture_file_fault(std::span<const std::byte> bytes, ImageKind kind) {
  const File file(bytes);
  const std::vector<Dump> images = read_texture_file(file.path(), kind, {}, true);
  const auto& first = images.front().info;
  for (const Dump& image : images) {
    if (image.texels.size() != texture_bytes(image.info.desc)) return "texels are missing";
  }
  const auto written = texture_file_bytes(images, kind);
  // What is packed is packed anew; all else in a file comes back.
  const bool packed = find_attribute(first.attributes, kKtx2Scheme) != nullptr;
  if (!packed && first.lost.empty() && !std::ranges::equal(written, bytes)) return "bytes are lost";
  const File copy(written);
  const std::vector<Dump> again = read_texture_file(copy.path(), kind, {}, true);
  if (again.size() != images.size()) return "images are lost";
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto& [info, texels] = again[i];
    if (texels != images[i].texels) return "texels differ";
    if (info.desc != images[i].info.desc) return "another texture";
    if (info.attributes != images[i].info.attributes) return "other attributes";
    if (info.image != images[i].info.image) return "another name";
  }
  return texture_file_bytes(again, kind) == written ? "" : "the second copy is another";
}

/// The same of a sidecar's text.
inline std::string sidecar_fault(const std::string& text) {
  const auto read = [](const std::string& from) {
    DumpInfo info = texture_infos(parse_sidecar(from, "x"), {}, "x").front();
    drop_implied_raw(info);
    return info;
  };
  const DumpInfo info = read(text);
  const std::string written = raw_sidecar(info, "x");
  const DumpInfo again = read(written);
  if (again.desc != info.desc) return "another texture";
  if (again.attributes != info.attributes) return "other attributes";
  return raw_sidecar(again, "x") == written ? "" : "the second copy is another";
}

}  // namespace gicodec::tools
