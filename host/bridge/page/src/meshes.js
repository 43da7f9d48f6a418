// Files of meshes as objects of the scene.
import * as THREE from 'three';
import { ColladaLoader } from 'three/examples/jsm/loaders/ColladaLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';

/** Textures are not drawn: none is asked for. */
const NO_TEXTURE = 'data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA=';
const manager = new THREE.LoadingManager();
manager.setURLModifier((url) => (url.startsWith('data:') ? url : NO_TEXTURE));

const textOf = (bytes) => new TextDecoder().decode(bytes);

const READERS = {
  stl: (bytes) => new THREE.Mesh(new STLLoader().parse(bytes)),
  dae: (bytes) => new ColladaLoader(manager).parse(textOf(bytes), '').scene,
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
  const others = [];
  let corners = 0;
  object?.traverse((part) => {
    corners += part.isMesh ? part.geometry.attributes.position.count : 0;
    if (part.isLight || part.isCamera || part.isLine || part.isPoints) others.push(part);
  });
  if (corners === 0) throw new Error(`${uri} has no surface that can be read`);
  for (const part of others) part.removeFromParent();
  return object;
}
