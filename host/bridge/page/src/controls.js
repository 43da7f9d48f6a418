// Buttons above the map, and keys.

const VIEW_KEYS = { 1: 'corner', 2: 'top', 3: 'front', 4: 'side' };
const LAYER_KEYS = { u: 'unknown', f: 'free', r: 'robot', s: 'sensors', c: 'cameras' };
const TURNS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const ZOOMS = { '+': 1 / 1.2, '=': 1 / 1.2, '-': 1.2 };

export class Controls {
  /** @param {object} parts {scene, timeline, recording, picking} @param {function(string, boolean)} onLayer */
  constructor(parts, onLayer) {
    Object.assign(this, parts);
    this.onLayer = onLayer;
    for (const button of document.querySelectorAll('[data-view]'))
      button.addEventListener('click', () => this.scene.look(button.dataset.view));
    for (const button of document.querySelectorAll('[data-layer]'))
      button.addEventListener('click', () => this.#press(button));
    document.addEventListener('keydown', (event) => this.#key(event));
  }

  #press(button) {
    const isOn = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', isOn);
    this.onLayer(button.dataset.layer, isOn);
  }

  /** Keys of an input, a button or a list that has the focus are its own. */
  #key(event) {
    const isElsewhere = event.target.closest('input, select, button, summary, a') !== null;
    if (event.ctrlKey || event.altKey || event.metaKey || isElsewhere) return;
    const act = this.#actionOf(event);
    if (!act) return;
    event.preventDefault();
    act();
  }

  #actionOf({ key: typed, shiftKey }) {
    const key = typed.length === 1 ? typed.toLowerCase() : typed;
    if (key in TURNS && (shiftKey || key === 'ArrowUp' || key === 'ArrowDown'))
      return () => this.scene.turn(...TURNS[key]);
    const time = this.recording.isShown ? this.recording : this.timeline;
    if (key === 'ArrowLeft') return () => time.step(-1);
    if (key === 'ArrowRight') return () => time.step(1);
    if (key === ' ') return () => time.toggle();
    if (key === 'Enter') return () => this.picking.pickMiddle();
    if (key in ZOOMS) return () => this.scene.zoom(ZOOMS[key]);
    if (key in VIEW_KEYS) return () => this.scene.look(VIEW_KEYS[key]);
    if (key in LAYER_KEYS) return () => this.#press(document.querySelector(`[data-layer=${LAYER_KEYS[key]}]`));
    return null;
  }
}
