// Modules of the page without a browser: node --test modules.test.mjs
import assert from 'node:assert/strict';
import { test } from 'node:test';
import v8 from 'node:v8';
import vm from 'node:vm';

const source = '../../../host/bridge/page/src/';
const { Bricks, bytesOf, STATE, stateOf } = await import(`${source}bricks.js`);
const { facesOf, FACE_BYTES } = await import(`${source}faces.js`);
const { History } = await import(`${source}history.js`);
const { readImage } = await import(`${source}images.js`);
const { brickAt, brickNumber, centreOf, keyAt } = await import(`${source}lattice.js`);
const { logOddsAt, stampsOf } = await import(`${source}layers.js`);
const { readMapPayload } = await import(`${source}map_payload.js`);
const { MapStore } = await import(`${source}map_store.js`);
const { Readings, readBatch } = await import(`${source}readings.js`);
const { sensorState } = await import(`${source}sensor_state.js`);

const BEGINS = 1;
const COMPLETE = 2;
const BRICK = brickNumber(4096, 4096, 4096); // its lowest voxel is at the map's origin

/** Writes a payload as docs/reference/watch.md has it. */
class Payload {
  constructor({ resolution_m = 0.04, occupiedFrom = 0, clock_s = 100, staleStamp = 160 } = {}) {
    this.bytes = [];
    this.number('setFloat64', 8, resolution_m);
    this.number('setFloat32', 4, occupiedFrom);
    this.bytes.push(1);
    this.number('setUint32', 4, clock_s);
    this.number('setUint16', 2, staleStamp);
  }

  number(set, size, value) {
    const view = new DataView(new ArrayBuffer(size));
    view[set](0, value, true);
    this.bytes.push(...new Uint8Array(view.buffer));
  }

  count(value) {
    for (; value >= 128; value = Math.floor(value / 128)) this.bytes.push((value % 128) + 128);
    this.bytes.push(value);
  }

  alike(number, logOdds, stamp) {
    this.count(number);
    this.bytes.push(1);
    this.number('setFloat32', 4, logOdds);
    this.bytes.push(1);
    this.number('setUint16', 2, stamp);
    return this;
  }

  /** Values of each voxel by its Morton code, in runs of at most 128 different ones. */
  each(number, logOdds, stamp) {
    const stampAt = typeof stamp === 'function' ? stamp : () => stamp;
    this.count(number);
    this.runs('setFloat32', 4, logOdds);
    this.runs('setUint16', 2, stampAt);
    return this;
  }

  runs(set, size, valueAt) {
    this.bytes.push(2);
    for (let from = 0; from < 512; from += 128) {
      this.bytes.push(127);
      for (let code = from; code < from + 128; code++) this.number(set, size, valueAt(code));
    }
  }

  unknown(number) {
    this.count(number);
    this.bytes.push(0, 0);
    return this;
  }

  get buffer() {
    return new Uint8Array(this.bytes).buffer;
  }
}

/** The stamp of a voxel, another one for each. */
const stampOf = (x, y, z) => 401 + x + 8 * y + 64 * z;

/** A brick of log-odds of voxels x fastest. */
function cellsOf(logOdds) {
  const payload = new Payload().each(
    BRICK,
    (code) => {
      const [x, y, z] = voxelOf(code);
      return logOdds[x + 8 * y + 64 * z];
    },
    (code) => stampOf(...voxelOf(code)),
  );
  return readMapPayload(payload.buffer, 0).bricks[0].cells;
}

/** The voxel of a Morton code, bit by bit. */
function voxelOf(code) {
  const at = [0, 0, 0];
  for (let bit = 0; bit < 9; bit++) at[bit % 3] |= ((code >> bit) & 1) << Math.floor(bit / 3);
  return at;
}

/** Pseudo-random numbers below 1, the same each time. */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 1103515245 + 12345) % 2147483648) / 2147483648;
}

