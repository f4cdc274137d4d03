// From the axes and units of a volume to three.js's (FORMAT.md, "Keys").
import {Matrix4, Vector3} from 'three';

export const AXES = 'right up back';  // of three.js
const DIRECTIONS = {right: [1, 0, 0], left: [-1, 0, 0], up: [0, 1, 0], down: [0, -1, 0], back: [0, 0, 1], forward: [0, 0, -1]};

const DECIMAL = /^-?\d+(\.\d+)?([eE][-+]?\d+)?$/;
/** Metres of a unit, and places in them, beyond which nothing is drawn. */
const LEAST = 1e-9, MOST = 1e9;
const numberOf = (text) => (DECIMAL.test(text) ? Number(text) : NaN);

/** Metres of a unit; 1 where a file does not say it, or says what cannot be. */
export function unitOf(metadata) {
  const unit = numberOf(metadata['gicodec:unit'] ?? '');
  return unit >= LEAST && unit <= MOST ? unit : 1;
}

export function turnOf(metadata) {
  const axes = (metadata['gicodec:axes'] ?? AXES).split(' ').map((word) => (Object.hasOwn(DIRECTIONS, word) ? DIRECTIONS[word] : null));
  const whole = axes.length === 3 && axes.every(Boolean) && [0, 1, 2].every((at) => axes.some((axis) => axis[at] !== 0));
  const [x, y, z] = (whole ? axes : AXES.split(' ').map((word) => DIRECTIONS[word]))
      .map((axis) => new Vector3(...axis).multiplyScalar(unitOf(metadata)));
  return new Matrix4().makeBasis(x, y, z);
}

/** Least corner and size of the box that a volume lights, in its units; null where a file does not say it. */
export function boxOf(metadata) {
  const bounds = (metadata['gicodec:bounds'] ?? '').split(' ').map(numberOf), unit = unitOf(metadata);
  if (bounds.length !== 6 || !bounds.every((at) => Math.abs(at * unit) <= MOST) || ![0, 1, 2].every((axis) => bounds[axis] < bounds[axis + 3])) return null;
  return {least: bounds.slice(0, 3), size: bounds.slice(3).map((at, axis) => at - bounds[axis])};
}

/** The same, or a box around the origin of a unit for each of these cells. */
export function boxOrCells(metadata, cells) {
  const box = boxOf(metadata);
  if (box) return box;
  console.warn('GILoader: the container does not say which box its volume lights: a unit for each probe is taken. ' +
               'gicodec encode --bounds says it.');
  return {least: cells.map((side) => -side / 2), size: cells};
}
