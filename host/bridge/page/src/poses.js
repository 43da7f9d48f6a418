// Rigid transforms of the daemon's `describe` (p: metres, q: x, y, z, w) as matrices, and back.
import * as THREE from 'three';

const ONE = new THREE.Vector3(1, 1, 1);

/** @param {{p: number[], q: number[]}} pose @returns {THREE.Matrix4} */
export function matrixOf({ p, q }) {
  return new THREE.Matrix4().compose(new THREE.Vector3(...p), new THREE.Quaternion(...q), ONE);
}

/** @param {THREE.Matrix4} matrix @returns {{p: number[], q: number[]}} */
export function poseOf(matrix) {
  const position = new THREE.Vector3();
  const rotation = new THREE.Quaternion();
  matrix.decompose(position, rotation, new THREE.Vector3());
  return { p: position.toArray(), q: rotation.toArray() };
}
