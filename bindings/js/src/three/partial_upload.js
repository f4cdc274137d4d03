// The blocks of a texture that changed, to the GPU, without the others.
import {formatOf} from './texture_formats.js';

/** Says that all of a texture's image changed. */
export function uploadAll(renderer, texture) {
  texture.needsUpdate = true;
  // WebGPURenderer does not look at the textures of what stands still.
  if (renderer?.isWebGPURenderer && renderer.backend.has(texture)) renderer.initTexture(texture);
}

/** Shares of a texture's blocks from which on all is sent at once. */
const MOST = 0.5;

/**
 * Sends these blocks (ascending) of texture.image.data, whose tiles are `tiles`. Returns the bytes that were
 * sent; 0: the renderer sends all of it when it draws next.
 */
export function uploadBlocks(renderer, texture, desc, tiles, blocks) {
  const all = () => (uploadAll(renderer, texture), 0);
  const known = formatOf(desc.format);
  if (!known || blocks.length > MOST * desc.blocks) return all();
  const {backend} = renderer;
  const gl = backend ? backend.gl : renderer.getContext();
  const handle = !backend ? renderer.properties.get(texture).__webglTexture
    : backend.has(texture) ? backend.get(texture)[gl ? 'textureGPU' : 'texture'] : null;
  if (!handle) return all();  // it was not drawn yet, or the context was lost
  const boxes = boxesOf(tiles, blocks);
  const {glFormat, glType, bytes} = known;
  const {width, height, data} = texture.image;
  if (!gl) {
    for (const {x, y, z, columns, rows, slices} of boxes) {
      backend.device.queue.writeTexture({texture: handle, origin: [x, y, z]}, data, {
        offset: ((z * height + y) * width + x) * bytes, bytesPerRow: width * bytes, rowsPerImage: height,
      }, [columns, rows, slices]);
    }
  } else {
    const target = texture.isData3DTexture ? gl.TEXTURE_3D : gl.TEXTURE_2D_ARRAY;
    sendWebGL(gl, backend ? backend.state : renderer.state, target, handle, boxes, texture.image, gl[glFormat], gl[glType]);
  }
  return boxes.reduce((sum, {columns, rows, slices}) => sum + columns * rows * slices * bytes, 0);
}

/** Boxes of texels that have the tiles of these blocks, those that lie in a row together. */
function boxesOf(tiles, blocks) {
  const boxes = [];
  for (const block of blocks) {
    const box = tiles.of(block), last = boxes.at(-1);
    if (last && last.y === box.y && last.z === box.z && last.x + last.columns === box.x) last.columns += box.columns;
    else boxes.push(box);
  }
  return boxes;
}

const UNPACK = {  // as the array lies in memory
  UNPACK_FLIP_Y_WEBGL: false, UNPACK_PREMULTIPLY_ALPHA_WEBGL: false, UNPACK_ALIGNMENT: 1, UNPACK_ROW_LENGTH: 0,
  UNPACK_IMAGE_HEIGHT: 0, UNPACK_SKIP_PIXELS: 0, UNPACK_SKIP_ROWS: 0, UNPACK_SKIP_IMAGES: 0,
};

function sendWebGL(gl, state, target, handle, boxes, {width, height, data}, format, type) {
  const before = Object.keys(UNPACK).map((name) => [gl[name], gl.getParameter(gl[name])]);
  for (const [name, value] of Object.entries({...UNPACK, UNPACK_ROW_LENGTH: width, UNPACK_IMAGE_HEIGHT: height})) {
    gl.pixelStorei(gl[name], value);
  }
  state.bindTexture(target, handle);
  for (const {x, y, z, columns, rows, slices} of boxes) {
    gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, x);
    gl.pixelStorei(gl.UNPACK_SKIP_ROWS, y);
    gl.pixelStorei(gl.UNPACK_SKIP_IMAGES, z);
    gl.texSubImage3D(target, 0, x, y, z, columns, rows, slices, format, type, data);
  }
  before.forEach(([name, value]) => gl.pixelStorei(name, value));
}
