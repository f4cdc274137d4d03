// Compiles, and what must not compile does not.
import {Decoder, GicodecError, open, peek, ready, useWorkers, type Player, type Texels} from 'gicodec';
import {connect, connectNats, type ClientVolume} from 'gicodec/client';
import {Encoder, Writer, ddgiIrradiance, volumeOfLayout, type VolumeDesc} from 'gicodec/encoder';
import {
  GIClient, GILoader, ProbeVolume, ProbeVolumeHelper, VolumeLight, captureLightProbeGrid, saveLightProbeGrid, type StateGrid,
} from 'gicodec/three';
import type {NatsConnection} from '@nats-io/nats-core';
import type {Camera, Scene, Texture, WebGLRenderer} from 'three';
import type {OwnBytes} from 'gicodec';

export async function play(file: File): Promise<Texels> {
  await ready;
  await useWorkers(2);
  const player: Player = await open(file, {textures: ['color', 1], limits: {maxTotalBytes: 1 << 28}});
  for await (const frame of player) console.log(frame.toFixed(), player.volumes[0]?.geometry?.origin);
  const words = await player.read('color', new Uint32Array(100));
  // @ts-expect-error: a number alone
  await player.seek('0');
  return words.length > 0 ? words : player.read(0);
}

export async function write(texels: Uint16Array): Promise<Blob> {
  const color = await ddgiIrradiance([2, 2, 2], 'R16G16B16A16_SFLOAT');
  const room: VolumeDesc = {kind: 'probes', textures: [{name: 'color', ...color}]};
  const writer = await Writer.create({room: {...room, geometry: {origin: [0, 0, 0]}}}, {preset: 'strong'});
  writer.add(0, {color: texels});
  const encoder = await Encoder.create(color);
  const packet = encoder.encode(texels, [1, 2, 3]);
  const decoder = await Decoder.create(color);
  decoder.decode(packet);
  console.log((await peek(packet)).type === 'keyframe', (await volumeOfLayout('three', [4, 4, 4])).kind);
  // @ts-expect-error: no such preset
  encoder.setPreset('slow');
  return new Blob([writer.finish(), encoder.read()]);
}

export async function follow(url: string, signal: AbortSignal): Promise<string> {
  const {closed} = await connect(url, {signal, onUpdate: ({volumes: [room]}) => draw(room)});
  return closed.catch((error: unknown) => (error instanceof GicodecError ? error.code : 'unknown'));
}

function draw(room: ClientVolume | undefined): void {
  console.log(room?.texels('color').byteLength, room?.geometry.grid);
}

export function shine(scene: Scene, renderer: WebGLRenderer, camera: Camera): GIClient {
  const live = new GIClient(renderer, 'wss://example.org', {token: 'x', everything: false});
  live.addEventListener('update', ({state, blocks}) => console.log(state.time, blocks, live.statistics.decodeMs));
  live.addEventListener('lost', ({why}) => console.warn(why));
  scene.add(live.object);
  live.setView(camera);
  return live;
}

export async function light(scene: Scene, renderer: WebGLRenderer): Promise<OwnBytes> {
  scene.traverse((object) => object instanceof VolumeLight && console.log(object.boundingBox.max.y));
  const loader = new GILoader().detectSupport(renderer).setWorkerLimit(1);
  loader.setPath('light/').setRequestHeader({authorization: 'x'});
  const grid = await loader.loadAsync('room.gic', ({loaded, total}) => console.log(loaded / total));
  scene.add(grid, await loader.loadAsync<StateGrid>('hall.gic'));
  if ('slice' in grid) {
    const map: Texture = grid.slice('lightmap', 4);
    console.log(grid.layout, map.name, grid.textures.get('Indirection'));
  } else if (grid instanceof ProbeVolume) {
    grid.add(new ProbeVolumeHelper(grid, {colors: 'age'}));
    grid.addEventListener('error', ({error}) => console.error(error.message));
  } else if ('isLightProbeGrid' in grid) {
    grid.addEventListener('state', ({state}) => console.log(state));
    grid.state = 12.5;
    await grid.setState(grid.states[0]?.name ?? 'noon');
    // @ts-expect-error: a state is a number or a name
    grid.state = null;
    return saveLightProbeGrid(renderer, [await captureLightProbeGrid(renderer, grid)], {states: [{time: 6}]});
  }
  return new Uint8Array();
}

export async function many(renderer: WebGLRenderer, nats: NatsConnection): Promise<GIClient> {
  const live = await connectNats(nats, {prefix: 'light', reach: 4, onUpdate: (client) => console.log(client.state.update)});
  await live.closed;
  // @ts-expect-error: the token of a gi-server
  await connectNats(nats, {token: 'x'});
  return new GIClient(renderer, nats, {reach: 4});
}
