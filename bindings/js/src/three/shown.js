// What shows a volume, of a file or of a server: rows of a table, of which the first that fits is taken.
import {AmbientCubeVolume, cubeTextures} from './ambient_cubes.js';
import {gridTextures, makeProbeGrid} from './probe_grid.js';
import {ProbeVolume, probeTextures} from './probe_volume.js';
import {TextureVolume, plainTextures} from './texture_volume.js';

/**
 * `textures(volume, all)`: the numbers of those that it needs, or null where it does not fit. What is made is
 * an object of three.js that has setTexels(all, second, part), which shows textures by number, and with
 * `blends` a share of others; setBlocks(texture, blocks, all), which shows what changed of them;
 * dispose(); and setGeometry(geometry) where it can scroll.
 */
const KINDS = [
  {textures: gridTextures, make: makeProbeGrid},
  {textures: probeTextures, make: (...values) => new ProbeVolume(...values)},
  {textures: cubeTextures, make: (...values) => new AmbientCubeVolume(...values)},
  {textures: plainTextures, make: (...values) => new TextureVolume(...values)},
];

/** {name, textures, make(renderer, options)} of a volume; null: a GPU can have none of its textures. */
export function findShown(volume, all) {
  for (const {textures, make} of KINDS) {
    const numbers = textures(volume, all);
    if (numbers) return {name: volume.name, textures: numbers, make: async (renderer, options) => make(volume, all, renderer, options)};
  }
  return null;
}

/** Lets a renderer draw with volumes. */
export async function useVolumes(renderer) {
  if (!renderer?.isWebGPURenderer) return;
  const {AmbientCubeVolumeNode, ProbeVolumeNode} = await import('gicodec:entry/three_nodes');
  for (const [Light, Node] of [[AmbientCubeVolume, AmbientCubeVolumeNode], [ProbeVolume, ProbeVolumeNode]]) {
    if (Light.registerNode) Light.registerNode(Node);
    else renderer.library.addLight(Node, Light);  // before r187
  }
}
