// Pages in Chromium: as a browser loads the package, and as bundlers make it.
import assert from 'node:assert/strict';
import {createHash} from 'node:crypto';
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {open} from 'gicodec';

import {launch, project, serve, tool} from './browser_support.mjs';
import {bytes, golden} from './support.mjs';

const FILE = 'native_strong.gic';
const entry = join(dirname(fileURLToPath(import.meta.url)), 'page.js');
const root = mkdtempSync(join(tmpdir(), 'gicodec-pages-'));
let browser, server, expected, volumes;

const BUNDLERS = {
  async plain(folder) {
    const imports = Object.fromEntries(['index', 'encoder', 'client', 'three'].map((name) =>
      [name === 'index' ? 'gicodec' : `gicodec/${name}`, `/node_modules/gicodec/${name}.js`]));
    imports.three = '/node_modules/three/build/three.module.js';
    return `<script type="importmap">${JSON.stringify({imports})}</script><script type=module src="/test/page.js"></script>`;
  },
  async esbuild(folder) {
    const {build} = await tool('esbuild');
    await build({entryPoints: [entry], bundle: true, minify: true, format: 'esm', outfile: join(folder, 'page.js'), logLevel: 'error'});
    return '<script type=module src="page.js"></script>';
  },
  async vite(folder) {
    const {build} = await tool('vite');
    await build({root: project, logLevel: 'error', configFile: false, build: {
      outDir: folder, emptyOutDir: false, chunkSizeWarningLimit: 1e6,
      rollupOptions: {input: entry, output: {entryFileNames: 'page.js'}}}});
    return '<script type=module src="page.js"></script>';
  },
  async rollup(folder) {
    const {rollup} = await tool('rollup');
    const {nodeResolve} = await tool('@rollup/plugin-node-resolve');
    const bundle = await rollup({input: entry, plugins: [nodeResolve({browser: true})], onLog(level, {message}) {
      assert.notEqual(level, 'warn', message);
    }});
    await bundle.write({file: join(folder, 'page.js'), format: 'es', inlineDynamicImports: true});
    return '<script type=module src="page.js"></script>';
  },
  async webpack(folder) {
    const {default: webpack} = await tool('webpack');
    await new Promise((resolve, reject) => webpack({
      mode: 'production', context: project, entry, output: {path: folder, filename: 'page.js'}, performance: false,
    }, (error, stats) => (error || stats.hasErrors() || stats.hasWarnings()
      ? reject(error ?? new Error(stats.toString())) : resolve())));
    return '<script src="page.js"></script>';
  },
};

before(async () => {
  const player = await open(golden(FILE));
  volumes = player.volumes.map(({name}) => name);
  expected = [];
  for await (const frame of player) {
    for (let i = 0; i < player.textures.length; ++i) {
      const digest = createHash('sha256').update(bytes(await player.read(i))).digest();
      expected.push(`${frame} ${i} ${Array.from(digest.subarray(0, 8)).join(',')}`);
    }
  }
  server = await serve({}, [root, project]);
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(root, {recursive: true, force: true});
});

for (const [name, build] of Object.entries(BUNDLERS)) {
  test(`in Chromium, ${name}`, async () => {
    const folder = join(root, name);
    mkdirSync(folder);
    const scripts = await build(folder);
    writeFileSync(join(folder, 'file.gic'), golden(FILE));
    writeFileSync(join(folder, 'index.html'), `<!doctype html><meta charset=utf-8>${scripts}`);
    const page = await browser.newPage();
    const errors = [];
    page.on('pageerror', (error) => errors.push(error.message));
    await page.goto(`${server.origin}/${name}/index.html`);
    await page.waitForFunction('window.result', {timeout: 20000});
    const {loaded, here: ours, there, packet, hello} = await page.evaluate('window.result');
    assert.deepEqual(ours, expected);
    assert.deepEqual(there, expected);
    assert.ok(packet > 0 && hello > 0);
    assert.deepEqual(loaded, volumes);
    assert.deepEqual(errors, []);
    await page.close();
  });
}
