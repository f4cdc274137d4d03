// Volumes of all engines' layouts in Chromium, by WebGL and by WebGPU: texels bit for bit, and how they light.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';

import {CHROMIUM_WITH_GPU, launch, pageOf, serve} from './browser_support.mjs';
import {program, randomWords} from './support.mjs';
import {open} from 'gicodec';
import {Writer, volumeOfLayout} from 'gicodec/encoder';

const LAYOUTS = {
  three: 'LightProbeGrid', 'three-float32': 'LightProbeGrid', paper: 'ProbeVolume', g3d: 'ProbeVolume', rtxgi: 'ProbeVolume',
  'rtxgi-float16': 'ProbeVolume', 'rtxgi-float32': 'ProbeVolume', 'rtxgi-z-up': 'ProbeVolume', o3de: 'ProbeVolume',
  flax: 'ProbeVolume', 'unity-apv': 'TextureVolume', 'unreal-vlm': 'TextureVolume', bevy: 'AmbientCubeVolume',
  godot: 'TextureVolume',
};
let browser, server, folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-layouts-'));
  const run = (name, ...values) => execFileSync(program(name), [...values, '-q'], {cwd: folder, stdio: 'pipe'});
  server = await serve({'/webgl.html': pageOf('layouts_page'), '/webgpu.html': pageOf('layouts_page', true)});
  for (const layout of Object.keys(LAYOUTS)) {
    run('gi-trace', '--scene', 'tomb', '--grid', '5x3x4', '--rays', '16', '--layout', layout, '--frames', '2', '--fps', '1', '-o', `${layout}.gic`);
    run('gicodec', 'decode', `${layout}.gic`, '-o', layout, '--files', 'raw', '--frames', '1');
    server.put(`/${layout}.gic`, readFileSync(join(folder, `${layout}.gic`)));
  }
  browser = await launch(CHROMIUM_WITH_GPU);
});
after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, {recursive: true, force: true});
});

const decode = (text) => new Uint8Array(Buffer.from(text, 'base64'));
const float = (mantissaBits) => (code) => {  // of an exponent of five bits
  const exponent = code >> mantissaBits, mantissa = code & (1 << mantissaBits) - 1, one = 1 << mantissaBits;
  return exponent === 31 ? (mantissa ? NaN : Infinity) : exponent === 0 ? mantissa / one * 2 ** -14 : (1 + mantissa / one) * 2 ** (exponent - 15);
};
const half = (code) => (code & 0x8000 ? -1 : 1) * float(10)(code & 0x7FFF);

/** By format: bytes of a texel, and its components of a DataView at a byte; norms as codes out of `codes`. */
const VALUES = {
  A2R10G10B10_UNORM_PACK32: [4, (view, at) => [view.getUint32(at, true)]],
  A2B10G10R10_UNORM_PACK32: [4, (view, at) => [view.getUint32(at, true)]],
  R8_UNORM: [1, (view, at) => [view.getUint8(at)], 255],
  R8G8B8A8_UNORM: [4, (view, at) => [0, 1, 2, 3].map((i) => view.getUint8(at + i)), 255],
  B8G8R8A8_UNORM: [4, (view, at) => [0, 1, 2, 3].map((i) => view.getUint8(at + i)), 255],  // WebGL has no such order
  R8G8B8A8_SNORM: [4, (view, at) => [0, 1, 2, 3].map((i) => Math.max(-127, view.getInt8(at + i))), 127],
  R8G8B8A8_UINT: [4, (view, at) => [0, 1, 2, 3].map((i) => view.getUint8(at + i))],
  R16G16_SFLOAT: [4, (view, at) => [0, 1].map((i) => half(view.getUint16(at + 2 * i, true)))],
  R16G16B16A16_SFLOAT: [8, (view, at) => [0, 1, 2, 3].map((i) => half(view.getUint16(at + 2 * i, true)))],
  R32G32_SFLOAT: [8, (view, at) => [0, 1].map((i) => view.getFloat32(at + 4 * i, true))],
  R32G32B32A32_SFLOAT: [16, (view, at) => [0, 1, 2, 3].map((i) => view.getFloat32(at + 4 * i, true))],
  B10G11R11_UFLOAT_PACK32: [4, (view, at) => {
    const word = view.getUint32(at, true);
    return [float(6)(word & 2047), float(6)(word >>> 11 & 2047), float(5)(word >>> 22)];
  }],
  E5B9G9R9_UFLOAT_PACK32: [4, (view, at) => {
    const word = view.getUint32(at, true);
    return [0, 9, 18].map((bit) => (word >>> bit & 511) * 2 ** ((word >>> 27) - 24));
  }],
};

