// What is read of a DDS, KTX2 or raw file is written and read as the same: for tests and fuzzing.
#pragma once

#include "dump/internal.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <string>
#include <vector>

namespace gicodec::tools {

/// The file of a dump, without a sidecar.
inline std::vector<std::byte> texture_file_bytes(const Dump& dump, ImageKind kind) {
  std::vector<std::byte> bytes;
  if (kind == ImageKind::dds) bytes = dds_head(dump.info, "x");
  if (kind == ImageKind::ktx2) bytes = ktx2_head(dump.info, "x");
  bytes.insert(bytes.end(), dump.texels.begin(), dump.texels.end());
  return bytes;
}

/// What is wrong with a DDS or KTX2 file's way in, out and in again; empty if nothing is. Throws
/// Error where it is refused. A `File` has a path() at which are the bytes it is made of.
template <typename File>
std::string texture_file_fault(std::span<const std::byte> bytes, ImageKind kind) {
  const File file(bytes);
  const Dump dump = read_texture_file(file.path(), kind, {}, true);
  if (dump.texels.size() != texture_bytes(dump.info.desc)) return "texels are missing";
  const auto written = texture_file_bytes(dump, kind);
  // All that is in a DDS file comes back; keys of KTX2 are in order and what pads them is zero.
  if (kind == ImageKind::dds && !std::ranges::equal(written, bytes)) return "bytes are lost";
  const File copy(written);
  const Dump again = read_texture_file(copy.path(), kind, {}, true);
  if (again.texels != dump.texels) return "texels differ";
  if (again.info.desc != dump.info.desc) return "another texture";
  if (again.info.attributes != dump.info.attributes) return "other attributes";
  return texture_file_bytes(again, kind) == written ? "" : "the second copy is another";
}

/// The same of a sidecar's text.
inline std::string sidecar_fault(const std::string& text) {
  const auto read = [](const std::string& from) {
    return texture_info(parse_sidecar(from, "x"), ImageKind::raw, {}, "x");
  };
  const DumpInfo info = read(text);
  const std::string written = raw_sidecar(info, "x");
  const DumpInfo again = read(written);
  if (again.desc != info.desc) return "another texture";
  if (again.attributes != info.attributes) return "other attributes";
  return raw_sidecar(again, "x") == written ? "" : "the second copy is another";
}

}  // namespace gicodec::tools
