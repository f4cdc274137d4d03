// Ambient cubes in one 3D texture of Rx x 2Ry x 3Rz texels, as Bevy's irradiance volumes have them:
// the sides -x, -y, -z of a voxel at y, +x, +y, +z at y + Ry; x, y and z at z, z + Rz, z + 2Rz.

Texture3D<float4> voxels : register(t0);
SamplerState linear_clamp : register(s0);  // linear filter, no mipmaps

// Light from the three sides that a normal looks at. `place`: in the volume, 0 to 1 along each axis.
float3 ambient_cube(float3 place, float3 normal) {
  float3 size;
  voxels.GetDimensions(size.x, size.y, size.z);
  float3 sides = size / float3(1, 2, 3);
  // Half a texel from the edge, so that nothing is mixed with another side.
  float3 texel = clamp(place * sides, 0.5, sides - 0.5);
  float3 squared = normal * normal, light = 0;
  for (int axis = 0; axis < 3; ++axis) {
    float3 at = texel + float3(0, normal[axis] >= 0 ? sides.y : 0, axis * sides.z);
    light += squared[axis] * voxels.SampleLevel(linear_clamp, at / size, 0).rgb;
  }
  return light;
}
