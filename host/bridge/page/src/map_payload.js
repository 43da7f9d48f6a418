// The map payload of `watch` (docs/reference/watch.md): a head, and the bricks that changed.
import { ByteReader } from './bytes.js';
import { cellsOf } from './bricks.js';
import { readLogOdds, readStamps } from './layers.js';

/**
 * Throws a RangeError for a payload that is cut off or malformed.
 * @param {ArrayBuffer} buffer @param {number} offset bytes before the payload
 * @returns {{resolution_m: number, occupiedFrom: number, hasAges: boolean, clock_s: number, staleStamp: number,
 *   bricks: {number: number, cells: import('./bricks.js').Cells}[]}} `number`: in Morton order. `occupiedFrom`:
 *   log-odds from which a voxel is occupied. Known voxels with a stamp below `staleStamp` are stale
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
    const { occupied, known, layer } = readLogOdds(reader, head.occupiedFrom);
    head.bricks.push({ number, cells: cellsOf(occupied, known, readStamps(reader), layer) });
  }
  return head;
}
