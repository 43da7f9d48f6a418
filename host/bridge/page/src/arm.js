// The robot with its sensors and cameras, as it is or was at the time that is shown.
import { Cameras } from './cameras.js';
import { Kinematics } from './kinematics.js';
import { MeshFiles } from './mesh_files.js';
import { Past } from './past.js';
import { Readings } from './readings.js';
import { Robot } from './robot.js';
import { Sensors } from './sensors.js';
import { sensorStates } from './sensor_state.js';

export class Arm {
  /**
   * @param {import('./scene.js').Scene} scene
   * @param {{fetchAsset: function(string): Promise<ArrayBuffer>, onMeshes: function(Map<string, string>)}} hears
   *   `onMeshes`: why links have their capsules, by link
   */
  constructor(scene, { fetchAsset, onMeshes }) {
    this.scene = scene;
    this.meshFiles = new MeshFiles(fetchAsset);
    this.onMeshes = onMeshes;
    this.visible = { robot: true, sensors: true, cameras: true };
    this.description = null;
    this.forget();
  }

  /** Forgets positions, ranges and states: the recording plays again, or the server is another one. */
  forget() {
    this.positions = new Map(); // newest, all sources
    this.joints = new Past();
    this.states = new Past(200);
    this.readings = new Readings();
    this.newest_s = null; // bus time of the newest joints or range
  }

  /** @param {object} description the answer to `describe`, and `urdf` */
  setDescription(description, theme) {
    for (const part of [this.robot, this.sensors, this.cameras]) part?.remove();
    if (this.description?.reloads !== description.reloads) this.meshFiles.clear();
    this.description = description;
    this.readings = new Readings(); // those of another rig's sensors are not theirs
    this.kinematics = new Kinematics(description);
    this.robot = this.#newRobot();
    this.sensors = new Sensors(this.scene.scene, description);
    this.cameras = new Cameras(this.scene.scene, description);
    this.#showAnew(theme);
  }

  #showAnew(theme) {
    this.setTheme(theme);
    this.#applyVisible();
    this.showAt(null);
  }

  #newRobot() {
    const robot = new Robot(this.scene.scene, this.kinematics, this.description, 'robot', {
      fetchMesh: (uri) => this.meshFiles.get(uri),
      onChange: () => {
        this.scene.request();
        this.onMeshes(this.robot.missing);
      },
    });
    this.onMeshes(robot.missing);
    return robot;
  }

  /** Meshes that the server did not give before may come now. */
  fetchMissing(theme) {
    if (!this.robot || this.robot.missing.size === 0) return;
    this.robot.remove();
    this.robot = this.#newRobot();
    this.#showAnew(theme);
  }

  setTheme(theme) {
    this.robot?.setColour(theme.body, theme.bodyOpacity);
    this.cameras?.setTheme(theme);
    this.scene.request();
  }

  /** @param {'robot' | 'sensors' | 'cameras'} layer */
  setVisible(layer, isVisible) {
    this.visible[layer] = isVisible;
    this.#applyVisible();
  }

  #applyVisible() {
    for (const [layer, isVisible] of Object.entries(this.visible))
      if (this[layer]) this[layer].root.visible = isVisible;
    this.scene.request();
  }

  /** @param {{joints: string[], positions: number[], time_s: number}} sample */
  addJoints({ joints, positions, time_s }) {
    joints.forEach((name, index) => this.positions.set(name, positions[index]));
    this.newest_s = time_s;
    this.joints.add(time_s, new Map(this.positions));
  }

  /** @param {import('./readings.js').Reading[]} readings */
  addReadings(readings) {
    for (const reading of readings) {
      this.readings.add(reading);
      this.newest_s = Math.max(this.newest_s ?? reading.time_s, reading.time_s);
    }
  }

  /**
   * The bus time of the map goes on although neither joints nor ranges come.
   * @returns {boolean} ranges that are drawn got too old
   */
  passTime(time_s) {
    if (this.newest_s === null || time_s < this.newest_s + 0.5) return false;
    this.newest_s = time_s;
    return true;
  }

  /** @returns {Map<string, object>} states of the sensors by the newest status */
  addStatus(status) {
    const states = sensorStates(status);
    this.states.add(this.newest_s ?? 0, states);
    return states;
  }

  /** @param {number | null} time_s bus seconds; null: now */
  showAt(time_s) {
    if (!this.robot) return;
    const positions = time_s === null ? this.positions : (this.joints.at(time_s) ?? this.positions);
    this.robot.setJoints(positions);
    const poses = this.kinematics.linkPoses(positions);
    this.sensors.setPoses(poses);
    this.cameras.setPoses(poses);
    const states = time_s === null ? this.states.newest : this.states.at(time_s);
    if (states) this.sensors.setStates(states);
    this.#showRanges(time_s ?? this.newest_s);
    this.scene.request();
  }

  #showRanges(now_s) {
    if (now_s === null) return;
    const seen = new Set();
    for (const reading of this.readings.backFrom(now_s)) {
      // newest first
      if (reading.time_s < now_s - 1) break;
      const name = `${reading.node} ${reading.sensor}`;
      if (!seen.has(name)) this.sensors.setRange(reading);
      seen.add(name);
    }
    this.sensors.setLengths(now_s);
  }

  /** What the rig calls a sensor. */
  sensorName(node, sensor) {
    const found = this.description?.sensors.find((each) => each.node === node && each.sensor === sensor);
    return found ? `${found.node_name} / ${found.name}` : `node ${node}, sensor ${sensor}`;
  }
}
