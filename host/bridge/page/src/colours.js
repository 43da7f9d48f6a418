// Colours of the scene, for both themes. Hues are those of Okabe and Ito, which colour-blind people can tell apart.

/** Kinds of the newest sight of a voxel, by the low two bits of its stamp. */
export const KINDS = ['none', 'range', 'camera', 'none'];

/** Narrower than this, in CSS pixels, the page has one column. */
export const NARROW_PX = 760;

export const SENSOR_COLOURS = {
  used: '#009e73',
  nothing: '#56b4e9',
  rejected: '#f0c000',
  faulty: '#d55e00',
  silent: '#8a929a',
};
export const ANSWER_COLOURS = { free: '#009e73', stale: '#cc79a7', unknown: '#8a929a', occupied: '#d55e00' };

export const THEMES = {
  dark: {
    background: '#14181d',
    grid: '#39424d',
    gridMinor: '#232a32',
    body: '#c9d1d9',
    bodyOpacity: 0.92,
    picked: '#ffffff',
    frustum: '#56b4e9',
    unknown: '#9fb0c4',
    unknownOpacity: 0.06,
    free: '#5f7f74',
    fresh: { none: '#9aa4ae', range: '#ffb224', camera: '#58aee0' },
    old: { none: '#5b646e', range: '#6e4c12', camera: '#24506f' },
  },
  light: {
    background: '#eef1f4',
    grid: '#b4bdc7',
    gridMinor: '#d7dde3',
    body: '#59636e',
    bodyOpacity: 0.92,
    picked: '#000000',
    frustum: '#0072b2',
    unknown: '#52606e',
    unknownOpacity: 0.06,
    free: '#7fae9d',
    fresh: { none: '#8b949d', range: '#e08a00', camera: '#0a74b8' },
    old: { none: '#c3c9cf', range: '#ecd2a4', camera: '#a9cde4' },
  },
};
