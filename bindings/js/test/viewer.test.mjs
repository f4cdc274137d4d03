// The page of tools/web in Chromium: files dropped on it, files and servers that its address names.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {setTimeout} from 'node:timers/promises';

import {CHROMIUM_WITH_GPU, launch, portOf, project, serve, startNginx} from './browser_support.mjs';
import {giServer} from './gi_server.mjs';
import {SOURCE, program} from './support.mjs';

let browser, server, folder, live, liveUrl;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-viewer-'));
  const run = (name, ...values) => execFileSync(program(name), [...values, '-q'], {cwd: folder, stdio: 'pipe'});
  run('gi-trace', '--scene', 'tomb', '--grid', '8x4x8', '--frames', '6', '--fps', '3', '-o', 'room.gic');
  run('gi-trace', '--scene', 'tomb', '--grid', '8x4x8', '--frames', '1', '--start', '2', '-o', 'other.gic');
  run('gi-trace', '--scene', 'tomb', '--export-gltf', 'room.glb');
  writeFileSync(join(folder, '<img src=x onerror=alert(1)>.gic'), readFileSync(join(folder, 'room.gic')));
  writeFileSync(join(folder, 'same.gic'), readFileSync(join(folder, 'room.gic')));
  writeFileSync(join(folder, 'bad.gic'), 'no container');
  writeFileSync(join(folder, 'notes.txt'), 'text');
  execFileSync(process.execPath, [join(SOURCE, 'tools/web/build.mjs'), '--npm', join(project, 'node_modules/gicodec'),
                                  '--tools', process.env.GICODEC_JS_TOOLS, '--out', join(folder, 'page')], {stdio: 'inherit'});
  server = await serve({}, [join(folder, 'page'), folder]);
  live = await giServer(join(folder, 'room.gic'), {options: ['--web-page', join(folder, 'page'), '--allow-origin', server.origin]});
  liveUrl = `ws://${live.address}`;
  browser = await launch(CHROMIUM_WITH_GPU);
});
after(async () => {
  await browser?.close();
  await server?.close();
  live?.child.kill();
  rmSync(folder, {recursive: true, force: true});
});

/** The page, and what went wrong on it. */
async function open(query = '', {width = 680, height = 360, dark = false, url = `${server.origin}/index.html`, by = browser} = {}) {
  const page = await by.newPage();
  const wrong = [];
  page.on('pageerror', (error) => wrong.push(error.message));
  page.on('console', (message) => message.type() === 'error' && wrong.push(message.text()));
  page.on('dialog', (dialog) => (wrong.push(`dialog: ${dialog.message()}`), dialog.dismiss()));
  await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: dark ? 'dark' : 'light'}]);
  await page.setViewport({width, height});
  await page.goto(url + query);
  await page.waitForSelector('#view');
  return {page, wrong};
}
const text = (page, selector) => page.$eval(selector, (element) => element.textContent);
const shown = (page, selector) => page.$eval(selector, (element) => !element.hidden);
/** How many pixels of the picture are not those of an empty scene. */
async function lit(page) {
  const {width, height} = page.viewport();
  const png = await page.screenshot({clip: {x: 20, y: 60, width: width - 300, height: height - 160}, encoding: 'base64'});
  return page.evaluate(async (data) => {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], {type: 'image/png'}));
    const canvas = new OffscreenCanvas(image.width, image.height), context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const {data: pixels} = context.getImageData(0, 0, image.width, image.height);
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) count += pixels[i] + pixels[i + 1] + pixels[i + 2] > 24;
    return count / (pixels.length / 4);
  }, png);
}
async function drop(page, ...names) {
  const input = await page.$('#files');
  await input.uploadFile(...names.map((name) => join(folder, name)));
  await page.waitForFunction(() => document.getElementById('progress').hidden);
}

test('a file and a scene of the address', async () => {
  const {page, wrong} = await open('?file=room.gic&scene=room.glb');
  await page.waitForFunction(() => document.getElementById('title').textContent === 'room.gic', {timeout: 60000});
  assert.equal(await shown(page, '#timeline'), true);
  assert.equal(await shown(page, '#hint'), false);
  assert.match(await text(page, '#facts'), /states6probes8 × 4 × 8/);
  await setTimeout(500);
  const both = await lit(page);
  assert.ok(both > 0.3, `${both}`);
  for (const mode of ['direct', 'indirect']) {
    await page.click(`[name=mode][value=${mode}]`);
    await setTimeout(300);
    const part = await lit(page);
    assert.ok(part > 0.02 && part !== both, `${mode} ${part}`);
  }
  await page.click('[name=probes][value=age]');
  await page.click('[name=camera][value=walk]');
  await page.keyboard.down('KeyW');
  await setTimeout(200);
  await page.keyboard.up('KeyW');
  await page.keyboard.press('Period');
  await page.waitForFunction(() => document.getElementById('state').textContent === '0.33');
  await page.keyboard.press('Space');
  await page.waitForFunction(() => Number(document.getElementById('time').value) > 0.8);
  assert.deepEqual(wrong, []);
  await page.close();
});

