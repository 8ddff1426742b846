/**
 * One possible frame, taken byte by byte until it is complete or proves to be none.
 *
 * A candidate starts where a frame may start. It decides as early as the bytes allow, and looks at
 * nothing but them, so that it does not matter how they arrive.
 */

import { concatenated, equal, NO_BYTES, standsAt } from "./bytes.js";
import { Content } from "./content.js";
import { Fault } from "./errors.js";
import type { Value } from "./numbers.js";
import { at, type Covered, type Sum } from "./plan.js";
import type { Sender } from "./sender.js";
import type { Unstuffer } from "./transparency.js";

/** A complete frame whose length and checksums are right. */
export class Cut {
  constructor(
    readonly size: number,
    readonly values: (Value | undefined)[],
    readonly payload: Uint8Array,
  ) {}
}

/** The first `size` bytes of a candidate, which are no frame. */
export class Failure {
  constructor(
    readonly size: number,
    readonly fault: Fault,
  ) {}
}

export type Verdict = Cut | Failure;

/** Values that a receiver was told, by their slots. */
export type ToldValues = readonly (Value | undefined)[];

export const NOTHING_TOLD: ToldValues = [];

/** A possible frame of one sender. Of no use after its verdict. */
export class Candidate {
  private wire: Uint8Array = new Uint8Array(32);
  private wireSize = 0;
  /** Bytes in front that are those of the frame before. */
  private shared = 0;
  /** Bytes at the end that are not the candidate's own. */
  private behind = 0;
  private readonly content: Content;
  private cut: Cut | null = null;
  /** Delimiters that are looked for; bytes that may begin one are held back. */
  private delimiters: readonly Uint8Array[];
  private held: number[] = [];
  /** Bytes still to come of an end that stands in a known place. */
  private endLeft = 0;
  /** True if the next start ends the frame, and nothing else does. */
  private endsAtStart = false;
  /** Place on the wire where the payload of such a frame begins. */
  private openFrom = 0;
  private regionBegun = false;
  private unstuffer: Unstuffer | null = null;
  /** Bytes that were released together with the one that is taken. */
  private waiting = 0;
  /** Wire bytes still to come of a region that holds nothing. */
  private emptyLeft = 0;
  /** Wire bytes that were taken as content or stuffing. */
  private passed = 0;
  /** As many as were passed, for each byte of content. */
  private readonly wireEnds: number[] = [];
  private refused: Fault | null = null;

  /** With `sharesStart`, the end of the frame before is also this one's start. */
  constructor(
    readonly sender: Sender,
    told: ToldValues,
    sharesStart = false,
  ) {
    const { frame } = sender;
    this.content = new Content(sender, told);
    this.delimiters = frame.end.length && frame.endIsUnique ? [frame.end] : [];
    try {
      this.content.begin();
      this.cross();
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      this.refused = error;
    }
    if (sharesStart) {
      for (const byte of frame.startBytes) this.push(byte);
      this.shared = frame.startBytes.length;
    }
  }

  /** Bytes of content so far. */
  get contentSize(): number {
    return this.content.size;
  }

  /** True if the bytes so far begin with what marks a start. */
  get beginsWithStart(): boolean {
    const { startWords } = this.sender.frame;
    return (
      !startWords.length || startWords.some((word) => standsAt(this.wire, this.wireSize, 0, word))
    );
  }

  /** Take the next byte. Null: the candidate needs more. */
  push(byte: number): Verdict | null {
    if (this.wireSize === this.wire.length) {
      const larger = new Uint8Array(2 * this.wireSize);
      larger.set(this.wire);
      this.wire = larger;
    }
    this.wire[this.wireSize++] = byte;
    try {
      if (!this.refused) this.take(byte);
      else if (this.wireSize > this.sender.startSize) throw this.refused;
      if (!this.cut && this.wireSize >= this.sender.frame.givenUpAt) {
        throw new Fault("length", `no frame has more than ${this.sender.frame.greatest} bytes`);
      }
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      return new Failure(this.ownSize, error);
    }
    return this.cut;
  }

  /** Take the end of the input, or a silence. */
  flush(): Verdict {
    try {
      this.closeAtFlush();
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      return new Failure(this.ownSize, error);
    }
    return this.cut!;
  }

  private get ownSize(): number {
    return this.wireSize - this.shared - this.behind;
  }

  // --- where the frame ends ------------------------------------------------------------------

  private take(byte: number): void {
    const start = this.sender.completesStart[byte] ? this.startInside() : 0;
    if (start) this.meetStart(start);
    else if (this.wireSize === this.sender.emptyFrame.length && this.isEmpty()) this.rejectEmpty();
    else if (this.delimiters.length && this.wireSize > this.sender.frame.markSize) {
      this.search(byte);
    } else this.pass(byte);
  }

