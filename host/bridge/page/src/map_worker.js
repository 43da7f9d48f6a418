// Keeps the map in a thread of its own: decodes, keeps the last minute, makes faces.
import { MapStore } from './map_store.js';

const store = new MapStore();
const figures = { updates: 0, malformed: 0, last_ms: 0, took_ms: [] };
let isDue = false;
let begun_ms = 0; // processor time of the frames of the next update

function sendUpdate() {
  isDue = false;
  const begin = performance.now();
  const update = store.takeUpdate();
  figures.last_ms = begun_ms + performance.now() - begin;
  begun_ms = 0;
  figures.updates += 1;
  figures.took_ms.push(figures.last_ms);
  if (figures.took_ms.length > 600) figures.took_ms.shift();
  const buffers = update.groups.flatMap(({ occupied, unknown, free }) => [
    occupied.buffer,
    unknown.buffer,
    free.buffer,
  ]);
  postMessage({ kind: 'update', update, worker_ms: figures.last_ms }, buffers);
}

/** Frames that wait are taken first: a slow machine skips maps instead of falling behind. */
function sendSoon() {
  if (isDue) return;
  isDue = true;
  setTimeout(sendUpdate, 0);
}

function addFrame({ flags, time_s, buffer, offset }) {
  const begin = performance.now();
  try {
    if (store.add(flags, time_s, buffer, offset)) sendSoon();
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
    figures.malformed += 1;
    postMessage({ kind: 'malformed' });
  }
  begun_ms += performance.now() - begin;
  postMessage({ kind: 'taken', bytes: buffer.byteLength });
}

const ANSWERS = {
  pick: ({ ray }) => store.pick(ray),
  voxel: ({ key }) => (store.head ? store.voxel(key) : null),
  figures: () => ({ ...figures, bytes: store.bytes, historyBytes: store.history.bytes }),
};

onmessage = ({ data }) => {
  if (data.kind === 'frame') addFrame(data);
  else if (data.kind === 'show') {
    store.show(data.time_s);
    sendSoon();
  } else if (data.kind === 'wanted') {
    store.setWanted(data.wanted);
    sendSoon();
  } else if (data.kind in ANSWERS)
    postMessage({ kind: 'answer', call: data.call, answer: ANSWERS[data.kind](data) });
};
