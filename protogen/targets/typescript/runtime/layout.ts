/** The places of a frame's parts, and what makes those that are not always the same. */

import { concatenated } from "./bytes.js";
import { dueOf } from "./candidate.js";
import { EncodeError } from "./errors.js";
import type { PartNumber, Value } from "./numbers.js";
import type { Bits, Covered, LengthNumber, Mirror, Part, Place, Single } from "./plan.js";
import type { Sum, SumPart } from "./plan.js";
import { numbersOf, type Sender } from "./sender.js";
import type { Writer } from "./writer.js";

/** Values of the parts of a frame, by their slots. */
export type Values = (Value | undefined)[];

/** What something is in a frame with this content, whose payload has so many bytes. */
type ValueOf<T = Value> = (content: Uint8Array, payload: number, values: Values) => T;

/** A place in the content: so many bytes, and those of the payload where `moves` is 1. */
interface Spot {
  readonly offset: number;
  readonly moves: 0 | 1;
}

function spotIn({ offset, moves }: Spot, payload: number): number {
  return offset + moves * payload;
}

interface Numbered {
  readonly name: string;
  readonly number: PartNumber;
}

/** The error of a part, whose number does not take its value. */
export function inside(error: unknown, name: string): unknown {
  return error instanceof EncodeError ? new EncodeError(name, error.problem) : error;
}

/** Write the number of a part. Throws an EncodeError. */
export function put(
  number: PartNumber,
  value: Value,
  out: Uint8Array,
  at: number,
  name: string,
): void {
  try {
    number.encode(value, out, at);
  } catch (error) {
    throw inside(error, name);
  }
}

/**
 * What gives a value: a slot, a length, or anything else.
 *
 * They are of one class, as a machine is faster where it knows what it calls.
 */
class Source {
  constructor(
    readonly slot: number,
    readonly length: Length | null = null,
    private readonly other: ValueOf | null = null,
  ) {}

  value(content: Uint8Array, payload: number, values: Values): Value {
    const { slot, length } = this;
    if (slot >= 0) return values[slot]!;
    return length ? length.of(payload) : this.other!(content, payload, values);
  }
}

function other(value: ValueOf): Source {
  return new Source(-1, null, value);
}

/** A length in a layout: so many bytes more than the payload. */
class Length {
  private readonly base: number;

  constructor(
    private readonly part: LengthNumber,
    isEmpty: boolean,
  ) {
    this.base = part.base + (isEmpty ? 0 : part.optional);
  }

  /** Its value in a frame whose payload has so many bytes. Throws an EncodeError. */
  of(payload: number): number {
    const value = this.base + payload;
    const { name, least, greatest } = this.part;
    if (value >= least && value <= greatest) return value;
    throw new EncodeError("payload", `makes ${name} ${value}, not in ${least}..${greatest}`);
  }
}

/** A part that is put into each frame. */
class Step {
  constructor(
    private readonly name: string,
    private readonly number: PartNumber,
    private readonly source: Source,
    private readonly spot: Spot,
  ) {}

  make(content: Uint8Array, payload: number, values: Values): void {
    const value = this.source.value(content, payload, values);
    put(this.number, value, content, spotIn(this.spot, payload), this.name);
  }
}

/** How frames of a sender are put together, those with a payload or those with an empty one. */
export class Layout {
  /** What stands in front of the payload, and behind it up to the end of the frame. */
  private readonly head: Uint8Array;
  private readonly tail: Uint8Array;
  /** Where each part begins, and where the last one ends. */
  private readonly spots: readonly Spot[];
  /** What is stuffed; null where nothing is. */
  private readonly region: readonly [Spot, Spot] | null;
  private readonly steps: Step[] = [];
  /** The length that a receiver is told. */
  private readonly told: Length | null;
  private readonly isPlanned: boolean[] = [];

  constructor(
    private readonly sender: Sender,
    private readonly isEmpty: boolean,
  ) {
    const { frame } = sender;
    const { parts, headSize, end } = frame;
    const offsets = isEmpty ? sender.offsetsEmpty : sender.offsets;
    this.spots = offsets.map((offset, index) => ({
      offset,
      moves: index > frame.payloadIndex ? 1 : 0,
    }));
    const fixed = concatenated([new Uint8Array(offsets[parts.length]!), end]);
    this.head = fixed.subarray(0, headSize);
    this.tail = fixed.subarray(headSize);
    this.region = this.regionOf();
    this.told = sender.toldLength && new Length(sender.toldLength, isEmpty);
    parts.forEach((part, index) => {
      if (part.kind === "literal" && !this.isAbsent(part)) fixed.set(part.bytes, offsets[index]);
      else this.plan(index);
    });
  }

  /** Bytes in front of the payload and behind it, before any stuffing. */
  get size(): number {
    return this.head.length + this.tail.length;
  }

  /** The frame around the payload that was written. Throws an EncodeError. */
  wire(writer: Writer, payload: number, values: Values): Uint8Array {
    const { head, tail, region, steps } = this;
    const { frame, length } = this.sender;
    if (payload > frame.greatestPayload && (length !== null || frame.isBounded)) {
      const problem = `has ${payload} bytes, at most ${frame.greatestPayload} fit`;
      throw new EncodeError("payload", problem);
    }
    const behind = head.length + payload;
    writer.size = behind;
    writer.room(tail.length);
    const { bytes } = writer;
    this.told?.of(payload);
    for (let index = 0; index < head.length; index++) bytes[index] = head[index]!;
    for (let index = 0; index < tail.length; index++) bytes[behind + index] = tail[index]!;
    for (let index = 0; index < steps.length; index++) {
      steps[index]!.make(bytes, payload, values);
    }
    if (!region) return writer.taken();
    const [from, to] = region;
    return frame.transparency!.put(bytes, writer.size, spotIn(from, payload), spotIn(to, payload));
  }

