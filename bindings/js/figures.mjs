// Figures of pages in Chromium (script/browser-figures): node figures.mjs PROGRAMS PAGE OUT [grids|live|page...],
// the folders of the built programs, of the built page, and of what is made on the way; all tables, or some.
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {dirname, extname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {setTimeout} from 'node:timers/promises';
import {brotliCompressSync, gzipSync} from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url)), top = join(here, '../..');
const [programs, page, out] = process.argv.slice(2, 5).map((path) => resolve(path));
const wanted = process.argv.slice(5);
const tools = createRequire(join(top, 'build/js/package.json'));
const program = (name) => ['gicodec', 'stream', 'programs'].map((folder) => join(programs, folder, name)).find(existsSync);
const run = (name, ...values) => execFileSync(name, values, {cwd: out, stdio: ['ignore', 'pipe', 'inherit'], maxBuffer: 1 << 30});
const GRIDS = [[32, 16, 16], [64, 32, 64]], PARTS = 7, RUNS = 3, MBPS = [10, 100];
const PRESETS = ['strong', 'fast', 'turbo'];
const NAMES = {...Object.fromEntries(PRESETS.map((preset) => [preset, `.gic, ${preset}`])), meshopt: 'meshopt, zstd -22',
               ktx2: 'KTX2, zstd -22', json: 'JSON of 1/4096, gzip'};
mkdirSync(out, {recursive: true});

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** The file of a grid in each format, all of the same halves. */
async function pack(grid) {
  const [nx, ny, nz] = grid, name = grid.join('x');
  run(program('gi-trace'), '--scene', 'villa', '--layout', 'three', '--grid', name, '--rays', '128', '--frames', '1', '-q', '-o', `${name}.gic`);
  run(program('gicodec'), 'decode', '-q', `${name}.gic`, '-o', name, '--files', 'raw');
  for (const preset of PRESETS) {
    run(program('gicodec'), 'encode', '-q', '-o', `${name}.${preset}.gic`, '--preset', preset, '--layout', 'three', '--grid', name, '--bounds=0,0,0,1,1,1', name);
  }
  const raw = readFileSync(join(out, name, 'grid.0000.raw'));
  const texels = new Uint16Array(raw.buffer, raw.byteOffset, raw.length / 2);
  const {DataUtils} = await import(join(top, 'build/js/node_modules/three/build/three.module.js'));
  const coefficients = [];
  for (let probe = 0; probe < nx * ny * nz; ++probe) {
    const xy = probe % (nx * ny), z = Math.floor(probe / (nx * ny));
    for (let i = 0; i < 27; ++i) {
      coefficients.push(Math.round(4096 * DataUtils.fromHalfFloat(texels[((i >> 2) * (nz + 2) + z + 1) * nx * ny * 4 + xy * 4 + i % 4])));
    }
  }
  const zstd = (from, to) => run('zstd', '-q', '-f', '--ultra', '-22', from, '-o', to);
  zstd(join(name, 'grid.0000.raw'), `${name}.raw.zst`);
  const {createDefaultContainer, write} = await import(join(top, 'build/node/node_modules/ktx-parse/dist/index.mjs'));
  const ktx = createDefaultContainer();
  Object.assign(ktx, {vkFormat: 97, typeSize: 2, pixelWidth: nx, pixelHeight: ny, pixelDepth: PARTS * (nz + 2), supercompressionScheme: 2,
                      levels: [{levelData: readFileSync(join(out, `${name}.raw.zst`)), uncompressedByteLength: raw.length}]});
  Object.assign(ktx.dataFormatDescriptor[0], {colorModel: 1, colorPrimaries: 1, transferFunction: 1, bytesPlane: [8, 0, 0, 0, 0, 0, 0, 0],
    samples: [0, 1, 2, 15].map((channelType, i) => ({bitOffset: 16 * i, bitLength: 15, channelType: channelType | 0xC0, samplePosition: [0, 0, 0, 0],
                                                    sampleLower: 0xBF800000, sampleUpper: 0x3F800000}))});
  const {MeshoptEncoder} = await import(join(top, 'build/js/node_modules/meshoptimizer/index.js'));
  await MeshoptEncoder.ready;
  const vertices = MeshoptEncoder.encodeVertexBuffer(new Uint8Array(raw), raw.length / 8, 8);
  writeFileSync(join(out, `${name}.vertices`), vertices);
  zstd(`${name}.vertices`, `${name}.vertices.zst`);
  return {
    json: gzipSync(JSON.stringify({resolution: grid, coefficients}), {level: 9}),
    ktx2: Buffer.from(write(ktx)),
    meshopt: Buffer.concat([Buffer.from(Uint32Array.of(vertices.length).buffer), readFileSync(join(out, `${name}.vertices.zst`))]),
    ...Object.fromEntries(PRESETS.map((preset) => [preset, readFileSync(join(out, `${name}.${preset}.gic`))])),
  };
}

