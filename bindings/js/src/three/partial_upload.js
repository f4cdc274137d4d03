// The blocks of a texture that changed, to the GPU, without the others.
import {formatOf} from './texture_formats.js';
import {originOf, tilingOf} from './tilings.js';

/** Says that all of texture.image.data changed. */
export function uploadAll(renderer, texture) {
  texture.needsUpdate = true;
  // WebGPURenderer does not look at the textures of what stands still.
  if (renderer?.isWebGPURenderer && renderer.backend.has(texture)) renderer.initTexture(texture);
}

/** Shares of a texture's blocks from which on all is sent at once. */
const MOST = 0.5;

/**
 * Sends these blocks (ascending) of texture.image.data, whose tiles `desc` describes. Returns the bytes that
 * were sent; 0: the renderer sends all of it when it draws next.
 */
export function uploadBlocks(renderer, texture, desc, blocks) {
  const all = () => (uploadAll(renderer, texture), 0);
  if (blocks.length > MOST * desc.blocks) return all();
  const {backend} = renderer;
  const gl = backend ? backend.gl : renderer.getContext();
  const handle = !backend ? renderer.properties.get(texture).__webglTexture
    : backend.has(texture) ? backend.get(texture)[gl ? 'textureGPU' : 'texture'] : null;
  if (!handle) return all();  // it was not drawn yet, or the context was lost
  const boxes = boxesOf(desc, blocks);
  const {glFormat, glType, bytes} = formatOf(desc.format);
  const {width, height, data} = texture.image;
  if (!gl) {
    for (const {x, y, z, columns, rows} of boxes) {
      backend.device.queue.writeTexture({texture: handle, origin: [x, y, z]}, data, {
        offset: ((z * height + y) * width + x) * bytes, bytesPerRow: width * bytes, rowsPerImage: height,
      }, [columns, rows, 1]);
    }
  } else {
    sendWebGL(gl, backend ? backend.state : renderer.state, handle, boxes, texture.image, gl[glFormat], gl[glType]);
  }
  return boxes.reduce((sum, {columns, rows}) => sum + columns * rows * bytes, 0);
}

/** Boxes of texels that have the tiles of these blocks, those that lie in a row together. */
function boxesOf(desc, blocks) {
  const {stride} = tilingOf(desc);
  const boxes = [];
  for (const block of blocks) {
    const {x, y, z} = originOf(desc, block);
    const last = boxes.at(-1);
    if (last && last.y === y && last.z === z && last.x + last.columns === x) last.columns += stride;
    else boxes.push({x, y, z, columns: stride, rows: stride});
  }
  return boxes;
}

const UNPACK = {  // as the array lies in memory
  UNPACK_FLIP_Y_WEBGL: false, UNPACK_PREMULTIPLY_ALPHA_WEBGL: false, UNPACK_ALIGNMENT: 1, UNPACK_ROW_LENGTH: 0,
  UNPACK_IMAGE_HEIGHT: 0, UNPACK_SKIP_PIXELS: 0, UNPACK_SKIP_ROWS: 0, UNPACK_SKIP_IMAGES: 0,
};

function sendWebGL(gl, state, handle, boxes, {width, height, data}, format, type) {
  const before = Object.keys(UNPACK).map((name) => [gl[name], gl.getParameter(gl[name])]);
  for (const [name, value] of Object.entries({...UNPACK, UNPACK_ROW_LENGTH: width, UNPACK_IMAGE_HEIGHT: height})) {
    gl.pixelStorei(gl[name], value);
  }
  state.bindTexture(gl.TEXTURE_2D_ARRAY, handle);
  for (const {x, y, z, columns, rows} of boxes) {
    gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, x);
    gl.pixelStorei(gl.UNPACK_SKIP_ROWS, y);
    gl.pixelStorei(gl.UNPACK_SKIP_IMAGES, z);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, x, y, z, columns, rows, 1, format, type, data);
  }
  before.forEach(([name, value]) => gl.pixelStorei(name, value));
}
