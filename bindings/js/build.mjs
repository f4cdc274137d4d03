// Makes the package in a folder: node build.mjs [--out build/npm] [--modules build/wasm-modules] [--quick].
// Modules are built by CMake, ninja and clang 16 with wasi-libc; --quick builds larger and slower ones, with
// vectors alone, in a quarter of the time, for tests.
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {parseArgs} from 'node:util';

const here = dirname(fileURLToPath(import.meta.url));
const top = resolve(here, '../..');
// script/bootstrap npm puts it there.
const {build} = createRequire(join(top, 'build/js/package.json'))('esbuild');
const {values} = parseArgs({options: {
  out: {type: 'string', default: join(top, 'build/npm')},
  modules: {type: 'string', default: join(top, 'build/wasm-modules')},
  quick: {type: 'boolean', default: false},
}});
const [out, folder] = [resolve(values.out), resolve(values.modules)];
const ENTRIES = {index: 'index', encoder: 'encoder_entry', client: 'client_entry', three: 'three/index',
                 three_nodes: 'three/volume_nodes'};  // and their sources
const BUILDS = values.quick ? [
  {name: 'quick', modules: ['decoder', 'client', 'encoder'], options: ['-DGICODEC_CLIENT=ON', '-DCMAKE_UNITY_BUILD=ON']},
] : [  // what is built at once
  {name: 'decode', modules: ['decoder', 'client'], options: ['-DGICODEC_DECODE_ONLY=ON', '-DGICODEC_CLIENT=ON']},
  {name: 'encode', modules: ['encoder'], options: []},
];
const SETS = values.quick ? {simd: 'simd128'} : {simd: 'simd128', scalar: 'scalar'};

function run(...command) {
  execFileSync(command[0], command.slice(1), {stdio: ['ignore', 'ignore', 'inherit']});
}

run('python3', join(here, 'make_interface.py'), '--check');
rmSync(out, {recursive: true, force: true});
mkdirSync(out, {recursive: true});
const texts = {};
for (const {name, modules, options} of BUILDS) {
  for (const [set, isa] of Object.entries(SETS)) {
    const at = join(folder, `${name}-${set}`);
    run('cmake', '-G', 'Ninja', '-S', join(here, 'wasm'), '-B', at,
        `-DCMAKE_TOOLCHAIN_FILE=${join(top, 'cmake/wasi.cmake')}`, '-DCMAKE_BUILD_TYPE=MinSizeRel',
        `-DCMAKE_CXX_FLAGS_MINSIZEREL=${values.quick ? '-O1' : '-Oz'} -DNDEBUG`, `-DGICODEC_ISAS=${isa}`,
        // Vectors in place of calls: ten times as fast for a tenth more bytes.
        `-DGICODEC_SMALL=${set === 'scalar' ? 'ON' : 'OFF'}`, `-DMODULES=${modules.join(';')}`, ...options);
    run('cmake', '--build', at);
    for (const module of modules) {
      const bytes = readFileSync(join(at, `${module}.wasm`));
      (texts[module] ??= {})[set] = bytes.toString('latin1');
      copyFileSync(join(at, `${module}.wasm`), join(out, `${module}${set === 'simd' ? '' : '-scalar'}.wasm`));
    }
  }
}

/** A string literal with a character for each byte, which stays compressible. */
function literal(text) {
  const escapes = {'\\': '\\\\', '\'': '\\\'', '\n': '\\n', '\r': '\\r', '\0': '\\0'};
  return `'${text.replace(/[\\'\n\r\0]/g, (one, at) =>
    (one === '\0' && /\d/.test(text[at + 1] ?? '') ? '\\x00' : escapes[one]))}'`;
}

const embedded = {
  name: 'gicodec',
  setup({onResolve, onLoad}) {
    onResolve({filter: /^gicodec:entry\//}, ({path}) => ({path: `./${path.slice('gicodec:entry/'.length)}.js`, external: true}));
    onResolve({filter: /^gicodec:/}, ({path}) => ({path, namespace: 'gicodec'}));
    onLoad({filter: /^gicodec:module\//, namespace: 'gicodec'}, ({path}) => {
      const module = path.slice('gicodec:module/'.length);
      return {contents: `export default {simd: '@${module}/simd@', scalar: '@${module}/scalar@'};`};
    });
    onLoad({filter: /^gicodec:sample$/, namespace: 'gicodec'}, async () => ({contents: `export default ${literal(await sample())};`}));
    onLoad({filter: /^gicodec:text\//, namespace: 'gicodec'}, async ({path}) => ({
      contents: `export default ${literal(await bundle(path.slice('gicodec:text/'.length), true))};`,
    }));
  },
};

/** A small grid of light probes as a container, by the entry "encoder", which is built before those that hold it. */
async function sample() {
  const {Writer, volumeOfLayout} = await import(pathToFileURL(join(out, 'encoder.js')));
  const writer = await Writer.create({grid: await volumeOfLayout('three', [4, 4, 4])}, {preset: 'fast'});
  // Halves around 1 and -1 whose low bits vary.
  writer.add(0, {grid: Uint16Array.from({length: 4 * 4 * 42 * 4}, (_, i) => 0x3C00 + (i & 1) * 0x8000 + (Math.imul(i, 2654435761) >>> 26) + (i >> 6))});
  return Buffer.from(writer.finish()).toString('latin1');
}

/** The text of a source with what it imports: a module, or what a worker runs. */
async function bundle(name, isWorker = false) {
  const {outputFiles: [{text}]} = await build({
    entryPoints: [join(here, 'src', `${name}.js`)], bundle: true, minify: isWorker, write: false,
    format: isWorker ? 'iife' : 'esm', platform: 'neutral', target: 'es2022', charset: 'utf8',
    legalComments: 'none', external: ['three', 'three/*'], plugins: [embedded],
  });
  // Behind the bundler, which escapes more than a module in UTF-8 needs.
  return text.replace(/(['"`])@(\w+)\/(\w+)@\1/g, (_, quote, module, set) => literal(texts[module][set] ?? ''));
}

const [, version] = readFileSync(join(top, 'include/gicodec/version.h'), 'utf8').match(/"(\d+\.\d+\.\d+)"/);
const about = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));
delete about.private;
writeFileSync(join(out, 'package.json'), `${JSON.stringify({...about, version}, null, 2)}\n`);
copyFileSync(join(here, 'README.md'), join(out, 'README.md'));
copyFileSync(join(top, 'LICENSE'), join(out, 'LICENSE'));
copyFileSync(join(here, 'THIRD_PARTY'), join(out, 'THIRD_PARTY'));
copyFileSync(join(here, 'types/common.d.ts'), join(out, 'common.d.ts'));

const sizes = [];
for (const [entry, source] of Object.entries(ENTRIES)) {
  writeFileSync(join(out, `${entry}.js`), await bundle(source));
  const types = join(here, 'types', `${entry}.d.ts`);
  if (existsSync(types)) copyFileSync(types, join(out, `${entry}.d.ts`));  // of those that users import
  sizes.push(`${entry}.js ${statSync(join(out, `${entry}.js`)).size}`);
}
console.log(`${out}: ${sizes.join(', ')} bytes`);
