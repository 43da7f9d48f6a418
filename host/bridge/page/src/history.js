// The map of the last minute: of each brick the versions in which it differed.
import { bytesOf, haveEqualStates } from './bricks.js';

const MINUTE_S = 60;
const BYTES_MAX = 64 * 1024 * 1024;
/** A brick in which only ages changed gets a version this often: an age of the past may be this much too high. */
const AGES_EVERY_S = 5;

const bytesOfVersion = ({ cells }) => 100 + (cells ? bytesOf(cells) : 0);

/** Times are seconds of the bus, and do not go back: then it is to be cleared. */
export class History {
  /** @param {number} [bytesMax] beyond which the oldest versions are forgotten */
  constructor(bytesMax = BYTES_MAX) {
    this.bytesMax = bytesMax;
    this.clear();
  }

  clear() {
    this.versions = new Map(); // number -> [{time_s, cells: Cells | null}], oldest first
    this.replaced = []; // [{at_s, number}]: the oldest version of this brick was replaced then
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
    const list = this.versions.get(number) ?? [];
    const newest = list.at(-1);
    const isOfAges = newest?.cells && cells && haveEqualStates(newest.cells, cells);
    if (isOfAges && time_s - newest.time_s < AGES_EVERY_S) return;
    if (newest) this.replaced.push({ at_s: time_s, number });
    const version = { time_s, cells: cells && { ...cells, logOdds: null } };
    list.push(version);
    this.versions.set(number, list);
    this.bytes += bytesOfVersion(version);
  }

  #forget() {
    let count = 0;
    let begin_s = Math.max(this.begin_s, this.end_s - MINUTE_S);
    while (count < this.replaced.length && (this.replaced[count].at_s <= begin_s || this.bytes > this.bytesMax)) {
      const { at_s, number } = this.replaced[count++];
      begin_s = Math.max(begin_s, at_s);
      const oldest = this.versions.get(number).shift();
      this.bytes -= bytesOfVersion(oldest);
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
   * O(bricks).
   */
  restore(time_s, bricks, from) {
    for (const [number, list] of this.versions) {
      const version = list.findLast((each) => each.time_s <= time_s) ?? null;
      if (from.get(number) === version) continue;
      from.set(number, version);
      bricks.set(number, version?.cells ?? null);
    }
  }
}
