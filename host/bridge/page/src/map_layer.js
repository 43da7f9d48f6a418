// The map in the scene: one mesh for each group of bricks and layer.
import * as THREE from 'three';
import { KINDS } from './colours.js';
import { FACE_BYTES, GROUP_BRICKS } from './faces.js';
import { ORIGIN_KEY } from './lattice.js';
import { FACE_FRAGMENT, FACE_VERTEX, HAZE_FRAGMENT, POINT_FRAGMENT, POINT_VERTEX } from './voxel_shaders.js';

const GROUP_VOXELS = 8 * GROUP_BRICKS;
/** An age at which a colour is old, in a map whose voxels never get stale. */
const OLD_S = 60;

const SQUARE = new THREE.BufferAttribute(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]), 3);
const SQUARE_INDEX = new THREE.BufferAttribute(new Uint16Array([0, 1, 2, 2, 1, 3]), 1);

function faceGeometry(bytes) {
  const geometry = new THREE.InstancedBufferGeometry();
  const buffer = new THREE.InstancedInterleavedBuffer(bytes, FACE_BYTES);
  geometry.setIndex(SQUARE_INDEX);
  geometry.setAttribute('position', SQUARE);
  geometry.setAttribute('voxel', new THREE.InterleavedBufferAttribute(buffer, 4, 0));
  geometry.setAttribute('seen', new THREE.InterleavedBufferAttribute(buffer, 4, 4));
  geometry.instanceCount = bytes.length / FACE_BYTES;
  return geometry;
}

function pointGeometry(bytes) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute(
    'voxel',
    new THREE.InterleavedBufferAttribute(new THREE.InterleavedBuffer(bytes, FACE_BYTES), 4, 0),
  );
  geometry.setDrawRange(0, bytes.length / FACE_BYTES);
  return geometry;
}

const shader = (vertexShader, fragmentShader, uniforms, options) =>
  new THREE.RawShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms,
    glslVersion: THREE.GLSL3,
    ...options,
  });

export class MapLayer {
  /** @param {THREE.Object3D} parent in the map frame */
  constructor(parent) {
    this.root = new THREE.Group();
    this.root.name = 'map';
    parent.add(this.root);
    this.meshes = new Map(); // `${layer} ${group}` -> mesh
    this.resolution_m = null;
    this.uniforms = {
      resolution_m: { value: 1 },
      clock_s: { value: 0 },
      staleStamp: { value: 0 },
      ageMax_s: { value: OLD_S },
      fresh: { value: KINDS.map(() => new THREE.Color()) },
      old: { value: KINDS.map(() => new THREE.Color()) },
      background: { value: new THREE.Color() },
      pointScale: { value: 500 },
    };
    this.unknownUniforms = {
      resolution_m: this.uniforms.resolution_m,
      tint: { value: new THREE.Color() },
      opacity: { value: 0.1 },
    };
    this.freeUniforms = {
      resolution_m: this.uniforms.resolution_m,
      pointScale: this.uniforms.pointScale,
      tint: { value: new THREE.Color() },
    };
    const translucent = { transparent: true, depthWrite: false };
    this.materials = {
      occupied: shader(FACE_VERTEX, FACE_FRAGMENT, this.uniforms),
      unknown: shader(FACE_VERTEX, HAZE_FRAGMENT, this.unknownUniforms, { ...translucent, side: THREE.DoubleSide }),
      free: shader(POINT_VERTEX, POINT_FRAGMENT, this.freeUniforms, translucent),
    };
  }

  /** @param {object} theme of colours.js */
  setTheme(theme) {
    KINDS.forEach((kind, index) => {
      this.uniforms.fresh.value[index].set(theme.fresh[kind]).convertLinearToSRGB();
      this.uniforms.old.value[index].set(theme.old[kind]).convertLinearToSRGB();
    });
    this.unknownUniforms.tint.value.set(theme.unknown).convertLinearToSRGB();
    this.unknownUniforms.opacity.value = theme.unknownOpacity;
    this.freeUniforms.tint.value.set(theme.free).convertLinearToSRGB();
  }

