// Dark or light: as the system has it, until the button is used.
import { THEMES } from './colours.js';

const KEY = 'octoskin-theme';

export class Theme {
  /** @param {function(object)} onChange colours of the scene */
  constructor(onChange) {
    this.onChange = onChange;
    this.button = document.getElementById('theme');
    this.system = matchMedia('(prefers-color-scheme: light)');
    this.system.addEventListener('change', () => this.apply());
    this.button.addEventListener('click', () => this.#switch());
    this.apply();
  }

  get name() {
    return this.#stored ?? (this.system.matches ? 'light' : 'dark');
  }

  get #stored() {
    const stored = localStorage.getItem(KEY);
    return stored in THEMES ? stored : null;
  }

  #switch() {
    localStorage.setItem(KEY, this.name === 'dark' ? 'light' : 'dark');
    this.apply();
  }

  apply() {
    document.documentElement.dataset.theme = this.name;
    this.button.textContent = this.name === 'dark' ? 'Light' : 'Dark';
    this.onChange(THEMES[this.name]);
  }
}
