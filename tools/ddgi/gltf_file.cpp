#include "gltf_file.h"

#include "dump/error.h"
#include "gltf.h"

#include <tiny_gltf.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

namespace gicodec::ddgi {
namespace {

using tools::Exit;
using tools::fail;

/// What the loader's callbacks share.
struct Loading {
  tinygltf::Model& model;
  std::vector<std::string>& files;
  std::string folder;                   ///< of the file
  bool outside = false;                 ///< files may lie anywhere
  std::string refused;                  ///< one that does
  std::uint64_t bytes = 0, texels = 0;  ///< of all buffers' and images' files, of all images
};

enum class ImageFile : std::uint8_t { other, png, jpeg };

ImageFile kind_of(std::span<const unsigned char> bytes) {
  constexpr std::array<unsigned char, 8> kPng{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  if (bytes.size() >= kPng.size() && std::ranges::equal(bytes.first(kPng.size()), kPng)) {
    return ImageFile::png;
  }
  const bool jpeg = bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
  return jpeg ? ImageFile::jpeg : ImageFile::other;
}

/// What the type, or else the name, asks for; other: neither says.
ImageFile kind_named(const tinygltf::Image& image) {
  const auto ends = [&](std::string_view ending) {
    return tools::lower_case(image.uri).ends_with(ending);
  };
  if (image.mimeType == "image/png") return ImageFile::png;
  if (image.mimeType == "image/jpeg") return ImageFile::jpeg;
  if (ends(".png")) return ImageFile::png;
  return ends(".jpg") || ends(".jpeg") ? ImageFile::jpeg : ImageFile::other;
}

/// Width × height as the header says, without decoding; 0 if it does not.
std::uint64_t image_area(ImageFile kind, std::span<const unsigned char> b) {
  const auto big16 = [&](std::size_t at) { return std::uint64_t{b[at]} << 8 | b[at + 1]; };
  if (kind == ImageFile::png && b.size() >= 24) {
    return (big16(16) << 16 | big16(18)) * (big16(20) << 16 | big16(22));
  }
  if (kind != ImageFile::jpeg) return 0;
  for (std::size_t at = 2; at + 9 <= b.size() && b[at] == 0xFF; at += 2 + big16(at + 2)) {
    const unsigned marker = b[at + 1];
    const bool frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return big16(at + 5) * big16(at + 7);
  }
  return 0;
}

/// Whether all chunks lie within the file, down to the last: memory is taken by what they say.
bool whole_png(std::span<const unsigned char> b) {
  for (std::size_t at = 8; b.size() >= 12 && at <= b.size() - 12;) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | b[at + i];
    if (length > b.size() - 12 - at) return false;
    if (std::equal(b.data() + at + 4, b.data() + at + 8, "IEND")) return true;
    at += std::size_t{12} + length;
  }
  return false;
}

bool lies_in_buffer(const tinygltf::Model& model, const tinygltf::Image& image) {
  const auto view_index = static_cast<std::size_t>(image.bufferView);
  if (view_index >= model.bufferViews.size()) return false;
  const tinygltf::BufferView& view = model.bufferViews[view_index];
  const auto buffer = static_cast<std::size_t>(view.buffer);
  if (view.buffer < 0 || buffer >= model.buffers.size()) return false;
  const std::size_t size = model.buffers[buffer].data.size();
  return view.byteOffset <= size && view.byteLength <= size - view.byteOffset;
}

/// Refuses an image before memory is spent on it, and kinds that glTF does not have: what decodes
/// images here knows more kinds, and would try them one after the other.
bool load_image(tinygltf::Image* image, const int index, std::string* errors, std::string* warnings,
                int width, int height, const unsigned char* bytes, int size, void* user) {
  auto& loading = *static_cast<Loading*>(user);
  // The loader takes the view's word for where it lies.
  if (image->bufferView >= 0 && !lies_in_buffer(loading.model, *image)) {
    *errors += fmt::format("image {} lies outside of its buffer", index);
    return false;
  }
  const std::span data(bytes, static_cast<std::size_t>(std::max(size, 0)));
  const ImageFile kind = kind_of(data), named = kind_named(*image);
  if (named != ImageFile::other && kind != ImageFile::other && named != kind) {
    *errors += fmt::format("image {} is called a {} and is a {}; correct its name or type", index,
                           named == ImageFile::png ? "PNG" : "JPEG",
                           kind == ImageFile::png ? "PNG" : "JPEG");
    return false;
  }
  const auto area = image_area(kind, data);
  if (area == 0 || area > kMaxGltfImage) {
    *errors += area == 0 ? fmt::format("image {} is no PNG or JPEG; convert it to one", index)
                         : fmt::format("image {} has more than {} texels; make it smaller", index,
                                       kMaxGltfImage);
    return false;
  }
  // What packs images packs so much; memory is taken by what the header says.
  constexpr std::uint64_t kFree = std::uint64_t{1} << 22, kPerByte = 1100;
  if (area > kFree && area / kPerByte > data.size()) {
    *errors += fmt::format("image {} claims {} texels in {} bytes", index, area, data.size());
    return false;
  }
  if (kind == ImageFile::png && !whole_png(data)) {
    *errors += fmt::format("image {} is a PNG that is cut off or damaged; write it anew", index);
    return false;
  }
  loading.texels += area;
  if (loading.texels > kMaxGltfImages) {
    *errors += fmt::format("its images have more than {} texels together; make them smaller",
                           kMaxGltfImages);
    return false;
  }
  return tinygltf::LoadImageData(image, index, errors, warnings, width, height, bytes, size,
                                 nullptr);
}

constexpr std::array<std::string_view, 3> kSupported{
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization"};

/// What a file with a required extension holds, and what makes it readable.
struct Unsupported {
  std::string_view extension, holds, cure;
};
constexpr std::array<Unsupported, 6> kUnsupported{{
    {"KHR_draco_mesh_compression", "meshes compressed with Draco",
     "export it without compression, or remove it with \"gltf-transform copy IN OUT\""},
    {"EXT_meshopt_compression", "meshes compressed with meshoptimizer",
     "export it without compression"},
    {"KHR_meshopt_compression", "meshes compressed with meshoptimizer",
     "export it without compression"},
    {"KHR_texture_basisu", "textures in KTX2 files", "export it with PNG or JPEG textures"},
    {"EXT_texture_webp", "textures in WebP files", "export it with PNG or JPEG textures"},
    {"KHR_texture_transform", "moved and scaled textures",
     "bake the transforms into the texture coordinates"},
}};

std::string read_bytes(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) fail(Exit::io, "{}: cannot be opened: {}", path, error.message());
  if (size > kMaxGltfBytes)
    fail(Exit::bad_input, "{}: is larger than {} bytes; split or simplify it", path, kMaxGltfBytes);
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(Exit::io, "{}: cannot be opened: {}", path, std::strerror(errno));
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(in.gcount()) != size)
    fail(Exit::io, "{}: cannot be read to its end", path);
  return bytes;
}

/// Whether a path leads into the folder, links followed.
bool lies_in(const std::string& folder, const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return false;
  const fs::path file = fs::weakly_canonical(path, error);
  return !error && std::ranges::mismatch(root, file).in1 == root.end();
}

/// Pipes and devices would be waited for. The loader looks in the current folder as well, which is
/// none of the file's business.
bool is_file(const std::string& path, void* user) {
  auto& loading = *static_cast<Loading*>(user);
  std::error_code error;
  const bool slash = loading.folder.ends_with('/');
  if (!path.starts_with(slash ? loading.folder : loading.folder + "/")) return false;
  if (!loading.outside && !lies_in(loading.folder, path)) {
    loading.refused = path;
    return false;
  }
  return std::filesystem::is_regular_file(path, error);
}

/// As it is: no variables, no commands.
std::string same_path(const std::string& path, void* /*user*/) { return path; }

bool write_nothing(std::string* errors, const std::string& /*path*/,
                   const std::vector<unsigned char>& /*bytes*/, void* /*user*/) {
  *errors += "nothing is written";
  return false;
}

/// A buffer or image that the file names.
bool read_named(std::vector<unsigned char>* bytes, std::string* errors, const std::string& path,
                void* user) {
  auto& loading = *static_cast<Loading*>(user);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (!error) loading.bytes += size;
  if (error || size > kMaxGltfBytes || loading.bytes > kMaxGltfBytes) {
    *errors += error ? fmt::format("{} {}\n", path, error.message())
                     : fmt::format("{} and the files before it have more than {} bytes\n", path,
                                   kMaxGltfBytes);
    return false;
  }
  loading.files.push_back(path);
  return tinygltf::ReadWholeFile(bytes, errors, path, nullptr);
}

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

void check_version(const std::string& path, std::string_view version) {
  if (version.starts_with("2.")) return;
  fail(Exit::bad_input, "{}: is glTF {}; only glTF 2.0 is read: export it as that{}", path, version,
       version.starts_with("1.") ? ", or convert it with \"gltf-pipeline -i IN -o OUT\"" : "");
}

/// Version and required extensions, from the JSON alone: the rest of the file may make no sense to
/// a reader that does not know the extension. And its depth, since the loader's stack grows with
/// it.
void check_needs(const std::string& path, std::string_view text) {
  using nlohmann::json;
  constexpr int kMaxDepth = 64;
  const auto wanted = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > kMaxDepth)
      fail(Exit::bad_input, "{}: its JSON nests more than {} deep; simplify its extras", path,
           kMaxDepth);
    return depth != 1 || event != json::parse_event_t::key || parsed == "asset" ||
           parsed == "extensionsRequired";
  };
  const json root = json::parse(text, wanted, false);
  if (!root.is_object()) return;  // the loader says what is wrong
  const json asset = root.value("asset", json()), none = json::array();
  if (asset.is_object() && asset.contains("version") && asset["version"].is_string())
    check_version(path, asset["version"].get<std::string>());
  for (const json& entry :
       root.contains("extensionsRequired") ? root["extensionsRequired"] : none) {
    if (!entry.is_string()) continue;
    const auto name = entry.get<std::string>();
    if (std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end()) continue;
    const auto* known = std::find_if(kUnsupported.begin(), kUnsupported.end(),
                                     [&](const Unsupported& u) { return u.extension == name; });
    if (known == kUnsupported.end())
      fail(Exit::bad_input, "{}: needs the extension {}, which is not supported: export it without",
           path, name);
    fail(Exit::bad_input, "{}: holds {} (the extension {}), which are not supported: {}", path,
         known->holds, name, known->cure);
  }
}

}  // namespace

