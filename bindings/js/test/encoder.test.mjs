import assert from 'node:assert/strict';
import {test} from 'node:test';

import {Decoder, VolumeDecoder, open, peek} from 'gicodec';
import {
  Encoder, VolumeEncoder, Writer, ddgiIrradiance, ddgiVisibility, formats, layouts, mapTexture, volumeOfLayout,
} from 'gicodec/encoder';

import {bytes, randomBytes} from './support.mjs';

test('every format round trips, all bits', async () => {
  const names = await formats();
  assert.ok(names.length > 50);
  for (const [i, format] of names.entries()) {
    const desc = await mapTexture([37, 21], format);
    const encoder = await Encoder.create(desc, {preset: ['turbo', 'fast', 'strong'][i % 3]});
    const decoder = await Decoder.create(desc);
    const texels = new desc.ArrayType(randomBytes(desc.textureBytes, i).buffer);
    for (let frame = 0; frame < 3; ++frame) {
      if (frame > 0) bytes(texels)[frame * 17] ^= 0x5A;
      const packet = encoder.encode(texels);
      decoder.decode(packet);
      const found = decoder.read();
      assert.equal(found.constructor, desc.ArrayType);
      assert.ok(bytes(found).equals(bytes(texels)), `${format}, frame ${frame}`);
      assert.equal(decoder.changed().length, frame === 0 ? desc.blocks : 1);
      assert.equal((await peek(packet)).type, frame === 0 ? 'keyframe' : 'delta');
    }
    assert.equal(decoder.sequence, 3);
  }
});

test('all half codes, in light maps and volumes', async () => {
  const codes = Uint16Array.from({length: 65536}, (_, i) => i);
  for (const size of [[256, 256], [128, 64, 8], [65536]]) {
    const desc = await mapTexture(size, 'R16_SFLOAT', [16, 16, size.length > 2 ? 4 : 1]);
    const decoder = await Decoder.create(desc);
    decoder.decode((await Encoder.create(desc)).encode(codes));
    assert.deepEqual(decoder.read(new Uint16Array(65536)), codes);
  }
});

test('a volume of probes, with guard bands', async () => {
  const color = await ddgiIrradiance([3, 2, 4]), distance = await ddgiVisibility([3, 2, 4]);
  const volume = {kind: 'probes', groups: [{bundled: true, textures: [
    {name: 'color', ...color}, {name: 'vis', ...distance}]}]};
  const encoder = await VolumeEncoder.create(volume), decoder = await VolumeDecoder.create(volume);
  const textures = {color: new Uint32Array(randomBytes(color.textureBytes, 5).buffer),
                    vis: new Uint16Array(randomBytes(distance.textureBytes, 6).buffer)};
  decoder.decode(encoder.encode(textures));
  for (const name of ['color', 'vis']) assert.deepEqual(decoder.read(name), textures[name]);
  textures.color[0] ^= 1;
  decoder.decode(encoder.encode(textures));
  assert.deepEqual(decoder.read('color'), textures.color);
  assert.deepEqual(decoder.changed('color'), Uint32Array.of(0));
  const late = await VolumeDecoder.create(volume);
  late.decode(encoder.snapshot());
  assert.deepEqual(late.read('vis'), textures.vis);
  assert.throws(() => encoder.encode({color: textures.color}), /"vis", which is missing/);
  assert.throws(() => encoder.encode({...textures, sky: textures.vis}), /there is no texture "sky": there are "color", "vis"/);
});

test('engines\' layouts', async () => {
  const all = await layouts();
  assert.ok(Object.keys(all).length > 10 && all.three);
  for (const layout of Object.keys(all)) {
    const volume = await volumeOfLayout(layout, [4, 4, 4]);
    const encoder = await VolumeEncoder.create(volume), decoder = await VolumeDecoder.create(volume);
    const textures = Object.fromEntries(encoder.textures.map((desc, i) =>
      [desc.name, new Uint8Array(randomBytes(desc.textureBytes, i))]));
    decoder.decode(encoder.encode(textures));
    for (const {name} of encoder.textures) {
      assert.equal(bytes(decoder.read(name)).length, textures[name].length, `${layout} ${name}`);
    }
  }
});