  /** The size of a start that the wire ends with and that ends this candidate, or 0. */
  private startInside(): number {
    const size = this.sender.startSize;
    const before = this.wireSize - size;
    if (before <= 0) return 0;
    const { frame } = this.sender;
    if (!frame.startWords.some((word) => standsAt(this.wire, this.wireSize, before, word))) {
      return 0;
    }
    const endsIt = frame.startIsUnique || (this.endsAtStart && before >= this.openFrom);
    return endsIt ? size : 0;
  }

  private meetStart(size: number): void {
    this.behind = size;
    if (!this.endsAtStart || this.wireSize - size < this.openFrom) {
      throw new Fault("truncated", "another frame starts inside");
    }
    this.held = [];
    this.close();
  }

  private isEmpty(): boolean {
    return standsAt(this.wire, this.wireSize, 0, this.sender.emptyFrame);
  }

  private rejectEmpty(): void {
    const { frame } = this.sender;
    // Where the same literal starts and ends a frame, this end may be the next frame's start.
    if (frame.start !== "after_end") this.behind = frame.end.length;
    throw new Fault("noise", "there is nothing in front of the end");
  }

  /** Look for the delimiter; let pass what can't begin it. */
  private search(byte: number): void {
    if (!this.held.length && !this.delimiters.some((item) => item[0] === byte)) {
      this.pass(byte);
      return;
    }
    this.held.push(byte);
    if (this.delimiters.some((item) => equal(item, this.held))) {
      this.held = [];
      this.close();
      return;
    }
    while (this.held.length && !this.delimiters.some((item) => this.isBegun(item))) {
      this.pass(this.held.shift()!);
    }
  }

  private isBegun(delimiter: Uint8Array): boolean {
    return equal(delimiter.subarray(0, this.held.length), this.held);
  }

  private matchEnd(byte: number): void {
    const { end } = this.sender.frame;
    if (byte !== end[end.length - this.endLeft]) throw this.content.surplus();
    if (!--this.endLeft) this.complete();
  }

  private closeAtFlush(): void {
    if (!(this.endsAtStart || this.sender.frame.endsIdle)) {
      throw new Fault("truncated", "the input ends inside the frame");
    }
    const { held } = this;
    this.held = [];
    for (const byte of held) this.pass(byte);
    this.close();
  }

  /** End the frame here, whatever is known of its size. */
  private close(): void {
    this.finishRegion(false);
    this.content.close();
    this.complete();
  }

  // --- wire bytes, one after another ---------------------------------------------------------

  /** Take a byte that begins no delimiter. */
  private pass(byte: number): void {
    if (this.endLeft) {
      this.matchEnd(byte);
      return;
    }
    this.passed++;
    if (this.unstuffer) this.unstuff(this.unstuffer, byte);
    else if (this.content.isFull) throw this.content.surplus();
    else this.accept(byte);
    if (this.content.regionEnd >= 0) this.reach(this.content.regionEnd);
  }

  /** Do what is due where the length says that something ends. */
  private reach(regionEnd: number): void {
    if (this.passed === regionEnd) this.finishRegion(false);
    if (this.passed === regionEnd + this.sender.frame.behindRegion) {
      this.content.closeCounted();
      this.cross();
    }
  }

  private unstuff(unstuffer: Unstuffer, byte: number): void {
    const released = unstuffer.push(byte);
    if (this.emptyLeft) {
      this.emptyLeft--;
      this.cross();
    } else if (this.content.isFull) throw this.content.surplus();
    for (let index = 0; index < released.length; index++) {
      this.waiting = released.length - index - 1;
      this.accept(released[index]!);
    }
  }

  private accept(value: number): void {
    if (this.sender.hasWireSum) this.wireEnds.push(this.passed);
    if (this.content.accept(value)) this.cross();
  }

  /** Do what is due between two parts. */
  private cross(): void {
    if (this.sender.frame.firstStuffed >= 0) this.crossRegion();
    if (this.content.isFull && !this.emptyLeft) this.meetFull();
    else if (
      this.content.isOpen &&
      !(this.delimiters.length || this.sender.length?.overWire)
    ) {
      this.open();
    }
  }

  /** From now on only a delimiter, or a silence, can tell where the frame ends. */
  private open(): void {
    const { frame } = this.sender;
    if (frame.endsIdle) return;
    if (frame.start === "anywhere") {
      throw new Fault("size", "the identity is unknown, and nothing else gives a size");
    }
    this.delimiters = frame.end.length ? [frame.end] : [];
    if (!this.delimiters.length && !this.endsAtStart) {
      this.endsAtStart = true;
      this.openFrom = this.wireSize;
      this.delimiters = frame.markSize ? frame.startWords : [];
    }
  }

