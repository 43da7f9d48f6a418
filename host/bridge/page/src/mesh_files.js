// The robot's meshes: each file is fetched once, one at a time, so that queries and maps are not kept waiting for all.
import { meshOf } from './meshes.js';

export class MeshFiles {
  /** @param {function(string): Promise<ArrayBuffer>} fetchAsset */
  constructor(fetchAsset) {
    this.fetchAsset = fetchAsset;
    this.fetched = 0; // files that came
    this.clear();
  }

  /** The files may be others now. */
  clear() {
    this.meshes = new Map(); // URI -> promise
    this.last = Promise.resolve();
  }

  /** @param {string} uri @returns {Promise<THREE.Object3D>} an object of the caller's own, rejected with a sentence */
  async get(uri) {
    if (!this.meshes.has(uri)) this.meshes.set(uri, this.#fetch(uri));
    const { meshes } = this;
    try {
      return (await meshes.get(uri)).clone();
    } catch (error) {
      meshes.delete(uri); // it may come another time
      throw error;
    }
  }

  #fetch(uri) {
    const mesh = this.last.then(async () => {
      const bytes = await this.fetchAsset(uri);
      this.fetched += 1;
      return meshOf(uri, bytes);
    });
    this.last = mesh.then(
      () => {},
      () => {},
    );
    return mesh;
  }
}
