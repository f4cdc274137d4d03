// Builds the page: node build.mjs [--npm build/npm] [--tools build/js] [--out build/web]. `out` gets the page as
// a server shows it (by Vite), its scripts also by Brotli, and viewer.html, one file into which gicodec view puts
// containers.
import {createHash} from 'node:crypto';
import {mkdirSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {parseArgs} from 'node:util';
import {brotliCompressSync} from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const top = join(here, '../..');
const {values} = parseArgs({options: {
  npm: {type: 'string', default: join(top, 'build/npm')},
  tools: {type: 'string', default: join(top, 'build/js')},
  out: {type: 'string', default: join(top, 'build/web')},
}});
const [npm, tools, out] = [values.npm, values.tools, values.out].map((path) => resolve(path));
const installed = createRequire(join(tools, 'package.json'));
const three = join(tools, 'node_modules/three');

/** The file of a package that the page imports; undefined: it is no package. */
function fileOf(name) {
  if (name === 'gicodec/three') return join(npm, 'three.js');
  if (name === 'three') return join(three, 'build/three.module.js');
  if (name.startsWith('three/addons/')) return join(three, 'examples/jsm', name.slice('three/addons/'.length));
  const [, build] = /^three\/(webgpu|tsl)$/.exec(name) ?? [];
  return build && join(three, `build/three.${build}.js`);
}

const {build} = await import(pathToFileURL(installed.resolve('vite')));
await build({
  root: here, configFile: false, base: './', logLevel: 'warn',
  plugins: [{name: 'packages', enforce: 'pre', resolveId: fileOf}],
  build: {outDir: out, emptyOutDir: true, modulePreload: {polyfill: false}, assetsInlineLimit: 0, chunkSizeWarningLimit: 4000},
});

// What gi-server sends to browsers that take it.
for (const name of readdirSync(out, {recursive: true}).map(String).filter((one) => /\.(js|css)$/.test(one))) {
  writeFileSync(join(out, `${name}.br`), brotliCompressSync(readFileSync(join(out, name))));
}

// What a page without a server and without WebGPU has no use for.
const LEFT_OUT = /(^three\/(webgpu|tsl)$|lighting\/LightProbeGrid\.js$|\/(client|three_nodes|encoder)\.js$)/;
const {build: bundle} = installed('esbuild');
const {outputFiles: [{text: script}]} = await bundle({
  entryPoints: [join(here, 'src/main.js')], bundle: true, minify: true, write: false, format: 'iife', target: 'es2022',
  charset: 'utf8', legalComments: 'none', logLevel: 'error', plugins: [{name: 'page', setup({onResolve, onLoad}) {
    onResolve({filter: LEFT_OUT}, ({path}) => ({path, namespace: 'none'}));
    onLoad({filter: /./, namespace: 'none'}, () => ({contents: 'export {};', loader: 'js'}));
    onResolve({filter: /^(gicodec|three)(\/|$)/}, ({path}) => ({path: fileOf(path)}));
  }}],
});
if (script.includes('</script') || script.includes('<!--')) throw new Error('the script ends the page that it stands in');
const style = readFileSync(join(here, 'style.css'), 'utf8');
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const policy = `default-src 'none'; script-src ${hash(script)} 'wasm-unsafe-eval'; worker-src blob:; style-src ${hash(style)}; ` +
               "img-src blob: data:; connect-src 'none'; base-uri 'none'; form-action 'none'";
/** Replaces a part that is there once. */
const replaced = (text, from, to) => {
  if (text.split(from).length !== 2) throw new Error(`index.html has not one ${from}`);
  return text.replace(from, () => to);
};
let page = readFileSync(join(here, 'index.html'), 'utf8');
page = page.replace(/(http-equiv="Content-Security-Policy" content=")[^"]*/, (_, before) => before + policy);
page = replaced(page, '<link rel="stylesheet" href="./style.css">', `<style>${style}</style>`);
page = replaced(page, '<script type="module" src="./src/main.js"></script>\n', '');
page = replaced(page, '<button id="connect">Connect…</button>', '<button id="connect" hidden></button>');
page = replaced(page, '</body>', `<!-- files -->\n<script>${script}</script>\n</body>`);
mkdirSync(out, {recursive: true});
writeFileSync(join(out, 'viewer.html'), page);
