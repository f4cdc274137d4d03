// Builds the page: vite build tools/web, with the package of build/npm and what script/bootstrap npm installed.
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const top = join(dirname(fileURLToPath(import.meta.url)), '../..');
const tools = process.env.GICODEC_JS_TOOLS ?? join(top, 'build/js');
const npm = process.env.GICODEC_NPM ?? join(top, 'build/npm');

export default {
  base: './',
  resolve: {
    alias: [
      {find: /^gicodec\/three$/, replacement: join(npm, 'three.js')},
      {find: /^three\/addons\//, replacement: `${join(tools, 'node_modules/three/examples/jsm')}/`},
      {find: /^three$/, replacement: join(tools, 'node_modules/three/build/three.module.js')},
      {find: /^three\/(webgpu|tsl)$/, replacement: `${join(tools, 'node_modules/three/build')}/three.$1.js`},
    ],
  },
  build: {outDir: join(top, 'build/web'), emptyOutDir: true, modulePreload: {polyfill: false}, assetsInlineLimit: 0,
          chunkSizeWarningLimit: 4000},
};