test('numbers of bricks are Morton codes of 39 bits', () => {
  assert.equal(brickNumber(1, 0, 0), 1);
  assert.equal(brickNumber(0, 1, 0), 2);
  assert.equal(brickNumber(0, 0, 1), 4);
  assert.equal(brickNumber(256, 0, 0), 2 ** 24);
  assert.equal(brickNumber(8191, 8191, 8191), 2 ** 39 - 1);
  assert.equal(brickNumber(-1, 0, 0), -1);
  assert.equal(brickNumber(0, 8192, 0), -1);
  const next = numbers(1);
  for (let count = 0; count < 1000; count++) {
    const at = [0, 0, 0].map(() => Math.floor(next() * 8192));
    assert.deepEqual(brickAt(brickNumber(...at)), at);
  }
});

test('keys are those of OctoMap', () => {
  assert.deepEqual(keyAt([0, -0.001, 0.079], 0.04), [32768, 32767, 32769]);
  assert.deepEqual(
    centreOf([32768, 32767, 32769], 0.04).map((along) => along.toFixed(3)),
    ['0.020', '-0.020', '0.060'],
  );
});

test('a payload is read voxel by voxel in Morton order', () => {
  const payload = new Payload().each(
    BRICK,
    (code) => (code % 3 === 0 ? NaN : code - 256),
    (code) => stampOf(...voxelOf(code)),
  );
  const { bricks, clock_s, staleStamp, resolution_m } = readMapPayload(payload.buffer, 0);
  assert.deepEqual(
    [clock_s, staleStamp, resolution_m, bricks.length, bricks[0].number],
    [100, 160, 0.04, 1, BRICK],
  );
  for (let code = 0; code < 512; code++) {
    const [x, y, z] = voxelOf(code);
    const { cells } = bricks[0];
    const voxel = x + 8 * y + 64 * z;
    const value = logOddsAt(cells.logOdds, voxel);
    const state = code % 3 === 0 ? STATE.unknown : code < 256 ? STATE.free : STATE.occupied;
    assert.ok(code % 3 === 0 ? Number.isNaN(value) : value === code - 256, `voxel ${code}`);
    assert.equal(stateOf(cells, voxel), state, `voxel ${code}`);
    assert.equal(stampsOf(cells.stamps)[voxel], stampOf(x, y, z));
  }
});

test('a payload that is cut anywhere is refused, or a shorter one', () => {
  const whole = new Payload().alike(BRICK, 1, 401).each(BRICK + 1, (code) => code, 5).buffer;
  let refused = 0;
  for (let size = 0; size < whole.byteLength; size++) {
    try {
      assert.ok(readMapPayload(whole.slice(0, size), 0).bricks.length < 2);
    } catch (error) {
      assert.ok(error instanceof RangeError);
      refused++;
    }
  }
  assert.equal(refused, whole.byteLength - 2); // all but the head alone, and the head with one brick
});

test('forms, runs and numbers that do not exist are refused', () => {
  const refusals = {
    'a fourth form': (payload) => payload.bytes.push(1, 3),
    'a run beyond the brick': (payload) => payload.bytes.push(1, 2, ...Array(5).fill([255, 0, 0, 0, 0]).flat()),
    'a count without an end': (payload) => payload.bytes.push(...Array(12).fill(255)),
  };
  for (const [name, spoil] of Object.entries(refusals)) {
    const payload = new Payload();
    spoil(payload);
    assert.throws(() => readMapPayload(payload.buffer, 0), RangeError, name);
  }
  for (const resolution_m of [0, -1, NaN, Infinity])
    assert.throws(() => readMapPayload(new Payload({ resolution_m }).buffer, 0), RangeError);
});

const DIRECTIONS = [0, 1, 2, 3, 4, 5];

function besideOf(at, direction) {
  const beside = [...at];
  beside[direction >> 1] += direction & 1 ? 1 : -1;
  return beside;
}

/** Shade of a face, voxel by voxel: of each corner, how many of the three voxels before the face are occupied. */
function shadeOf(at, direction, isOccupied) {
  const front = besideOf(at, direction);
  const [u, v] = [1, 2].map((next) => ((direction >> 1) + next) % 3);
  const corners = [
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
  ];
  return corners.reduce((shade, [du, dv], corner) => {
    const moved = (alongU, alongV) =>
      isOccupied(front.map((x, axis) => x + (axis === u ? alongU : axis === v ? alongV : 0))) ? 1 : 0;
    const [sideU, sideV] = [moved(du, 0), moved(0, dv)];
    return shade | ((sideU && sideV ? 3 : sideU + sideV + moved(du, dv)) << (2 * corner));
  }, 0);
}

