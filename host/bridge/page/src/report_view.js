// The maps of a report in three dimensions, without a server: host/lab/report/view_section.cpp writes the elements.
import * as THREE from 'three';
import { STATE } from './bricks.js';
import { KINDS, THEMES } from './colours.js';
import { ORIGIN_KEY } from './lattice.js';
import { MapLayer } from './map_layer.js';
import { MapStore } from './map_store.js';
import { Scene } from './scene.js';

const STATE_NAMES = Object.fromEntries(Object.entries(STATE).map(([name, state]) => [state, name]));
const BEGINS = 1;
const COMPLETE = 2;
/** A click that moves further than this, in CSS pixels, turns the view. */
const CLICK_PX = 4;
/** Share of the sphere about all voxels that the view shows: few are at its rim. */
const FILLED = 0.6;

/** The payloads of one map, a line of base64 each. @returns {ArrayBuffer[]} */
function payloadsOf(element) {
  return element.textContent
    .trim()
    .split('\n')
    .map((line) => Uint8Array.from(atob(line), (byte) => byte.charCodeAt(0)).buffer);
}

function storeOf(element) {
  const store = new MapStore();
  const payloads = payloadsOf(element);
  payloads.forEach((payload, index) => {
    const flags = (index === 0 ? BEGINS : 0) | (index === payloads.length - 1 ? COMPLETE : 0);
    store.add(flags, 0, payload, 0);
  });
  return store;
}

class ReportView {
  constructor(root) {
    this.root = root;
    this.buttons = [...root.querySelectorAll('.map-buttons button')];
    this.said = root.querySelector('.map-said');
    this.scene = new Scene(root.querySelector('.map-canvas'));
    this.layer = new MapLayer(this.scene.scene);
    this.system = matchMedia('(prefers-color-scheme: light)');
    this.system.addEventListener('change', () => this.#colour());
    this.scene.beforeDrawing.push(() => this.layer.setPointScale(this.scene.pointScale));
    for (const button of this.buttons) button.addEventListener('click', () => this.show(button));
    this.#hearClicks();
    this.#hearKeys();
    this.#colour();
    this.show(this.buttons[0]);
    this.#frame();
  }

  #colour() {
    const theme = THEMES[this.system.matches ? 'light' : 'dark'];
    this.scene.setTheme(theme);
    this.layer.setTheme(theme);
    this.scene.request();
  }

  /** Shows the map of a button in place of the one before. */
  show(button) {
    for (const one of this.buttons) one.setAttribute('aria-pressed', String(one === button));
    const data = this.root.querySelector(`.map-data[data-map="${button.dataset.map}"]`);
    this.layer.clear();
    this.store = storeOf(data);
    this.layer.apply(this.store.takeUpdate());
    this.said.textContent = `${button.textContent}: ${this.layer.drawnKeys().length} occupied voxels with a visible face.`;
    this.scene.request();
  }

  #frame() {
    const box = this.layer.box();
    if (box.isEmpty()) return;
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    this.scene.frame(sphere.center, FILLED * sphere.radius);
    this.scene.look('corner');
  }

  #hearClicks() {
    const { canvas } = this.scene;
    let begun = null;
    canvas.addEventListener('pointerdown', ({ offsetX, offsetY }) => (begun = [offsetX, offsetY]));
    canvas.addEventListener('pointerup', ({ offsetX, offsetY }) => {
      if (!begun || Math.hypot(offsetX - begun[0], offsetY - begun[1]) > CLICK_PX) return;
      this.#describe(this.store.pick(this.scene.rayThrough(offsetX, offsetY)));
    });
  }

  #hearKeys() {
    const actions = {
      ArrowLeft: () => this.scene.turn(-1, 0),
      ArrowRight: () => this.scene.turn(1, 0),
      ArrowUp: () => this.scene.turn(0, 1),
      ArrowDown: () => this.scene.turn(0, -1),
      '+': () => this.scene.zoom(0.85),
      '-': () => this.scene.zoom(1 / 0.85),
      Enter: () => this.#pickMiddle(),
    };
    this.scene.canvas.addEventListener('keydown', (event) => {
      const action = actions[event.key];
      if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      action();
    });
  }

  #pickMiddle() {
    const { clientWidth, clientHeight } = this.scene.element;
    this.#describe(this.store.pick(this.scene.rayThrough(clientWidth / 2, clientHeight / 2)));
  }

  /** @param {object | null} picked of MapStore.pick */
  #describe(picked) {
    if (!picked) return;
    const centre_m = picked.key.map((along) => (along - ORIGIN_KEY + 0.5) * this.store.head.resolution_m);
    const kind = KINDS[picked.stamp & 3];
    const seen = kind === 'none' ? '' : `, last seen by a ${kind === 'camera' ? 'camera' : 'range sensor'}`;
    const logOdds = picked.logOdds === null ? '' : `, log-odds ${picked.logOdds.toFixed(2)}`;
    const at = centre_m.map((along) => along.toFixed(2)).join(', ');
    this.said.textContent = `${STATE_NAMES[picked.state]} voxel at (${at}) m${logOdds}${seen}.`;
  }
}

for (const root of document.querySelectorAll('.map-view')) window.octoskinReport = new ReportView(root);
