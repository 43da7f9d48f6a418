// The map payload of `watch` (docs/reference/watch.md): a head, and the bricks that changed.
import { ByteReader } from './bytes.js';
import { BRICK_VOXELS, LINEAR_OF_MORTON } from './lattice.js';

const FORM = { unknown: 0, alike: 1, runs: 2 };

/** One array for all bricks with one value: most bricks of free space are such. */
class AlikeLayers {
  constructor(Type, unknown) {
    this.Type = Type;
    this.unknown = new Type(BRICK_VOXELS).fill(unknown);
    this.layers = new Map();
  }

  of(value) {
    if (Number.isNaN(value)) return this.unknown;
    if (!this.layers.has(value)) {
      if (this.layers.size > 1000) this.layers.clear();
      this.layers.set(value, new this.Type(BRICK_VOXELS).fill(value));
    }
    return this.layers.get(value);
  }
}

const logOddsAlike = new AlikeLayers(Float32Array, NaN);
const stampsAlike = new AlikeLayers(Uint16Array, 0);

function readRuns(reader, values, read) {
  for (let voxel = 0; voxel < BRICK_VOXELS;) {
    const control = reader.u8();
    const isRepeated = control >= 128;
    const end = voxel + (isRepeated ? control - 126 : control + 1);
    if (end > BRICK_VOXELS) throw new RangeError('a run beyond its brick');
    let value = isRepeated ? read() : 0;
    for (; voxel < end; voxel++) {
      if (!isRepeated) value = read();
      values[LINEAR_OF_MORTON[voxel]] = value;
    }
  }
  return values;
}

function readLayer(reader, alike, read) {
  const form = reader.u8();
  if (form === FORM.unknown) return alike.unknown;
  if (form === FORM.alike) return alike.of(read());
  if (form === FORM.runs) return readRuns(reader, new alike.Type(BRICK_VOXELS), read);
  throw new RangeError(`form ${form} of a brick`);
}

/**
 * @typedef {object} Brick
 * @property {number} number in Morton order
 * @property {Float32Array} logOdds of 512 voxels, x fastest; NaN: unknown
 * @property {Uint16Array} stamps 4 times the clock's reading, s, when the voxel was last seen, plus the kind of sensor
 */

/**
 * Throws a RangeError for a payload that is cut off or malformed.
 * @param {ArrayBuffer} buffer @param {number} offset bytes before the payload
 * @returns {{resolution_m: number, occupiedFrom: number, hasAges: boolean, clock_s: number, staleStamp: number,
 *   bricks: Brick[]}} `occupiedFrom`: log-odds from which a voxel is occupied; known voxels with a stamp below
 *   `staleStamp` are stale
 */
export function readMapPayload(buffer, offset) {
  const reader = new ByteReader(buffer, offset);
  const head = {
    resolution_m: reader.f64(),
    occupiedFrom: reader.f32(),
    hasAges: reader.u8() === 1,
    clock_s: reader.u32(),
    staleStamp: reader.u16(),
    bricks: [],
  };
  if (!(head.resolution_m > 0 && Number.isFinite(head.resolution_m)))
    throw new RangeError('a resolution not above 0');
  while (!reader.isAtEnd) {
    const number = reader.count();
    const logOdds = readLayer(reader, logOddsAlike, () => reader.f32());
    const stamps = readLayer(reader, stampsAlike, () => reader.u16());
    head.bricks.push({ number, logOdds, stamps });
  }
  return head;
}
