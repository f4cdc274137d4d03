// Reading accessors of a glTF file that may say anything: every range is checked.
#pragma once

#include "vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace gicodec::ddgi {

/// Reads with checks; throws tools::Error of Exit::bad_input that names file and accessor.
class AccessorReader {
 public:
  AccessorReader(const tinygltf::Model& model, std::string path);

  /// Elements with exactly `components` components as floats; normalised integers become [0, 1] or
  /// [-1, 1]. Unused places of an element are 0. All values are finite.
  [[nodiscard]] std::vector<std::array<float, 4>> floats(int accessor, int components) const;
  /// Scalar unsigned integers.
  [[nodiscard]] std::vector<std::uint32_t> indices(int accessor) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Range {
    const unsigned char* first;
    std::size_t count, stride;
    int type;  ///< of a component
    bool normalized;
  };
  [[nodiscard]] Range range(int accessor, int components) const;

  const tinygltf::Model& model_;
  std::string path_;
  /// Elements that may still be read: few bytes may name the same accessor again and again.
  mutable std::uint64_t elements_left_;
};

}  // namespace gicodec::ddgi
