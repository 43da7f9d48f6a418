// Which voxel a ray meets first (Amanatides and Woo 1987).
import { brickNumber, ORIGIN_KEY } from './lattice.js';
import { STATE, stateOf } from './bricks.js';

/** State of a voxel in `bricks`. @param {number[]} key */
export function stateAt(bricks, [x, y, z]) {
  const cells = bricks.get(brickNumber(x >> 3, y >> 3, z >> 3));
  return cells ? stateOf(cells, (x & 7) + 8 * (y & 7) + 64 * (z & 7)) : STATE.unknown;
}

/**
 * Visits the voxels along a ray until `visit(key)` returns true.
 * @param {number[]} origin metres, map frame @param {number[]} direction unit length @param {number} far_m
 * @returns {number[] | null} the key at which it ended; null: at `far_m`
 */
export function walk(origin, direction, far_m, resolution_m, visit) {
  const key = origin.map((along) => Math.floor(along / resolution_m) + ORIGIN_KEY);
  const step = direction.map(Math.sign);
  const delta = direction.map((along) => (along === 0 ? Infinity : resolution_m / Math.abs(along)));
  const next = direction.map((along, axis) => {
    if (along === 0) return Infinity;
    const face = (key[axis] - ORIGIN_KEY + (along > 0 ? 1 : 0)) * resolution_m;
    return (face - origin[axis]) / along;
  });
  const stepsMax = 3 * Math.ceil(far_m / resolution_m) + 3;
  for (let count = 0; count < stepsMax; count++) {
    if (visit(key)) return [...key];
    const axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
    if (next[axis] > far_m) return null;
    key[axis] += step[axis];
    next[axis] += delta[axis];
  }
  return null;
}

/** The first occupied voxel; with `alsoUnknown`, if there is none, the first unknown one behind free space. */
export function pickAlong(bricks, ray, resolution_m, alsoUnknown) {
  const { origin, direction, far_m } = ray;
  const hit = walk(origin, direction, far_m, resolution_m, (key) => stateAt(bricks, key) === STATE.occupied);
  if (hit || !alsoUnknown) return hit;
  let wasFree = false;
  return walk(origin, direction, far_m, resolution_m, (key) => {
    const state = stateAt(bricks, key);
    const isBehind = wasFree && state === STATE.unknown;
    wasFree = state === STATE.free;
    return isBehind;
  });
}
