// glTF 2.0 in and out: meshes, materials with base colour and emission, node animation, punctual
// lights (KHR_lights_punctual), cameras, and extras for sky and probe volume (docs/ddgi.md).
#pragma once

#include "scene.h"

#include "dump/file.h"

#include <array>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// Reads .gltf or .glb. Animated nodes become dynamic objects; skins and morph targets stay at
/// rest. Where the file has no volume or no camera, rays find a place for them (framing.h). Throws
/// tools::Error: Exit::io if the file cannot be opened, Exit::bad_input if it is broken, has
/// nothing to draw, names files outside of its folder unless they may lie `outside`, or is larger
/// than the limits below.
[[nodiscard]] Scene load_gltf(const std::string& path, bool outside = false);

inline constexpr std::uint64_t kMaxGltfBytes = std::uint64_t{1} << 30;  ///< and of what it names
inline constexpr std::uint64_t kMaxGltfTriangles = 50'000'000;
inline constexpr std::uint64_t kMaxGltfImage = std::uint64_t{1} << 26;   ///< texels
inline constexpr std::uint64_t kMaxGltfImages = std::uint64_t{1} << 28;  ///< of all together

/// Second texture coordinates of each triangle's corners: of every mesh of every object, in order.
using SecondUvs = std::vector<std::vector<std::array<Vec2, 3>>>;

/// Writes a binary .glb with everything embedded; what moves becomes an animation sampled `frames`
/// times, 1 / fps apart. Lights, emission, sky and exposure keep their state at `start`; area
/// lights are left out. Traced at a sampled time, the file gives the texels of the scene bit for
/// bit, unless an object turns: rotations are equal but for rounding. With `second`, meshes carry
/// TEXCOORD_1; vertices at which triangles do not agree are split.
void save_gltf(const std::string& path, const Scene& scene, double start, std::uint32_t frames,
               double fps, tools::Existing existing = tools::Existing::refuse,
               const SecondUvs& second = {});
/// The bytes of such a file of the scene as it stands at `start`.
[[nodiscard]] std::string gltf_bytes(const Scene& scene, double start);

}  // namespace gicodec::ddgi