test('dropped files, and another beside', async () => {
  const {page, wrong} = await open();
  assert.equal(await shown(page, '#hint'), true);
  await drop(page, 'room.glb', 'room.gic', 'other.gic');
  assert.equal(await text(page, '#title'), 'room.gic');
  assert.equal(await shown(page, '#difference'), true);
  await setTimeout(400);
  assert.ok(await lit(page) > 0.001);
  await drop(page, '<img src=x onerror=alert(1)>.gic');
  assert.equal(await text(page, '#title'), '<img src=x onerror=alert(1)>.gic');
  assert.deepEqual(wrong, []);
  for (const [name, why] of [['bad.gic', /not a gicodec container|is not|container/i], ['notes.txt', /notes\.txt: not a \.gic/]]) {
    await drop(page, name);
    assert.equal(await shown(page, '#error'), true);
    assert.match(await text(page, '#error p'), why);
    await page.click('#dismiss');
    assert.equal(await shown(page, '#error'), false);
  }
  await page.close();
});

test('a file beside itself differs in no state, and the next one is compared with none', async () => {
  const {page, wrong} = await open();
  await drop(page, 'room.glb', 'room.gic', 'same.gic');
  await page.focus('#view');
  for (let step = 0; step < 3; ++step) {
    await setTimeout(300);
    assert.ok(await lit(page) < 1e-3, `state ${step}`);
    await page.keyboard.press('Period');
  }
  await drop(page, 'other.gic');
  assert.equal(await shown(page, '#difference'), false);
  assert.equal(await page.$eval('[name=mode]:checked', ({value}) => value), 'both');
  await setTimeout(300);
  assert.ok(await lit(page) > 0.1);
  assert.deepEqual(wrong, []);
  await page.close();
});

test('a server shows its own page, and refuses those of others', async () => {
  const [url] = live.said().match(/http:\/\/127\.0\.0\.1:\d+\/\?server/);
  const {page, wrong} = await open('', {url});
  await page.waitForFunction(() => /updates\d/.test(document.getElementById('facts').textContent), {timeout: 60000});
  assert.equal(await page.evaluate(() => document.getElementById('server').open), false);
  assert.deepEqual(wrong, []);
  await page.close();
  const other = await serve({}, [join(folder, 'page'), folder]);
  const {page: stranger} = await open(`?server=${encodeURIComponent(liveUrl)}`, {url: `${other.origin}/index.html`});
  await stranger.waitForFunction(() => document.getElementById('server').open);
  await stranger.click('#server [value=connect]');
  await stranger.waitForFunction(() => !document.getElementById('error').hidden);
  for (const end = Date.now() + 20000; !live.said().includes('--allow-origin'); await setTimeout(50)) assert.ok(Date.now() < end, live.said());
  assert.ok(live.said().includes(`--allow-origin ${other.origin} lets its pages in`), live.said());
  await stranger.close();
  await other.close();
});

test('a server behind nginx, which has the certificate', async () => {
  const own = mkdtempSync(join(tmpdir(), 'gicodec-proxy-')), name = 'light.example.org', port = portOf(1);
  const origin = `https://${name}:${port}`;
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '2', '-subj', `/CN=${name}`,
                           '-keyout', 'key.pem', '-out', 'chain.pem'], {cwd: own, stdio: 'pipe'});
  const behind = await giServer(join(folder, 'room.gic'), {options: ['--web-page', join(folder, 'page'), '--web-scene', '--allow-origin', origin, '--behind-proxy']});
  let conf = readFileSync(join(SOURCE, 'packaging/nginx/gi-server.conf'), 'utf8');
  for (const [from, to] of [
    ['listen 443 ssl;', `listen 127.0.0.1:${port} ssl;`], ['listen [::]:443 ssl;', ''],
    ['listen 80;', `listen 127.0.0.1:${portOf(2)};`], ['listen [::]:80;', ''], ['http://127.0.0.1:8080', `http://${behind.address}`],
    ['/etc/letsencrypt/live/light.example.org/fullchain.pem', `${own}/chain.pem`],
    ['/etc/letsencrypt/live/light.example.org/privkey.pem', `${own}/key.pem`], ['/srv/light/', `${folder}/`]]) {
    assert.ok(conf.includes(from), from);
    conf = conf.replaceAll(from, to);
  }
  const nginx = await startNginx(`types { text/html html; text/javascript js; text/css css; } ${conf}`, own, `https://127.0.0.1:${port}/health`);
  const other = await launch([...CHROMIUM_WITH_GPU, `--host-resolver-rules=MAP ${name} 127.0.0.1`, '--ignore-certificate-errors']);
  try {
    const {page, wrong} = await open(/\/(\?server&scene=scene\.glb)/.exec(behind.said())[1], {url: `${origin}/`, by: other});
    await page.waitForFunction(() => /updates\d/.test(document.getElementById('facts').textContent), {timeout: 60000});
    await page.goto(`${origin}/?file=/light/room.gic`);
    await page.waitForFunction(() => document.getElementById('title').textContent === 'room.gic', {timeout: 60000});
    const {encoding, asked} = await page.evaluate(async () => {
      const script = document.querySelector('script[src]').src, answer = await fetch(script);
      return {encoding: answer.headers.get('content-encoding'), asked: (await fetch('/scene.glb')).status};
    });
    assert.deepEqual([encoding, asked], ['br', 200]);
    assert.equal(await page.evaluate(() => fetch('/metrics').then(({status}) => status)), 404);
    assert.deepEqual(wrong.filter((one) => !one.includes('404')), []);
    assert.ok(nginx.log().some(({path, status}) => path === '/light/room.gic' && status === 206));
    assert.ok(nginx.log().every(({status}) => status < 500));
    await page.close();
  } finally {
    await other.close();
    behind.child.kill();
    await nginx.close();
  }
});

