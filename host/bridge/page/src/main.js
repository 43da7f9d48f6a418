// The page: connects the parts.
import { Arm } from './arm.js';
import { NARROW_PX } from './colours.js';
import { Connection, jsonOf } from './connection.js';
import { Controls } from './controls.js';
import { Details } from './details.js';
import { count, fixed } from './dom.js';
import { Images, readImage } from './images.js';
import { inspection } from './inspection.js';
import { MapClient } from './map_client.js';
import { MapLayer } from './map_layer.js';
import { Panels } from './panels.js';
import { Picking } from './picking.js';
import { Posture } from './posture.js';
import { readBatch } from './readings.js';
import { Recording } from './recording.js';
import { Scene } from './scene.js';
import { Theme } from './theme.js';
import { Timeline } from './timeline.js';

const FIGURES_MAX = 600;

class Page {
  constructor() {
    this.main_ms = []; // of each map: taking it and drawing it
    this.taken_ms = []; // of the maps that are not drawn yet
    this.scene = new Scene(document.getElementById('canvas'));
    this.layer = new MapLayer(this.scene.scene);
    this.arm = new Arm(this.scene, {
      fetchAsset: (uri) => this.connection.fetchAsset(uri),
      onMeshes: (missing) => this.panels.showMeshes(missing),
    });
    this.panels = new Panels();
    this.details = new Details();
    this.images = new Images();
    this.timeline = new Timeline((time_s) => this.#showAt(time_s));
    this.map = new MapClient({
      onUpdate: (update) => this.#mapChanged(update),
      onGap: () => this.connection.reopen(), // a new subscription begins with the whole map
    });
    this.connection = new Connection(this.#url, {
      onState: (state) => this.#linkChanged(state),
      onServer: (server) => this.#serverFound(server),
    });
    this.posture = new Posture(
      this.scene.scene,
      (query) => this.connection.call('/octoskin/query', query),
      () => this.scene.request(),
    );
    this.recording = new Recording((request) => this.connection.call('/octoskin/play', request));
    this.picking = new Picking(this);
    this.controls = new Controls(this, (layer, isOn) => this.#setLayer(layer, isOn));
    this.wanted = { unknown: false, free: false };
    this.theme = new Theme((theme) => this.#setTheme(theme));
    this.#prepareDrawing();
    document.getElementById('legend').open = innerWidth > NARROW_PX;
    this.#hear();
    this.connection.open();
  }

  get #url() {
    return `ws://${location.host}/`;
  }

  #prepareDrawing() {
    this.scene.beforeDrawing.push(() => this.layer.setPointScale(this.scene.pointScale));
    this.scene.afterDrawing.push((drawn_ms) => {
      this.main_ms.push(...this.taken_ms.map((taken_ms) => taken_ms + drawn_ms));
      this.main_ms.splice(0, Math.max(0, this.main_ms.length - FIGURES_MAX));
      this.taken_ms = [];
    });
  }

  #hear() {
    const view = (name) => new RegExp(`^/octoskin/view/${name}`);
    this.connection.wants(view('map$'), (message) => this.map.frame(message));
    this.connection.wants(view('joints$'), (message) => this.#jointsMoved(jsonOf(message)));
    this.connection.wants(view('ranges$'), ({ buffer, offset }) => this.#rangesCame(readBatch(buffer, offset)));
    this.connection.wants(view('status$'), (message) => this.#statusChanged(jsonOf(message)));
    this.connection.wants(view('robot$'), (message) => this.#robotChanged(jsonOf(message)));
    this.connection.wants(view('link$'), (message) => this.#daemonChanged(jsonOf(message)));
    this.connection.wants(view('images/'), ({ topic, buffer, offset }) =>
      this.images.show(topic.split('/').pop(), readImage(buffer, offset)),
    );
  }

  #setTheme(theme) {
    this.colours = theme;
    this.scene.setTheme(theme);
    this.layer.setTheme(theme);
    this.picking.setTheme(theme);
    this.arm.setTheme(theme);
  }

  #linkChanged(state) {
    this.linkState = state;
    this.#showPill();
    if (state === 'lost')
      this.#notice('octoskin view does not answer. The page connects again as soon as it does.');
    else if (state === 'connected') this.#notice(null);
  }

  /** The server, and behind it the daemon or the recording. */
  #showPill() {
    const hasNone = this.linkState === 'connected' && this.hasDaemon === false;
    const state = hasNone ? 'lost' : this.linkState;
    const pill = document.getElementById('link');
    pill.className = `pill ${state}`;
    pill.textContent = hasNone
      ? 'no daemon'
      : { connecting: 'connecting', connected: 'connected', lost: 'not connected' }[state];
  }

  #notice(text) {
    const notice = document.getElementById('notice');
    notice.hidden = text === null;
    notice.textContent = text ?? '';
  }