test('each visible face is made once, with its shade, also between bricks', () => {
  const next = numbers(7);
  const bricks = new Bricks(() => {});
  const states = new Map(); // key -> state; no key: unknown
  for (let brick = 0; brick < 27; brick++) {
    if (brick % 5 === 1) continue;
    const [x, y, z] = [brick % 3, Math.floor(brick / 3) % 3, Math.floor(brick / 9)];
    const share = next();
    const logOdds = Float32Array.from({ length: 512 }, (_, voxel) => {
      const key = [8 * x + (voxel & 7), 8 * y + ((voxel >> 3) & 7), 8 * z + (voxel >> 6)].join();
      if (next() < 0.2) return NaN;
      states.set(key, next() < share ? STATE.occupied : STATE.free);
      return states.get(key) === STATE.occupied ? 1 : -1;
    });
    bricks.set(brickNumber(x, y, z), cellsOf(logOdds));
  }
  const stateOfKey = (at) => states.get(at.join()) ?? STATE.unknown;
  const isOccupied = (at) => stateOfKey(at) === STATE.occupied;
  const made = { occupied: [], unknown: [], free: [] };
  for (const number of bricks.cells.keys())
    for (const [layer, faces] of Object.entries(facesOf(bricks, number, { unknown: true, free: true })))
      for (let at = 0; at < faces.length; at += FACE_BYTES)
        made[layer].push(faces.slice(at, at + FACE_BYTES).join());
  const expected = { occupied: [], unknown: [], free: [] };
  for (const [key, state] of states) {
    const at = key.split(',').map(Number);
    const stamp = stampOf(...at.map((along) => along % 8));
    const face = (direction, shade) => [...at, direction, stamp & 255, stamp >> 8, shade, 0].join();
    if (state === STATE.free) expected.free.push(face(0, 0));
    for (const direction of DIRECTIONS) {
      const beside = besideOf(at, direction);
      if (state === STATE.occupied && !isOccupied(beside))
        expected.occupied.push(face(direction, shadeOf(at, direction, isOccupied)));
      if (state === STATE.free && stateOfKey(beside) === STATE.unknown) expected.unknown.push(face(direction, 0));
    }
  }
  for (const layer of Object.keys(expected)) assert.deepEqual(made[layer].sort(), expected[layer].sort(), layer);
});

test('a corner is darker the more of the voxels beside it are occupied', () => {
  const bricks = new Bricks(() => {});
  const logOdds = new Float32Array(512).fill(-1);
  const place = (x, y, z) => (logOdds[x + 8 * y + 64 * z] = 1);
  place(3, 3, 3);
  place(4, 3, 4); // beside the upper face, on the side of x
  bricks.set(0, cellsOf(logOdds));
  const { occupied } = facesOf(bricks, 0, { unknown: false, free: false });
  const face = [...Array(occupied.length / FACE_BYTES).keys()]
    .map((each) => occupied.slice(each * FACE_BYTES, (each + 1) * FACE_BYTES))
    .find(([x, y, z, direction]) => x === 3 && y === 3 && z === 3 && direction === 5);
  const shades = [0, 2, 4, 6].map((shift) => (face[6] >> shift) & 3);
  assert.deepEqual(shades, [0, 1, 0, 1]);
});

/** Frames of a store; the time is the bus time. */
function add(store, time_s, payload, flags = COMPLETE) {
  return store.add(flags, time_s, payload.buffer, 0);
}

const keysOf = (store) => store.takeUpdate().occupied;

