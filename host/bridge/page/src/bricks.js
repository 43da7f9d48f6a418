// The map as bricks: what each voxel is, and when it was last seen.
import { BRICK_VOXELS } from './lattice.js';

export const STATE = { unknown: 0, free: 1, occupied: 2 };

const uniformStates = Object.values(STATE).map((state) => new Uint8Array(BRICK_VOXELS).fill(state));

function statesOf(logOdds, occupiedFrom) {
  const states = new Uint8Array(BRICK_VOXELS);
  let all = 0;
  for (let voxel = 0; voxel < BRICK_VOXELS; voxel++) {
    const value = logOdds[voxel];
    states[voxel] = value >= occupiedFrom ? STATE.occupied : value === value ? STATE.free : STATE.unknown;
    all |= 1 << states[voxel];
  }
  const uniform = uniformStates.find((_, state) => all === 1 << state);
  return uniform ?? states; // one array for all bricks of one state
}

export function areEqual(a, b) {
  if (a === b) return true;
  for (let voxel = 0; voxel < BRICK_VOXELS; voxel++) if (a[voxel] !== b[voxel]) return false;
  return true;
}

/** @typedef {{states: Uint8Array, stamps: Uint16Array, logOdds: Float32Array | null, occupied: number}} Cells */

/** @returns {Cells} 512 voxels each, x fastest */
export function cellsOf(logOdds, stamps, occupiedFrom) {
  return withCount(statesOf(logOdds, occupiedFrom), stamps, logOdds);
}

export function withCount(states, stamps, logOdds = null) {
  let occupied = 0;
  for (let voxel = 0; voxel < BRICK_VOXELS; voxel++) occupied += states[voxel] === STATE.occupied ? 1 : 0;
  return { states, stamps, logOdds, occupied };
}

export function isUnknown(cells) {
  return cells.states === uniformStates[STATE.unknown];
}

/** Bricks by number. `onChange(number, statesChanged)` hears of each brick that differs from before. */
export class Bricks {
  constructor(onChange) {
    this.onChange = onChange;
    this.cells = new Map();
    this.occupied = 0;
  }

  get(number) {
    return this.cells.get(number);
  }

  /** @param {number} number @param {Cells | null} cells null: all unknown */
  set(number, cells) {
    const before = this.cells.get(number);
    const states = cells ? cells.states : uniformStates[STATE.unknown];
    const statesChanged = !areEqual(before ? before.states : uniformStates[STATE.unknown], states);
    const stampsChanged = cells !== null && before !== undefined && !areEqual(before.stamps, cells.stamps);
    this.occupied += (cells ? cells.occupied : 0) - (before ? before.occupied : 0);
    if (cells) this.cells.set(number, cells);
    else this.cells.delete(number);
    if (statesChanged || stampsChanged) this.onChange(number, statesChanged);
  }

  clear() {
    for (const number of [...this.cells.keys()]) this.set(number, null);
  }

  /** Bytes of the arrays that belong to one brick alone, at most. */
  get bytes() {
    let bytes = 0;
    for (const cells of this.cells.values())
      bytes += (uniformStates.includes(cells.states) ? 0 : 512) + 1024 + (cells.logOdds ? 2048 : 0) + 100;
    return bytes;
  }
}