  /** Another session has another map, and perhaps another bus time. */
  #serverFound({ sessionId, metadata }) {
    if (this.session !== undefined && this.session !== sessionId) {
      this.arm.forget();
      this.arm.meshFiles.clear();
    }
    this.session = sessionId;
    this.arm.fetchMissing(this.colours);
    const mode = document.getElementById('mode');
    mode.hidden = metadata?.mode === undefined;
    mode.textContent = metadata?.mode ?? '';
  }

  #daemonChanged(link) {
    this.#notice(link.connected ? null : link.why);
    this.hasDaemon = link.connected;
    this.#showPill();
    document.body.dataset.mode = link.mode;
    document.getElementById('rejected').hidden = link.mode === 'recording'; // it has no counters
    this.timeline.liveWord = link.mode === 'recording' ? 'newest' : 'live';
    this.recording.show(link);
  }

  #robotChanged(description) {
    if (description.ok === false) return;
    const text = JSON.stringify(description);
    if (text === this.description) return this.arm.fetchMissing(this.colours);
    this.description = text;
    document.getElementById('rig').textContent = description.rig;
    this.arm.setDescription(description, this.colours);
    this.images.clear();
    this.posture.setRobot(this.arm.kinematics, description);
  }

  #jointsMoved(sample) {
    this.arm.addJoints(sample);
    this.posture.setArm(this.arm.positions);
    if (this.timeline.shown_s === null) this.arm.showAt(null);
  }

  #rangesCame(readings) {
    this.arm.addReadings(readings);
    if (this.timeline.shown_s === null) this.arm.showAt(null);
  }

  #statusChanged(status) {
    this.status = status;
    this.panels.show(status, this.arm.addStatus(status));
    if (this.timeline.shown_s === null) this.arm.showAt(null);
    this.knownVoxels = status.map.known_voxels;
    this.#showFigures();
  }

  #mapChanged(update) {
    const begin = performance.now();
    this.layer.apply(update);
    if (update.groups.length > 0 || this.drawnClock_s !== update.clock_s) {
      this.taken_ms.push(performance.now() - begin);
      this.scene.request();
    }
    this.drawnClock_s = update.clock_s;
    if (this.arm.passTime(update.time_s) && this.timeline.shown_s === null) this.arm.showAt(null);
    this.timeline.setSpan(update.history.begin_s, update.history.end_s);
    this.#frameOnce();
    this.#showFigures();
    this.picking.refresh();
  }

  /** The first map decides what the view turns about. */
  #frameOnce() {
    if (this.isFramed) return;
    const box = this.layer.box();
    if (box.isEmpty()) return;
    this.isFramed = true;
    const radius_m = Math.min(1.6, 0.5 * box.min.distanceTo(box.max));
    this.scene.frame(box.getCenter(this.scene.target.clone()).clampLength(0, 1.2), radius_m);
    this.scene.look('corner');
  }

  #showFigures() {
    const newest = this.map.newest;
    if (!newest) return;
    const known = this.knownVoxels === undefined ? '' : `${count(this.knownVoxels)} known voxels, `;
    document.getElementById('figures').textContent =
      `${known}${count(newest.occupied)} occupied, ${fixed(newest.resolution_m * 100, 1)} cm`;
  }

  #showAt(time_s) {
    this.map?.show(time_s);
    this.arm.showAt(time_s);
  }

  #setLayer(layer, isOn) {
    if (layer in this.arm.visible) return this.arm.setVisible(layer, isOn);
    this.wanted = { ...this.wanted, [layer]: isOn };
    this.map.setWanted(this.wanted);
  }
}

window.octoskin = inspection(new Page());