  /** Pixels that 1 m has at a distance of 1 m. */
  setPointScale(pixels) {
    this.uniforms.pointScale.value = pixels;
  }

  /** Takes what a MapStore says is to be drawn anew. */
  apply(update) {
    if (update.resolution_m === null) return;
    this.resolution_m = update.resolution_m;
    this.uniforms.resolution_m.value = update.resolution_m;
    this.uniforms.clock_s.value = update.clock_s;
    this.uniforms.staleStamp.value = update.staleStamp;
    const oldest_s = update.staleStamp >> 2;
    this.uniforms.ageMax_s.value = oldest_s > 0 ? Math.max(1, update.clock_s - oldest_s) : OLD_S;
    for (const group of update.groups) for (const layer of Object.keys(this.materials)) this.#replace(layer, group);
  }

  #replace(layer, { group, lowestKey, [layer]: bytes }) {
    const name = `${layer} ${group}`;
    const before = this.meshes.get(name);
    if (before) {
      before.geometry.dispose();
      if (bytes.length === 0) {
        this.root.remove(before);
        this.meshes.delete(name);
      }
    }
    if (bytes.length === 0) return;
    const mesh = before ?? this.#newMesh(layer, name, lowestKey);
    mesh.geometry = layer === 'free' ? pointGeometry(bytes) : faceGeometry(bytes);
    const half = (GROUP_VOXELS / 2) * this.resolution_m;
    mesh.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(half, half, half), half * Math.sqrt(3));
    mesh.userData.bytes = bytes;
    mesh.position.fromArray(lowestKey.map((along) => (along - ORIGIN_KEY) * this.resolution_m));
  }

  #newMesh(layer, name, lowestKey) {
    const Kind = layer === 'free' ? THREE.Points : THREE.Mesh;
    const mesh = new Kind(undefined, this.materials[layer]);
    mesh.name = name;
    mesh.userData = { layer, lowestKey };
    mesh.renderOrder = layer === 'occupied' ? 0 : 5;
    this.meshes.set(name, mesh);
    this.root.add(mesh);
    return mesh;
  }

  /** Another map follows. */
  clear() {
    for (const mesh of this.meshes.values()) {
      mesh.geometry.dispose();
      this.root.remove(mesh);
    }
    this.meshes.clear();
  }

  /** Keys of the voxels that have a face in the scene, each once, as "x,y,z". @param {string} layer */
  drawnKeys(layer = 'occupied') {
    const keys = new Set();
    for (const mesh of this.root.children) {
      if (mesh.userData.layer !== layer) continue;
      const { bytes, lowestKey } = mesh.userData;
      for (let at = 0; at < bytes.length; at += FACE_BYTES)
        keys.add(`${lowestKey[0] + bytes[at]},${lowestKey[1] + bytes[at + 1]},${lowestKey[2] + bytes[at + 2]}`);
    }
    return [...keys];
  }

  /** Faces in the scene, and bytes that they take: here, and once more in the graphics memory. */
  figures() {
    const bytes = this.root.children.reduce((sum, mesh) => sum + mesh.userData.bytes.length, 0);
    return { faces: bytes / FACE_BYTES, bytes: 2 * bytes, meshes: this.root.children.length };
  }

  /** The box about all groups, metres, map frame; empty if nothing is drawn. */
  box() {
    const box = new THREE.Box3();
    for (const mesh of this.root.children) {
      if (mesh.userData.layer !== 'occupied') continue;
      const { bytes } = mesh.userData;
      for (let at = 0; at < bytes.length; at += 16 * FACE_BYTES)
        box.expandByPoint(
          new THREE.Vector3(bytes[at], bytes[at + 1], bytes[at + 2])
            .multiplyScalar(this.resolution_m)
            .add(mesh.position),
        );
    }
    return box;
  }
}
