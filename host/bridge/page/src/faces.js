// The visible faces of a brick: those between an occupied voxel and one that is not.
import { brickAt, brickNumber, BRICK_VOXELS, ROWS } from './lattice.js';
import { stampsOf } from './layers.js';

/** Bytes of a face: x, y, z in the group, direction, stamp (2 bytes), shade of the corners, 0. */
export const FACE_BYTES = 8;
/** A group of 4 x 4 x 4 bricks is one mesh. */
export const GROUP_BRICKS = 4;

// A brick with one voxel of each neighbour about it, as bits: 10 x 10 rows along x, each of 10 bits. The row of the
// brick's own y and z is y + 1 + 10 (z + 1), the bit of its own x is x + 1.
const EDGE = 10;
const OWN_BITS = 0x1fe;
const occupied = new Uint16Array(EDGE * EDGE);
const known = new Uint16Array(EDGE * EDGE);

/** Directions 0 to 5: -x, +x, -y, +y, -z, +z. The corners of a face run along the next two axes, u and v. */
const AXES = [
  { bit: 1, row: 0 },
  { bit: 0, row: 1 },
  { bit: 0, row: EDGE },
];
const DIRECTIONS = Array.from({ length: 6 }, (_, direction) => {
  const axis = direction >> 1;
  const sign = direction & 1 ? 1 : -1;
  const { bit, row } = AXES[axis];
  return { bit: sign * bit, row: sign * row, u: AXES[(axis + 1) % 3], v: AXES[(axis + 2) % 3] };
});

const NO_ROWS = new Uint8Array(ROWS);
const NOTHING = { occupied: NO_ROWS, known: NO_ROWS };
// First and last row, along y or z, that a neighbour at -1, 0 or 1 gives; then the shift to the rows about the brick.
const SPANS = [
  [7, 7, -7],
  [0, 7, 1],
  [0, 0, 9],
];

/** Rows of three bricks along x, beside one another. */
function copyRows(to, low, middle, high, spanY, spanZ) {
  for (let z = spanZ[0]; z <= spanZ[1]; z++)
    for (let y = spanY[0]; y <= spanY[1]; y++) {
      const row = y + 8 * z;
      to[y + spanY[2] + EDGE * (z + spanZ[2])] = (low[row] >> 7) | (middle[row] << 1) | ((high[row] & 1) << 9);
    }
}

function gather(bricks, [bx, by, bz], withKnown) {
  for (let dz = -1; dz <= 1; dz++)
    for (let dy = -1; dy <= 1; dy++) {
      const [low, middle, high] = [-1, 0, 1].map(
        (dx) => bricks.get(brickNumber(bx + dx, by + dy, bz + dz)) ?? NOTHING,
      );
      const spans = [SPANS[dy + 1], SPANS[dz + 1]];
      copyRows(occupied, low.occupied, middle.occupied, high.occupied, ...spans);
      if (withKnown) copyRows(known, low.known, middle.known, high.known, ...spans);
    }
}

const isOccupied = (row, bit) => (occupied[row] >> bit) & 1;

/** How many of the three voxels at a corner, before the face, are occupied: 0 to 3; two sides hide the corner. */
const cornerShade = (sideA, sideB, diagonal) => (sideA & sideB ? 3 : sideA + sideB + diagonal);

/** Two bits for each of the corners (0,0), (1,0), (0,1), (1,1) along u and v. */
function shadeOf(row, bit, u, v) {
  const left = isOccupied(row - u.row, bit - u.bit);
  const right = isOccupied(row + u.row, bit + u.bit);
  const below = isOccupied(row - v.row, bit - v.bit);
  const above = isOccupied(row + v.row, bit + v.bit);
  return (
    cornerShade(left, below, isOccupied(row - u.row - v.row, bit - u.bit - v.bit)) |
    (cornerShade(right, below, isOccupied(row + u.row - v.row, bit + u.bit - v.bit)) << 2) |
    (cornerShade(left, above, isOccupied(row - u.row + v.row, bit - u.bit + v.bit)) << 4) |
    (cornerShade(right, above, isOccupied(row + u.row + v.row, bit + u.bit + v.bit)) << 6)
  );
}

// Faces of one brick, as two little-endian words each; a voxel has at most six.
const words = new Uint32Array(2 * 6 * BRICK_VOXELS);
const bytes = new Uint8Array(words.buffer);
let size = 0; // words

const takeFaces = () => bytes.slice(0, 4 * size);

let stamps; // of the brick's voxels

/** @param {number} inner bits of a row of voxels that have faces @param {Uint16Array} outer rows that hide a face */
function putFacesOfRow(inner, outer, row, corner, isShaded) {
  const [y, z] = [(row % EDGE) - 1, Math.floor(row / EDGE) - 1];
  for (let direction = 0; direction < 6; direction++) {
    const to = DIRECTIONS[direction];
    const beside = to.bit === 0 ? outer[row + to.row] : to.bit > 0 ? outer[row] >> 1 : outer[row] << 1;
    for (let visible = inner & ~beside; visible !== 0; visible &= visible - 1) {
      const bit = 31 - Math.clz32(visible & -visible);
      const stamp = stamps[bit - 1 + 8 * y + 64 * z];
      const shade = isShaded ? shadeOf(row + to.row, bit + to.bit, to.u, to.v) : 0;
      words[size++] = corner + bit - 1 + (y << 8) + (z << 16) + (direction << 24);
      words[size++] = stamp | (shade << 16);
    }
  }
}

/** Of the occupied voxels, towards any other; or of the free ones, towards unknown ones. */
function facesBetween(corner, ofOccupied) {
  size = 0;
  for (let z = 1; z <= 8; z++)
    for (let y = 1; y <= 8; y++) {
      const row = y + EDGE * z;
      const inner = OWN_BITS & (ofOccupied ? occupied[row] : known[row] & ~occupied[row]);
      if (inner !== 0) putFacesOfRow(inner, ofOccupied ? occupied : known, row, corner, ofOccupied);
    }
  return takeFaces();
}

function freeVoxels(cells, corner) {
  size = 0;
  for (let row = 0; row < ROWS; row++)
    for (let free = cells.known[row] & ~cells.occupied[row]; free !== 0; free &= free - 1) {
      const x = 31 - Math.clz32(free & -free);
      words[size++] = corner + x + ((row & 7) << 8) + ((row >> 3) << 16);
      words[size++] = stamps[x + 8 * row];
    }
  return takeFaces();
}

const NONE = new Uint8Array(0);

/**
 * What to draw of one brick. About 5 us for a brick of a surface.
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
  const [x, y, z] = at.map((along) => 8 * (along % GROUP_BRICKS));
  const corner = x | (y << 8) | (z << 16);
  if (cells.count > 0 || wanted.unknown) gather(bricks, at, wanted.unknown);
  if (cells.count > 0 || wanted.unknown || wanted.free) stamps = stampsOf(cells.stamps);
  return {
    occupied: cells.count === 0 ? NONE : facesBetween(corner, true),
    unknown: wanted.unknown ? facesBetween(corner, false) : NONE,
    free: wanted.free ? freeVoxels(cells, corner) : NONE,
  };
}
