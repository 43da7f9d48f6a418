// The controls of a recording that the server plays.
import { element, fixed } from './dom.js';

const SPEEDS = [0.25, 1, 4];

export class Recording {
  /** @param {function(object): Promise<object>} play asks the server, {"at_s", "speed"} */
  constructor(play) {
    this.play = play;
    this.section = document.getElementById('recording');
    this.speed = 1;
    this.slider = element('input', {
      type: 'range',
      step: 'any',
      'aria-label': 'Seconds of the recording',
      onchange: () => this.#ask(Number(this.slider.value)),
      oninput: () => this.#say(Number(this.slider.value)),
      onpointerdown: () => (this.isHeld = true),
      onpointerup: () => (this.isHeld = false),
    });
    this.isHeld = false;
    this.button = element('button', { type: 'button', onclick: () => this.toggle() }, 'Pause');
    this.rate = element(
      'select',
      { 'aria-label': 'Speed', onchange: () => this.#ask(null) },
      ...SPEEDS.map((speed) => element('option', { value: speed, selected: speed === 1 }, `${speed} x`)),
    );
    this.label = element('output');
    this.section
      .querySelector('.body')
      .append(element('div', { class: 'actions' }, this.button, this.rate, this.label), this.slider);
  }

  /** @param {object} link of /octoskin/view/link */
  show({ mode, begin_s, end_s, now_s, speed }) {
    this.section.hidden = mode !== 'recording';
    if (!this.isShown || end_s === undefined) return;
    this.speed = speed; // another client may have changed it
    if (SPEEDS.includes(speed)) this.rate.value = speed;
    Object.assign(this.slider, { min: begin_s, max: end_s });
    this.begin_s = begin_s;
    this.end_s = end_s;
    this.now_s = now_s;
    if (!this.isHeld) this.slider.value = now_s;
    this.isAtEnd = now_s >= end_s;
    if (this.isAtEnd) this.button.textContent = 'Play again';
    else this.button.textContent = this.speed === 0 ? 'Play' : 'Pause';
    this.#say(now_s);
  }

  #say(now_s) {
    this.label.textContent = `${fixed(now_s - this.begin_s, 1)} of ${fixed(this.end_s - this.begin_s, 1)} s`;
  }

  get isShown() {
    return !this.section.hidden;
  }

  /** @param {number} direction -1: a second back, 1: ahead */
  step(direction) {
    this.#ask(Math.min(this.end_s, Math.max(this.begin_s, this.now_s + direction)));
  }

  toggle() {
    const isPlaying = this.speed !== 0 && !this.isAtEnd;
    this.speed = isPlaying ? 0 : Number(this.rate.value);
    this.button.textContent = isPlaying ? 'Play' : 'Pause';
    this.#ask(this.isAtEnd ? this.begin_s : null);
  }

  #ask(at_s) {
    if (this.speed !== 0) this.speed = Number(this.rate.value);
    this.play({ at_s, speed: this.speed }).catch((error) => {
      this.label.textContent = error.message;
    });
  }
}
