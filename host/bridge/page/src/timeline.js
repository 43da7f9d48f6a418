// The slider over the last minute.
import { fixed } from './dom.js';

const STEP_S = 1;

export class Timeline {
  /** @param {function(number | null)} onShow bus seconds to show; null: live */
  constructor(onShow) {
    this.onShow = onShow;
    this.slider = document.getElementById('time');
    this.button = document.getElementById('pause');
    this.label = document.getElementById('when');
    this.begin_s = this.end_s = null;
    this.shown_s = null; // null: live
    this.liveWord = 'live';
    this.slider.addEventListener('input', () => this.#moved());
    this.button.addEventListener('click', () => this.toggle());
    this.#draw();
  }

  /** What the history covers, bus seconds. */
  setSpan(begin_s, end_s) {
    if (end_s !== null && this.end_s !== null && end_s < this.end_s) this.shown_s = null; // the map began anew
    this.begin_s = begin_s;
    this.end_s = end_s;
    if (this.shown_s !== null && this.shown_s < begin_s) this.showAt(begin_s);
    else this.#draw();
  }

  get span_s() {
    return this.end_s === null ? 0 : this.end_s - this.begin_s;
  }

  #moved() {
    const value = Number(this.slider.value);
    this.showAt(value >= 0 || this.end_s === null ? null : this.end_s + value);
  }

  /** Continues, or pauses at the newest map. */
  toggle() {
    this.showAt(this.shown_s === null ? this.end_s : null);
  }

  /** @param {number} direction -1: back, 1: ahead */
  step(direction) {
    if (this.end_s === null) return;
    const next_s = (this.shown_s ?? this.end_s) + direction * STEP_S;
    this.showAt(next_s >= this.end_s ? null : next_s);
  }

  /** @param {number | null} time_s bus seconds; null: live */
  showAt(time_s) {
    this.shown_s =
      time_s === null || this.end_s === null ? null : Math.min(this.end_s, Math.max(this.begin_s, time_s));
    this.onShow(this.shown_s);
    this.#draw();
  }

  #draw() {
    const before_s = this.shown_s === null ? 0 : this.end_s - this.shown_s;
    this.slider.min = -Math.max(1, Math.ceil(Math.min(60, this.span_s)));
    this.slider.value = -before_s;
    this.slider.disabled = this.end_s === null;
    this.button.disabled = this.end_s === null;
    this.button.textContent = this.shown_s === null ? 'Pause' : 'Continue';
    this.label.textContent = this.shown_s === null ? this.liveWord : `${fixed(before_s, 1)} s before`;
    this.label.classList.toggle('live', this.shown_s === null);
    this.slider.setAttribute('aria-valuetext', this.label.textContent);
  }
}
