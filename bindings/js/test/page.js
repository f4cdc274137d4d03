// What a page does with the package: bundled by each bundler, or as it is with an import map.
import {open, useWorkers} from 'gicodec';
import {Client} from 'gicodec/client';
import {Encoder, mapTexture} from 'gicodec/encoder';
import {GILoader} from 'gicodec/three';

async function played(player) {
  const found = [];
  for await (const frame of player) {
    for (let i = 0; i < player.textures.length; ++i) {
      const digest = await crypto.subtle.digest('SHA-256', await player.read(i));
      found.push(`${frame} ${i} ${Array.from(new Uint8Array(digest.slice(0, 8))).join(',')}`);
    }
  }
  player.close();
  return found;
}

window.result = (async () => {
  const file = 'file.gic';
  const here = await played(await open(fetch(file)));
  await useWorkers(2);
  const there = await played(await open(fetch(file)));
  const desc = await mapTexture([32, 32], 'R16_SFLOAT');
  const encoder = await Encoder.create(desc);
  const client = await Client.create();
  const {children} = await new GILoader().loadAsync(file);
  return {loaded: children.map(({name}) => name), here, there, packet: encoder.encode(new Uint16Array(1024)).length, hello: client.hello().length};
})();
