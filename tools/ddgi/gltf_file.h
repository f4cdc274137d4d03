// Opening a glTF file: what is not glTF 2.0, or needs what is not supported, is refused in plain
// words before anything else of it is looked at.
#pragma once

#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace gicodec::ddgi {

/// Reads .gltf or .glb, distinguished by their first bytes, with buffers and images; adds to
/// `files` what it reads: files in its folder and below, and others only if they may lie `outside`.
/// Throws tools::Error: Exit::io if the file cannot be opened, Exit::bad_input otherwise.
[[nodiscard]] tinygltf::Model read_gltf_file(const std::string& path,
                                             std::vector<std::string>& files, bool outside);

}  // namespace gicodec::ddgi
