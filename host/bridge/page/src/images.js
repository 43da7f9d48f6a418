// The newest depth image of each camera.
import { ByteReader } from './bytes.js';
import { element, fixed } from './dom.js';

const NEAR_M = 0.3;
const FAR_M = 4.5;
// Near to far, perceptually even: stops of matplotlib's "cividis", reversed.
const STOPS = [
  [254, 232, 56],
  [203, 186, 105],
  [148, 142, 119],
  [101, 103, 113],
  [56, 70, 108],
  [0, 34, 78],
];

const TABLE = Array.from({ length: 256 }, (_, index) => {
  const along = (index / 255) * (STOPS.length - 1);
  const low = Math.min(STOPS.length - 2, Math.floor(along));
  return STOPS[low].map((value, channel) => value + (STOPS[low + 1][channel] - value) * (along - low));
});

/** A message of /octoskin/view/images. Throws a RangeError if it is cut off. */
export function readImage(buffer, offset) {
  const reader = new ByteReader(buffer, offset);
  const [width, height, time_s] = [reader.u16(), reader.u16(), reader.seconds()];
  if (reader.offset + 2 * width * height > buffer.byteLength) throw new RangeError('an image that is cut off');
  const depths_mm = new Uint16Array(buffer.slice(reader.offset, reader.offset + 2 * width * height));
  return { width, height, time_s, depths_mm };
}

function paint(canvas, { width, height, depths_mm }) {
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  depths_mm.forEach((depth_mm, pixel) => {
    const share = (depth_mm / 1000 - NEAR_M) / (FAR_M - NEAR_M);
    const colour = depth_mm === 0 ? [0, 0, 0] : TABLE[Math.round(255 * Math.min(1, Math.max(0, share)))];
    image.data.set(colour, 4 * pixel);
    image.data[4 * pixel + 3] = 255;
  });
  context.putImageData(image, 0, 0);
}

export class Images {
  constructor() {
    this.section = document.getElementById('images');
    this.body = this.section.querySelector('.body');
    this.cameras = new Map();
  }

  /** @param {string} name of the camera */
  show(name, image) {
    this.section.hidden = false;
    if (!this.cameras.has(name)) this.cameras.set(name, this.#add(name));
    const { canvas, caption } = this.cameras.get(name);
    paint(canvas, image);
    const seen = image.depths_mm.reduce((sum, depth_mm) => sum + (depth_mm > 0 ? 1 : 0), 0);
    caption.textContent = `${Math.round((100 * seen) / image.depths_mm.length)} % of the pixels have a depth`;
  }

  /** Another rig has other cameras. */
  clear() {
    this.cameras.clear();
    this.body.replaceChildren();
    this.section.hidden = true;
  }

  #add(name) {
    const canvas = element('canvas', { role: 'img', 'aria-label': `Depth image of ${name}` });
    const caption = element('span');
    const figure = element('figure', {}, canvas, element('figcaption', {}, element('span', {}, name), caption));
    figure.append(
      element(
        'figcaption',
        {},
        element('span', {}, `yellow: ${fixed(NEAR_M, 1)} m`),
        element('span', {}, 'black: no value'),
        element('span', {}, `blue: ${fixed(FAR_M, 1)} m`),
      ),
    );
    this.body.append(figure);
    return { canvas, caption };
  }
}