test('a server: asked about, followed, lost, reconnected', async () => {
  const {page, wrong} = await open(`?server=${encodeURIComponent(liveUrl)}&scene=room.glb`);
  await page.waitForFunction(() => document.getElementById('server').open, {timeout: 60000});
  assert.match(await text(page, '#ask'), /another server/);
  assert.equal(await page.$eval('#url', ({value}) => value), liveUrl);
  await page.click('#server [value=connect]');
  await page.waitForFunction(() => /updates\d/.test(document.getElementById('facts').textContent), {timeout: 60000});
  assert.equal(await shown(page, '#graphs'), true);
  await page.waitForFunction(() => [...document.querySelectorAll('#graphs output')].every(({textContent}) => textContent !== ''));
  assert.ok(await lit(page) > 0.3);
  assert.deepEqual(wrong, []);
  await drop(page, 'bad.gic');
  await setTimeout(1000);  // updates go on
  assert.equal(await shown(page, '#error'), true);
  await page.click('#dismiss');
  live.child.kill('SIGKILL');
  await page.waitForFunction(() => !document.getElementById('error').hidden, {timeout: 60000});
  assert.match(await text(page, '#error p'), /connection was lost.*\nThe next try/);
  assert.equal(await shown(page, '#again'), true);
  await page.close();
});

test('phones, and the dark', async () => {
  const {page, wrong} = await open('?file=room.gic', {width: 360, height: 640, dark: true});
  await page.waitForFunction(() => document.getElementById('title').textContent === 'room.gic', {timeout: 60000});
  assert.equal(await shown(page, '#panel'), false);
  await page.click('#toggle');
  const fits = await page.evaluate(() => [...document.querySelectorAll('header, aside, footer')].every((element) => {
    const {left, right} = element.getBoundingClientRect();
    return left >= 0 && right <= innerWidth;
  }));
  assert.ok(fits);
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), 'rgb(20, 20, 22)');
  assert.deepEqual(wrong, []);
  await page.close();
});

test('a page with everything inside, from a disk', async () => {
  const name = '<img src=x onerror=alert(1)>.gic';
  execFileSync(program('gicodec'), ['view', name, '--scene', 'room.glb', '--export', 'room.html', '--page', 'page/viewer.html'],
               {cwd: folder, stdio: 'pipe'});
  const {page, wrong} = await open('', {url: `file://${folder}/room.html`});
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  await page.waitForFunction((wanted) => document.getElementById('title').textContent === wanted, {timeout: 60000}, name);
  await setTimeout(500);
  assert.ok(await lit(page) > 0.2);
  assert.equal(await shown(page, '#connect'), false);
  assert.deepEqual(wrong, []);
  assert.deepEqual(asked.filter((url) => !/^(blob|data):/.test(url)), []);
  const policy = await page.$eval('meta[http-equiv]', ({content}) => content);
  assert.match(policy, /connect-src 'none'/);
  assert.match(policy, /script-src 'sha256-[^']+' 'wasm-unsafe-eval';/);
  await page.close();
});

test('it keeps to its content security policy, and keeps nothing', async () => {
  const {page} = await open('?file=room.gic');
  await page.waitForFunction(() => document.getElementById('title').textContent === 'room.gic', {timeout: 60000});
  const policy = await page.$eval('meta[http-equiv]', ({content}) => content);
  assert.match(policy, /script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:/);
  assert.doesNotMatch(policy, /unsafe-inline|unsafe-eval'[^;]*unsafe-eval/);
  const kept = await page.evaluate(() => [document.cookie, localStorage.length, sessionStorage.length]);
  assert.deepEqual(kept, ['', 0, 0]);
  assert.ok(readdirSync(join(folder, 'page/assets')).length > 1);
  await page.close();
});