tinygltf::Model read_gltf_file(const std::string& path, std::vector<std::string>& files,
                               bool outside) {
  files.push_back(path);
  const std::string bytes = read_bytes(path);
  const bool binary = bytes.starts_with("glTF");
  if (binary && bytes.size() >= 8 && word(bytes, 4) != 2)
    check_version(path, fmt::format("{}.0", word(bytes, 4)));
  check_needs(path, binary ? std::string_view(bytes).substr(std::min<std::size_t>(bytes.size(), 20),
                                                            word(bytes, 12))
                           : std::string_view(bytes));
  tinygltf::Model model;
  std::string errors, warnings;
  bool loaded = false;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const std::string folder = parent.empty() ? std::string(1, '.') : parent.string();
  Loading loading{model, files, folder, outside, {}, 0, 0};
  try {
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(load_image, &loading);
    loader.SetFsCallbacks({is_file, same_path, read_named, write_nothing, &loading});
    const auto size = static_cast<unsigned>(bytes.size());
    loaded =
        binary ? loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                             reinterpret_cast<const unsigned char*>(bytes.data()),
                                             size, folder)
               : loader.LoadASCIIFromString(&model, &errors, &warnings, bytes.data(), size, folder);
  } catch (const std::exception& thrown) {
    errors = thrown.what();
  }
  if (!loading.refused.empty()) {
    fail(Exit::bad_input,
         "{}: names {}, which lies outside of its folder; --allow-outside reads such files, if you "
         "trust who made it",
         path, loading.refused);
  }
  if (loaded) return model;
  while (!errors.empty() && (errors.back() == '\n' || errors.back() == ' ')) errors.pop_back();
  fail(Exit::bad_input,
       "{}: is no readable glTF 2.0 file: {}; .gltf with all files it names, or .glb, is expected",
       path, errors.empty() ? "unknown reason" : errors);
}

}  // namespace gicodec::ddgi
