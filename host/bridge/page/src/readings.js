// The ranges of the last minute, and which of them last touched a voxel.
import { ByteReader } from './bytes.js';
import { centreOf } from './lattice.js';

const CAPACITY = 65536;
const FIELDS = 13;
const MINUTE_S = 60;

/**
 * @typedef {object} Reading
 * @property {number} time_s bus time of its capture
 * @property {number} node @property {number} sensor @property {number} zone
 * @property {boolean} hasTarget @property {number} range_m @property {number} sigma_m
 * @property {number[]} origin @property {number[]} direction map frame, metres
 */

/**
 * A batch of /octoskin/view/ranges. Throws a RangeError if it is cut off.
 * @param {ArrayBuffer} buffer @param {number} offset bytes @returns {Reading[]}
 */
export function readBatch(buffer, offset) {
  const reader = new ByteReader(buffer, offset);
  reader.seconds(); // the batch's own time
  const readings = [];
  while (!reader.isAtEnd) {
    const bytes = reader.u32();
    const time_s = reader.seconds();
    const end = reader.offset + bytes;
    readings.push({
      time_s,
      node: reader.u8(),
      sensor: reader.u8(),
      zone: reader.u8(),
      hasTarget: reader.u8() === 1,
      range_m: reader.f64(),
      sigma_m: reader.f64(),
      origin: reader.vector(),
      direction: reader.vector(),
    });
    reader.offset = end;
  }
  return readings;
}

/** Part of a ray, metres from its origin, within a cube; null if they do not meet. */
function within(origin, direction, centre, half) {
  let from = 0;
  let to = Infinity;
  for (let axis = 0; axis < 3; axis++) {
    const a = (centre[axis] - half - origin[axis]) / direction[axis];
    const b = (centre[axis] + half - origin[axis]) / direction[axis];
    if (direction[axis] === 0) {
      if (Math.abs(centre[axis] - origin[axis]) > half) return null;
      continue;
    }
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  return from <= to ? [from, to] : null;
}

/** A ring of the newest readings: 6.8 MB. */
export class Readings {
  constructor() {
    this.values = new Float64Array(CAPACITY * FIELDS);
    this.count = 0; // since the start
  }

  /** @param {Reading} reading */
  add(reading) {
    const { time_s, node, sensor, zone, hasTarget, range_m, sigma_m, origin, direction } = reading;
    this.values.set(
      [time_s, node, sensor, zone, hasTarget ? 1 : 0, range_m, sigma_m, ...origin, ...direction],
      (this.count % CAPACITY) * FIELDS,
    );
    this.count += 1;
  }

  #at(index) {
    const from = (index % CAPACITY) * FIELDS;
    const [time_s, node, sensor, zone, target, range_m, sigma_m, ...vectors] = this.values.subarray(
      from,
      from + FIELDS,
    );
    return {
      time_s,
      node,
      sensor,
      zone,
      hasTarget: target === 1,
      range_m,
      sigma_m,
      origin: vectors.slice(0, 3),
      direction: vectors.slice(3),
    };
  }

  /** From `until_s` back to a minute before, newest first. @returns {Generator<Reading>} */
  *backFrom(until_s) {
    for (let index = this.count - 1; index >= Math.max(0, this.count - CAPACITY); index--) {
      const reading = this.#at(index);
      if (reading.time_s < until_s - MINUTE_S) return;
      if (reading.time_s <= until_s) yield reading;
    }
  }

  /**
   * The newest reading whose beam's axis meets a voxel. At most CAPACITY comparisons, about 20 ms.
   * @returns {{reading: Reading, endsHere: boolean} | null} null: none in the minute before `until_s`
   */
  lastThrough(key, resolution_m, until_s) {
    const centre = centreOf(key, resolution_m);
    for (const reading of this.backFrom(until_s)) {
      const part = within(reading.origin, reading.direction, centre, resolution_m / 2);
      if (!part || part[0] > reading.range_m) continue;
      return { reading, endsHere: reading.hasTarget && reading.range_m <= part[1] };
    }
    return null;
  }
}
