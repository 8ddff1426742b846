/**
 * Frames without rare things, put together around their payload in one go.
 *
 * What is always the same is made once for each message. Whatever is odd is left to a layout, which
 * knows all frames, and what is wrong with one.
 */

import type { Checksum } from "./checksums.js";
import { NONE_GIVEN, type Counts, type GivenPart, type GivenParts } from "./given.js";
import type { PartNumber, Value } from "./numbers.js";
import { at as placeAt } from "./plan.js";
import type { Frame, Place, Stuff, Sum } from "./plan.js";
import type { Sender } from "./sender.js";
import type { Writer } from "./writer.js";

/** A number, and its place in front of the payload. */
class Spot {
  private readonly isByte: boolean;

  constructor(
    private readonly number: PartNumber,
    private readonly at: number,
  ) {
    this.isByte = number.size === 1;
  }

  /** Put a value there, which the number can have. */
  put(value: Value, bytes: Uint8Array): void {
    if (this.isByte) bytes[this.at] = value as number;
    else this.number.encode(value, bytes, this.at);
  }
}

/** A checksum over one run of content. */
interface RunSum {
  readonly number: PartNumber;
  readonly algorithm: Checksum;
  readonly place: Place;
  readonly from: Place;
  readonly to: Place;
}

/** The checksum as one over a run of content; null of another one. */
function runSum({ number, algorithm, place, covers, isBits, overWire }: Sum): RunSum | null {
  const [run] = covers;
  const isRun = covers.length === 1 && run && "from" in run && !run.stuffed;
  if (!isRun || isBits || overWire || !number.isPlain) return null;
  return { number, algorithm, place, from: run.from, to: run.to };
}

/** Puts the frames of a message together. */
export class PlainFrame {
  /** What stands in front of the payload, and behind it up to the end of the frame. */
  private readonly head: Uint8Array;
  private readonly tail: Uint8Array;
  /** Where the parts lie whose values callers give. */
  private readonly spots: readonly Spot[];
  private readonly length: Spot | null;
  /** What the length is without a payload, and its bounds. */
  private readonly base: number;
  private readonly least: number;
  private readonly greatest: number;
  private readonly sum: RunSum | null;
  private readonly frame: Frame;
  /** Where the stuffed bytes begin, and how many there are between the payload and their end. */
  private readonly stuffed: number;
  private readonly stuffedBehind: number;

  private constructor(
    sender: Sender,
    private readonly parts: readonly GivenPart[],
    identity: readonly Value[],
  ) {
    const { frame, offsets, length } = sender;
    const { headSize, tailSize, end } = frame;
    const content = new Uint8Array(headSize + tailSize + end.length);
    const found = new Map<number, Spot>();
    frame.parts.forEach((part, index) => {
      const at = offsets[index]!;
      if (part.kind === "literal") content.set(part.bytes, at);
      else if (part.kind === "number") found.set(part.part.slot, new Spot(part.part.number, at));
    });
    content.set(end, headSize + tailSize);
    sender.identityParts.forEach(({ slot }, index) => {
      found.get(slot)!.put(identity[index]!, content);
    });
    this.head = content.slice(0, headSize);
    this.tail = content.slice(headSize);
    this.spots = parts.map(({ slot }) => found.get(slot)!);
    this.length = length && found.get(length.slot)!;
    this.base = length ? length.base : 0;
    this.least = length ? length.least : 0;
    this.greatest = length ? Math.min(length.greatest, this.base + frame.greatestPayload) : 0;
    this.sum = frame.sums.length ? runSum(frame.sums[0]!) : null;
    this.frame = frame;
    this.stuffed = frame.transparency ? offsets[frame.firstStuffed]! : 0;
    this.stuffedBehind = frame.transparency ? offsets[frame.lastStuffed + 1]! - headSize : 0;
  }

  /** What puts the frames of a message with that identity together; null: there are rare things. */
  static of(
    sender: Sender,
    parts: readonly GivenPart[],
    identity: readonly Value[],
  ): PlainFrame | null {
    const { whole, told, isBounded, sums, payloadIndex, parts: all } = sender.frame;
    // What is taken at once is plain, but for these.
    const isBehind = all.some((part, index) => part.kind === "number" && index > payloadIndex);
    const sumsMore = sums.length > 1 || sums.some((sum) => !runSum(sum));
    const isOdd = isBehind || sumsMore || isBounded || told.length > 0;
    if (!whole || isOdd || sender.length?.overWire) return null;
    return new PlainFrame(sender, parts, identity);
  }

  /** The frame around the payload that was written; null where something is odd. */
  around(writer: Writer, given: GivenParts, counts: Counts | null): Uint8Array | null {
    const { head, tail, length, frame } = this;
    const end = writer.size;
    const payload = end - head.length;
    writer.room(tail.length);
    const { bytes } = writer;
    for (let index = 0; index < head.length; index++) bytes[index] = head[index]!;
    for (let index = 0; index < tail.length; index++) bytes[end + index] = tail[index]!;
    if (!this.takes(given, counts, bytes) || (length && !this.measures(length, payload, bytes))) {
      writer.size = end;
      return null;
    }
    if (frame.stuff) return this.stuff(frame.stuff, writer, end);
    const { sum } = this;
    if (sum) {
      const from = placeAt(sum.from, head.length, payload);
      const to = placeAt(sum.to, head.length, payload);
      const due = sum.algorithm.compute(bytes, from, to);
      sum.number.encode(due, bytes, placeAt(sum.place, head.length, payload));
    }
    if (!frame.transparency) return writer.taken();
    return frame.transparency.put(bytes, writer.size, this.stuffed, end + this.stuffedBehind);
  }

  /** The frame with its region stuffed and summed up by a printed function. */
  private stuff(stuff: Stuff, writer: Writer, end: number): Uint8Array {
    let at = stuff(writer, end);
    const { bytes, size, stuffed: wire } = writer;
    for (let index = 0; index < this.stuffed; index++) wire[index] = bytes[index]!;
    for (let index = end + this.stuffedBehind; index < size; index++) wire[at++] = bytes[index]!;
    return wire.slice(0, at);
  }

  /** Put the values of parts in their places. False: callers give something odd. */
  private takes(given: GivenParts, counts: Counts | null, bytes: Uint8Array): boolean {
    const { parts, spots } = this;
    let left = 0;
    if (given !== NONE_GIVEN) for (const _name in given) left++;
    for (let index = 0; index < parts.length; index++) {
      const part = parts[index]!;
      let value = part.own(given);
      if (value === undefined || value === null) value = part.usual(counts);
      else left--;
      if (!part.isPlain(value)) return false;
      spots[index]!.put(value, bytes);
    }
    return left === 0;
  }

  /** Put the length in its place. False: no frame has such a payload. */
  private measures(spot: Spot, payload: number, bytes: Uint8Array): boolean {
    const value = this.base + payload;
    if (value < this.least || value > this.greatest) return false;
    spot.put(value, bytes);
    return true;
  }
}
