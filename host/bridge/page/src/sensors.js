// The sensors in the scene: a cone each, as long as the newest range, coloured by the sensor's state.
import * as THREE from 'three';
import { SENSOR_COLOURS } from './colours.js';
import { matrixOf } from './poses.js';

/** Length of a cone without a target, metres. */
const STUB_M = 0.18;
/** A range older than this does not count, seconds of the bus. */
const RECENT_S = 0.6;
const THIN_RAD = 0.02;

// Unit cone: apex at the origin, along z, radius 1 at z = 1.
const CONE = new THREE.ConeGeometry(1, 1, 20, 1, true).rotateX(-Math.PI / 2).translate(0, 0, 0.5);
const RIM = new THREE.BufferGeometry().setFromPoints(
  Array.from(
    { length: 25 },
    (_, step) => new THREE.Vector3(Math.cos((step * Math.PI) / 12), Math.sin((step * Math.PI) / 12), 1),
  ),
);

export class Sensors {
  /** @param {THREE.Object3D} parent in the map frame @param {object} description the answer to `describe` */
  constructor(parent, description) {
    this.parent = parent;
    this.root = new THREE.Group();
    this.root.name = 'sensors';
    parent.add(this.root);
    this.materials = Object.fromEntries(
      Object.entries(SENSOR_COLOURS).map(([state, colour]) => [
        state,
        {
          cone: new THREE.MeshBasicMaterial({
            color: colour,
            transparent: true,
            opacity: 0.2,
            depthWrite: false,
            side: THREE.DoubleSide,
          }),
          rim: new THREE.LineBasicMaterial({ color: colour }),
        },
      ]),
    );
    this.sensors = new Map(
      description.sensors.map((sensor) => [`${sensor.node} ${sensor.sensor}`, this.#add(sensor)]),
    );
  }

  #add(sensor) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.visible = false;
    const cone = new THREE.Mesh(CONE, this.materials.silent.cone);
    const rim = new THREE.Line(RIM, this.materials.silent.rim);
    cone.renderOrder = 3;
    group.add(cone, rim);
    this.root.add(group);
    const half_rad = Math.max(sensor.fov_rad / 2, THIN_RAD);
    const entry = {
      link: sensor.link,
      T_link_sensor: matrixOf(sensor.T_link_sensor),
      half_rad,
      group,
      cone,
      rim,
      state: 'silent',
      range_m: null,
      time_s: -Infinity,
    };
    this.#setLength(entry, STUB_M);
    return entry;
  }

  #setLength({ cone, rim, half_rad }, length_m) {
    const radius_m = Math.tan(half_rad) * length_m;
    cone.scale.set(radius_m, radius_m, length_m);
    rim.scale.copy(cone.scale);
  }

  /** @param {Map<string, THREE.Matrix4>} linkPoses T_map_link */
  setPoses(linkPoses) {
    for (const entry of this.sensors.values()) {
      const T_map_link = linkPoses.get(entry.link);
      entry.group.visible = T_map_link !== undefined;
      if (!T_map_link) continue;
      entry.group.matrix.multiplyMatrices(T_map_link, entry.T_link_sensor);
      entry.group.matrixWorldNeedsUpdate = true;
    }
  }

  /** @param {Map<string, {state: string}>} states of sensorStates() */
  setStates(states) {
    for (const [name, entry] of this.sensors) {
      entry.state = states.get(name)?.state ?? 'silent';
      entry.cone.material = this.materials[entry.state].cone;
      entry.rim.material = this.materials[entry.state].rim;
    }
  }

  /** A reading that went into the map. @param {import('./readings.js').Reading} reading */
  setRange(reading) {
    const entry = this.sensors.get(`${reading.node} ${reading.sensor}`);
    if (!entry) return;
    entry.range_m = reading.hasTarget ? reading.range_m : null;
    entry.time_s = reading.time_s;
  }

  /** Cones as long as their newest range, if it is recent at `now_s`, bus seconds. */
  setLengths(now_s) {
    for (const entry of this.sensors.values()) {
      const isRecent = entry.range_m !== null && Math.abs(now_s - entry.time_s) < RECENT_S;
      this.#setLength(entry, isRecent ? entry.range_m : STUB_M);
    }
  }

  /** Colour of each cone as drawn, "#rrggbb", by "node sensor". */
  drawnColours() {
    return Object.fromEntries(
      [...this.sensors].map(([name, { cone }]) => [name, `#${cone.material.color.getHexString()}`]),
    );
  }

  remove() {
    this.parent.remove(this.root);
    for (const { cone, rim } of Object.values(this.materials)) {
      cone.dispose();
      rim.dispose();
    }
  }
}