  private isAbsent(part: Part): boolean {
    return this.isEmpty && part.isOptional === true;
  }

  private regionOf(): readonly [Spot, Spot] | null {
    const { parts, firstStuffed, lastStuffed, transparency } = this.sender.frame;
    if (!transparency) return null;
    const stuffed = parts.slice(firstStuffed, lastStuffed + 1);
    if (this.isEmpty && stuffed.every((part) => this.isAbsent(part))) return null;
    return [this.spots[firstStuffed]!, this.spots[lastStuffed + 1]!];
  }

  private spot(place: Place): Spot {
    if (!place.isTail) return { offset: place.offset, moves: 0 };
    const absent = this.isEmpty ? place.absent : 0;
    return { offset: this.sender.frame.headSize + place.offset - absent, moves: 1 };
  }

  // --- steps, each behind those whose bytes it needs ------------------------------------------

  private plan(index: number): void {
    const part = this.sender.frame.parts[index]!;
    if (this.isPlanned[index] || this.isAbsent(part)) return;
    this.isPlanned[index] = true;
    if (part.kind === "literal" || part.kind === "payload") return;
    const [{ name, number }, source] = this.numbered(part);
    this.steps.push(new Step(name, number, source, this.spots[index]!));
  }

  /** Plan all parts of a run of content. */
  private planRun(from: Spot, to: Spot): void {
    const payload = this.isEmpty ? 0 : 1;
    const [first, end] = [spotIn(from, payload), spotIn(to, payload)];
    for (let index = 0; index + 1 < this.spots.length; index++) {
      const isIn = spotIn(this.spots[index]!, payload) < end;
      if (isIn && spotIn(this.spots[index + 1]!, payload) > first) this.plan(index);
    }
  }

  /** A part that is a number, and what gives its value. */
  private numbered(part: Bits | Single | SumPart): readonly [Numbered, Source] {
    if (part.kind === "bits") return [part, this.bits(part)];
    if (part.kind === "number") return [part.part, this.slot(part.part.slot)];
    const sum = this.sender.frame.sums[part.sum]!;
    return [sum, this.sum(sum)];
  }

  /** The value of a slot: one that is known, or a length. */
  private slot(slot: number): Source {
    const numbers = numbersOf(this.sender.frame.parts);
    const length = numbers.find((item) => item.kind === "length" && item.slot === slot);
    return length?.kind === "length" ? this.length(length) : new Source(slot);
  }

  private length(part: LengthNumber): Source {
    const length = new Length(part, this.isEmpty);
    const more = part.overWire ? this.stuffing() : null;
    if (!more) return new Source(-1, length);
    return other((content, payload) => length.of(payload + more(content, payload)));
  }

  /** Bytes that stuffing adds; null where nothing is stuffed. */
  private stuffing(): ((content: Uint8Array, payload: number) => number) | null {
    const { region } = this;
    if (!region) return null;
    const [from, to] = region;
    this.planRun(from, to);
    return (content, payload) => {
      const plain = content.slice(spotIn(from, payload), spotIn(to, payload));
      return this.sender.frame.transparency!.encode(plain).length - plain.length;
    };
  }

  private bits(part: Bits): Source {
    const scratch = new Uint8Array(part.size);
    const items = [
      ...part.members.map((item) => [item, this.slot(item.slot)] as const),
      ...part.sums.map((index) => {
        const sum = this.sender.frame.sums[index]!;
        return [sum, this.sum(sum)] as const;
      }),
      ...part.mirrors.map((item) => [item, this.mirror(item)] as const),
    ];
    return other((content, payload, values) => {
      let joined = part.fixed;
      for (const [{ number, name }, source] of items) {
        put(number, source.value(content, payload, values), scratch, 0, name);
        joined |= BigInt(part.number.decode(scratch, 0));
      }
      return joined;
    });
  }

  private mirror({ of, flips }: Mirror): Source {
    const found = this.slot(of);
    return other((content, payload, values) =>
      Number(BigInt(found.value(content, payload, values)) ^ flips),
    );
  }

  // --- checksums -----------------------------------------------------------------------------

  private sum(sum: Sum): Source {
    const { algorithm, covers } = sum;
    const pieces = covers.map((covered) => this.covered(covered, sum.name));
    return other((content, payload, values) => {
      const joined = concatenated(pieces.map((piece) => piece(content, payload, values)));
      return dueOf(sum, algorithm.compute(joined, 0, joined.length));
    });
  }

  /** The bounds of a run of content, all of whose parts are planned. */
  private run(covered: { readonly from: Place; readonly to: Place }): readonly [Spot, Spot] {
    const run = [this.spot(covered.from), this.spot(covered.to)] as const;
    this.planRun(...run);
    return run;
  }

  private covered(covered: Covered, name: string): ValueOf<Uint8Array> {
    if ("bytes" in covered) return () => covered.bytes;
    if ("virtual" in covered) {
      return (_content, _payload, values) => this.virtual(covered.virtual, values, name);
    }
    const [from, to] = this.run(covered);
    return (content, payload) => {
      const plain = content.slice(spotIn(from, payload), spotIn(to, payload));
      return covered.stuffed ? this.sender.frame.transparency!.encode(plain) : plain;
    };
  }

  private virtual(index: number, values: Values, by: string): Uint8Array {
    const bytes = this.sender.virtual(index, values);
    if (bytes) return bytes;
    const problem = `has no value for an unknown identity, and ${by} covers it`;
    throw new EncodeError(this.sender.frame.virtual[index]!.name, problem);
  }
}
