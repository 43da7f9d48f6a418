// A click on a voxel: which one it is, what is known of it, and a frame about it.
import * as THREE from 'three';
import { centreOf } from './lattice.js';

const CLICK_PX = 4;

function frameMesh() {
  const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(1.06, 1.06, 1.06));
  const frame = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ depthTest: false }));
  frame.renderOrder = 10;
  frame.visible = false;
  return frame;
}

export class Picking {
  /** Services and parts that it asks. @param {object} parts {scene, map, arm, details, connection, timeline} */
  constructor(parts) {
    Object.assign(this, parts);
    this.frame = frameMesh();
    this.scene.scene.add(this.frame);
    this.key = null;
    const { canvas } = this.scene;
    canvas.addEventListener('pointerdown', ({ clientX, clientY }) => {
      this.pressed = [clientX, clientY];
    });
    canvas.addEventListener('pointerup', (event) => this.#released(event));
  }

  setTheme(theme) {
    this.frame.material.color.set(theme.picked);
  }

  /** A press that did not turn the view. */
  #released({ clientX, clientY, button }) {
    if (!this.pressed || button !== 0) return;
    const moved = Math.hypot(clientX - this.pressed[0], clientY - this.pressed[1]);
    this.pressed = null;
    if (moved > CLICK_PX) return;
    const box = this.scene.canvas.getBoundingClientRect();
    this.pickAt(clientX - box.left, clientY - box.top);
  }

  pickMiddle() {
    return this.pickAt(this.scene.element.clientWidth / 2, this.scene.element.clientHeight / 2);
  }

  /** @param {number} x_px of the canvas @returns {Promise<object | null>} the voxel (MapStore.voxel) under the pixel */
  async pickAt(x_px, y_px) {
    const voxel = await this.map.pick(this.scene.rayThrough(x_px, y_px));
    this.key = voxel?.key ?? null;
    await this.#show(voxel);
    return voxel;
  }

  /** Shows the picked voxel anew: the map has changed. */
  async refresh() {
    if (this.key && !this.isAsking) await this.#show(await this.map.voxel(this.key));
  }

  async #show(voxel) {
    this.frame.visible = voxel !== null;
    this.scene.request();
    if (!voxel) return this.details.showNothing();
    const { resolution_m } = this.map.newest;
    const centre = centreOf(voxel.key, resolution_m);
    this.frame.position.fromArray(centre);
    this.frame.scale.setScalar(resolution_m);
    this.isAsking = true;
    const [daemon, explained] = await Promise.all([this.#daemon(centre), this.#explained(voxel.key, centre)]);
    this.isAsking = false;
    if (this.key?.join() === voxel.key.join())
      this.details.show(voxel, this.map.newest, daemon, explained, this.#last(voxel.key));
  }

  /** The daemon knows the map of now only. */
  #daemon(centre) {
    return this.timeline.shown_s === null ? this.#ask('/octoskin/voxel', centre) : null;
  }

  /** A recording does not change: each voxel is asked once. */
  async #explained(key, centre) {
    if (!this.connection.offers('/octoskin/explain')) return null;
    if (this.explainedKey !== key.join()) {
      this.explainedKey = key.join();
      this.explanation = this.#ask('/octoskin/explain', centre);
    }
    return this.explanation;
  }

  async #ask(service, point_m) {
    if (!this.connection.offers(service)) return null;
    try {
      return await this.connection.call(service, { point_m });
    } catch (error) {
      return { ok: false, error: { message: error.message } };
    }
  }

  #last(key) {
    const until_s = this.timeline.shown_s ?? this.arm.newest_s;
    if (until_s === null) return null;
    const found = this.arm.readings.lastThrough(key, this.map.newest.resolution_m, until_s);
    return { found, until_s, name: found ? this.arm.sensorName(found.reading.node, found.reading.sensor) : '' };
  }
}
