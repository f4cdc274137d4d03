// The entry "three_nodes", which is loaded for WebGPURenderer alone.
export {AmbientCubeVolumeNode} from './cube_nodes.js';
export {ProbeVolumeNode} from './probe_nodes.js';
