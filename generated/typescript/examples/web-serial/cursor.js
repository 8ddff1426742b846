/** Rows of a frame, and what takes their bytes one after another. */

/**
 * A row: some bytes and what they stand for. `bits` are those of a packed number, which has no bytes
 * of its own; `value` is a bigint, a float or a text; `cut` says that bytes are missing.
 */
export const row = (members) => ({
  offset: 0,
  wire: [],
  bytes: [],
  bits: "",
  path: "",
  type: "",
  value: null,
  meaning: "",
  fault: "",
  cut: false,
  ...members,
});

export const reads = (found, value, meaning, fault = "") => ({
  ...found,
  value,
  meaning,
  fault: found.fault || fault,
});

/** Takes units one after another; `offset` is the place of the first one in the frame. */
export class Cursor {
  constructor(units, offset) {
    this.units = units;
    this.offset = offset;
    this.position = 0;
  }

  get left() {
    return this.units.length - this.position;
  }

  /** A row of the next `count` units, or of as many as there are. */
  take(count, path, type, members = {}) {
    const { offset } = this;
    const taken = this.next(count);
    const missing = count - taken.length;
    return row({
      offset,
      wire: taken.flatMap((unit) => unit.wire),
      bytes: taken.map((unit) => unit.byte),
      path,
      type,
      ...members,
      ...(missing ? { fault: `missing bytes: ${missing}`, cut: true } : {}),
    });
  }

  next(count) {
    const taken = this.units.slice(this.position, this.position + count);
    this.position += taken.length;
    for (const unit of taken) this.offset += unit.wire.length;
    return taken;
  }

  /** Units in front of a byte that is `behind` so many of them, or of all. */
  sizeTo(byte, behind) {
    const from = this.position + behind;
    for (let at = from; at < this.units.length; at++) {
      if (this.units[at].byte === byte) return at - this.position;
    }
    return Math.max(behind, this.left);
  }

  /** Elements that are left in front of a tail. */
  elements(tail) {
    const left = this.units.slice(this.position);
    const counted =
      tail.separator === undefined || tail.separator === null
        ? left.length
        : left.filter((unit) => unit.byte === tail.separator).length;
    return Math.floor(Math.max(0, counted - (tail.least ?? 0)) / tail.element);
  }

  endsWith(bytes) {
    const last = this.units.slice(this.position).slice(-bytes.length);
    return last.length === bytes.length && last.every((unit, at) => unit.byte === bytes[at]);
  }

  skip(size) {
    this.offset += size;
  }

  rest() {
    return this.next(this.left);
  }

  /** A cursor over the next `count` units, which this one passes. */
  part(count) {
    const { offset } = this;
    return new Cursor(this.next(count), offset);
  }
}
