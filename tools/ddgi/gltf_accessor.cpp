#include "gltf_accessor.h"

#include "dump/error.h"
#include "gltf.h"

#include <tiny_gltf.h>

#include <cstring>

namespace gicodec::ddgi {
namespace {

/// Elements of one accessor; enough for the largest mesh, and for what a hostile one may ask for.
constexpr std::size_t kMaxElements = 3 * kMaxGltfTriangles;

template <typename T>
T load(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

template <typename T>
float load_integer(const unsigned char* at, bool normalized) {
  const auto value = static_cast<float>(load<T>(at));
  if (!normalized) return value;
  return std::max(-1.0F, value / static_cast<float>(std::numeric_limits<T>::max()));
}

float load_float(const unsigned char* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load_integer<std::int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load_integer<std::uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load_integer<std::int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load_integer<std::uint16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load_integer<std::uint32_t>(at, normalized);
    default:
      return load<float>(at);
  }
}

}  // namespace

AccessorReader::AccessorReader(const tinygltf::Model& model, std::string path)
    : model_(model), path_(std::move(path)), elements_left_(std::uint64_t{1} << 22) {
  constexpr std::uint64_t kUses = 16;  // of each byte
  for (const auto& buffer : model.buffers) elements_left_ += kUses * buffer.data.size();
}

void AccessorReader::fail(const std::string& what) const {
  tools::fail(tools::Exit::bad_input, "{}: {}", path_, what);
}

AccessorReader::Range AccessorReader::range(int index, int components) const {
  const auto in = [](int i, std::size_t size) {
    return i >= 0 && static_cast<std::size_t>(i) < size;
  };
  if (!in(index, model_.accessors.size())) fail(fmt::format("there is no accessor {}", index));
  const auto& accessor = model_.accessors[static_cast<std::size_t>(index)];
  const std::string name = fmt::format("accessor {}", index);
  if (accessor.sparse.isSparse)
    fail(name + " is sparse, which is not supported: export it without sparse accessors");
  if (!in(accessor.bufferView, model_.bufferViews.size())) fail(name + " has no buffer view");
  const auto& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (!in(view.buffer, model_.buffers.size())) fail(name + " has no buffer");
  const auto& bytes = model_.buffers[static_cast<std::size_t>(view.buffer)].data;

  const int found = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const int size =
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  if (found != components || size < 1) fail(name + " is of an unexpected type");
  const std::size_t element = static_cast<std::size_t>(size) * static_cast<std::size_t>(components);
  const std::size_t stride = view.byteStride > 0 ? view.byteStride : element;
  if (accessor.count > kMaxElements) fail(name + " is too large");
  // Offsets and lengths are 64-bit numbers from the file: compare before adding.
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset ||
      accessor.byteOffset > view.byteLength || stride < element || stride > 255) {
    fail(name + " lies outside of its buffer");
  }
  if (accessor.count > elements_left_)
    fail("its meshes and animations use the same bytes too often: give each its own accessors");
  elements_left_ -= accessor.count;
  const std::size_t space = view.byteLength - accessor.byteOffset;
  if (accessor.count > 0 &&
      (accessor.count - 1 > space / stride || (accessor.count - 1) * stride + element > space)) {
    fail(name + " lies outside of its buffer");
  }
  return {bytes.data() + view.byteOffset + accessor.byteOffset, accessor.count, stride,
          accessor.componentType, accessor.normalized};
}

std::vector<std::array<float, 4>> AccessorReader::floats(int accessor, int components) const {
  const Range r = range(accessor, components);
  if (r.type == TINYGLTF_COMPONENT_TYPE_DOUBLE)
    fail(fmt::format("accessor {} holds doubles", accessor));
  const auto size = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(r.type)));
  std::vector<std::array<float, 4>> values(r.count);
  for (std::size_t i = 0; i < r.count; ++i) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(components); ++c) {
      values[i][c] = load_float(r.first + i * r.stride + c * size, r.type, r.normalized);
      if (!std::isfinite(values[i][c]))
        fail(fmt::format("accessor {}: element {} is not finite", accessor, i));
    }
  }
  return values;
}

std::vector<std::uint32_t> AccessorReader::indices(int accessor) const {
  const Range r = range(accessor, 1);
  std::vector<std::uint32_t> values(r.count);
  for (std::size_t i = 0; i < r.count; ++i) {
    const unsigned char* at = r.first + i * r.stride;
    switch (r.type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        values[i] = *at;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        values[i] = load<std::uint16_t>(at);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        values[i] = load<std::uint32_t>(at);
        break;
      default:
        fail(fmt::format("accessor {} holds no indices", accessor));
    }
  }
  return values;
}

}  // namespace gicodec::ddgi