test('the map of each time of the last minute comes back', () => {
  const store = new MapStore();
  const next = numbers(3);
  const expected = [];
  add(store, 10, new Payload().alike(BRICK, -1, 401), BEGINS | COMPLETE);
  for (let step = 0; step < 40; step++) {
    const number = BRICK + Math.floor(next() * 8);
    const payload = new Payload();
    if (next() < 0.2) payload.unknown(number);
    else payload.each(number, () => (next() < 0.3 ? 1 : -1), 401 + step);
    add(store, 11 + step, payload);
    expected.push({ time_s: 11 + step, occupied: keysOf(store) });
  }
  for (const { time_s, occupied } of [...expected].sort(() => next() - 0.5)) {
    store.show(time_s);
    assert.equal(keysOf(store), occupied, `at ${time_s} s`);
  }
  store.show(null);
  assert.equal(keysOf(store), expected.at(-1).occupied);
});

test('a new beginning leaves out what is gone, and the slider still has it', () => {
  const store = new MapStore();
  add(store, 10, new Payload().alike(BRICK, 1, 401).alike(BRICK + 1, 1, 401), BEGINS | COMPLETE);
  add(store, 20, new Payload().alike(BRICK, 1, 401), BEGINS);
  assert.equal(keysOf(store), 1024); // until the map is complete
  add(store, 20, new Payload());
  assert.equal(keysOf(store), 512);
  store.show(15);
  assert.equal(keysOf(store), 1024);
});

test('a bus time that goes back begins the history anew, with the whole map', () => {
  const store = new MapStore();
  add(store, 100, new Payload().alike(BRICK, 1, 401), BEGINS | COMPLETE);
  add(store, 50, new Payload().alike(BRICK + 1, 1, 401));
  assert.deepEqual(store.takeUpdate().history.begin_s, 50);
  store.show(50);
  assert.equal(keysOf(store), 1024);
});

test('another resolution is another map', () => {
  const store = new MapStore();
  add(store, 10, new Payload().alike(BRICK, 1, 401), BEGINS | COMPLETE);
  add(store, 11, new Payload({ resolution_m: 0.02 }).alike(BRICK + 9, 1, 401), BEGINS | COMPLETE);
  assert.equal(keysOf(store), 512);
  assert.equal(store.history.begin_s, 11);
});

test('the history keeps a minute, and never more than its bytes', () => {
  const next = numbers(5);
  for (const bytesMax of [Infinity, 20000]) {
    const history = new History(bytesMax);
    for (let time_s = 0; time_s < 200; time_s++) {
      const logOdds = Float32Array.from({ length: 512 }, () => next() - 0.5);
      history.add(time_s, time_s, 0, new Map([[time_s % 4, cellsOf(logOdds)]]));
      assert.ok(history.bytes <= bytesMax);
    }
    assert.equal(history.end_s, 199);
    if (bytesMax === Infinity) assert.equal(history.begin_s, 139);
    else assert.ok(history.begin_s > 139);
    const held = [...history.versions.values()].flat();
    assert.ok(held.length < 70);
    assert.equal(
      history.bytes,
      held.reduce((sum, { cells }) => sum + 100 + bytesOf(cells), 0),
    );
  }
});

test('a page that is left open for 10,000 maps keeps its memory', async () => {
  v8.setFlagsFromString('--expose-gc');
  const collect = vm.runInNewContext('gc');
  const store = new MapStore();
  const memory = [];
  for (let map = 0; map < 10000; map++) {
    const payload = new Payload({ clock_s: 100 + Math.floor(map / 10) });
    for (let brick = 0; brick < 4; brick++) {
      const number = BRICK + ((map * 7 + brick * 13) % 256); // comes, changes, goes
      if ((map + brick) % 3 === 0) payload.unknown(number);
      else payload.alike(number, brick % 2 === 0 ? 2 : -2, 400 + (map % 64));
    }
    store.add((map === 0 ? BEGINS : 0) | COMPLETE, 1 + map / 10, payload.buffer, 0);
    store.takeUpdate();
    if (map % 500 !== 499) continue;
    for (let turn = 0; turn < 3; turn++) {
      collect();
      await new Promise(setImmediate); // buffers are released beside
    }
    const { heapUsed, arrayBuffers } = process.memoryUsage();
    memory.push(heapUsed + arrayBuffers);
  }
  // What is not collected yet comes and goes; what is kept does not go.
  const [early, late] = [memory.slice(2, 10), memory.slice(12)].map((part) => Math.min(...part));
  assert.ok(late < 1.1 * early, `${memory}`);
});