test('a container, with geometry and notes', async () => {
  const color = await ddgiIrradiance([4, 4, 4], 'R16G16B16A16_SFLOAT');
  const writer = await Writer.create({room: {
    kind: 'probes', textures: [{name: 'color', ...color, metadata: {unit: 'lux'}}], metadata: {floor: '2'},
    geometry: {origin: [0, 1.5, -0.1], spacing: [1, 2, 0.3333]}}},
  {scene: 'villa', metadata: {made: 'here'}, preset: 'strong'});
  const texels = new Uint16Array(randomBytes(color.textureBytes, 9).buffer);
  const pieces = [];
  for (let frame = 0; frame < 4; ++frame) {
    texels[frame * 100] = 0x7E00 + frame;
    writer.add(frame * 10, {color: texels});
    pieces.push(writer.take());
  }
  pieces.push(writer.finish());
  assert.throws(() => writer.finish(), /create another Writer/);
  const player = await open(new Blob(pieces));
  assert.equal(player.scene, 'villa');
  assert.deepEqual(player.metadata, {made: 'here'});
  const [{name, kind, metadata, geometry}] = player.volumes;
  assert.deepEqual([name, kind, metadata], ['room', 'probes', {floor: '2'}]);
  assert.deepEqual(geometry.grid, [4, 4, 4]);
  assert.deepEqual(geometry.origin.map(Math.fround), [0, 1.5, -0.1].map(Math.fround));
  assert.deepEqual(geometry.spacing.map(Math.fround), [1, 2, 0.3333].map(Math.fround));
  assert.deepEqual(player.textures[0].metadata, {unit: 'lux'});
  const frames = [];
  for await (const frame of player) frames.push(frame);
  assert.deepEqual(frames, [0, 10, 20, 30]);
  assert.deepEqual(await player.read('color'), texels);
  assert.throws(() => writer.add(50, {color: texels}), {code: 'out_of_order'});
});

test('bounded errors', async () => {
  const desc = await mapTexture([64, 64], 'R32_SFLOAT');
  const texels = Float32Array.from({length: 4096}, (_, i) => 1 + Math.sin(i / 50) / 2);
  const exact = (await Encoder.create(desc)).encode(texels);
  const lossy = (await Encoder.create(desc, {maxError: 0.01})).encode(texels);
  assert.ok(lossy.length < exact.length / 2);
  const decoder = await Decoder.create(desc);
  decoder.decode(lossy);
  decoder.read().forEach((value, i) => assert.ok(Math.abs(value - texels[i]) <= 0.01 * texels[i]));
});

