// What the GPU has of a texture, for tests in pages.
import {DataUtils, RGBAIntegerFormat, RedIntegerFormat} from 'three';

const BLOCK = 4;  // texels along a side of a compressed block

/**
 * The texels of an array or 3D texture. WebGPU: {bytes}, as they are. WebGL: {values}, four floats of each as
 * bits, or four integers.
 */
export async function readTexels(renderer, texture) {
  renderer.initTexture(texture);
  const {backend} = renderer;
  if (backend?.isWebGPUBackend) return {bytes: await readWebGPU(backend, texture)};
  return {values: readWebGL(renderer, texture)};
}

const BYTES = {r8unorm: 1, rg8unorm: 2, rgba8unorm: 4, rgba8snorm: 4, rgba8uint: 4, bgra8unorm: 4, r16float: 2, rg16float: 4,
               rgba16float: 8, r32float: 4, rg32float: 8, rgba32float: 16, r32uint: 4, rgb9e5ufloat: 4, rg11b10ufloat: 4};

async function readWebGPU(backend, texture) {
  const {device} = backend, {texture: handle} = backend.get(texture);
  const {format, width, height, depthOrArrayLayers: slices} = handle;
  const [side, texel] = format.startsWith('bc') ? [BLOCK, /^bc[14]/.test(format) ? 8 : 16] : [1, BYTES[format]];
  const [columns, rows] = [width / side, height / side];
  const pitch = Math.ceil(columns * texel / 256) * 256;
  const buffer = device.createBuffer({size: pitch * rows * slices, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
  const commands = device.createCommandEncoder();
  commands.copyTextureToBuffer({texture: handle}, {buffer, bytesPerRow: pitch, rowsPerImage: rows}, [width, height, slices]);
  device.queue.submit([commands.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const mapped = new Uint8Array(buffer.getMappedRange());
  const bytes = new Uint8Array(columns * texel * rows * slices);
  for (let y = 0; y < rows * slices; ++y) bytes.set(mapped.subarray(y * pitch, y * pitch + columns * texel), y * columns * texel);
  buffer.destroy();
  return bytes;
}

/** The texels of a texture of 32 bits each as words: of integers, or of two halves. */
export async function readWords(renderer, texture) {
  const {bytes, values} = await readTexels(renderer, texture);
  if (bytes) return new Uint32Array(bytes.buffer);
  const words = new Uint32Array(values.length / 4), floats = new Float32Array(values.buffer);
  const half = (at) => DataUtils.toHalfFloat(floats[at]);  // halves come as floats, exactly
  const integer = texture.format === RedIntegerFormat;
  return words.map((_, i) => (integer ? values[4 * i] : half(4 * i) | half(4 * i + 1) << 16));
}

const programs = new Map();

/** Of a sampler; a context that was lost takes them along. */
function programOf(gl, sampler, integer) {
  const known = programs.get(sampler);
  if (known && gl.isProgram(known)) return known;
  const program = gl.createProgram();
  const attach = (type, source) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float; precision highp int;\n${source}`);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  };
  attach(gl.VERTEX_SHADER, `
    void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`);
  attach(gl.FRAGMENT_SHADER, `
    uniform highp ${sampler} all;
    uniform int slice;
    out uvec4 texel;
    void main() { texel = ${integer ? '' : 'floatBitsToUint'}(texelFetch(all, ivec3(gl_FragCoord.xy, slice), 0)); }`);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  programs.set(sampler, program);
  return program;
}

/** Draws each slice's texels into integers. */
function readWebGL(renderer, texture) {
  const gl = renderer.getContext();
  const {width, height, depth} = texture.image;
  if (gl.isContextLost()) return new Uint32Array(4 * width * height * depth);
  const integer = [RedIntegerFormat, RGBAIntegerFormat].includes(texture.format);
  const program = programOf(gl, `${integer ? 'u' : ''}sampler${texture.isData3DTexture ? '3D' : '2DArray'}`, integer);
  const target = gl.createTexture(), framebuffer = gl.createFramebuffer(), array = gl.createVertexArray();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, target);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, width, height);
  gl.bindTexture(texture.isData3DTexture ? gl.TEXTURE_3D : gl.TEXTURE_2D_ARRAY, renderer.properties.get(texture).__webglTexture);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.useProgram(program);
  gl.bindVertexArray(array);
  gl.viewport(0, 0, width, height);
  for (const one of [gl.BLEND, gl.DEPTH_TEST, gl.SCISSOR_TEST, gl.CULL_FACE, gl.STENCIL_TEST]) gl.disable(one);
  gl.colorMask(true, true, true, true);
  const values = new Uint32Array(4 * width * height * depth);
  for (let slice = 0; slice < depth; ++slice) {
    gl.uniform1i(gl.getUniformLocation(program, 'slice'), slice);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, values.subarray(4 * width * height * slice));
  }
  if (gl.getError() !== gl.NO_ERROR) throw new Error('the texture could not be read');
  gl.deleteFramebuffer(framebuffer);
  gl.deleteTexture(target);
  gl.deleteVertexArray(array);
  renderer.resetState();
  return values;
}
