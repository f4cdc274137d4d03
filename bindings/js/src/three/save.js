// Baked grids as containers.
import {AXES} from './axes.js';
import {PADDING, PARTS, toHalf} from './probe_grid.js';

/** What a grid's texture holds now: {resolution, bounds, texels}, a Uint16Array of halves or a Float32Array. */
export async function captureLightProbeGrid(renderer, grid) {
  if (!renderer?.isWebGLRenderer && !renderer?.isWebGPURenderer) throw new TypeError('the renderer that baked the grid is needed');
  if (!grid?.isLightProbeGrid || !grid.texture) {
    throw new TypeError('a LightProbeGrid that was baked or loaded is needed');
  }
  const resolution = grid.resolution.toArray();
  const {min, max} = grid.boundingBox;
  return {resolution, bounds: [...min.toArray(), ...max.toArray()],
          texels: await texelsOf(renderer, grid.texture, resolution)};
}

/**
 * The bytes of a container with a grid as it is now, or with what captureLightProbeGrid() returned, several
 * times, as its states. `states`: {time, name} of each. `half` turns float to half, which loses bits.
 */
export async function saveLightProbeGrid(renderer, grid, {states = [], half = false, name = 'grid', preset = 'fast'} = {}) {
  const all = Array.isArray(grid) ? grid : [await captureLightProbeGrid(renderer, grid)];
  const [{resolution, bounds, texels: {constructor: Type}}] = all;
  if (all.some((one) => `${one.resolution}` !== `${resolution}` || one.texels.constructor !== Type)) {
    throw new RangeError('the states of a container have as many probes each, and one type');
  }
  if (states.length > 0 && states.length !== all.length) {
    throw new RangeError(`a file of ${all.length} grids has as many states, not ${states.length}`);
  }
  const times = states.map(({time}) => time).filter((time) => time !== undefined);
  const twice = times.find((time, i) => times.indexOf(time) < i);
  if (twice !== undefined) throw new RangeError(`two states have the time ${twice}`);
  const halves = half || Type === Uint16Array;
  const layout = halves ? 'three' : 'three-float32';
  const {Writer, volumeOfLayout} = await import('gicodec:entry/encoder');
  const volume = await volumeOfLayout(layout, resolution);
  for (const {time = 0, name: called = ''} of states) {
    if (!Number.isFinite(time) || called.includes('\n')) {
      throw new RangeError(`a state has a finite time and a name in one line, not ${time} and ${JSON.stringify(called)}`);
    }
  }
  const lines = states.map(({time = '-', name: called = ''}, frame) => `${frame} ${time} ${called}`);
  const writer = await Writer.create({[name]: {...volume, metadata: {
    'gicodec:layout': layout, 'gicodec:axes': AXES, 'gicodec:unit': '1', 'gicodec:bounds': bounds.join(' '),
  }}}, {preset, metadata: lines.length ? {'gicodec:states': lines.join('\n')} : {}});
  all.forEach(({texels}, frame) => {
    const turned = halves && Type !== Uint16Array ? Uint16Array.from(texels, toHalf) : texels;
    writer.add(frame, {grid: turned});
  });
  return writer.finish();
}

/** The texels of a 3D texture: those that it was made of, or what the GPU has. */
async function texelsOf(renderer, texture, [width, height, depth]) {
  const data = texture.image?.data;
  if (data instanceof Uint16Array || data instanceof Float32Array) return data.slice();
  const slices = PARTS * (depth + 2 * PADDING);
  const {backend} = renderer;
  if (backend?.isWebGPUBackend) return readWebGPU(backend.device, backend.get(texture).texture, width, height, slices);
  const gl = backend ? backend.gl : renderer.getContext();
  const handle = backend ? backend.get(texture).textureGPU : renderer.properties.get(texture).__webglTexture;
  if (!handle) throw new TypeError('the texture of the grid is not on the GPU of this renderer');
  return readWebGL(gl, handle, width, height, slices);
}

function readWebGL(gl, texture, width, height, slices) {
  const bound = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
  const framebuffer = gl.createFramebuffer();
  const size = width * height * 4;
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, framebuffer);
  try {
    gl.framebufferTextureLayer(gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, texture, 0, 0);
    if (gl.checkFramebufferStatus(gl.READ_FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) {
      throw new TypeError('this device cannot read textures of float (EXT_color_buffer_float)');
    }
    const half = gl.getFramebufferAttachmentParameter(
        gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.FRAMEBUFFER_ATTACHMENT_RED_SIZE) === 16;
    const asHalf = half && gl.getParameter(gl.IMPLEMENTATION_COLOR_READ_TYPE) === gl.HALF_FLOAT;
    const texels = new (asHalf ? Uint16Array : Float32Array)(size * slices);
    for (let slice = 0; slice < slices; ++slice) {
      gl.framebufferTextureLayer(gl.READ_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, texture, 0, slice);
      gl.readPixels(0, 0, width, height, gl.RGBA, asHalf ? gl.HALF_FLOAT : gl.FLOAT,
                    texels.subarray(slice * size, (slice + 1) * size));
    }
    return half && !asHalf ? Uint16Array.from(texels, toHalf) : texels;  // floats that are halves: exact
  } finally {
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, bound);
    gl.deleteFramebuffer(framebuffer);
  }
}

async function readWebGPU(device, texture, width, height, slices) {
  const Type = texture.format === 'rgba16float' ? Uint16Array : Float32Array;
  const row = width * 4 * Type.BYTES_PER_ELEMENT, pitch = Math.ceil(row / 256) * 256;
  const buffer = device.createBuffer({size: pitch * height * slices, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
  const commands = device.createCommandEncoder();
  commands.copyTextureToBuffer({texture}, {buffer, bytesPerRow: pitch, rowsPerImage: height}, [width, height, slices]);
  device.queue.submit([commands.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const bytes = new Uint8Array(buffer.getMappedRange());
  const texels = new Uint8Array(row * height * slices);
  for (let y = 0; y < height * slices; ++y) texels.set(bytes.subarray(y * pitch, y * pitch + row), y * row);
  buffer.destroy();
  return new Type(texels.buffer);
}
