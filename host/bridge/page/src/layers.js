// The two layers of a brick in a map payload (docs/reference/watch.md): log-odds and stamps. A layer is kept as it came,
// and decoded when its values are needed.
import { ByteReader } from './bytes.js';
import { BRICK_VOXELS, LINEAR_OF_MORTON, ROWS } from './lattice.js';

const FORM = { unknown: 0, alike: 1, runs: 2 };
const NAN_BITS = 0x7fc00000;

// Values of 512 voxels, x fastest.
const logOddsBits = new Uint32Array(BRICK_VOXELS);
const logOdds = new Float32Array(logOddsBits.buffer);
const stamps = new Uint16Array(BRICK_VOXELS);

/** @param {ByteReader} reader at the runs; then behind them @param {Uint32Array | Uint16Array} values */
function decodeRuns(reader, values) {
  const { view } = reader;
  const size = values.BYTES_PER_ELEMENT;
  let at = reader.offset;
  for (let code = 0; code < BRICK_VOXELS;) {
    const control = view.getUint8(at++);
    const isRepeated = control >= 128;
    const end = code + (isRepeated ? control - 126 : control + 1);
    if (end > BRICK_VOXELS) throw new RangeError('a run beyond its brick');
    for (; code < end; code++) {
      values[LINEAR_OF_MORTON[code]] = size === 4 ? view.getUint32(at, true) : view.getUint16(at, true);
      if (!isRepeated) at += size;
    }
    if (isRepeated) at += size;
  }
  reader.offset = at;
}

function decode(reader, values, unknown) {
  const form = reader.u8();
  if (form === FORM.unknown) values.fill(unknown);
  else if (form === FORM.alike) values.fill(values.BYTES_PER_ELEMENT === 4 ? reader.u32() : reader.u16());
  else if (form === FORM.runs) decodeRuns(reader, values);
  else throw new RangeError(`form ${form} of a brick`);
}

/**
 * Reads log-odds as states. Throws a RangeError for a malformed layer, as `readStamps` does.
 * @param {ByteReader} reader @param {number} occupiedFrom log-odds
 * @returns {{occupied: Uint8Array, known: Uint8Array, layer: Uint8Array}} rows as in Cells; the layer for `logOddsAt`
 */
export function readLogOdds(reader, occupiedFrom) {
  const begin = reader.offset;
  decode(reader, logOddsBits, NAN_BITS);
  const occupied = new Uint8Array(ROWS);
  const known = new Uint8Array(ROWS);
  for (let row = 0, voxel = 0; row < ROWS; row++) {
    let occupiedBits = 0;
    let knownBits = 0;
    for (let bit = 1; bit < 256; bit <<= 1, voxel++) {
      const value = logOdds[voxel];
      if (value >= occupiedFrom) occupiedBits |= bit;
      if (value === value) knownBits |= bit; // NaN is unknown
    }
    occupied[row] = occupiedBits;
    known[row] = knownBits;
  }
  return { occupied, known, layer: reader.copyFrom(begin) };
}

/** @param {Uint8Array} layer of `readLogOdds` @param {number} voxel x + 8 y + 64 z @returns {number} NaN: unknown */
export function logOddsAt(layer, voxel) {
  decode(new ByteReader(layer.buffer, layer.byteOffset), logOddsBits, NAN_BITS);
  return logOdds[voxel];
}

/** @param {ByteReader} reader @returns {Uint8Array} the layer for `stampsOf` */
export function readStamps(reader) {
  const begin = reader.offset;
  decode(reader, stamps, 0);
  return reader.copyFrom(begin);
}

/** @param {Uint8Array} layer @returns {Uint16Array} of 512 voxels, x fastest, until the next call; 0: unknown */
export function stampsOf(layer) {
  decode(new ByteReader(layer.buffer, layer.byteOffset), stamps, 0);
  return stamps;
}
