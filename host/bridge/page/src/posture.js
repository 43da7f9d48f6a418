// A posture of one's own: sliders for its joints, a second arm in the scene, and what `query` answers.
import { ANSWER_COLOURS } from './colours.js';
import { element, fixed, point } from './dom.js';
import { Robot } from './robot.js';

const SETTLED_MS = 250;
const CONTINUOUS_RAD = Math.PI;
const GHOST = '#cfd8e3';

const SPACE = {
  stale: 'free space that no sensor has confirmed lately',
  unknown: 'unknown space',
  occupied: 'something occupied',
};

/** The answer as sentences. @returns {string[]} */
export function sentencesOf(answer) {
  if (!answer.ok) return [answer.error?.message ?? 'The question was refused.'];
  const leg = answer.legs[0];
  const sentences = [];
  if (answer.state === 'free') sentences.push('All space that the posture touches is free.');
  else if (leg.voxel_m) sentences.push(`${leg.link} touches ${SPACE[answer.state]}, at ${point(leg.voxel_m)}.`);
  else sentences.push(`${leg.link} has no body, or is outside the map.`);
  if (answer.state !== 'occupied' && typeof leg.occupied_m === 'number')
    sentences.push(`The nearest occupied voxel is ${fixed(leg.occupied_m, 3)} m from ${leg.occupied_link}.`);
  const evidence = leg.evidence;
  if (evidence && evidence.age_s !== null)
    sentences.push(`The weakest evidence is ${fixed(evidence.age_s, 0)} s old.`);
  return sentences;
}

export class Posture {
  /**
   * @param {THREE.Object3D} parent in the map frame @param {function(object): Promise<object>} ask a query
   * @param {function()} onChange the scene is to be drawn
   */
  constructor(parent, ask, onChange) {
    this.parent = parent;
    this.ask = ask;
    this.onChange = onChange;
    this.body = document.querySelector('#posture .body');
    this.isShown = false;
    this.linkStates = new Map();
    this.asked = 0;
  }

  /** @param {Kinematics} kinematics @param {object} description the answer to `describe` */
  setRobot(kinematics, description) {
    this.#hide();
    this.kinematics = kinematics;
    this.description = description;
    this.joints = kinematics.order
      .map((name) => kinematics.joints.find((joint) => joint.name === name))
      .filter(Boolean);
    this.positions = new Map();
    this.#build();
  }

