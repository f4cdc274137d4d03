// Where the tiles of blocks lie in a texture (FORMAT.md, "In memory").

/** How column, row and slice of a block's tile grow with its x, with y and with z. */
const TILES = {
  atlas_xy_z: ([nx]) => [[1, 0, 0], [nx, 0, 0], [0, 1, 0]],
  atlas_xz_y: ([nx]) => [[1, 0, 0], [0, 1, 0], [nx, 0, 0]],
  atlas_x_yz: ([, ny]) => [[1, 0, 0], [0, 1, 0], [0, ny, 0]],
  slices_xz_y: () => [[1, 0, 0], [0, 0, 1], [0, 1, 0]],
  slices_xy_z: () => [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  blocks: ([nx, ny]) => [[0, 0, 1], [0, 0, nx], [0, 0, nx * ny]],
  atlas_yz_x: ([, ny]) => [[0, 1, 0], [1, 0, 0], [ny, 0, 0]],
  slices_yx_z: () => [[0, 1, 0], [1, 0, 0], [0, 0, 1]],
};

/** The tiles of a texture by its description: a block with its guard band and padding. */
export class Tiles {
  #laid;
  #extent;
  #texelBytes;

  constructor({tiling, grid, slots, block, guardBand, padBefore = 0, padAfter = 0, width, height, slices, textureBytes}) {
    this.#laid = slots ?? grid;
    this.#extent = [width, height, slices];
    this.#texelBytes = textureBytes / (width * height * slices);
    /** As above. */
    this.steps = TILES[tiling](this.#laid);
    /** Texels of a tile along each axis. */
    this.size = block.map((side, axis) => side + (axis < 2 ? 2 * guardBand : 0) + (side > 1 ? padBefore + padAfter : 0));
    /** Texels of a tile in front of its core. */
    this.offset = guardBand + padBefore;
  }

  /** The box of texels of a block by its number: {x, y, z, columns, rows, slices}. */
  of(block) {
    const [nx, ny] = this.#laid;
    const at = [block % nx, Math.floor(block / nx) % ny, Math.floor(block / (nx * ny))];
    const [x, y, z] = this.size.map((side, axis) => side * this.steps.reduce((sum, step, i) => sum + step[axis] * at[i], 0));
    const [columns, rows, slices] = [x, y, z].map((first, axis) => Math.min(this.size[axis], this.#extent[axis] - first));
    return {x, y, z, columns, rows, slices};
  }

  /** Calls body(first, end) with the bytes of each row of a block's tile in the texture. */
  forRows(block, body) {
    const {x, y, z, columns, rows, slices} = this.of(block), [width, height] = this.#extent;
    for (let slice = z; slice < z + slices; ++slice) {
      for (let row = y; row < y + rows; ++row) {
        const first = ((slice * height + row) * width + x) * this.#texelBytes;
        body(first, first + columns * this.#texelBytes);
      }
    }
  }
}