test('a reading that ends in a voxel differs from one that passes through', () => {
  const readings = new Readings();
  const reading = (time_s, range_m) => ({
    time_s,
    node: 1,
    sensor: 2,
    zone: 0,
    hasTarget: true,
    range_m,
    sigma_m: 0.01,
    origin: [0, 0.01, 0.01],
    direction: [1, 0, 0],
  });
  const key = keyAt([0.5, 0.01, 0.01], 0.04);
  readings.add(reading(10, 0.3));
  assert.equal(readings.lastThrough(key, 0.04, 20), null);
  readings.add(reading(11, 0.5));
  readings.add(reading(12, 0.9));
  assert.deepEqual(
    [readings.lastThrough(key, 0.04, 20).endsHere, readings.lastThrough(key, 0.04, 20).reading.time_s],
    [false, 12],
  );
  assert.deepEqual(
    [readings.lastThrough(key, 0.04, 11).endsHere, readings.lastThrough(key, 0.04, 11).reading.time_s],
    [true, 11],
  );
  assert.equal(readings.lastThrough(key, 0.04, 80), null); // over a minute ago
  assert.equal(readings.lastThrough(keyAt([0.5, 0.1, 0.01], 0.04), 0.04, 20), null);
});

test('a batch of ranges that is cut off is refused', () => {
  const bytes = new Uint8Array(8 + 12 + 4 + 64);
  new DataView(bytes.buffer).setUint32(8, 68, true);
  assert.equal(readBatch(bytes.buffer, 0).length, 1);
  for (let size = 9; size < bytes.length; size++)
    assert.throws(() => readBatch(bytes.buffer.slice(0, size), 0), RangeError);
});

test('an image that is cut off, or smaller than it says, is refused', () => {
  const bytes = new Uint8Array(12 + 2 * 3 * 2);
  const view = new DataView(bytes.buffer);
  view.setUint16(0, 3, true);
  view.setUint16(2, 2, true);
  view.setBigInt64(4, 1500000000n, true);
  view.setUint16(12 + 2 * 4, 2500, true);
  const { width, height, time_s, depths_mm } = readImage(bytes.buffer, 0);
  assert.deepEqual([width, height, time_s, [...depths_mm]], [3, 2, 1.5, [0, 0, 0, 0, 2500, 0]]);
  for (let size = 0; size < bytes.length; size++)
    assert.throws(() => readImage(bytes.buffer.slice(0, size), 0), RangeError);
});

test('a sensor has one state, the worst that applies', () => {
  const node = { verdict: 'usable' };
  const well = { state: 'ranging', fault: 'none', disputed: false, camera: null, age_s: 0.1, rejected: null };
  const cases = {
    used: [{}, { camera: { contradicts: false } }],
    nothing: [{ rejected: 'no_return' }],
    rejected: [{ rejected: 'self_hit' }, { rejected: 'late' }],
    silent: [{ age_s: null }, { age_s: 3.1 }, { state: null }, { age_s: 5, rejected: 'no_return' }],
    faulty: [
      { state: 'failed', age_s: null },
      { disputed: true },
      { camera: { contradicts: true, fault: null }, rejected: 'no_return' },
    ],
  };
  for (const [state, sensors] of Object.entries(cases))
    for (const changed of sensors)
      assert.equal(sensorState(node, { ...well, ...changed }).state, state, JSON.stringify(changed));
});

test('states of voxels: unknown, free, and occupied from the threshold on', () => {
  const logOdds = new Float32Array(512).fill(NaN);
  logOdds.set([-0.1, 0, 0.1]);
  const cells = cellsOf(logOdds);
  const states = [0, 1, 2, 3].map((voxel) => stateOf(cells, voxel));
  assert.deepEqual(states, [STATE.free, STATE.occupied, STATE.occupied, STATE.unknown]);
  assert.equal(cells.count, 2);
});