const TYPES = {'.js': 'text/javascript', '.html': 'text/html', '.css': 'text/css', '.wasm': 'application/wasm'};
const files = new Map();
const zipped = new Map();
const IMPORTS = {three: '/three/build/three.module.js', 'three/addons/': '/three/examples/jsm/', 'gicodec/three': '/npm/three.js'};
files.set('/', Buffer.from(`<!doctype html><meta charset=utf-8><script type=importmap>${JSON.stringify({imports: IMPORTS})}</script>` +
                           '<script type=module src="/figures_page.js"></script>'));

/** Code comes by Brotli, JSON by gzip, and data that is compressed as it is. */
function find(path) {
  if (files.has(path)) return {body: files.get(path), encoding: path.endsWith('.json') ? 'gzip' : null};
  const [, folder, rest] = /^\/(three|npm|page)\/(.*)$/.exec(path) ?? [];
  const file = folder ? join({three: join(top, 'build/js/node_modules/three'), npm: join(top, 'build/npm'), page}[folder], rest) : join(here, path.slice(1));
  if (!existsSync(file) || !statSync(file).isFile()) return null;
  if (!zipped.has(file)) zipped.set(file, brotliCompressSync(readFileSync(file)));
  return {body: zipped.get(file), encoding: 'br'};
}
const server = createServer(({url}, response) => {
  const path = new URL(url, 'http://x').pathname, found = find(path);
  if (!found) return response.writeHead(404).end();
  response.writeHead(200, {'content-type': TYPES[extname(path)] ?? (path === '/' ? 'text/html' : 'application/octet-stream'),
                           'cache-control': 'no-store', ...(found.encoding ? {'content-encoding': found.encoding} : {})}).end(found.body);
});
await new Promise((started) => server.listen(0, '127.0.0.1', started));
const origin = `http://127.0.0.1:${server.address().port}`;
const browser = await tools('puppeteer-core').launch({
  executablePath: '/usr/bin/chromium', protocolTimeout: 600000,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking', '--no-first-run']});

/** A new page, over a link of so many Mbps with 20 ms of delay. */
async function open(mbps) {
  const tab = await browser.newPage();
  tab.on('pageerror', ({message}) => console.error(message));
  await tab.goto(origin);
  await tab.waitForFunction('window.ready');
  if (mbps) {
    const link = await tab.createCDPSession();
    await link.send('Network.enable');
    await link.send('Network.emulateNetworkConditions', {offline: false, latency: 20, downloadThroughput: mbps * 125000, uploadThroughput: -1});
  }
  return tab;
}

async function grids() {
  console.log('| grid | format | bytes | shown at 10 Mbps, ms | at 100 Mbps, ms | code, bytes | with code, at 10 Mbps | at 100 Mbps | texels |');
  console.log('| --- | --- | --- | --- | --- | --- | --- | --- | --- |');
  for (const grid of GRIDS) {
    const packed = await pack(grid);
    let exact = null;
    for (const format of Object.keys(NAMES)) {
      const url = `/${grid.join('x')}.${format}`;
      files.set(url, packed[format]);
      const row = {};
      for (const loaded of [true, false]) {
        for (const mbps of MBPS) {
          const ms = [];
          for (let run = 0; run < RUNS; ++run) {
            const tab = await open(mbps);
            const reader = PRESETS.includes(format) ? 'gic' : format;
            if (loaded) await tab.evaluate((one) => window.page.prepare(one), reader);
            const link = await tab.createCDPSession();
            const sizes = [];
            await link.send('Network.enable');
            let own = '';  // the request of the grid itself
            link.on('Network.requestWillBeSent', ({requestId, request}) => { if (request.url.endsWith(url)) own = requestId; });
            link.on('Network.loadingFinished', ({requestId, encodedDataLength}) => requestId === own || sizes.push(encodedDataLength));
            const found = await tab.evaluate((...values) => window.page.load(...values), reader, url, grid);
            ms.push(found.ms);
            row.hash = found.hash;
            if (!loaded) row.code = sizes.reduce((sum, size) => sum + size, 0);
            await tab.close();
          }
          row[`${loaded} ${mbps}`] = median(ms).toFixed(0);
        }
      }
      exact ??= row.hash;
      console.log(`| ${grid.join(' × ')} | ${NAMES[format]} | ${packed[format].length} | ${row['true 10']} | ${row['true 100']} | ${row.code} | ` +
                  `${row['false 10']} | ${row['false 100']} | ${row.hash === exact ? 'all bits' : 'rounded'} |`);
    }
  }
}

async function live() {
  console.log('\n| probes | update, bytes | decode in Chromium, ms | native, ms | upload, ms | pictures per second |');
  console.log('| --- | --- | --- | --- | --- | --- |');
  for (const [grid, probes] of [['16x8x16', 2048], ['16x16x16', 4096]]) {
    run(program('gi-trace'), '--scene', 'villa', '--grid', grid, '--frames', '20', '--fps', '10', '-q', '-o', `${probes}.gic`);
    const port = join(out, 'port');
    rmSync(port, {force: true});
    const child = spawn(program('gi-server'), ['--play', join(out, `${probes}.gic`), '--loop', '--no-culling', '--rate', '10', '--listen-web', '127.0.0.1:0', '--insecure-web',
                                               '--allow-origin', '*', '--port-file', port, '-q'], {stdio: 'ignore'});
    while (!existsSync(port)) await setTimeout(50);
    const address = `ws://127.0.0.1:${readFileSync(port, 'utf8').trim()}`;
    const tab = await open();
    const found = await tab.evaluate((...values) => window.page.live(...values), address, 10);
    await tab.close();
    const native = JSON.parse(run(program('gi-client'), '--connect', address, '--simulate', '1', '--updates', '100', '--stats', 'json').toString().trim().split('\n').at(-1));
    child.kill();
    console.log(`| ${probes} | ${Math.round(native.mbps * 125000 / native.updates_per_s)} | ${found.decodeMs.toFixed(2)} | ${native.decode_ms.toFixed(2)} | ` +
                `${found.uploadMs.toFixed(2)} | ${found.fps.toFixed(0)} |`);
  }
}

function pageBytes() {
  const all = readdirSync(page, {recursive: true}).map(String).filter((name) => /\.(html|js|css|wasm)$/.test(name) && name !== 'viewer.html');
  console.log('\n| file of the page | bytes | gzip | Brotli |\n| --- | --- | --- | --- |');
  const sum = [0, 0, 0];
  for (const name of all) {
    const body = readFileSync(join(page, name));
    const sizes = [body.length, gzipSync(body, {level: 9}).length, brotliCompressSync(body).length];
    sizes.forEach((size, i) => { sum[i] += size; });
    console.log(`| ${name} | ${sizes.join(' | ')} |`);
  }
  console.log(`| all | ${sum.join(' | ')} |`);
}

try {
  for (const [name, body] of Object.entries({grids, live, page: pageBytes})) {
    if (wanted.length === 0 || wanted.includes(name)) await body();
  }
} finally {
  await browser.close();
  server.close();
}