/** Nothing differs between what `gicodec decode` wrote and what the GPU has. */
function compare(name, format, raw, {bytes, values}) {
  if (bytes) return assert.ok(Buffer.from(raw).equals(decode(bytes)), name);
  const [size, components, codes] = VALUES[format];
  const view = new DataView(raw.buffer, raw.byteOffset, raw.length), bits = decode(values);
  const integers = new Uint32Array(bits.buffer), floats = new Float32Array(bits.buffer);
  const found = /UINT|A2.*PACK32/.test(format) ? integers : codes ? floats.map((one) => Math.round(one * codes)) : floats;
  assert.equal(integers.length / 4, raw.length / size, name);
  for (let texel = 0; texel < integers.length / 4; ++texel) {
    components(view, texel * size).forEach((wanted, i) => {
      if (!Object.is(found[4 * texel + i], wanted)) assert.equal(found[4 * texel + i], wanted, `${name} ${texel} ${i}`);
    });
  }
}

/** Radiance 0, 1/4, 1/2 and 1 as E5B9G9R9. */
const rgb9e5 = (...color) => (16 << 27 | color.reduce((word, one, i) => word | one * 256 << 9 * i, 0)) >>> 0;
const FACES = {  // towards +x, -x, +y, -y, +z, -z of the volume
  '+x': [1, 0, 0], '-x': [0, 1, 0], '+y': [0, 0, 1], '-y': [1, 1, 0], '+z': [0.25, 0, 1], '-z': [0, 0.5, 0.5],
};

/** The texels of ambient cubes, each with the colours of FACES by `share(x, y, z)`. */
function cubeTexels([nx, ny, nz], share = () => 1) {
  const texels = new Uint32Array(nx * 2 * ny * 3 * nz);
  Object.values(FACES).forEach((color, face) => {
    for (let z = 0; z < nz; ++z) for (let y = 0; y < ny; ++y) for (let x = 0; x < nx; ++x) {
      texels[x + nx * (y + face % 2 * ny + 2 * ny * (z + (face >> 1) * nz))] = rgb9e5(...color.map((one) => one * share(x, y, z)));
    }
  });
  return texels;
}

/** A container of such. */
async function cubes(grid, metadata, share) {
  const writer = await Writer.create({room: {...await volumeOfLayout('bevy', grid), metadata: {'gicodec:layout': 'bevy', ...metadata}}});
  writer.add(0, {voxels: cubeTexels(grid, share)});
  return writer.finish();
}

const near = (found, wanted, what) => found.forEach((one, i) => assert.ok(Math.abs(one - wanted[i]) < 2e-3, `${what}: ${found}, not ${wanted}`));

