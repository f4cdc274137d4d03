#include "modules/module.h"

#include "error.h"
#include "modules/hevc.h"
#include "modules/http.h"
#include "modules/images.h"
#include "modules/nats.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace gicodec::tools {
namespace {

/// The program's run path and what the loader adds to it. dlopen() searches these itself, but not
/// where a sanitizer calls it in the program's place.
std::vector<std::string> library_folders() {
  std::vector<std::string> folders;
  void* const program = dlopen(nullptr, RTLD_LAZY);
  Dl_serinfo size{};
  if (program == nullptr || dlinfo(program, RTLD_DI_SERINFOSIZE, &size) != 0) return folders;
  const auto storage = std::make_unique<std::byte[]>(size.dls_size);
  auto* const info = new (storage.get()) Dl_serinfo(size);
  if (dlinfo(program, RTLD_DI_SERINFO, info) != 0) return folders;
  for (unsigned i = 0; i < info->dls_cnt; ++i) folders.emplace_back(info->dls_serpath[i].dls_name);
  return folders;
}

/// Whether its last part, the table of sections, is there: to load a file that was cut off ends the
/// program.
bool is_whole(const std::string& path) {
  ElfW(Ehdr) head{};
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return !error && file.read(reinterpret_cast<char*>(&head), sizeof head) &&
         std::memcmp(head.e_ident, ELFMAG, SELFMAG) == 0 && head.e_shoff <= size &&
         std::size_t{head.e_shnum} * head.e_shentsize <= size - head.e_shoff;
}

/// The table of a module, from the folders where the program finds its libraries; it stays loaded.
/// `purpose`: what it is for, for messages.
const ModuleHead* load_module(const char* name, const char* purpose) {
  for (const std::string& folder : library_folders()) {
    if (!folder.starts_with('/')) continue;  // never from where the user happens to stand
    const std::string path = fmt::format("{}/{}.so", folder, name);
    if (access(path.c_str(), F_OK) != 0) continue;
    if (!is_whole(path)) {
      fail(Exit::internal, "{}, which is needed for {}, is damaged; install it again", path,
           purpose);
    }
    void* const module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    const auto* const table = module == nullptr
                                  ? nullptr
                                  : static_cast<const ModuleHead*>(dlsym(module, "gicodec_module"));
    if (table == nullptr) {
      fail(Exit::internal, "{} cannot be loaded, which is needed for {}: {}", path, purpose,
           dlerror());
    }
    if (table->name != name || table->version != kVersionString) {
      fail(Exit::internal,
           "{}: is {} {}, and {} {} is needed for {}; install programs and modules together", path,
           table->name, table->version, name, kVersionString, purpose);
    }
    return table;
  }
  fail(Exit::internal,
       "{}.so, which is needed for {}, is not installed; it belongs into lib/gicodec beside the "
       "folder of the programs",
       name, purpose);
}

}  // namespace

const ImageModule& image_module() {
  static const auto* const module =
      reinterpret_cast<const ImageModule*>(load_module("gicodec-images", "PNG, TIFF and DPX"));
  return *module;
}

const HttpModule& http_module() {
  static const auto* const module =
      reinterpret_cast<const HttpModule*>(load_module("gicodec-http", "files on servers"));
  return *module;
}

const NatsModule& nats_module() {
  static const auto* const module =
      reinterpret_cast<const NatsModule*>(load_module("gicodec-nats", "NATS"));
  return *module;
}

const HevcModule& hevc_module() {
  static const auto* const module =
      reinterpret_cast<const HevcModule*>(load_module("gicodec-hevc", "HEVC"));
  return *module;
}

}  // namespace gicodec::tools
