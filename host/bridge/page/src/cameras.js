// The depth cameras in the scene: what each can see.
import * as THREE from 'three';
import { matrixOf } from './poses.js';

/** Corners of the image at a depth, metres, optical frame. */
function cornersAt({ width, height, fx, fy, cx, cy }, depth_m) {
  return [
    [0, 0],
    [width, 0],
    [width, height],
    [0, height],
  ].map(([u, v]) => new THREE.Vector3(((u - cx) / fx) * depth_m, ((v - cy) / fy) * depth_m, depth_m));
}

function frustum(camera, depth_m) {
  const corners = cornersAt(camera, depth_m);
  const apex = new THREE.Vector3();
  const points = corners.flatMap((corner, index) => [apex, corner, corner, corners[(index + 1) % 4]]);
  return new THREE.BufferGeometry().setFromPoints(points);
}

const BODY_M = 0.12;

export class Cameras {
  /** @param {THREE.Object3D} parent in the map frame @param {object} description the answer to `describe` */
  constructor(parent, description) {
    this.parent = parent;
    this.root = new THREE.Group();
    this.root.name = 'cameras';
    parent.add(this.root);
    this.near = new THREE.LineBasicMaterial();
    this.far = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.22 });
    this.cameras = description.cameras.map((camera) => this.#add(camera));
  }

  #add(camera) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.visible = false;
    group.add(
      new THREE.LineSegments(frustum(camera, BODY_M), this.near),
      new THREE.LineSegments(frustum(camera, camera.depth_max_m), this.far),
    );
    this.root.add(group);
    return { name: camera.name, link: camera.link, T_link_camera: matrixOf(camera.T_link_camera), group };
  }

  setTheme(theme) {
    this.near.color.set(theme.frustum);
    this.far.color.set(theme.frustum);
  }

  /** @param {Map<string, THREE.Matrix4>} linkPoses T_map_link */
  setPoses(linkPoses) {
    for (const { link, T_link_camera, group } of this.cameras) {
      const T_map_link = linkPoses.get(link);
      group.visible = T_map_link !== undefined;
      if (!T_map_link) continue;
      group.matrix.multiplyMatrices(T_map_link, T_link_camera);
      group.matrixWorldNeedsUpdate = true;
    }
  }

  remove() {
    this.parent.remove(this.root);
    this.near.dispose();
    this.far.dispose();
  }
}
