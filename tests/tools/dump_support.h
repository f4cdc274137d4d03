// Dumps to test with, and a directory to put them in.
#pragma once

#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/texture_file.h"

#include <gicodec/probes.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// A directory of its own for a test, removed at the end.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory();
  [[nodiscard]] std::string path(const std::string& name) const {
    return path_text(root_ / native_path(name));
  }
  /// Names of the files in it, hidden ones included, ascending.
  [[nodiscard]] std::vector<std::string> files(const std::string& folder = "") const;

 private:
  std::filesystem::path root_;
};

#if defined(_WIN32)
/// Whether the system allows paths of more than 260 characters.
[[nodiscard]] bool long_paths();
#endif

/// Reproducible texels; bits that no component uses are zero.
[[nodiscard]] std::vector<std::byte> random_texels(const TextureDesc& desc, std::uint32_t seed);

/// A dump of random texels with the attributes of make_info(). Alpha is zero if it has no channel.
[[nodiscard]] Dump random_dump(const TextureDesc& desc, std::uint32_t seed);
[[nodiscard]] Dump without_alpha(Dump dump);
/// The same of all levels and faces of a texture; the first has the attributes.
[[nodiscard]] std::vector<Dump> random_images(Format format, const TextureHead& head);

[[nodiscard]] std::vector<std::byte> file_bytes(const std::string& path);
[[nodiscard]] std::string file_text(const std::string& path);
void write_bytes(const std::string& path, std::span<const std::byte> bytes);

/// The error that reading a file gives; nothing if it can be read.
[[nodiscard]] std::optional<Error> read_error(const std::string& path, const Hints& hints = {});

}  // namespace gicodec::tools
