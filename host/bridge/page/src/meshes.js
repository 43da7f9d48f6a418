// Files of meshes as objects of the scene.
import * as THREE from 'three';
import { ColladaLoader } from 'three/examples/jsm/loaders/ColladaLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';

/** Textures are not drawn: none is asked for. */
const NO_TEXTURE = 'data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA=';
const manager = new THREE.LoadingManager();
manager.setURLModifier((url) => (url.startsWith('data:') ? url : NO_TEXTURE));

const STL_HEAD_BYTES = 84;
const STL_FACET_BYTES = 50;

const textOf = (bytes) => new TextDecoder().decode(bytes);
const countOf = (text, word) => text.split(word).length - 1;

/** The loader takes quadratic time for a text in which ends are missing. */
function checkTextStl(text) {
  const hasEnds = countOf(text, 'facet') === 2 * countOf(text, 'endfacet');
  if (!hasEnds || countOf(text, 'solid') > 2 * countOf(text, 'endsolid') + 16) throw new Error('an end is missing');
}

function readStl(bytes) {
  const facets = bytes.byteLength < STL_HEAD_BYTES ? 0 : new DataView(bytes).getUint32(80, true);
  if (bytes.byteLength !== STL_HEAD_BYTES + STL_FACET_BYTES * facets) checkTextStl(textOf(bytes));
  return new THREE.Mesh(new STLLoader().parse(bytes));
}

/** Like ROS, whatever the file calls up: the URDF's axes are those of the coordinates. */
function readCollada(bytes) {
  const { scene } = new ColladaLoader(manager).parse(textOf(bytes), '');
  scene.position.set(0, 0, 0);
  scene.quaternion.identity();
  return scene;
}

const READERS = {
  stl: readStl,
  dae: readCollada,
  obj: (bytes) => new OBJLoader(manager).parse(textOf(bytes)),
};

/**
 * The surfaces of a file (.stl, .dae, .obj), metres. Throws an Error with a sentence.
 * @param {string} uri @param {ArrayBuffer} bytes @returns {THREE.Object3D} with nothing but meshes
 */
export function meshOf(uri, bytes) {
  const read = READERS[uri.split('.').pop().toLowerCase()];
  if (!read) throw new Error(`${uri} is no STL, COLLADA or OBJ`);
  let object;
  try {
    object = read(bytes);
  } catch {
    throw new Error(`${uri} cannot be read`);
  }
  const [surfaces, others] = [[], []];
  object.traverse((part) => {
    if (part.isMesh && part.geometry.attributes.position?.count > 0) surfaces.push(part);
    else if (part.isMesh || part.isLight || part.isCamera || part.isLine || part.isPoints) others.push(part);
  });
  if (surfaces.length === 0) throw new Error(`${uri} has no surface that can be read`);
  for (const part of others) part.removeFromParent();
  return object;
}
