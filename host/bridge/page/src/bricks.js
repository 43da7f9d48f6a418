// The map as bricks: what each voxel is, and when it was last seen.
import { ROWS } from './lattice.js';

export const STATE = { unknown: 0, free: 1, occupied: 2 };

const NONE = new Uint8Array(ROWS);
const ALL = new Uint8Array(ROWS).fill(255);

export function areEqual(a, b) {
  if (a === b) return true;
  if (a.length !== b.length) return false;
  for (let at = 0; at < a.length; at++) if (a[at] !== b[at]) return false;
  return true;
}

/** One array for all bricks of one state. */
function shared(rows) {
  if (areEqual(rows, NONE)) return NONE;
  return areEqual(rows, ALL) ? ALL : rows;
}

const BITS_OF_BYTE = Uint8Array.from({ length: 256 }, (_, byte) => byte.toString(2).replaceAll('0', '').length);

/**
 * A brick. Rows are bits: a byte for each y + 8 z, in which bit x is that voxel. Layers are as they came (layers.js).
 * @typedef {object} Cells
 * @property {Uint8Array} occupied rows
 * @property {Uint8Array} known rows: occupied or free
 * @property {Uint8Array} stamps layer
 * @property {Uint8Array | null} logOdds layer; null: of the past, of which it is not kept
 * @property {number} count of occupied voxels
 */

/** @param {Uint8Array} occupied @param {Uint8Array} known @param {Uint8Array} stamps @param {Uint8Array} logOdds */
export function cellsOf(occupied, known, stamps, logOdds) {
  let count = 0;
  for (let row = 0; row < ROWS; row++) count += BITS_OF_BYTE[occupied[row]];
  return { occupied: shared(occupied), known: shared(known), stamps, logOdds, count };
}

const UNKNOWN = cellsOf(NONE, NONE, new Uint8Array(1), null);

export function isUnknown(cells) {
  return cells.known === NONE;
}

export function haveEqualStates(a, b) {
  return areEqual(a.occupied, b.occupied) && areEqual(a.known, b.known);
}

/** @param {Cells} cells @param {number} voxel x + 8 y + 64 z */
export function stateOf(cells, voxel) {
  const bit = 1 << (voxel & 7);
  if (cells.occupied[voxel >> 3] & bit) return STATE.occupied;
  return cells.known[voxel >> 3] & bit ? STATE.free : STATE.unknown;
}

/** Bytes of a brick, with what the JavaScript engine needs beside its arrays, at most. */
export function bytesOf({ occupied, known, stamps, logOdds }) {
  const rows = [occupied, known].filter((each) => each !== NONE && each !== ALL).length;
  return 400 + rows * ROWS + stamps.length + (logOdds?.length ?? 0);
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
    const before = this.cells.get(number) ?? UNKNOWN;
    const after = cells ?? UNKNOWN;
    const statesChanged = !haveEqualStates(before, after);
    const stampsChanged = !isUnknown(before) && !isUnknown(after) && !areEqual(before.stamps, after.stamps);
    this.occupied += after.count - before.count;
    if (cells) this.cells.set(number, cells);
    else this.cells.delete(number);
    if (statesChanged || stampsChanged) this.onChange(number, statesChanged);
  }

  clear() {
    for (const number of [...this.cells.keys()]) this.set(number, null);
  }

  get bytes() {
    let bytes = 0;
    for (const cells of this.cells.values()) bytes += bytesOf(cells);
    return bytes;
  }
}
