// What is known of the voxel that was clicked.
import { centreOf, ORIGIN_KEY } from './lattice.js';
import { STATE } from './bricks.js';
import { KINDS } from './colours.js';
import { Contents, element, fixed, point, table } from './dom.js';

const STATE_NAMES = Object.fromEntries(Object.entries(STATE).map(([name, state]) => [state, name]));
const KIND_NAMES = { none: 'not known', range: 'a range sensor', camera: 'a camera' };

/** What the page's own map has. @returns {{state: string, age_s: number | null, kind: string, isStale: boolean}} */
export function sightOf({ state, stamp }, { clock_s, staleStamp }) {
  return {
    state: STATE_NAMES[state],
    kind: KINDS[stamp & 3],
    age_s: stamp > 4 ? Math.max(0, clock_s - (stamp >> 2)) : null,
    isStale: state !== STATE.unknown && (stamp < staleStamp || (staleStamp > 0 && stamp <= 4)),
  };
}

/** @param {import('./readings.js').Reading} reading */
function readingText({ reading, endsHere }, until_s, name) {
  const ago = `${fixed(Math.max(0, until_s - reading.time_s), 1)} s before`;
  return endsHere
    ? `${name}, ${ago}: its range of ${fixed(reading.range_m, 3)} m ends here`
    : `${name}, ${ago}: its beam passes through`;
}

export class Details {
  constructor() {
    this.contents = new Contents(document.querySelector('#voxel .body'));
    this.showNothing();
  }

  showNothing() {
    this.contents.show(null, () => [
      element(
        'p',
        { class: 'empty' },
        'Click a voxel of the map. With the keyboard: Enter picks the one in the middle of the picture.',
      ),
    ]);
  }

  /**
   * @param {object} voxel of MapStore.voxel @param {object} update the newest of the map
   * @param {object | null} daemon answer of /octoskin/voxel, or null
   * @param {object | null} explained answer of /octoskin/explain, or null
   * @param {{found: object | null, until_s: number, name: string} | null} last the newest reading through it
   */
  show(voxel, update, daemon, explained, last) {
    const sight = sightOf(voxel, update);
    const age_s = daemon?.ok ? daemon.age_s : sight.age_s;
    const rows = [
      ['State', sight.isStale ? `${sight.state}, stale` : sight.state],
      ['Centre', point(centreOf(voxel.key, update.resolution_m))],
      ['Key', voxel.key.map((along) => along - ORIGIN_KEY).join(', ')],
      ['Log-odds', fixed(voxel.logOdds ?? daemon?.log_odds)],
    ];
    if (daemon?.ok)
      rows.push([
        'Hits, misses',
        daemon.hits === null ? 'not counted' : `${fixed(daemon.hits, 1)}, ${fixed(daemon.misses, 1)}`,
      ]);
    if (sight.state !== 'unknown')
      rows.push([
        'Last seen',
        age_s === null ? 'at an unknown time' : `${fixed(age_s, 0)} s before, by ${KIND_NAMES[sight.kind]}`,
      ]);
    if (last && !explained)
      rows.push([
        'Newest range',
        last.found ? readingText(last.found, last.until_s, last.name) : 'none met it within the last minute',
      ]);
    this.contents.show([rows, explained], () => [table(rows), ...(explained ? this.#explanation(explained) : [])]);
  }

  #explanation(explained) {
    if (!explained.conclusion)
      return [element('p', { class: 'answer' }, explained.error?.message ?? 'There is no explanation.')];
    const rows = explained.sources.map(({ source, hits, misses, change }) =>
      element(
        'tr',
        {},
        element('td', {}, source.name),
        element('td', { class: 'number' }, `${hits}`),
        element('td', { class: 'number' }, `${misses}`),
        element('td', { class: 'number' }, fixed(change)),
      ),
    );
    const head = ['Source', 'Hits', 'Misses', 'Log-odds'].map((name) => element('th', { scope: 'col' }, name));
    return [
      element('p', { class: 'answer' }, `${explained.conclusion}.`),
      element('table', {}, element('thead', {}, element('tr', {}, ...head)), element('tbody', {}, ...rows)),
    ];
  }
}
