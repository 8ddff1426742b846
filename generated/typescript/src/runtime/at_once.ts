/**
 * Frames that are there as a whole, taken by the function that is generated for them.
 *
 * It has the places and bounds of a frame as constants, and takes none that is odd in any way: for
 * these, and for frames in pieces, there are others.
 */

import { hasHighBit, NO_BYTES } from "./bytes.js";
import { Fault } from "./errors.js";
import { Framed, Source, type PartValues } from "./events.js";
import { holds } from "./plan.js";
import type { Frame, Group, Runs, TakeWhole } from "./plan.js";
import { Reader } from "./reader.js";
import type { Sender } from "./sender.js";

/** A place in some input, for a generated function. Its methods say if all is well so far. */
export class AtOnce {
  /** What came in. */
  data: Uint8Array = NO_BYTES;
  /** The bytes of it that are there. */
  size = 0;
  /** Content without its stuffing; what came in where nothing is stuffed. */
  content: Uint8Array;
  /** The same, for numbers of several bytes. */
  view: DataView;
  private at = 0;
  private source: Source;
  private readonly isStuffed: boolean;
  private readonly reader = new Reader(NO_BYTES);
  private readonly frame: Frame;
  /** Groups by the numbers of identities: those of small ones, and those of others. */
  private readonly near: (Group | undefined)[] = [];
  private readonly far = new Map<number, Group>();
  /** Bytes that may end a start or an end inside the frame. */
  private readonly marks: Uint8Array;

  constructor(
    readonly sender: Sender,
    private readonly whole: TakeWhole,
  ) {
    const { frame } = sender;
    this.frame = frame;
    this.source = new Source(sender, NO_BYTES, 0);
    this.isStuffed = frame.transparency !== null;
    this.content = new Uint8Array(frame.greatest + 1);
    this.content.set(frame.startBytes);
    this.view = new DataView(this.content.buffer);
    for (const [identity, group] of plainGroups(sender)) {
      if (identity >= NEAR) this.far.set(identity, group);
      else {
        while (this.near.length < identity) this.near.push(undefined);
        this.near[identity] = group;
      }
    }
    this.marks = marksOf(sender);
  }

  /** Take frames from a start on, one behind another; the place behind the last one. */
  take(source: Source, size: number, start: number, events: unknown[]): number {
    if (this.source !== source) {
      const { data } = source;
      this.source = source;
      this.data = data;
      if (!this.isStuffed) {
        this.content = data;
        this.view = new DataView(data.buffer);
      }
    }
    this.size = size;
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

  /** True if nothing stands there that may begin another frame or end this one. */
  isClear(from: number, to: number): boolean {
    const { data, marks } = this;
    for (let place = from; place < to; place++) if (marks[data[place]!]) return false;
    return true;
  }

  /** True if the bytes have their most significant bits clear. */
  isSevenBit(from: number, to: number): boolean {
    return !hasHighBit(this.content, from, to);
  }

  /** The checksum of bytes. */
  sum(index: number, from: number, to: number): number | bigint {
    return this.frame.sums[index]!.algorithm.compute(this.content, from, to);
  }

  /** The messages of an identity, which is the number of all its parts; undefined: look further. */
  group(identity: number): Group | undefined {
    return identity < this.near.length ? this.near[identity] : this.far.get(identity);
  }

  /** The event of the frame up to a place, with such a payload. Throws a Fault. */
  event(
    parts: PartValues,
    group: Group | undefined,
    from: number,
    to: number,
    behind: number,
  ): Framed | null {
    const { at, reader, source } = this;
    const size = behind - at;
    if (!group || size > this.frame.givenUpAt || !holds(group.carried[0]!, to - from)) return null;
    const message = group.messages[0]!.read(reader.restart(this.content, from, to));
    reader.finish();
    return new Framed(source.offset + at, size, source, parts, message);
  }
}

/** Identities below it are looked up in an array, which is faster. */
const NEAR = 4096;

/** As many identities of a message are listed at most. */
const LISTED = 256;

/** The groups of one message that needs nothing but its payload, by the number of the identity. */
function plainGroups(sender: Sender): ReadonlyMap<number, Group> {
  const found = new Map<number, Group>();
  const factors = sender.identityParts.map(({ number }) => 256 ** number!.size);
  for (const group of sender.frame.groups) {
    if (group.messages.length > 1 || group.messages[0]!.held.length) continue;
    for (const identity of numbersOf(group.identities, factors)) found.set(identity, group);
  }
  return found;
}

/** Identities as numbers, each part above those behind it; none where there are very many. */
function numbersOf(identities: Runs, factors: readonly number[]): readonly number[] {
  let found = [0];
  identities.forEach((runs, index) => {
    const values = runs.flatMap(([first, last]) => valuesOf(Number(first), Number(last)));
    const isMany = found.length * values.length > LISTED;
    const listed = isMany ? [] : values;
    found = found.flatMap((number) => listed.map((value) => number * factors[index]! + value));
  });
  return found;
}

/** The values from the first to the last, or as many of them as show that they are too many. */
function valuesOf(first: number, last: number): readonly number[] {
  const length = Math.min(last - first, LISTED) + 1;
  return Array.from({ length }, (_, index) => first + index);
}

/** The bytes that may end a start or an end inside a frame. */
export function marksOf({ frame, completesStart }: Sender): Uint8Array {
  const marks = frame.startIsUnique ? completesStart.slice() : new Uint8Array(256);
  if (frame.endIsUnique) marks[frame.end[frame.end.length - 1]!] = 1;
  return marks;
}
