// The arm in the scene: the visuals of its URDF, or its body as capsules.
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

/**
 * Visuals by link. A link whose meshes are not all there has none: its capsules remain. Throws what the URDF's loader
 * throws.
 * @param {string} urdf @param {function(string): Promise<THREE.Object3D>} fetchMesh
 * @returns {Map<string, Promise<THREE.Object3D[]>>} rejected with the reason
 */
function visualsOf(urdf, fetchMesh) {
  const loader = new URDFLoader();
  const uris = new Map(); // group of the visual -> its mesh
  loader.packages = (name) => `package://${name}`;
  loader.loadMeshCb = (uri, _manager, _material, done) => {
    const group = new THREE.Group();
    uris.set(group, uri);
    done(group);
  };
  const visuals = new Map();
  for (const [name, link] of Object.entries(loader.parse(urdf).links)) {
    const own = link.children.filter((child) => child.isURDFVisual);
    const groups = [];
    for (const visual of own) visual.traverse((part) => uris.has(part) && groups.push(part));
    const meshes = groups.map(async (group) => group.add(await fetchMesh(uris.get(group))));
    if (own.length > 0)
      visuals.set(
        name,
        Promise.all(meshes).then(() => own.filter(hasSurface)),
      );
  }
  return visuals;
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
   * @param {{fetchMesh: function(string): Promise<THREE.Object3D>, onChange: function()}} [hears] `onChange`: visuals
   *   have come
   */
  constructor(parent, kinematics, description, name, hears) {
    this.parent = parent;
    this.kinematics = kinematics;
    this.root = new THREE.Group();
    this.root.name = name;
    this.links = new Map();
    this.materials = new Map();
    for (const link of description.links) this.#addLink(link);
    for (const body of description.body)
      this.links.get(body.link)?.add(capsule(body, this.materials.get(body.link)));
    /** Why links are drawn as capsules, although the URDF has visuals of them: a sentence each. */
    this.missing = new Map();
    if (description.urdf && hears) this.#addVisuals(description.urdf, hears);
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

  #addVisuals(urdf, { fetchMesh, onChange }) {
    let visuals;
    try {
      visuals = visualsOf(urdf, fetchMesh);
    } catch {
      return this.missing.set('all links', 'The URDF cannot be read.');
    }
    for (const [name, parts] of visuals)
      parts
        .then((come) => this.links.has(name) && this.#showVisuals(name, come))
        .catch(({ message }) => this.missing.set(name, message))
        .finally(onChange);
  }

  #showVisuals(name, visuals) {
    if (visuals.length === 0 || this.isRemoved) return;
    const group = this.links.get(name);
    for (const body of group.children) body.visible = false;
    for (const visual of visuals)
      visual.traverse((part) => {
        if (part.isMesh) part.material = this.materials.get(name);
      });
    group.add(...visuals);
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

  /** The visuals by link: their triangles, and the box about them, metres, link frame. */
  drawnVisuals() {
    const drawn = {};
    this.root.updateMatrixWorld(true);
    for (const [name, group] of this.links) {
      const T_link_map = group.matrixWorld.clone().invert();
      const box = new THREE.Box3();
      let triangles = 0;
      group.traverse(({ isMesh, geometry, matrixWorld }) => {
        if (!isMesh || geometry.type === 'CapsuleGeometry') return;
        triangles += (geometry.index ?? geometry.attributes.position).count / 3;
        const T_link_part = T_link_map.clone().multiply(matrixWorld);
        box.union(new THREE.Box3().setFromBufferAttribute(geometry.attributes.position).applyMatrix4(T_link_part));
      });
      if (triangles > 0) drawn[name] = { triangles, min: box.min.toArray(), max: box.max.toArray() };
    }
    return drawn;
  }

  remove() {
    this.isRemoved = true;
    this.parent.remove(this.root);
    this.root.traverse((part) => part.geometry?.dispose());
    for (const material of this.materials.values()) material.dispose();
  }
}