  private meetFull(): void {
    const { frame } = this.sender;
    if (this.delimiters.length || frame.endsIdle) return;
    if (frame.end.length) this.endLeft = frame.end.length;
    else this.complete();
  }

  // --- the stuffed region --------------------------------------------------------------------

  private crossRegion(): void {
    const { firstStuffed, lastStuffed, transparency } = this.sender.frame;
    if (!this.regionBegun && this.content.index >= firstStuffed) {
      this.regionBegun = true;
      this.unstuffer = transparency!.decoder();
      if (this.content.index > lastStuffed) {
        this.emptyLeft = transparency!.encode(NO_BYTES).length;
      }
    }
    if (this.unstuffer && this.content.index > lastStuffed && !this.emptyLeft) {
      const endsAtDelimiter = this.content.isFull && this.delimiters.length;
      if (!endsAtDelimiter) this.finishRegion(true);
    }
  }

  /** End the region. What was held back until now is content, or a surplus of it. */
  private finishRegion(isSurplus: boolean): void {
    const { unstuffer } = this;
    this.unstuffer = null;
    if (!unstuffer) return;
    const released = unstuffer.finish();
    if (isSurplus && (released.length || this.waiting)) throw this.content.surplus();
    for (let index = 0; index < released.length; index++) this.accept(released[index]!);
  }

  // --- the complete frame --------------------------------------------------------------------

  private complete(): void {
    const { content } = this;
    const { headSize, sums } = this.sender.frame;
    for (const sum of sums) if (content.payloadSize || !sum.isOptional) this.check(sum);
    const payload = content.bytes.slice(headSize, headSize + content.payloadSize);
    this.cut = new Cut(this.ownSize, content.values, payload);
  }

  private check(sum: Sum): void {
    const { content } = this;
    const pieces = sum.covers.map((covered) => this.covered(sum, covered));
    const place = at(sum.place, this.sender.frame.headSize, content.payloadSize);
    const joined = concatenated(pieces);
    if (!sumIsRight(sum, sum.algorithm.compute(joined, 0, joined.length), content.bytes, place)) {
      throw new Fault("checksum", `${sum.name} is not that of the bytes`);
    }
  }

  /** The bytes of something that a checksum runs over. */
  private covered(sum: Sum, covered: Covered): Uint8Array {
    if ("bytes" in covered) return covered.bytes;
    if ("virtual" in covered) {
      const bytes = this.sender.virtual(covered.virtual, this.content.values);
      if (bytes) return bytes;
      throw new Fault("checksum", "the identity is unknown, and so is what the checksum covers");
    }
    const { headSize } = this.sender.frame;
    const from = at(covered.from, headSize, this.content.payloadSize);
    const to = at(covered.to, headSize, this.content.payloadSize);
    if (!sum.overWire || from === to) return this.content.bytes.subarray(from, to);
    const start = from ? this.wireEnds[from - 1]! : 0;
    return this.wire.subarray(start, this.wireEnds[to - 1]!);
  }
}

/** The value of a checksum, where the algorithm has this result. */
export function dueOf(sum: Sum, result: number | bigint): number | bigint {
  if (!sum.isBits) return result;
  return Number((BigInt(result) >> BigInt(sum.lowest)) & BigInt(sum.greatest));
}

/** True if the bytes at a place are those of a checksum with this result. */
export function sumIsRight(
  sum: Sum,
  result: number | bigint,
  bytes: Uint8Array,
  place: number,
): boolean {
  const due = dueOf(sum, result);
  if (!sum.isBits && sum.number.isPlain) return sum.number.decode(bytes, place) === due;
  const found = bytes.subarray(place, place + sum.size);
  if (sum.isBits) return BigInt(sum.number.decode(found, 0)) === BigInt(due);
  const right = new Uint8Array(sum.size);
  sum.number.encode(due, right, 0);
  return equal(right, found);
}

/** The verdict on a candidate that is the whole input, and the offset of the byte that gave it. */
export function verdictOn(
  sender: Sender,
  data: Uint8Array,
  told: ToldValues,
): readonly [Verdict, number] {
  const candidate = new Candidate(sender, told);
  for (let offset = 0; offset < data.length; offset++) {
    const verdict = candidate.push(data[offset]!);
    if (verdict) return [verdict, offset];
  }
  return [candidate.flush(), data.length];
}
