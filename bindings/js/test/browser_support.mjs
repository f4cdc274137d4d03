// What tests in browsers share: Debian's Chromium, and a server of files that sends parts of them.
import {existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {spawn} from 'node:child_process';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, extname, join, normalize} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

export const project = dirname(dirname(fileURLToPath(import.meta.url)));
// Bundlers and the browser's driver are no part of the project that uses the package.
const tools = createRequire(join(process.env.GICODEC_JS_TOOLS, 'package.json'));
export const tool = (name) => import(pathToFileURL(tools.resolve(name)));

const TYPES = {'.js': 'text/javascript', '.css': 'text/css', '.html': 'text/html', '.gic': 'application/octet-stream',
               '.wasm': 'application/wasm'};
const QUIET = ['--no-sandbox', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'];

export async function launch(flags = []) {
  const {default: puppeteer} = await tool('puppeteer-core');
  return puppeteer.launch({executablePath: '/usr/bin/chromium', args: [...QUIET, ...flags]});
}

/**
 * Serves texts and bytes by path, and files of these folders: {origin, put(path, body), log, parts, close()}.
 * `log` has what was sent, `parts` says whether parts of files are.
 */
export async function serve(bodies = {}, folders = [project]) {
  const state = {log: [], parts: true};
  const made = new Map(Object.entries(bodies));
  const server = createServer(({url, headers}, response) => {
    const path = normalize(new URL(url, 'http://localhost').pathname);
    const file = folders.map((folder) => join(folder, path)).find((one) => existsSync(one) && statSync(one).isFile());
    const body = made.get(path) ?? (file ? readFileSync(file) : null);
    if (body === null) return response.writeHead(404).end();
    const all = Buffer.from(body);
    const range = state.parts && /^bytes=(\d*)-(\d+)$/.exec(headers.range ?? '');
    let [first, last] = [0, all.length - 1];
    if (range?.[1]) [first, last] = [Number(range[1]), Math.min(Number(range[2]), last)];
    else if (range) first = Math.max(0, all.length - Number(range[2]));
    state.log.push({path, first, size: last - first + 1});
    response.writeHead(range ? 206 : 200, {
      'content-type': TYPES[extname(path)] ?? 'text/plain', 'content-length': last - first + 1, 'cache-control': 'no-store',
      ...(range ? {'content-range': `bytes ${first}-${last}/${all.length}`} : {}),
    }).end(all.subarray(first, last + 1));
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return Object.assign(state, {
    origin: `http://127.0.0.1:${server.address().port}`,
    put: (path, body) => made.set(path, body),
    close: () => new Promise((resolve) => { server.close(resolve); server.closeAllConnections(); }),
  });
}

/**
 * nginx with that text in its block http: {log(), close()}. `folder` becomes its own, and ends with it; `ready`
 * is a URL that it answers.
 */
export async function startNginx(http, folder, ready) {
  writeFileSync(join(folder, 'nginx.conf'), `
    daemon off; master_process off; pid ${folder}/pid; error_log ${folder}/error.log;
    events {}
    http {
      log_format sent '$status $uri $body_bytes_sent'; access_log ${folder}/access.log sent;
      ${['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((one) => `${one}_temp_path ${folder}/${one};`).join(' ')}
      ${http}
    }`);
  const nginx = spawn('nginx', ['-c', join(folder, 'nginx.conf'), '-p', folder], {stdio: 'inherit'});
  for (let tries = 0; ; ++tries) {
    const there = await fetch(ready).then(() => true, ({cause}) => /CERT|SELF_SIGNED/.test(cause?.code));
    if (there) break;
    if (tries === 100 || nginx.exitCode !== null) throw new Error('nginx does not start');
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return {
    log: () => readFileSync(join(folder, 'access.log'), 'utf8').trim().split('\n').map((line) => {
      const [status, path, size] = line.split(' ');
      return {status: Number(status), path, size: Number(size)};
    }),
    close: () => new Promise((resolve) => {
      nginx.on('exit', () => { rmSync(folder, {recursive: true, force: true}); resolve(); });
      nginx.kill();
    }),
  };
}

/** A port that is likely free, another one for each `use` of a process. */
export const portOf = (use) => 20000 + (7 * process.pid + use) % 20000;

/** nginx with bodies by path and the files of the project: {origin, log(), close()}. */
export async function serveByNginx(bodies) {
  const folder = mkdtempSync(join(tmpdir(), 'gicodec-nginx-')), port = portOf(0);
  for (const [path, body] of Object.entries(bodies)) writeFileSync(join(folder, path), body);
  const types = Object.entries(TYPES).map(([ending, type]) => `${type} ${ending.slice(1)};`).join(' ');
  const origin = `http://127.0.0.1:${port}`;
  const nginx = await startNginx(`types { ${types} }
      server { listen 127.0.0.1:${port}; root ${folder}; location ~ ^/(node_modules|test)/ { root ${project}; } }`, folder, `${origin}/`);
  return {...nginx, origin};
}

/** What Chromium has WebGL and WebGPU by where there is no GPU. */
export const CHROMIUM_WITH_GPU = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--enable-unsafe-webgpu',
                                  '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan'];

/** A page of a module of this folder, with three.js of WebGLRenderer or WebGPURenderer. */
export function pageOf(module, webgpu = false) {
  const imports = {
    three: `/node_modules/three/build/three.${webgpu ? 'webgpu' : 'module'}.js`,
    'three/webgpu': '/node_modules/three/build/three.webgpu.js', 'three/tsl': '/node_modules/three/build/three.tsl.js',
    'three/addons/': '/node_modules/three/examples/jsm/', 'gicodec/three': '/node_modules/gicodec/three.js',
  };
  return `<!doctype html><meta charset=utf-8><script type=importmap>${JSON.stringify({imports})}</script>` +
         `<script type=module src="/test/${module}.js"></script>`;
}
