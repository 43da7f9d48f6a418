// The map's thread, seen from the page: frames go in, what to draw comes out.

/** The newest figures that are kept. */
const FIGURES_MAX = 600;

/** More frames than this do not wait for the map's thread: the whole map is then asked for again. */
const WAITING_BYTES_MAX = 256 * 1024 * 1024;
const BEGINS = 1;

export function percentile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length === 0 ? null : sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

export class MapClient {
  /**
   * @param {{onUpdate: function(object), onGap: function()}} hears `onGap`: a frame could not be used, and none is
   *   before one that begins a map
   */
  constructor({ onUpdate, onGap }) {
    this.worker = new Worker('worker.js');
    this.worker.onmessage = ({ data }) => this.#take(data);
    this.onUpdate = onUpdate;
    this.onGap = onGap;
    this.waitingBytes = 0;
    this.gaps = 0;
    this.hasGap = false;
    this.calls = new Map();
    this.nextCall = 1;
    this.newest = null;
    this.worker_ms = [];
  }

  #take(data) {
    if (data.kind === 'answer') {
      this.calls.get(data.call)?.(data.answer);
      this.calls.delete(data.call);
    } else if (data.kind === 'malformed') this.#gap();
    else if (data.kind === 'taken') this.waitingBytes -= data.bytes;
    else {
      this.newest = { ...data.update, groups: null };
      this.worker_ms.push(data.worker_ms);
      if (this.worker_ms.length > FIGURES_MAX) this.worker_ms.shift();
      this.onUpdate(data.update);
    }
  }

  #gap() {
    if (this.hasGap) return;
    this.hasGap = true;
    this.gaps += 1;
    this.onGap();
  }

  /** A message of /octoskin/view/map; its buffer is given away. */
  frame({ buffer, offset }) {
    const view = new DataView(buffer);
    if (buffer.byteLength < offset + 9) throw new RangeError('a map frame that is cut off');
    const flags = view.getUint8(offset);
    const time_s = Number(view.getBigInt64(offset + 1, true)) / 1e9;
    if (flags & BEGINS) this.hasGap = false;
    if (this.waitingBytes > WAITING_BYTES_MAX) this.#gap();
    if (this.hasGap) return;
    this.waitingBytes += buffer.byteLength;
    this.worker.postMessage({ kind: 'frame', flags, time_s, buffer, offset: offset + 9 }, [buffer]);
  }

  show(time_s) {
    this.worker.postMessage({ kind: 'show', time_s });
  }

  setWanted(wanted) {
    this.worker.postMessage({ kind: 'wanted', wanted });
  }

  #call(message) {
    const call = this.nextCall++;
    this.worker.postMessage({ ...message, call });
    return new Promise((resolve) => this.calls.set(call, resolve));
  }

  /** @returns {Promise<object | null>} the first voxel along a ray of the map frame (MapStore.pick) */
  pick(ray) {
    return this.#call({ kind: 'pick', ray });
  }

  voxel(key) {
    return this.#call({ kind: 'voxel', key });
  }

  figures() {
    return this.#call({ kind: 'figures' });
  }
}
