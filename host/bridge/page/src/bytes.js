// Reads numbers of a message, little-endian.

/** Reads on from an offset. Reading beyond the end throws a RangeError, as DataView does. */
export class ByteReader {
  /** @param {ArrayBuffer} buffer @param {number} [offset] bytes */
  constructor(buffer, offset = 0) {
    this.view = new DataView(buffer);
    this.bytes = new Uint8Array(buffer);
    this.offset = offset;
  }

  get isAtEnd() {
    return this.offset >= this.view.byteLength;
  }

  advance(bytes) {
    const at = this.offset;
    this.offset += bytes;
    return at;
  }

  /** Bytes from an offset to where the reader is, as an array of their own. */
  copyFrom(begin) {
    return this.bytes.slice(begin, this.offset);
  }

  u8() {
    return this.view.getUint8(this.advance(1));
  }

  u16() {
    return this.view.getUint16(this.advance(2), true);
  }

  u32() {
    return this.view.getUint32(this.advance(4), true);
  }

  f32() {
    return this.view.getFloat32(this.advance(4), true);
  }

  f64() {
    return this.view.getFloat64(this.advance(8), true);
  }

  /** Signed nanoseconds as seconds. @returns {number} exact to a microsecond until the year 2250 */
  seconds() {
    return Number(this.view.getBigInt64(this.advance(8), true)) / 1e9;
  }

  vector() {
    return [this.f64(), this.f64(), this.f64()];
  }

  /** Seven bits a byte, the lowest first. @returns {number} below 2^49; a longer count throws a RangeError */
  count() {
    let value = 0;
    for (let scale = 1; scale < 2 ** 49; scale *= 128) {
      const byte = this.u8();
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
    throw new RangeError('a count of more than seven bytes');
  }
}
