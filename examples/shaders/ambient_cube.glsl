// Ambient cubes in one 3D texture of Rx x 2Ry x 3Rz texels, as Bevy's irradiance volumes have them:
// the sides -x, -y, -z of a voxel at y, +x, +y, +z at y + Ry; x, y and z at z, z + Rz, z + 2Rz.

layout(binding = 0) uniform sampler3D voxels;  // linear filter, no mipmaps

// Light from the three sides that a normal looks at. `place`: in the volume, 0 to 1 along each axis.
vec3 ambient_cube(vec3 place, vec3 normal) {
  vec3 size = vec3(textureSize(voxels, 0)), sides = size / vec3(1.0, 2.0, 3.0);
  // Half a texel from the edge, so that nothing is mixed with another side.
  vec3 texel = clamp(place * sides, vec3(0.5), sides - 0.5);
  vec3 squared = normal * normal, light = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    vec3 at = texel + vec3(0.0, normal[axis] >= 0.0 ? sides.y : 0.0, float(axis) * sides.z);
    light += squared[axis] * textureLod(voxels, at / size, 0.0).rgb;
  }
  return light;
}