test('wrong calls are named', async () => {
  await assert.rejects(mapTexture([4, 4], 'R17_SFLOAT'), {code: 'unsupported_format', message: /R17_SFLOAT/});
  await assert.rejects(volumeOfLayout('nobody', [1, 1, 1]), {code: 'invalid_name', message: /"nobody": paper/});
  await assert.rejects(async () => ddgiIrradiance([8, 4]), /a grid is a list of 3 whole numbers from 1 on, not \[8,4\]/);
  for (const size of [[0, 8], [8.5, 8], [-8, 8], 8]) await assert.rejects(async () => mapTexture(size, 'R8_UNORM'), RangeError);
  const desc = await mapTexture([16, 16], 'R8_UNORM');
  await assert.rejects(Encoder.create(desc, {preset: 'slow'}), /there is no preset "slow": turbo, fast, strong are/);
  await assert.rejects(Encoder.create(desc, {speed: 3}), /there is no option speed: there are preset, gop/);
  await assert.rejects(Encoder.create(desc, {gop: -1}), /gop is a whole number from 0 to below 4294967296, not -1/);
  await assert.rejects(Encoder.create(desc, {host: 64}), /there is no option host/);
  await assert.rejects(Encoder.create({...desc, tiling: 'spiral'}), /there is no tiling "spiral"/);
  await assert.rejects(Encoder.create({...desc, guardBand: 2}), /: guard_band: it is 0 or 1$/);
  await assert.rejects(VolumeEncoder.create({kind: 'textures', textures: [
    {...desc, name: 'a'}, {...desc, name: 'a'},
  ]}), /name: two textures have the same/);
  await assert.rejects(VolumeEncoder.create({kind: 'clouds', textures: []}), /there is no kind "clouds": .*probes/);
  await assert.rejects(Writer.create({room: {kind: 'textures', textures: [desc]}}), /has a name/);
  await assert.rejects(Decoder.create(Promise.resolve(desc)), /a grid, a block, and a format/);
  const writer = await Writer.create({room: {kind: 'textures', textures: [{name: 'a', ...desc}]}});
  assert.throws(() => writer.add(0, {a: new Float32Array(64)}), /takes the bits of R8_UNORM in a Uint8Array, not a Float32Array/);
  assert.throws(() => writer.add(0, {a: new Uint8Array(257)}), /"a" has 256 bytes, the array 257/);
  for (const frame of [-1, 1.5, '0']) assert.throws(() => writer.add(frame, {a: new Uint8Array(256)}), /a number from 0 on/);
  const encoder = await Encoder.create(desc);
  assert.throws(() => encoder.encode(new Uint8Array(256), 'alll'), /blocks are "changed", "all" or a list/);
  assert.throws(() => encoder.encode(new Uint8Array(255)), /the texture has 256 bytes, the array 255/);
  assert.throws(() => encoder.encode(new Uint8Array(256), [7]), {code: 'block_out_of_range'});
  assert.throws(() => encoder.encode('text'), TypeError);
  const decoder = await Decoder.create(desc);
  assert.throws(() => decoder.decode(new Uint8Array(3)), {name: 'GicodecError'});
});

test('a refused frame does not spoil those behind it', async () => {
  const color = await ddgiIrradiance([2, 2, 2]);
  const room = {kind: 'probes', textures: [{name: 'constructor', ...color}]};
  const writer = await Writer.create({room});
  const texels = (value) => new color.ArrayType(color.textureBytes / 4).fill(value);
  writer.add(0, {room: Object.assign(Object.create(null), {constructor: texels(0)})});
  writer.add(5, {constructor: texels(5)});
  for (const frame of [4, 5]) assert.throws(() => writer.add(frame, {constructor: texels(9)}), {code: 'wrong_frame'});
  writer.add(6, {constructor: texels(6)});
  const player = await open(writer.finish());
  const found = [];
  for await (const frame of player) found.push([frame, (await player.read(0))[0]]);
  assert.deepEqual(found, [[0, 0], [5, 5], [6, 6]]);
});

test('names are whole, and shown safely', async () => {
  const map = await mapTexture([8, 8], 'R8_UNORM', [8, 8]);
  const named = (name) => Writer.create({room: {kind: 'textures', textures: [{name, ...map}]}});
  await assert.rejects(named('a\0b'), TypeError);
  await assert.rejects(named('a\ud800'), TypeError);
  const writer = await named('a\x1b[31mred\x9b');
  const player = await open(writer.finish());
  await assert.rejects(player.read('none'), ({message}) => /31mred/.test(message) && !/[\x00-\x1f\x7f-\x9f]/.test(message));
  await assert.rejects(open(new Uint8Array(9), {limits: {constructor: 1}}), /there is no constructor/);
});

test('one without memory ends alone', async () => {
  const small = await mapTexture([16, 16], 'R8_UNORM');
  const other = await Encoder.create(small);
  const large = await mapTexture([4096, 3840], 'R32G32B32A32_SFLOAT');
  const textures = Array.from({length: 18}, (_, i) => ({name: `t${i}`, ...large}));  // 4.3 GB
  const encoder = await VolumeEncoder.create({kind: 'textures', textures});
  const texels = new Uint8Array(large.textureBytes);
  const all = Object.fromEntries(textures.map(({name}) => [name, texels]));
  for (let i = 0; i < 2; ++i) assert.throws(() => encoder.encode(all), {code: 'out_of_memory'});
  assert.ok(other.encode(new Uint8Array(256)).length > 0);
});
