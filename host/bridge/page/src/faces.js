// The visible faces of a brick: those between an occupied voxel and one that is not.
import { brickAt, brickNumber } from './lattice.js';
import { STATE } from './bricks.js';

/** Bytes of a face: x, y, z in the group, direction, stamp (2 bytes), shade of the corners, 0. */
export const FACE_BYTES = 8;
/** A group of 4 x 4 x 4 bricks is one mesh. */
export const GROUP_BRICKS = 4;

// A brick with one voxel of each neighbour about it: 10 x 10 x 10.
const EDGE = 10;
const AXIS_STEP = [1, EDGE, EDGE * EDGE];
const around = new Uint8Array(EDGE ** 3);
const indexIn = (x, y, z) => x + EDGE * y + EDGE * EDGE * z;

/** Directions 0 to 5: -x, +x, -y, +y, -z, +z. The corners of a face run along the next two axes. */
const DIRECTIONS = Array.from({ length: 6 }, (_, direction) => {
  const axis = direction >> 1;
  return {
    step: (direction & 1 ? 1 : -1) * AXIS_STEP[axis],
    u: AXIS_STEP[(axis + 1) % 3],
    v: AXIS_STEP[(axis + 2) % 3],
  };
});

// First and last voxel, along one axis, that a neighbour at -1, 0 or 1 gives.
const SPAN = { '-1': [7, 7, -7], 0: [0, 7, 1], 1: [0, 0, 9] };

function copyNeighbour(states, dx, dy, dz) {
  const [x0, x1, shiftX] = SPAN[dx];
  const [y0, y1, shiftY] = SPAN[dy];
  const [z0, z1, shiftZ] = SPAN[dz];
  for (let z = z0; z <= z1; z++)
    for (let y = y0; y <= y1; y++)
      for (let x = x0; x <= x1; x++)
        around[indexIn(x + shiftX, y + shiftY, z + shiftZ)] = states ? states[x + 8 * y + 64 * z] : STATE.unknown;
}

function gather(bricks, [bx, by, bz]) {
  for (let dz = -1; dz <= 1; dz++)
    for (let dy = -1; dy <= 1; dy++)
      for (let dx = -1; dx <= 1; dx++)
        copyNeighbour(bricks.get(brickNumber(bx + dx, by + dy, bz + dz))?.states, dx, dy, dz);
}

const isSolid = (index) => (around[index] === STATE.occupied ? 1 : 0);

/** How many of the three voxels at a corner, before the face, are occupied: 0 to 3; two sides hide the corner. */
function cornerShade(sideA, sideB, diagonal) {
  return sideA && sideB ? 3 : sideA + sideB + isSolid(diagonal);
}

/** Two bits for each of the corners (0,0), (1,0), (0,1), (1,1) along u and v. */
function shadeOf(before, u, v) {
  const left = isSolid(before - u);
  const right = isSolid(before + u);
  const below = isSolid(before - v);
  const above = isSolid(before + v);
  return (
    cornerShade(left, below, before - u - v) |
    (cornerShade(right, below, before + u - v) << 2) |
    (cornerShade(left, above, before - u + v) << 4) |
    (cornerShade(right, above, before + u + v) << 6)
  );
}

/** Grows as needed; `take` gives a copy of what was put. */
class FaceList {
  constructor() {
    this.bytes = new Uint8Array(1 << 16);
    this.size = 0;
  }

  put(x, y, z, direction, stamp, shade) {
    if (this.size + FACE_BYTES > this.bytes.length) {
      const larger = new Uint8Array(2 * this.bytes.length);
      larger.set(this.bytes);
      this.bytes = larger;
    }
    const bytes = this.bytes;
    let at = this.size;
    bytes[at++] = x;
    bytes[at++] = y;
    bytes[at++] = z;
    bytes[at++] = direction;
    bytes[at++] = stamp & 255;
    bytes[at++] = stamp >> 8;
    bytes[at] = shade;
    this.size += FACE_BYTES;
  }

  take() {
    const taken = this.bytes.slice(0, this.size);
    this.size = 0;
    return taken;
  }
}

const list = new FaceList();

function facesBetween(cells, offset, inner, isOuter, isShaded) {
  for (let voxel = 0; voxel < 512; voxel++) {
    if (cells.states[voxel] !== inner) continue;
    const x = voxel & 7;
    const y = (voxel >> 3) & 7;
    const z = voxel >> 6;
    const here = indexIn(x + 1, y + 1, z + 1);
    for (let direction = 0; direction < 6; direction++) {
      const { step, u, v } = DIRECTIONS[direction];
      if (!isOuter(around[here + step])) continue;
      list.put(
        offset[0] + x,
        offset[1] + y,
        offset[2] + z,
        direction,
        cells.stamps[voxel],
        isShaded ? shadeOf(here + step, u, v) : 0,
      );
    }
  }
  return list.take();
}

function freeVoxels(cells, offset) {
  for (let voxel = 0; voxel < 512; voxel++)
    if (cells.states[voxel] === STATE.free)
      list.put(
        offset[0] + (voxel & 7),
        offset[1] + ((voxel >> 3) & 7),
        offset[2] + (voxel >> 6),
        0,
        cells.stamps[voxel],
        0,
      );
  return list.take();
}

const NONE = new Uint8Array(0);

/**
 * What to draw of one brick. About 20 us for a brick of a surface.
 * @param {{get: function(number): (import('./bricks.js').Cells | undefined)}} bricks the brick and its 26 neighbours
 * @param {number} number
 * @param {{unknown: boolean, free: boolean}} wanted layers beside the occupied one
 * @returns {{occupied: Uint8Array, unknown: Uint8Array, free: Uint8Array}} FACE_BYTES each. `unknown`: faces between
 *   a free voxel, whose position they have, and an unknown one. `free`: voxels
 */
export function facesOf(bricks, number, wanted) {
  const cells = bricks.get(number);
  if (!cells) return { occupied: NONE, unknown: NONE, free: NONE };
  const at = brickAt(number);
  const offset = at.map((along) => 8 * (along % GROUP_BRICKS));
  if (cells.occupied > 0 || wanted.unknown) gather(bricks, at);
  return {
    occupied:
      cells.occupied === 0
        ? NONE
        : facesBetween(cells, offset, STATE.occupied, (state) => state !== STATE.occupied, true),
    unknown: !wanted.unknown
      ? NONE
      : facesBetween(cells, offset, STATE.free, (state) => state === STATE.unknown, false),
    free: !wanted.free ? NONE : freeVoxels(cells, offset),
  };
}
