// Problems, sensors, and what is rejected, from the status.
import COUNTERS from 'octoskin:counters';
import { Contents, count, element, fixed } from './dom.js';

const WINDOW_S = 10;
const WORDS = { used: 'measures', nothing: 'no target', rejected: 'rejected', faulty: 'faulty', silent: 'silent' };

/** Counters that grew, of all inputs. @returns {{input: string, reason: string, grown: number}[]} the most first */
export function grownCounters(before, now) {
  const grown = [];
  for (const [input, { rejected }] of Object.entries(now.inputs))
    for (const [reason, total] of Object.entries(rejected)) {
      const more = total - (before.inputs[input]?.rejected[reason] ?? 0);
      if (more > 0) grown.push({ input, reason, grown: more });
    }
  return grown.sort((a, b) => b.grown - a.grown);
}

/** What a counter means; `input` is "depth frames of NAME" with several cameras. */
function meaningOf(input, reason) {
  return COUNTERS[input.replace(/^(depth \w+) of .*/, '$1')]?.[reason] ?? { meaning: reason, remedy: '' };
}

function inputsIn(before, now) {
  return Object.entries(now.inputs)
    .map(([input, { used, in: all }]) => ({
      input,
      used: used - (before.inputs[input]?.used ?? 0),
      all: all - (before.inputs[input]?.in ?? 0),
    }))
    .filter(({ all }) => all > 0);
}

export class Panels {
  constructor() {
    const body = (id) => new Contents(document.querySelector(`#${id} .body`));
    this.problems = body('problems');
    this.sensors = body('sensors');
    this.rejected = body('rejected');
    this.samples = []; // {at_ms, status}
  }

  /** @param {object} status of the daemon @param {Map<string, object>} states of sensorStates() */
  show(status, states) {
    this.#keep(status);
    this.#showProblems(status.problems);
    this.#showSensors(status, states);
    this.#showRejected(this.samples[0].status, status);
  }

  /** Links that are drawn as capsules, although the robot has visuals of them. @param {Map<string, string>} missing */
  showMeshes(missing) {
    const links = new Map(); // by reason
    for (const [link, reason] of missing) links.set(reason, [...(links.get(reason) ?? []), link]);
    const line = document.getElementById('meshes');
    line.hidden = missing.size === 0;
    line.textContent = [...links]
      .map(([reason, names]) => `Drawn as capsules: ${names.join(', ')}. ${reason}`)
      .join('\n');
  }

  /** Forgets earlier samples: after a restart counters begin at 0. */
  #keep(status) {
    const newest = this.samples.at(-1);
    if (newest && newest.status.uptime_s > status.uptime_s) this.samples = [];
    const now_ms = performance.now();
    this.samples.push({ at_ms: now_ms, status });
    while (this.samples.length > 2 && this.samples[1].at_ms < now_ms - WINDOW_S * 1000) this.samples.shift();
  }

  #count(id, value, isBad) {
    const badge = document.querySelector(`#${id} .count`);
    badge.textContent = value;
    badge.classList.toggle('bad', isBad);
  }

  #showProblems(problems) {
    this.#count('problems', problems.length === 0 ? '' : problems.length, true);
    this.problems.show(problems, () =>
      problems.length === 0
        ? [element('p', { class: 'empty' }, 'None.')]
        : [
            element(
              'ul',
              { class: 'plain' },
              ...problems.map(({ text, remedy }) =>
                element(
                  'li',
                  { class: 'problem' },
                  text,
                  remedy && !text.includes(remedy) ? element('div', { class: 'remedy' }, remedy) : null,
                ),
              ),
            ),
          ],
    );
  }

  #showSensors(status, states) {
    const chips = status.nodes.flatMap((node) =>
      node.sensors.map((sensor) => {
        const { state, why } = states.get(`${node.id} ${sensor.index}`);
        return {
          name: sensor.name,
          node: node.name,
          state,
          why,
          range_m: state === 'used' ? sensor.range_m : null,
        };
      }),
    );
    const well = chips.filter(({ state }) => state === 'used' || state === 'nothing').length;
    this.#count('sensors', chips.length === 0 ? '' : `${well} of ${chips.length} measure`, well < chips.length);
    this.sensors.show(chips, () =>
      chips.length === 0
        ? [element('p', { class: 'empty' }, 'The rig has no sensors.')]
        : [element('div', { class: 'chips' }, ...chips.map((chip) => this.#chip(chip)))],
    );
  }

  #chip({ name, node, state, why, range_m }) {
    return element(
      'div',
      { class: 'chip', title: `${node} / ${name}: ${why}` },
      element('i', { class: `dot ${state}` }),
      element('span', {}, name),
      element('b', {}, range_m === null ? WORDS[state] : `${fixed(range_m)} m`),
    );
  }

  #showRejected(before, now) {
    const grown = grownCounters(before, now);
    const inputs = inputsIn(before, now);
    this.#count(
      'rejected',
      grown.length === 0 ? '' : count(grown.reduce((sum, { grown: more }) => sum + more, 0)),
      false,
    );
    this.rejected.show({ grown, inputs }, () => [
      element(
        'p',
        { class: 'total' },
        inputs.length === 0
          ? 'Nothing arrived.'
          : `${inputs.map(({ input, used, all }) => `${input}: ${count(used)} of ${count(all)} used`).join('; ')}.`,
      ),
      element('ul', { class: 'plain' }, ...grown.map((each) => this.#reason(each))),
    ]);
  }

  #reason({ input, reason, grown }) {
    const { meaning, remedy } = meaningOf(input, reason);
    return element(
      'li',
      { class: 'reason', title: reason },
      element('div', { class: 'number' }, count(grown)),
      element('div', {}, `${input}: ${meaning}`),
      remedy ? element('div', { class: 'remedy' }, remedy) : null,
    );
  }
}
