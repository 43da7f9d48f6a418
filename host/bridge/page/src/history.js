// The map of the last minute: of each brick the versions in which it differed.
import { BRICK_VOXELS } from './lattice.js';
import { areEqual, withCount } from './bricks.js';

const MINUTE_S = 60;
const BYTES_MAX = 64 * 1024 * 1024;
/** A brick in which only ages changed gets a version this often: an age of the past may be this much too high. */
const AGES_EVERY_S = 5;
/** What the JavaScript engine needs beside the bytes of a version, at most. */
const OVERHEAD = 200;

const scratch = new Uint8Array(BRICK_VOXELS + 3 * BRICK_VOXELS);

/** Runs of states (6 bits of length less 1, 2 bits of state), then runs of stamps (length less 1, 16 bits). */
function encode({ states, stamps }) {
  let size = 0;
  for (let voxel = 0, end; voxel < BRICK_VOXELS; voxel = end) {
    for (end = voxel + 1; end < BRICK_VOXELS && end < voxel + 64 && states[end] === states[voxel];) end++;
    scratch[size++] = ((end - voxel - 1) << 2) | states[voxel];
  }
  for (let voxel = 0, end; voxel < BRICK_VOXELS; voxel = end) {
    for (end = voxel + 1; end < BRICK_VOXELS && end < voxel + 256 && stamps[end] === stamps[voxel];) end++;
    scratch[size++] = end - voxel - 1;
    scratch[size++] = stamps[voxel] & 255;
    scratch[size++] = stamps[voxel] >> 8;
  }
  return scratch.slice(0, size);
}

function decode(bytes) {
  const states = new Uint8Array(BRICK_VOXELS);
  const stamps = new Uint16Array(BRICK_VOXELS);
  let at = 0;
  for (let voxel = 0; voxel < BRICK_VOXELS; at++) {
    const end = voxel + (bytes[at] >> 2) + 1;
    states.fill(bytes[at] & 3, voxel, end);
    voxel = end;
  }
  for (let voxel = 0; voxel < BRICK_VOXELS; at += 3) {
    const end = voxel + bytes[at] + 1;
    stamps.fill(bytes[at + 1] | (bytes[at + 2] << 8), voxel, end);
    voxel = end;
  }
  return withCount(states, stamps);
}

/** Times are seconds of the bus, and do not go back: then it is to be cleared. */
export class History {
  /** @param {number} [bytesMax] beyond which the oldest versions are forgotten */
  constructor(bytesMax = BYTES_MAX) {
    this.bytesMax = bytesMax;
    this.clear();
  }

  clear() {
    this.versions = new Map(); // number -> [{time_s, bytes | null}], oldest first
    this.replaced = []; // [{at_s, number}]: the oldest version of this brick was replaced then
    this.newest = new Map(); // number -> {time_s, states}: what the newest version has
    this.marks = []; // times and clocks of the map
    this.bytes = 0;
    this.begin_s = null;
    this.end_s = null;
  }

  /** The changes that made the map of `time_s`. @param {Map<number, import('./bricks.js').Cells | null>} changed */
  add(time_s, clock_s, staleStamp, changed) {
    this.begin_s ??= time_s;
    this.end_s = time_s;
    this.marks.push({ time_s, clock_s, staleStamp });
    for (const [number, cells] of changed) this.#addBrick(time_s, number, cells);
    this.#forget();
  }

  #addBrick(time_s, number, cells) {
    const newest = this.newest.get(number);
    const states = cells ? cells.states : null;
    if (
      newest &&
      time_s - newest.time_s < AGES_EVERY_S &&
      newest.states &&
      states &&
      areEqual(newest.states, states)
    )
      return;
    const list = this.versions.get(number) ?? [];
    if (list.length > 0) this.replaced.push({ at_s: time_s, number });
    const bytes = cells ? encode(cells) : null;
    list.push({ time_s, bytes });
    this.versions.set(number, list);
    this.newest.set(number, { time_s, states });
    this.bytes += OVERHEAD + (bytes ? bytes.length : 0);
  }

  #forget() {
    let count = 0;
    let begin_s = Math.max(this.begin_s, this.end_s - MINUTE_S);
    while (count < this.replaced.length && (this.replaced[count].at_s <= begin_s || this.bytes > this.bytesMax)) {
      const { at_s, number } = this.replaced[count++];
      begin_s = Math.max(begin_s, at_s);
      const oldest = this.versions.get(number).shift();
      this.bytes -= OVERHEAD + (oldest.bytes ? oldest.bytes.length : 0);
    }
    this.replaced.splice(0, count);
    this.begin_s = begin_s;
    this.marks.splice(
      0,
      this.marks.findIndex(({ time_s }) => time_s >= begin_s),
    );
  }

  /** Clock and stale stamp of the map at a time. */
  markAt(time_s) {
    return this.marks.findLast((mark) => mark.time_s <= time_s) ?? this.marks[0];
  }

  /**
   * Writes the map of a time into `bricks`, which holds that of `from` (a Map of versions, changed too).
   * O(bricks), and 5 us for each that differs.
   */
  restore(time_s, bricks, from) {
    for (const [number, list] of this.versions) {
      const version = list.findLast((each) => each.time_s <= time_s) ?? null;
      if (from.get(number) === version) continue;
      from.set(number, version);
      bricks.set(number, version?.bytes ? decode(version.bytes) : null);
    }
  }
}
