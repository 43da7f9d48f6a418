// The map that is shown: takes updates, keeps the last minute, and says what to draw anew. Runs in a worker, or in a
// page that shows one map alone.
import { Bricks, isUnknown } from './bricks.js';
import { facesOf, GROUP_BRICKS } from './faces.js';
import { History } from './history.js';
import { brickAt, brickNumber } from './lattice.js';
import { logOddsAt, stampsOf } from './layers.js';
import { readMapPayload } from './map_payload.js';
import { pickAlong, stateAt } from './ray_walk.js';

const BEGINS = 1;
const COMPLETE = 2;
const BRICKS_OF_GROUP = GROUP_BRICKS ** 3;
const LAYERS = ['occupied', 'unknown', 'free'];

function joined(parts) {
  const whole = new Uint8Array(parts.reduce((size, part) => size + part.length, 0));
  parts.reduce((at, part) => (whole.set(part, at), at + part.length), 0);
  return whole;
}

export class MapStore {
  constructor() {
    this.changed = new Map(); // since the last complete map: number -> Cells or null
    this.dirty = new Set(); // bricks whose faces are to be made anew
    this.reshaped = new Set(); // those of them in which the state of a voxel changed
    this.live = new Bricks((number, statesChanged) => {
      this.changed.set(number, this.live.get(number) ?? null);
      if (this.shown === this.live) this.#touch(number, statesChanged);
    });
    this.past = new Bricks((number, statesChanged) => {
      if (this.shown === this.past) this.#touch(number, statesChanged);
    });
    this.pastVersions = new Map();
    this.shown = this.live;
    this.history = new History();
    this.groups = new Map(); // group -> Map(brick -> faces)
    this.wanted = { unknown: false, free: false };
    this.seen = null; // bricks since a map began
    this.head = null;
    this.time_s = null;
    this.shown_s = null; // null: live
  }

  /**
   * Takes a frame. Throws a RangeError for a malformed one, of which nothing is then taken.
   * @param {number} flags 1 begins, 2 complete @param {number} time_s of the bus
   * @returns {boolean} the map is complete: `takeUpdate` has something new
   */
  add(flags, time_s, buffer, offset) {
    const head = readMapPayload(buffer, offset);
    if (this.head && this.head.resolution_m !== head.resolution_m) this.#forgetAll();
    if (flags & BEGINS) this.seen = new Set();
    this.head = head;
    for (const { number, cells } of head.bricks) {
      this.seen?.add(number);
      this.live.set(number, isUnknown(cells) ? null : cells);
    }
    head.bricks = [];
    if (!(flags & COMPLETE)) return false;
    this.#complete(time_s);
    return true;
  }

