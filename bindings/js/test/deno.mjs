// In Deno: the package in a worker and out of it.
import {open, useWorkers} from 'gicodec';
import {golden, hashOf} from './support.mjs';

for (const workers of [0, 1]) {
  await useWorkers(workers);
  const player = await open(golden('native_fast.gic'));
  for await (const frame of player) {
    for (let i = 0; i < player.textures.length; ++i) {
      console.log(`native_fast.gic ${frame} ${i} ${hashOf(await player.read(i))}`);
    }
  }
  player.close();
}
await useWorkers(0);
