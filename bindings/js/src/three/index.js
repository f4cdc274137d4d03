// The entry "gicodec/three": containers as objects of three.js.
export {AmbientCubeVolume} from './ambient_cubes.js';
export {GIClient} from './client.js';
export {ProbeVolumeHelper} from './helper.js';
export {GILoader} from './loader.js';
export {ProbeVolume} from './probe_volume.js';
export {captureLightProbeGrid, saveLightProbeGrid} from './save.js';
export {TextureVolume} from './texture_volume.js';
export {VolumeLight} from './volume_light.js';