  #build() {
    this.toggle = element(
      'button',
      { type: 'button', 'aria-pressed': 'false', onclick: () => this.#toggle() },
      'Show',
    );
    this.take = element('button', { type: 'button', disabled: true, onclick: () => this.#takeArm() }, 'As the arm');
    this.own = element('input', { type: 'checkbox', id: 'own-space', onchange: () => this.#query() });
    this.sliders = element('div', {}, ...this.joints.map((joint) => this.#slider(joint)));
    this.answer = element('div', { class: 'answer', 'aria-live': 'polite', hidden: true });
    this.body.replaceChildren(
      element(
        'div',
        { class: 'actions' },
        this.toggle,
        this.take,
        element(
          'label',
          { class: 'muted', title: 'Unknown or stale space within 0.1 m of the arm counts as free' },
          this.own,
          ' own space 0.1 m',
        ),
      ),
      this.answer,
      this.sliders,
    );
    this.sliders.hidden = true;
  }

  #slider(joint) {
    const isBounded = joint.kind !== 'continuous';
    const input = element('input', {
      type: 'range',
      id: `joint-${joint.name}`,
      min: isBounded ? joint.min : -CONTINUOUS_RAD,
      max: isBounded ? joint.max : CONTINUOUS_RAD,
      step: 0.01,
      oninput: () => this.#moved(),
    });
    const unit = joint.kind === 'prismatic' ? 'm' : 'rad';
    input.dataset.joint = joint.name;
    return element(
      'div',
      { class: 'joint' },
      element('label', { for: input.id, title: joint.name }, joint.name),
      input,
      element('output', { for: input.id, 'data-unit': unit }),
    );
  }

  /** The arm's positions now, from which a posture starts. @param {Map<string, number>} positions */
  setArm(positions) {
    this.arm = positions;
  }

  #toggle() {
    if (this.isShown) return this.#hide();
    this.isShown = true;
    this.toggle.setAttribute('aria-pressed', 'true');
    this.take.disabled = false;
    this.sliders.hidden = false;
    this.ghost = new Robot(this.parent, this.kinematics, { ...this.description, urdf: null }, 'posture');
    this.ghost.setColour(GHOST, 0.45);
    this.#takeArm();
  }

  #hide() {
    this.isShown = false;
    this.ghost?.remove();
    this.ghost = null;
    if (!this.toggle) return;
    this.toggle.setAttribute('aria-pressed', 'false');
    this.take.disabled = true;
    this.sliders.hidden = true;
    this.answer.hidden = true;
    this.onChange();
  }

  #takeArm() {
    for (const joint of this.joints) this.positions.set(joint.name, this.arm?.get(joint.name) ?? 0);
    for (const input of this.sliders.querySelectorAll('input'))
      input.value = this.positions.get(input.dataset.joint);
    this.#moved();
  }

  /** @param {Map<string, number>} positions rad or m, for tests */
  set(positions) {
    if (!this.isShown) this.#toggle();
    for (const input of this.sliders.querySelectorAll('input'))
      if (positions.has(input.dataset.joint)) input.value = positions.get(input.dataset.joint);
    this.#moved();
  }

  #moved() {
    for (const input of this.sliders.querySelectorAll('input')) {
      const output = input.parentElement.querySelector('output');
      this.positions.set(input.dataset.joint, Number(input.value));
      output.textContent = `${fixed(Number(input.value))} ${output.dataset.unit}`;
    }
    this.ghost.setJoints(this.positions);
    this.onChange();
    this.#query();
  }

  get #request() {
    const path = [this.kinematics.order.map((name) => this.positions.get(name) ?? 0)];
    return this.own.checked ? { path, own_space_m: 0.1 } : { path };
  }

  /** One question at a time; the newest posture is asked next. */
  async #query() {
    if (!this.isShown) return;
    const asked = ++this.asked;
    clearTimeout(this.settling);
    if (this.isAsking) return;
    this.isAsking = true;
    const answer = await this.#answerTo(this.#request);
    this.isAsking = false;
    if (asked !== this.asked) return this.#query();
    if (!this.isShown) return;
    this.#show(answer);
    this.settling = setTimeout(() => this.#queryLinks(asked, answer), SETTLED_MS);
  }

  async #answerTo(request) {
    try {
      return await this.ask(request);
    } catch (error) {
      return { ok: false, error: { message: error.message } };
    }
  }

  #show(answer) {
    this.newest = answer;
    this.answer.hidden = false;
    this.answer.className = `answer ${answer.ok ? answer.state : ''}`;
    this.answer.replaceChildren(
      element('strong', {}, answer.ok ? answer.state : 'no answer'),
      ...sentencesOf(answer).map((sentence) => element('div', {}, sentence)),
    );
    this.linkStates = new Map();
    if (answer.ok)
      for (const link of answer.links) this.linkStates.set(link, answer.state === 'free' ? 'free' : null);
    if (answer.ok && answer.state !== 'free') this.linkStates.set(answer.legs[0].link, answer.state);
    this.#colour();
  }

  /** Once the posture rests: the state of each link alone. */
  async #queryLinks(asked, answer) {
    if (!answer.ok || answer.state === 'free') return;
    for (const link of answer.links) {
      const others = answer.links.filter((other) => other !== link);
      const alone = await this.#answerTo({ ...this.#request, links_ignored: others, reach_m: 0 });
      if (asked !== this.asked || !this.isShown) return;
      if (alone.ok) this.linkStates.set(link, alone.state);
    }
    this.#colour();
  }

  #colour() {
    this.ghost.setColour(GHOST, 0.35);
    for (const [link, state] of this.linkStates) if (state) this.ghost.setColour(ANSWER_COLOURS[state], 0.55, link);
    this.onChange();
  }
}