for (const name of ['webgl', 'webgpu']) {
  describe(name, () => {
    let page;
    const said = [];
    const call = (method, ...values) => page.evaluate((m, v) => window.page[m](...v), method, values);

    before(async () => {
      page = await browser.newPage();
      page.on('pageerror', (error) => assert.fail(error.message));
      page.on('console', (message) => ['error', 'warn'].includes(message.type()) && !message.text().includes('404') && said.push(message.text()));
      await page.goto(`${server.origin}/${name}.html${name === 'webgpu' ? '?webgpu' : ''}`);
      await page.waitForFunction('window.ready', {timeout: 60000});
      assert.equal(await page.evaluate('window.ready'), true);
    });

    for (const [layout, type] of Object.entries(LAYOUTS)) {
      test(`${layout}: texels are those that gicodec decodes`, async () => {
        const player = await open(readFileSync(join(folder, `${layout}.gic`)));
        const {found, type: is, states, left} = await call('texels', `/${layout}.gic`, 1);
        player.close();
        assert.equal(is.replace(/WebGL$/, ''), type);
        assert.equal(states, 2);
        const names = {ProbeVolume: ['color', 'visibility']}[type] ?? Object.keys(found);
        names.forEach((one, i) => {
          const desc = type === 'ProbeVolume' ? player.textures[i] : player.textures.find(({name: its}) => its === one);
          compare(`${layout} ${one}`, desc.format, readFileSync(join(folder, layout, `${desc.name}.0001.raw`)), found[one]);
        });
        if (type === 'TextureVolume') assert.equal(names.length, player.textures.length);
        assert.equal(left, 0);
      });
    }

    test('ambient cubes light as Bevy has them, in their box alone', async () => {
      const normals = {'+x': [1, 0, 0], '-x': [-1, 0, 0], '+y': [0, 1, 0], '-y': [0, -1, 0], '+z': [0, 0, 1], '-z': [0, 0, -1]};
      server.put('/cubes.gic', await cubes([2, 3, 4], {'gicodec:bounds': '-1 -1 -1 3 1 1'}));
      const {colors, box} = await call('tiles', '/cubes.gic', [
        ...Object.values(normals).map((normal) => [[0.3, 0.2, 0.1], normal]),
        [[0, 0, 0], [0.6, 0.8, 0]], [[-1.5, 0, 0], [1, 0, 0]], [[0, 1.5, 0], [1, 0, 0]]]);
      Object.keys(normals).forEach((face, i) => near(colors[i], FACES[face], face));
      near(colors[6], [0.36, 0, 0.64], 'between +x and +y');
      near(colors[7], [0, 0, 0], 'outside');
      near(colors[8], [0, 0, 0], 'outside');
      assert.deepEqual(box, [-1, -1, -1, 3, 1, 1]);
      const moved = await call('tiles', '/cubes.gic', [[[-11.5, 0, 0], [1, 0, 0]], [[-9, 0, 0], [1, 0, 0]]], {position: [-10, 0, 0]});
      near(moved.colors[0], [0, 0, 0], 'outside');
      near(moved.colors[1], FACES['+x'], 'moved');
    });

    test('ambient cubes are filtered between voxels, and not with those of other faces', async () => {
      server.put('/filtered.gic', await cubes([2, 2, 2], {'gicodec:bounds': '0 0 0 2 2 2'}, (x, y, z) => [x, y, z].reduce((a, b) => a + b, 0) === 0 ? 0 : 1));
      const {colors} = await call('tiles', '/filtered.gic', [[[0.5, 0.5, 0.5], [1, 0, 0]], [[1, 0.5, 0.5], [1, 0, 0]], [[0.02, 0.02, 0.02], [0, 1, 0]]]);
      near(colors[0], [0, 0, 0], 'in a voxel');
      near(colors[1], [0.5, 0, 0], 'between two');
      near(colors[2], [0, 0, 0], 'at the edge');
    });

    test('axes and units of other engines are turned', async () => {
      // Unity's z is three.js's -z; Unreal's x is forward, y right and z up, in centimetres.
      for (const [axes, unit, bounds, wanted, faces] of [
        ['right up forward', 1, '0 0 0 4 2 2', [0, 0, -2, 4, 2, 0], {'+x': '+x', '+y': '+y', '-z': '+z', '+z': '-z'}],
        ['forward right up', 0.01, '0 0 0 400 200 100', [0, 0, -4, 2, 1, 0], {'-z': '+x', '+x': '+y', '+y': '+z', '+z': '-x'}]]) {
        const axesOf = {'+x': [1, 0, 0], '+y': [0, 1, 0], '+z': [0, 0, 1], '-z': [0, 0, -1]};
        server.put('/turned.gic', await cubes([2, 2, 2], {'gicodec:bounds': bounds, 'gicodec:axes': axes, 'gicodec:unit': `${unit}`}));
        const {colors, box} = await call('tiles', '/turned.gic', Object.keys(faces).map((face) => [[0.5, 0.5, -0.5], axesOf[face]]));
        box.forEach((at, i) => assert.ok(Math.abs(at - wanted[i]) < 1e-6, `${axes}: ${box}`));
        Object.entries(faces).forEach(([face, own], i) => near(colors[i], FACES[own], `${axes} ${face}`));
      }
    });

    test('layers of light maps are light maps of materials, and follow the state', async () => {
      const volume = await volumeOfLayout('godot', [8, 8, 2]);
      const writer = await Writer.create({map: {...volume, metadata: {'gicodec:layout': 'godot'}}});
      const halves = {0: 0, 0.25: 0x3400, 0.5: 0x3800, 1: 0x3C00};
      const texels = (shares) => Uint16Array.from({length: 8 * 8 * 8 * 4}, (_, i) => halves[shares[i >> 8]]);
      writer.add(0, {lightmap: texels([1, 0, 0, 0, 0.25, 0, 0, 0])});
      writer.add(1, {lightmap: texels([0, 0, 0, 0, 0.5, 0, 0, 0])});
      server.put('/map.gic', writer.finish());
      const {colors, refused} = await call('lightMap', '/map.gic', 'lightmap', [0, 4], 1);
      [1, 0.25, 0.5].forEach((wanted, i) => near(colors[i], [wanted, wanted, wanted], i));
      assert.match(refused, /has slices 0 to 7, not 1000000/);
    });

    test('compressed blocks go to the GPU as they are', async (t) => {
      if (!await call('compresses')) return t.skip('this GPU has no BC formats');
      const words = randomWords(3);
      for (const [format, three, size] of [['BC6H_UFLOAT_BLOCK', 'RGB_BPTC_UNSIGNED_Format', 16], ['BC7_UNORM_BLOCK', 'RGBA_BPTC_Format', 16]]) {
        const block = Uint8Array.from({length: 4 * 4 * size}, () => words.next().value >>> 24);
        const texture = {name: 'map', format, grid: [4, 4, 1], block: [1, 1, 1], tiling: 'slices_xy_z'};
        const writer = await Writer.create({map: {kind: 'textures', textures: [texture], metadata: {'gicodec:layout': 'godot'}}});
        writer.add(0, {map: block});
        server.put('/bc.gic', writer.finish());
        const {found} = await call('texels', '/bc.gic', 0);
        const [own, wanted] = [found.map, await call('compressed', Buffer.from(block).toString('base64'), 16, 16, three)];
        assert.deepEqual(own, wanted);
        if (own.bytes) assert.deepEqual(decode(own.bytes), block);
      }
    });

    test('nothing was said', () => assert.deepEqual(said, []));

    test('what cannot light becomes textures or is left out, and the rest lights', async () => {
      const bevy = {...await volumeOfLayout('bevy', [2, 2, 2]), metadata: {'gicodec:layout': 'bevy', 'gicodec:bounds': '0 0 0 2 2 2'}};
      const flat = (format, slices) => ({kind: 'textures', textures: [{name: 'map', format, grid: [1, 1, slices], block: [8, 8, 1], tiling: 'slices_xy_z'}]});
      const writer = await Writer.create({
        good: bevy, words: {...flat('A2R10G10B10_UNORM_PACK32', 6), metadata: {'gicodec:layout': 'bevy'}},
        bytes: {...flat('R8_UNORM', 21), metadata: {'gicodec:layout': 'three'}},
        cut: {...flat('R16G16B16A16_SFLOAT', 5), metadata: {'gicodec:layout': 'three'}}});
      writer.add(0, {good: {voxels: cubeTexels([2, 2, 2])}, words: {map: new Uint32Array(384)}, bytes: {map: new Uint8Array(64 * 21)},
                     cut: {map: new Uint16Array(64 * 5 * 4)}});
      server.put('/mixed.gic', writer.finish());
      assert.deepEqual(await call('types', '/mixed.gic'), {good: 'AmbientCubeVolume', words: 'TextureVolume', bytes: 'TextureVolume'});
      assert.ok(said.some((line) => line.includes('"cut" is left out')), said);
      const {colors} = await call('tiles', '/mixed.gic', [[[1, 1, 1], [1, 0, 0]]]);
      near(colors[0], FACES['+x'], 'the good one');
    });

    test('programs do not grow with what comes and goes', {skip: name === 'webgpu'}, async () => {
      const counts = await call('programs', '/cubes.gic', 8);
      assert.equal(counts.at(-1), counts[0], counts);
    });

    test('as many volumes light as a material has textures for', async () => {
      const grid = [1, 1, 1], names = Array.from({length: 40}, (_, i) => `room${i}`);
      const volume = {...await volumeOfLayout('bevy', grid), metadata: {'gicodec:layout': 'bevy', 'gicodec:bounds': '0 0 0 2 2 2'}};
      const writer = await Writer.create(Object.fromEntries(names.map((one) => [one, volume])));
      const texels = cubeTexels(grid, () => 1 / 64);
      writer.add(0, Object.fromEntries(names.map((one) => [one, {voxels: texels}])));
      server.put('/many.gic', writer.finish());
      const {colors: [[red]]} = await call('tiles', '/many.gic', [[[1, 1, 1], [1, 0, 0]]]);
      assert.ok(red >= 9 / 64 - 1e-3 && red < 40 / 64, `${red}`);
      assert.ok(said.some((line) => line.includes('does not light all')), said);
    });
  });
}
