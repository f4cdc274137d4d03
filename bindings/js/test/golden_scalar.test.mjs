// The same without vectors, by a module that the caller serves.
import {readFile} from 'node:fs/promises';
import {fileURLToPath} from 'node:url';
import {useModule} from 'gicodec';
import {testGolden} from './golden_lines.mjs';

await useModule(await readFile(fileURLToPath(import.meta.resolve('gicodec/decoder-scalar.wasm'))));
testGolden('without vectors');
