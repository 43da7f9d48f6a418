// Makes elements. Texts of the daemon are always text, never markup.

/**
 * @param {string} tag @param {object} properties of the element; `class`, `aria-*` and `data-*` are attributes
 * @param {...(Node | string | null)} children
 */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes('-') || name === 'class' || name === 'for' || name === 'scope')
      made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** A table of names and values. @param {[string, string | Node][]} rows */
export function table(rows) {
  return element(
    'table',
    {},
    element(
      'tbody',
      {},
      ...rows.map(([name, value]) =>
        element('tr', {}, element('th', { scope: 'row' }, name), element('td', {}, value)),
      ),
    ),
  );
}

/**
 * Replaces the contents only if `content` (any JSON) differs from the last time: a screen reader says it once.
 */
export class Contents {
  constructor(parent) {
    this.parent = parent;
    this.last = undefined;
  }

  show(content, make) {
    const text = JSON.stringify(content);
    if (text === this.last) return;
    this.last = text;
    this.parent.replaceChildren(...make());
  }
}

export const fixed = (value, digits = 2) => (value === null || value === undefined ? '-' : value.toFixed(digits));
export const point = (values) => `(${values.map((value) => value.toFixed(3)).join(', ')}) m`;
export const count = (value) => value.toLocaleString('en-GB');
