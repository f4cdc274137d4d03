#!/usr/bin/env bash
# The shaders of the examples compile, in both languages.
#   shaders.sh GLSLANG SHADER_FOLDER
set -euo pipefail
glslang=$1 shaders=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# compile NAME BODY: a program that returns what the body says, which is GLSL.
compile() {
  {
    echo '#version 450'
    cat "$shaders/$1.glsl"
    echo "layout(location = 0) out vec4 result; vec3 lit() { $2 } void main() { result = lit().xyzz; }"
  } >"$scratch/glsl.frag"
  {
    cat "$shaders/$1.hlsl"
    echo "float3 lit() { $2 } float4 main() : SV_Target { return lit().xyzz; }" |
      sed -E 's/\bivec3/int3/g; s/\bvec3/float3/g'
  } >"$scratch/hlsl.frag"
  "$glslang" -V --target-env vulkan1.1 -o "$scratch/$1.glsl.spv" "$scratch/glsl.frag"
  "$glslang" -V -D -S frag -e main --target-env vulkan1.1 -o "$scratch/$1.hlsl.spv" \
    "$scratch/hlsl.frag"
}

up='vec3(0.0, 1.0, 0.0)'
compile ambient_cube "return ambient_cube(vec3(0.5, 0.5, 0.5), $up);"
compile irradiance_vectors "return has_light(3) ? vector_light(3, $up) : $up;"
compile probes "ProbeVolume v; v.grid = ivec3(4, 4, 4); v.origin = $up; v.spacing = $up;
  v.scroll = ivec3(1, 0, 0); v.color_core = 8.0; v.visibility_core = 16.0;
  return probe_light(v, $up, $up, $up);"
compile voxels "return voxel_light($up, $up, 2u).xyz;"
[ "$(find "$scratch" -name '*.spv' -size +0 | wc -l)" -eq 8 ]
