// Values of the last minute with their times, for the slider.

const MINUTE_S = 60;

export class Past {
  /** @param {number} [countMax] beyond which the oldest are forgotten */
  constructor(countMax = 10000) {
    this.countMax = countMax;
    this.values = []; // {time_s, value}, oldest first
  }

  /** Times that go back begin anew. @param {number} time_s of the bus */
  add(time_s, value) {
    if (this.values.length > 0 && time_s < this.values.at(-1).time_s - 1) this.values = [];
    this.values.push({ time_s, value });
    const first = this.values.findIndex((each) => each.time_s >= time_s - MINUTE_S);
    const surplus = Math.max(first, this.values.length - this.countMax);
    if (surplus > 100) this.values.splice(0, surplus);
  }

  /** The newest value not after a time; the oldest if there is none; null: there is nothing. */
  at(time_s) {
    return (this.values.findLast((each) => each.time_s <= time_s) ?? this.values[0])?.value ?? null;
  }

  get newest() {
    return this.values.at(-1)?.value ?? null;
  }
}
