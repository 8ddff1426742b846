/**
 * Frames that are there as a whole, taken by the function that is generated for them.
 *
 * It has the places and bounds of a frame as constants, and takes none that is odd in any way: for
 * these, and for frames in pieces, there are others.
 */

import { hasHighBit, NO_BYTES, standsAt } from "./bytes.js";
import { Fault } from "./errors.js";
import { Framed } from "./events.js";
import type { Value } from "./numbers.js";
import { holds } from "./plan.js";
import type { Frame, Group, TakeWhole } from "./plan.js";
import { Reader } from "./reader.js";
import type { Sender } from "./sender.js";

/** A place in some input, for a generated function. Its methods say if all is well so far. */
export class AtOnce {
  /** What came in, from the first byte of the frame on. */
  view: DataView;
  /** What is taken of a frame where it is stuffed. */
  readonly content: DataView;
  private data: Uint8Array = NO_BYTES;
  private size = 0;
  private at = 0;
  private offset = 0;
  /** Place in the input behind the bytes that are taken. */
  private place = 0;
  /** Bytes of content that are taken off. */
  private filled = 0;
  /** Content where it is stuffed, and what came in where it is not. */
  private bytes: Uint8Array;
  private readonly steps: Int16Array | null;
  private readonly scratch: Uint8Array;
  private readonly reader = new Reader(NO_BYTES);
  private readonly frame: Frame;
  /** Bytes that may end a start or an end inside the frame. */
  private readonly marks: Uint8Array;

  constructor(
    private readonly sender: Sender,
    private readonly whole: TakeWhole,
  ) {
    const { frame } = sender;
    this.frame = frame;
    this.steps = frame.transparency?.steps?.() ?? null;
    this.scratch = this.bytes = new Uint8Array(frame.greatest + 1);
    this.content = this.view = new DataView(this.scratch.buffer);
    this.marks = marksOf(sender);
  }

  /** Take frames from a start on, one behind another; the place behind the last one. */
  take(data: Uint8Array, size: number, start: number, offset: number, events: unknown[]): number {
    if (this.data !== data) {
      this.data = data;
      this.view = new DataView(data.buffer);
      if (!this.steps) this.bytes = data;
    }
    this.size = size;
    this.offset = offset;
    this.at = start;
    try {
      for (let event; this.at < size && (event = this.whole(this, this.at)); ) {
        events.push(event);
        this.at += event.size;
      }
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
    }
    return this.at;
  }

  // --- what generated functions call ---------------------------------------------------------

  /** Take content that is not stuffed up to a place. */
  reach(place: number): boolean {
    this.place = place;
    return place + this.frame.end.length <= this.size;
  }

  /** Take a few bytes that are not stuffed, and then stuffed ones until so many are there. */
  begin(before: number, due: number): boolean {
    const { at, data, scratch } = this;
    for (let index = 0; index < before; index++) scratch[index] = data[at + index]!;
    this.place = at + before;
    this.filled = before;
    return this.fill(due);
  }

  /** Take stuffed bytes until so many are there. */
  fill(due: number): boolean {
    const { data, size, scratch, steps } = this;
    let { place, filled } = this;
    while (filled < due) {
      if (place >= size) return false;
      let step = steps![data[place++]!]!;
      while (step < 0) {
        if (step === -1 || place >= size) return false;
        step = steps![256 * (-2 - step) + data[place++]!]!;
      }
      scratch[filled++] = step;
    }
    this.place = place;
    this.filled = filled;
    return true;
  }

  /** True if nothing stands there that may begin another frame or end this one. */
  isClear(from: number, to: number): boolean {
    const { data, marks } = this;
    for (let place = from; place < to; place++) if (marks[data[place]!]) return false;
    return true;
  }

  /** True if the bytes have their most significant bits clear. */
  isSevenBit(from: number, to: number): boolean {
    return !hasHighBit(this.bytes, from, to);
  }

  /** The checksum of bytes. */
  sum(index: number, from: number, to: number): number | bigint {
    return this.frame.sums[index]!.algorithm.compute(this.bytes, from, to);
  }

  /** The messages of frames with these values; undefined where there are none. */
  group(values: readonly Value[]): Group | undefined {
    return this.sender.group(values);
  }

  /** The event of the frame with these values and such a payload. Throws a Fault. */
  event(values: Value[], group: Group | undefined, from: number, to: number): Framed | null {
    const { sender, data, at, frame, place } = this;
    if (!group || group.messages.length > 1) return null;
    const plan = group.messages[0]!;
    const sizes = group.carried[0]!;
    const payload = to - from;
    if (!holds(plan.sizes, payload)) return null;
    if (sizes !== plan.sizes && !holds(sizes, payload)) return null;
    const { end } = frame;
    const size = place + end.length - at;
    if (size > frame.givenUpAt || !standsAt(data, this.size, place, end)) return null;
    const reader = this.reader.restart(this.bytes, from, to, sender.held(plan, values));
    const message = plan.read(reader);
    reader.finish();
    const offset = this.offset + at;
    return new Framed("message", offset, size, data, at, sender, values, NO_BYTES, message, plan);
  }
}

/** The bytes that may end a start or an end inside a frame. */
export function marksOf({ frame, completesStart }: Sender): Uint8Array {
  const marks = frame.startIsUnique ? completesStart.slice() : new Uint8Array(256);
  if (frame.endIsUnique) marks[frame.end[frame.end.length - 1]!] = 1;
  return marks;
}
