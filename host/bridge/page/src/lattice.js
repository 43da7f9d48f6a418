// Positions of voxels and bricks. A key is OctoMap's: 32768 is the voxel whose lower corner is the map's origin.

export const ORIGIN_KEY = 32768;
export const BRICK_EDGE = 8; // voxels
export const BRICK_VOXELS = 512;
export const ROWS = 64; // rows along x of a brick, each of eight voxels

/** Bits 0, 3, 6, ... of a number below 2^24, as bits 0, 1, 2, ... */
function gathered(bits) {
  let value = 0;
  for (let bit = 0; bit < 8; bit++) value |= ((bits >>> (3 * bit)) & 1) << bit;
  return value;
}

/** Bit i of a byte at bit 3 i. */
const SPREAD = Uint32Array.from({ length: 256 }, (_, byte) => {
  let bits = 0;
  for (let bit = 0; bit < 8; bit++) bits |= ((byte >>> bit) & 1) << (3 * bit);
  return bits;
});

/** Linear index (x + 8 y + 64 z) of each voxel of a brick in Morton order. */
export const LINEAR_OF_MORTON = Uint16Array.from(
  { length: BRICK_VOXELS },
  (_, code) => gathered(code) + 8 * gathered(code >> 1) + 64 * gathered(code >> 2),
);

/**
 * Coordinates of a brick, in bricks. A brick's number has 39 bits, more than JavaScript's integers operators take.
 * @param {number} number in Morton order @returns {number[]} x, y, z, each below 8192
 */
export function brickAt(number) {
  const low = number % 2 ** 24;
  const high = Math.floor(number / 2 ** 24);
  return [0, 1, 2].map((axis) => gathered(low >>> axis) + 256 * gathered(high >>> axis));
}

/** The inverse. @returns {number} -1 outside the octree */
export function brickNumber(x, y, z) {
  if (x < 0 || y < 0 || z < 0 || x > 8191 || y > 8191 || z > 8191) return -1;
  const low = SPREAD[x & 255] + 2 * SPREAD[y & 255] + 4 * SPREAD[z & 255];
  return low + 2 ** 24 * (SPREAD[x >> 8] + 2 * SPREAD[y >> 8] + 4 * SPREAD[z >> 8]);
}

/** The voxel that contains a point. @param {number[]} p_map metres @returns {number[]} key */
export function keyAt(p_map, resolution_m) {
  return p_map.map((along) => Math.floor(along / resolution_m) + ORIGIN_KEY);
}

/** @param {number[]} key @returns {number[]} metres, map frame */
export function centreOf(key, resolution_m) {
  return key.map((along) => (along - ORIGIN_KEY + 0.5) * resolution_m);
}
