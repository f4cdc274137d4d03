// Speed of decoding containers by the built package, in MB of texels per second, the best of some plays:
// node speed.mjs node|chromium PLAYS FILE.gic... (script/wasm-speed).
import {readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const top = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const entry = join(top, 'build/npm/index.js');
const [where, plays, ...files] = process.argv.slice(2);

/** Runs here, and as text in a page. */
async function measure(gicodec, bytes, plays) {
  let best = 0;
  for (let n = 0; n < plays; ++n) {
    const player = await gicodec.open(bytes);
    const size = player.textures.reduce((sum, texture) => sum + texture.textureBytes, 0);
    let frames = 0;
    const start = performance.now();
    for await (const _ of player) ++frames;
    best = Math.max(best, frames * size / (performance.now() - start) / 1e3);
    player.close();
  }
  return best;
}

const print = (file, speed) => console.log(`${where} ${file} ${speed.toFixed(1)}`);
if (where === 'node') {
  const gicodec = await import(entry);
  for (const file of files) print(file, await measure(gicodec, readFileSync(file), Number(plays)));
} else {
  const server = createServer(({url}, response) => {
    const [type, read] = {
      '/': ['text/html', () => '<!doctype html>'], '/index.js': ['text/javascript', () => readFileSync(entry)],
    }[url] ?? ['application/octet-stream', () => readFileSync(files[Number(url.slice(1))])];
    if (url === '/favicon.ico') return response.writeHead(404).end();
    response.setHeader('content-type', type);
    response.end(read());
  });
  await new Promise((started) => server.listen(0, '127.0.0.1', started));
  const puppeteer = createRequire(join(top, 'build/js/package.json'))('puppeteer-core');
  const browser = await puppeteer.launch({executablePath: '/usr/bin/chromium', protocolTimeout: 600000, args: ['--no-sandbox']});
  const page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  for (const [place, file] of files.entries()) {
    print(file, await page.evaluate(`(async () => {
      const bytes = await (await fetch('/${place}')).arrayBuffer();
      return (${measure})(await import('/index.js'), bytes, ${Number(plays)});
    })()`));
  }
  await browser.close();
  server.close();
}
