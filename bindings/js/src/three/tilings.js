// Where the tiles of blocks lie in a texture (FORMAT.md, "In memory").

/** How column, row and slice of a block's tile grow with its x, with y and with z. */
const TILES = {
  atlas_xy_z: ([nx]) => [[1, 0, 0], [nx, 0, 0], [0, 1, 0]],
  atlas_xz_y: ([nx]) => [[1, 0, 0], [0, 1, 0], [nx, 0, 0]],
  atlas_x_yz: ([, ny]) => [[1, 0, 0], [0, 1, 0], [0, ny, 0]],
  slices_xz_y: () => [[1, 0, 0], [0, 0, 1], [0, 1, 0]],
  slices_xy_z: () => [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  atlas_yz_x: ([, ny]) => [[0, 1, 0], [1, 0, 0], [ny, 0, 0]],
  slices_yx_z: () => [[0, 1, 0], [1, 0, 0], [0, 0, 1]],
};

/**
 * Of a texture of square blocks: the steps above, texels from a tile to the next, and those of a tile in front
 * of its core. null: it has no such tiles.
 */
export function tilingOf({tiling, grid, block, guardBand, padBefore = 0, padAfter = 0}) {
  const steps = TILES[tiling]?.(grid);
  if (!steps || block[0] !== block[1] || block[2] !== 1) return null;
  return {steps, stride: block[0] + 2 * guardBand + padBefore + padAfter, offset: padBefore + guardBand};
}

/** The first texel of the tile of a block by its number. */
export function originOf(desc, block) {
  const {steps, stride} = tilingOf(desc);
  const [nx, ny] = desc.grid;
  const at = [block % nx, Math.floor(block / nx) % ny, Math.floor(block / (nx * ny))];
  const place = (axis) => steps.reduce((sum, step, i) => sum + step[axis] * at[i], 0);
  return {x: place(0) * stride, y: place(1) * stride, z: place(2)};
}

/** Calls body(first, end) with the bytes of each row of a block's tile in the texture. */
export function forRows(desc, block, body) {
  const {x, y, z} = originOf(desc, block);
  const {stride} = tilingOf(desc);
  const bytes = desc.textureBytes / (desc.width * desc.height * desc.slices);
  for (let row = 0; row < stride; ++row) {
    const first = ((z * desc.height + y + row) * desc.width + x) * bytes;
    body(first, first + stride * bytes);
  }
}
