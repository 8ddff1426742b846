/**
 * Frames that are there as a whole, taken by the function that is generated for them.
 *
 * It has the places and bounds of a frame as constants, and takes none that is odd in any way: for
 * these, and for frames in pieces, there are others.
 */

import { hasHighBit, NO_BYTES } from "./bytes.js";
import { Fault } from "./errors.js";
import { Framed, Source, type JoinedParts } from "./events.js";
import { holds } from "./plan.js";
import type { Frame, Group, NamedMessage, Runs, Sizes, TakeWhole } from "./plan.js";
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
  private readonly near: readonly (Known | undefined)[];
  private readonly frames: KnownFrames;
  private readonly givenUpAt: number;

  constructor(
    readonly sender: Sender,
    private readonly whole: TakeWhole,
  ) {
    const { frame } = sender;
    this.frame = frame;
    this.givenUpAt = frame.givenUpAt;
    this.source = new Source(sender, NO_BYTES, 0);
    this.isStuffed = frame.transparency !== null;
    this.content = new Uint8Array(frame.greatest + 1);
    this.content.set(frame.startBytes);
    this.view = new DataView(this.content.buffer);
    this.frames = framesOf(sender);
    this.near = this.frames.near;
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
    const { data } = this;
    const { marks } = this.frames;
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

  /** The message of an identity, which is the number of all its parts; undefined: look further. */
  known(identity: number): Known | undefined {
    return identity < this.near.length ? this.near[identity] : this.frames.far.get(identity);
  }

  /** The event of the frame up to a place, with such a payload. Throws a Fault. */
  event(
    parts: JoinedParts,
    known: Known | undefined,
    from: number,
    to: number,
    behind: number,
  ): Framed | null {
    const { at, reader, source } = this;
    const size = behind - at;
    if (!known || size > this.givenUpAt || !known.holds(to - from)) return null;
    const message = known.read(reader.restart(this.content, from, to));
    if (reader.at !== to) reader.finish();
    return new Framed(source.offset + at, size, source, parts, message);
  }
}

/** A message that needs nothing but its payload. */
class Known {
  readonly read: (reader: Reader) => NamedMessage;
  /** The payload's size, where it has no other one. */
  readonly fixed: number | null;
  private readonly sizes: Sizes;

  constructor(group: Group) {
    this.read = group.messages[0]!.read;
    this.fixed = group.fixed;
    this.sizes = group.carried[0]!;
  }

  /** True if a frame carries so many bytes of it. */
  holds(size: number): boolean {
    return size === this.fixed || holds(this.sizes, size);
  }
}

/** What is looked up of a sender, and the same for all its decoders. */
class KnownFrames {
  /** Messages by the numbers of identities: those of small ones, and those of others. */
  readonly near: (Known | undefined)[] = [];
  readonly far = new Map<number, Known>();
  /** Bytes that may end a start or an end inside a frame. */
  readonly marks: Uint8Array;

  constructor(sender: Sender) {
    this.marks = marksOf(sender);
    for (const [identity, group] of plainGroups(sender)) {
      const known = new Known(group);
      if (identity >= NEAR) this.far.set(identity, known);
      else {
        while (this.near.length < identity) this.near.push(undefined);
        this.near[identity] = known;
      }
    }
  }
}

const KNOWN = /* @__PURE__ */ new WeakMap<Sender, KnownFrames>();

function framesOf(sender: Sender): KnownFrames {
  let found = KNOWN.get(sender);
  if (!found) KNOWN.set(sender, (found = new KnownFrames(sender)));
  return found;
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
