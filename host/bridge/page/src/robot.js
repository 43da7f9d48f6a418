// The arm in the scene: its body as capsules, and the visuals of its URDF that are not meshes.
import * as THREE from 'three';
import URDFLoader from 'urdf-loader';

const Z = new THREE.Vector3(0, 0, 1);

/** A capsule between two points of the link's frame, metres. */
function capsule({ a, b, radius_m }, material) {
  const from = new THREE.Vector3(...a);
  const along = new THREE.Vector3(...b).sub(from);
  const length_m = along.length();
  const mesh = new THREE.Mesh(new THREE.CapsuleGeometry(radius_m, length_m, 6, 20).rotateX(Math.PI / 2), material);
  mesh.position.copy(from).addScaledVector(along, 0.5);
  if (length_m > 0) mesh.quaternion.setFromUnitVectors(Z, along.divideScalar(length_m));
  return mesh;
}

/** Visuals by link. The files of meshes are not served: those links have their capsules. */
function visualsOf(urdf) {
  const loader = new URDFLoader();
  loader.loadMeshCb = (_path, _manager, _material, done) => done(new THREE.Group());
  const visuals = new Map();
  for (const [name, link] of Object.entries(parsedLinks(loader, urdf)))
    visuals.set(
      name,
      link.children.filter((child) => child.isURDFVisual && hasSurface(child)),
    );
  return visuals;
}

/** Empty for a text that the loader cannot read: the capsules remain. It throws whatever it meets. */
function parsedLinks(loader, urdf) {
  try {
    return loader.parse(urdf).links;
  } catch {
    return {};
  }
}

function hasSurface(object) {
  let has = false;
  object.traverse((part) => {
    has ||= part.isMesh === true;
  });
  return has;
}

export class Robot {
  /**
   * @param {THREE.Object3D} parent in the map frame @param {import('./kinematics.js').Kinematics} kinematics
   * @param {object} description the answer to `describe`, and `urdf` @param {string} name
   */
  constructor(parent, kinematics, description, name) {
    this.parent = parent;
    this.kinematics = kinematics;
    this.root = new THREE.Group();
    this.root.name = name;
    this.links = new Map();
    this.materials = new Map();
    for (const link of description.links) this.#addLink(link);
    for (const body of description.body)
      this.links.get(body.link)?.add(capsule(body, this.materials.get(body.link)));
    if (description.urdf) this.#addVisuals(description.urdf);
    parent.add(this.root);
  }

  #addLink(name) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.visible = false;
    this.links.set(name, group);
    this.materials.set(name, new THREE.MeshLambertMaterial({ transparent: true }));
    this.root.add(group);
  }

  #addVisuals(urdf) {
    for (const [name, visuals] of visualsOf(urdf)) {
      const group = this.links.get(name);
      if (!group || visuals.length === 0) continue;
      for (const body of group.children) body.visible = false;
      group.add(...visuals);
    }
  }

  /** @param {Map<string, number>} positions rad or m */
  setJoints(positions) {
    for (const [name, pose] of this.kinematics.linkPoses(positions)) {
      const group = this.links.get(name);
      if (!group) continue;
      group.visible = true;
      group.matrix.copy(pose);
      group.matrixWorldNeedsUpdate = true;
    }
  }

  /** @param {string} colour @param {number} opacity @param {string} [link] only this link */
  setColour(colour, opacity, link) {
    for (const [name, material] of this.materials) {
      if (link !== undefined && link !== name) continue;
      material.color.set(colour);
      material.opacity = opacity;
      material.depthWrite = opacity > 0.8;
    }
  }

  /** T_map_link as drawn. @returns {Map<string, THREE.Matrix4>} */
  drawnPoses() {
    this.root.updateMatrixWorld(true);
    const drawn = [...this.links].filter(([, group]) => group.visible);
    return new Map(drawn.map(([name, group]) => [name, group.matrixWorld]));
  }

  remove() {
    this.parent.remove(this.root);
    this.root.traverse((part) => part.geometry?.dispose());
    for (const material of this.materials.values()) material.dispose();
  }
}