  #complete(time_s) {
    if (this.seen)
      for (const number of [...this.live.cells.keys()]) if (!this.seen.has(number)) this.live.set(number, null);
    this.seen = null;
    this.time_s = time_s;
    if (time_s === 0) return; // not known yet: the changes count for the first known time
    const isBack = this.history.end_s !== null && time_s < this.history.end_s; // the bus time began anew
    if (isBack) this.history.clear();
    this.history.add(time_s, this.head.clock_s, this.head.staleStamp, isBack ? this.live.cells : this.changed);
    this.changed.clear();
  }

  #forgetAll() {
    this.show(null);
    this.live.clear();
    this.changed.clear();
    this.history.clear();
  }

  #touch(number, statesChanged) {
    this.dirty.add(number);
    if (statesChanged) this.reshaped.add(number);
  }

  /** Corners are shaded by their neighbours: those of a brick in which a state changed have other faces, too. */
  #touchNeighbours() {
    if (this.reshaped.size > this.shown.cells.size / 4)
      for (const number of this.shown.cells.keys()) this.dirty.add(number); // sooner done than looking for them
    else for (const number of this.reshaped) this.#touchAround(number);
    this.reshaped.clear();
  }

  #touchAround(number) {
    const [x, y, z] = brickAt(number);
    for (let dz = -1; dz <= 1; dz++)
      for (let dy = -1; dy <= 1; dy++)
        for (let dx = -1; dx <= 1; dx++) {
          const beside = brickNumber(x + dx, y + dy, z + dz);
          if (this.shown.get(beside)) this.dirty.add(beside);
        }
  }

  /** Shows the map of a time of the last minute, bus seconds; null: the newest. */
  show(time_s) {
    const before = this.shown;
    this.shown_s = time_s;
    this.shown = time_s === null ? this.live : this.past;
    if (time_s !== null) this.history.restore(time_s, this.past, this.pastVersions);
    if (this.shown !== before) this.#touchDifferences(before);
    if (time_s === null) {
      this.past.clear();
      this.pastVersions.clear();
    }
  }

  #touchDifferences(before) {
    const all = new Set([...before.cells.keys(), ...this.shown.cells.keys()]);
    const comparing = new Bricks((number, statesChanged) => this.#touch(number, statesChanged));
    for (const number of all) {
      comparing.cells.set(number, before.get(number));
      if (!before.get(number)) comparing.cells.delete(number);
      comparing.set(number, this.shown.get(number) ?? null);
    }
  }

  /** Layers beside the occupied voxels. @param {{unknown: boolean, free: boolean}} wanted */
  setWanted(wanted) {
    this.wanted = wanted;
    for (const number of this.shown.cells.keys()) this.dirty.add(number);
  }

  /** What is to be drawn anew since the last time: groups of bricks, with their faces by layer. */
  takeUpdate() {
    const groups = this.#makeDirty();
    const mark = this.shown_s === null ? this.head : this.history.markAt(this.shown_s);
    return {
      groups,
      resolution_m: this.head?.resolution_m ?? null,
      clock_s: mark?.clock_s ?? 0,
      staleStamp: mark?.staleStamp ?? 0,
      time_s: this.time_s,
      shown_s: this.shown_s,
      occupied: this.shown.occupied,
      bricks: this.shown.cells.size,
      history: { begin_s: this.history.begin_s, end_s: this.history.end_s, bytes: this.history.bytes },
    };
  }

  #makeDirty() {
    const touched = new Set();
    this.#touchNeighbours();
    for (const number of this.dirty) {
      const group = Math.floor(number / BRICKS_OF_GROUP);
      touched.add(group);
      if (!this.groups.has(group)) this.groups.set(group, new Map());
      if (this.shown.get(number)) this.groups.get(group).set(number, facesOf(this.shown, number, this.wanted));
      else this.groups.get(group).delete(number);
    }
    this.dirty.clear();
    return [...touched].map((group) => this.#groupUpdate(group));
  }

  #groupUpdate(group) {
    const bricks = this.groups.get(group);
    if (bricks.size === 0) this.groups.delete(group);
    const update = { group, lowestKey: brickAt(group * BRICKS_OF_GROUP).map((along) => 8 * along) };
    for (const layer of LAYERS) update[layer] = joined([...bricks.values()].map((faces) => faces[layer]));
    return update;
  }

  /**
   * The voxel that a ray meets first, in the map that is shown.
   * @param {{origin: number[], direction: number[], far_m: number}} ray metres, map frame; direction of unit length
   */
  pick(ray) {
    if (!this.head) return null;
    const key = pickAlong(this.shown, ray, this.head.resolution_m, this.wanted.unknown);
    return key && this.voxel(key);
  }

  /** @param {number[]} key @returns {{key: number[], state: number, stamp: number, logOdds: number | null}} */
  voxel(key) {
    const [x, y, z] = key;
    const cells = this.shown.get(brickNumber(x >> 3, y >> 3, z >> 3));
    const index = (x & 7) + 8 * (y & 7) + 64 * (z & 7);
    const logOdds = cells?.logOdds ? logOddsAt(cells.logOdds, index) : null;
    return {
      key,
      state: stateAt(this.shown, key),
      stamp: cells ? stampsOf(cells.stamps)[index] : 0,
      logOdds: Number.isNaN(logOdds) ? null : logOdds,
    };
  }

  /** Bytes of all bricks and faces, without the history. O(bricks). */
  get bytes() {
    let bytes = this.live.bytes + this.past.bytes;
    for (const bricks of this.groups.values())
      for (const faces of bricks.values()) for (const layer of LAYERS) bytes += faces[layer].length;
    return bytes;
  }
}
