// What the GPU has of a texture, for tests in pages.
import {DataUtils, RedIntegerFormat} from 'three';

/** The texels of an array texture of 32 bits each: words, or pairs of halves. */
export async function readWords(renderer, texture) {
  const {width, height, depth} = texture.image;
  return renderer.isWebGPURenderer ? readWebGPU(renderer.backend, texture, width, height, depth)
                                   : readWebGL(renderer, texture, width, height, depth);
}

async function readWebGPU(backend, texture, width, height, depth) {
  const {device} = backend, pitch = Math.ceil(width / 64) * 64;
  const buffer = device.createBuffer({size: 4 * pitch * height * depth, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
  const commands = device.createCommandEncoder();
  commands.copyTextureToBuffer({texture: backend.get(texture).texture}, {buffer, bytesPerRow: 4 * pitch, rowsPerImage: height},
                               [width, height, depth]);
  device.queue.submit([commands.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const rows = new Uint32Array(buffer.getMappedRange());
  const words = new Uint32Array(width * height * depth);
  for (let y = 0; y < height * depth; ++y) words.set(rows.subarray(y * pitch, y * pitch + width), y * width);
  buffer.destroy();
  return words;
}

function readWebGL(renderer, texture, width, height, depth) {
  const gl = renderer.getContext(), framebuffer = gl.createFramebuffer();
  const integer = texture.format === RedIntegerFormat, size = width * height;
  const texels = integer ? new Uint32Array(4 * size) : new Float32Array(4 * size);
  const words = new Uint32Array(size * depth);
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, framebuffer);
  for (let slice = 0; slice < depth; ++slice) {
    const handle = renderer.properties.get(texture).__webglTexture;
    gl.framebufferTextureLayer(gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, handle, 0, slice);
    gl.readPixels(0, 0, width, height, integer ? gl.RGBA_INTEGER : gl.RGBA, integer ? gl.UNSIGNED_INT : gl.FLOAT, texels);
    for (let i = 0; i < size; ++i) {  // halves come as floats, exactly
      words[slice * size + i] = integer ? texels[4 * i]
        : DataUtils.toHalfFloat(texels[4 * i]) | DataUtils.toHalfFloat(texels[4 * i + 1]) << 16;
    }
  }
  gl.deleteFramebuffer(framebuffer);
  renderer.resetState();
  return words;
}
