import assert from 'node:assert/strict';
import {simd} from 'gicodec';
import {testGolden} from './golden_lines.mjs';

assert.equal(simd, true);
testGolden('with vectors');
