#include "tools/dump_support.h"

#include "dump/file_system.h"

#include <gicodec/textures.h>

#if defined(_WIN32)
#include <windows.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

namespace gicodec::tools {

namespace fs = std::filesystem;

TemporaryDirectory::TemporaryDirectory() {
  std::random_device random;
  do {
    root_ = fs::temp_directory_path() / fmt::format("gicodec-test-{:08x}", random());
  } while (!fs::create_directory(root_));
  fs::permissions(root_, fs::perms::owner_all);
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code error;
  fs::remove_all(root_, error);
}

std::vector<std::string> TemporaryDirectory::files(const std::string& folder) const {
  std::vector<std::string> names;
  if (!fs::exists(root_ / native_path(folder))) return names;
  for (const auto& entry : fs::directory_iterator(root_ / native_path(folder))) {
    if (entry.is_regular_file()) names.push_back(path_text(entry.path().filename()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

#if defined(_WIN32)
bool long_paths() {
  const HMODULE system = GetModuleHandleW(L"ntdll");
  const auto asked = reinterpret_cast<BOOLEAN(NTAPI*)()>(
      reinterpret_cast<void*>(GetProcAddress(system, "RtlAreLongPathsEnabled")));
  return asked != nullptr && asked() != 0;
}
#endif

std::vector<std::byte> random_texels(const TextureDesc& desc, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(desc)));
  for (std::byte& byte : texels) byte = static_cast<std::byte>(random());
  return texels;
}

Dump random_dump(const TextureDesc& desc, std::uint32_t seed) {
  return {make_info(desc), random_texels(desc, seed)};
}

std::vector<Dump> random_images(Format format, const TextureHead& head) {
  std::vector<Dump> images;
  for (const ImagePlace& place : places_of(head)) {
    const Grid records = records_of(level_texels(head, place.level), format);
    const BlockShape block = head.volume ? BlockShape{4, 4, 4} : BlockShape{8, 8, 1};
    const TextureDesc desc = map_texture(format, records, block);
    Dump image{make_info(desc), random_texels(desc, static_cast<std::uint32_t>(images.size()))};
    image.info.head = images.empty();
    if (!image.info.head) image.info.attributes.clear();
    image.info.place = place;
    image.info.image = image_name(head, place);
    images.push_back(std::move(image));
  }
  return images;
}

Dump without_alpha(Dump dump) {
  const Record& record = dump.info.desc.record;
  dump.info.channels.alpha = false;
  for (std::size_t i = 0; i < dump.texels.size(); i += record.bytes) {
    std::byte* texel = &dump.texels[i];
    std::vector<std::uint32_t> codes;
    for (const Component& component : record.used()) {
      codes.push_back(load_component(texel, record.bytes, component));
    }
    std::fill_n(texel, record.bytes, std::byte{0});
    for (std::size_t c = 0; c < codes.size(); ++c) {
      if (letter(record.components[c]) == 'A') continue;
      store_component(texel, record.bytes, record.components[c], codes[c]);
    }
  }
  return dump;
}

std::vector<std::byte> file_bytes(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(native_path(path), std::ios::binary).rdbuf();
  const auto bytes = std::as_bytes(std::span(text.view()));
  return {bytes.begin(), bytes.end()};
}

std::string file_text(const std::string& path) {
  const auto bytes = file_bytes(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_bytes(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream file(native_path(path), std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

std::optional<Error> read_error(const std::string& path, const Hints& hints) {
  try {
    (void)read_dump(path, hints);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

}  // namespace gicodec::tools
