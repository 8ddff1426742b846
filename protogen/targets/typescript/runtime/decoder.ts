/** The decoder: bytes in any portions -> events. */

import { AtOnce } from "./at_once.js";
import { Cut, Failure, type Verdict } from "./candidate.js";
import { Fault, type Reason } from "./errors.js";
import { framed, Framed, Invalid, Source, type AnyEvent, type Event } from "./events.js";
import { Search, type Judge } from "./search.js";
import type { Sender } from "./sender.js";
import type { Telling } from "./told.js";
import { WholeFrames } from "./whole.js";

const LEAST_ROOM = 8192;

/**
 * Cuts what is on a line into events: what one endpoint sends, or several.
 *
 * The raw bytes of all events, joined, are the input; how the input is divided among calls of `feed`
 * changes nothing. At most one greatest frame is kept between calls, and behind it what may yet
 * become a start of three bytes or more; in front of a frame that only a silence ends, as much noise.
 */
export class Decoder<Message = unknown, Parts = unknown> {
  private readonly search: Search;
  private readonly name: string;
  /** Takes what is plain; null where only candidates do. */
  private readonly whole: WholeFrames | null;
  /** Takes what is there as a whole; null where nothing is generated for that. */
  private readonly atOnce: AtOnce | null;
  private readonly shares: boolean;
  private readonly greatest: number;
  /** Zeros behind the bytes that came in, as a generated function may look beyond these. */
  private readonly ahead: number;
  private readonly isAnywhere: boolean;
  /** True if noise has to go where it and a candidate are longer than a frame. */
  private readonly keepsOne: boolean;
  private events: AnyEvent[] = [];
  /** What is not delivered, and a little context in front of it. Bytes that came in are not changed. */
  private data: Uint8Array = new Uint8Array(0);
  private size = 0;
  /** Offset of the first of these bytes in the input. */
  private offset = 0;
  private source: Source | null = null;
  // Places in these bytes:
  /** All in front of it is delivered. */
  private done = 0;
  /** No frame starts between `done` and here. */
  private scan = 0;
  /** The candidate has taken all in front of it. */
  private pushed = 0;
  /** Bytes of the frame there that were tried at once. */
  private tried = 0;
  private candidate: Judge | null = null;
  /** The candidate's, until the next start is known. */
  private failure: Failure | null = null;
  private sharesStart = false;
  /** True if nothing came in since the start or the last flush. */
  private isFresh = true;
  private beganFresh = false;

  /** Throws a RangeError where the frames of several senders are found in different ways. */
  constructor(senders: readonly Sender[]) {
    const [first] = senders as readonly [Sender];
    const names = new Set(senders.map((sender) => sender.frame.sender));
    this.name = names.size === 1 ? first.frame.sender : "";
    this.search = new Search(senders);
    this.whole = senders.length === 1 ? WholeFrames.of(first) : null;
    const { whole } = first.frame;
    this.atOnce = whole && senders.length === 1 ? new AtOnce(first, whole) : null;
    this.shares = first.frame.sharesDelimiter;
    this.greatest = Math.max(...senders.map((sender) => sender.frame.greatest));
    this.ahead = this.atOnce ? 2 * this.greatest : 0;
    this.isAnywhere = first.frame.start === "anywhere";
    this.keepsOne = this.isAnywhere && !first.frame.endsIdle;
  }

  /** Bytes that were taken and that no event covers yet. */
  get pending(): number {
    return this.size - this.done;
  }

  /** Take the next bytes of the input; the events that are certain now. */
  feed(chunk: Uint8Array): Event<Message, Parts>[] {
    this.append(chunk);
    this.run(false);
    return this.deliver();
  }

  /** Take the end of the input; all remaining events. */
  flush(): Event<Message, Parts>[] {
    this.run(true);
    const events = this.deliver();
    this.offset += this.size;
    this.data = new Uint8Array(0);
    this.size = this.done = this.scan = this.pushed = 0;
    this.isFresh = true;
    return events;
  }

  /** Take a silence on the line: what `flush` does, which ends what has come. */
  idle(): Event<Message, Parts>[] {
    return this.flush();
  }

  /**
   * Tell identities that are not sent, such as what was asked for, by their parts' names.
   *
   * They hold for the frame that comes next and those behind it, or for one where the schema says so.
   * Several values are those of frames that follow each other, of which the last stays. Throws a
   * RangeError where there is no such part, or it can't have the value.
   */
  tell(values: Readonly<Record<string, Telling | undefined>>): void {
    this.search.told.tell(values);
    this.restart();
  }

  /** Take what another decoder found on the same bus, which may tell an identity here. */
  hear(event: Event): void {
    if (!(event instanceof Framed)) return;
    this.search.told.hear(event);
    this.restart();
  }

  /** Let a candidate that has taken no byte know what was told since it was made. */
  private restart(): void {
    if (!this.candidate || this.pushed !== this.scan) return;
    this.candidate = this.sharesStart ? this.search.sharing() : this.begin(this.beganFresh);
  }

  /** Keep the bytes, behind those that are there. */
  private append(chunk: Uint8Array): void {
    if (this.size + chunk.length > this.data.length - this.ahead) this.move(chunk.length);
    this.data.set(chunk, this.size);
    this.size += chunk.length;
  }

  /** Forget what is delivered: what is left goes to a place of its own, where more fits behind it. */
  private move(more: number): void {
    // The bytes stay where they are, for the events.
    const passed = Math.max(0, this.done - this.search.starts.context);
    const left = this.data.subarray(passed, this.size);
    this.data = new Uint8Array(Math.max(LEAST_ROOM, 2 * left.length + more) + this.ahead);
    this.data.set(left);
    this.size = left.length;
    this.offset += passed;
    this.done -= passed;
    this.scan -= passed;
    this.pushed -= passed;
  }

  private deliver(): Event<Message, Parts>[] {
    const { events } = this;
    this.events = [];
    return events as unknown as Event<Message, Parts>[];
  }

  // --- seek, take, scan again ----------------------------------------------------------------

  private run(final: boolean): void {
    let goesOn = true;
    while (goesOn) {
      if (this.failure) goesOn = this.resume(this.failure, final);
      else if (this.candidate) goesOn = this.take(this.candidate, final);
      else if (this.whole?.isWaiting) goesOn = this.goOn(this.whole, final);
      else goesOn = this.seek(final);
    }
  }

  /** Look for the next possible start; what is in front of it is noise. */
  private seek(final: boolean): boolean {
    const start = this.nextStart();
    const { starts } = this.search;
    const end = final ? this.size : starts.undecided(this.data, this.size, this.scan);
    if (start >= 0 && start <= end) return this.open(start, final);
    this.scan = end;
    this.noise(end, final);
    return false;
  }

  private nextStart(): number {
    if (this.isFresh && this.search.senders[0]!.frame.start === "after_end") return this.scan;
    return this.search.starts.find(this.data, this.size, this.scan, this.size + 1);
  }

  /** Begin at a possible start. */
  private open(start: number, final: boolean): boolean {
    this.beganFresh = this.isFresh;
    this.isFresh = false;
    if (!this.isAnywhere) this.noise(start, true);
    this.scan = this.pushed = start;
    this.tried = this.size - start;
    if (this.atOnce && this.takeAtOnce(this.atOnce)) return true;
    if (this.whole) {
      this.whole.begin();
      return this.takeWhole(this.whole, final);
    }
    this.candidate = this.begin(this.beganFresh);
    return true;
  }

  /** Take more of a frame, of which most often the rest has come. */
  private goOn(whole: WholeFrames, final: boolean): boolean {
    const there = this.size - this.scan;
    // One that comes in small pieces is not begun anew with each of them.
    if (this.atOnce && there >= 2 * this.tried) {
      this.tried = there;
      if (this.takeAtOnce(this.atOnce)) {
        whole.isWaiting = false;
        return true;
      }
    }
    return this.takeWhole(whole, final);
  }

  /** Take the frames that are there, one behind another. False: there is none. */
  private takeAtOnce(atOnce: AtOnce): boolean {
    const { size, scan, events } = this;
    this.done = this.scan = atOnce.take(this.sourceOf(atOnce.sender), size, scan, events);
    return this.scan > scan;
  }

  /** Take the frame there if it is plainly one, or as much of it as has come. */
  private takeWhole(whole: WholeFrames, final: boolean): boolean {
    const event = whole.take(this.sourceOf(whole.sender), this.size, this.scan);
    if (event) {
      this.events.push(event);
      this.done = this.scan += event.size;
      return true;
    }
    if (whole.isWaiting && !final) return false;
    whole.isWaiting = false;
    this.candidate = this.begin(this.beganFresh);
    return true;
  }

  private begin(isFresh: boolean): Judge {
    const { data, size, scan: place } = this;
    return this.search.candidate({ data, size, place, isFresh });
  }

  /** Give the candidate bytes until its verdict. */
  private take(candidate: Judge, final: boolean): boolean {
    const { data, size } = this;
    for (let place = this.pushed; place < size; place++) {
      const verdict = candidate.push(data[place]!);
      if (this.keepsOne && place + 1 - this.done > this.greatest) this.noise(this.scan, true);
      if (verdict) return this.judge(candidate, verdict);
    }
    this.pushed = size;
    if (!final) return false;
    if (this.scan < size) return this.judge(candidate, candidate.flush());
    this.candidate = null;
    this.noise(this.scan, true);
    return false;
  }

  private judge(candidate: Judge, verdict: Verdict): boolean {
    this.failure = verdict instanceof Cut ? this.read(candidate.sender, verdict) : verdict;
    if (this.failure) return true;
    this.giveUp(this.done);
    if (this.shares) {
      // The end of the frame before may be the start of the next as well.
      this.pushed = this.scan;
      this.sharesStart = true;
      this.candidate = this.search.sharing();
    }
    return true;
  }

  /** Deliver the frame, unless its payload is not that of its message. */
  private read(sender: Sender, cut: Cut): Failure | null {
    let event: Framed;
    const start = this.scan;
    try {
      event = framed(this.sourceOf(sender), this.offset + start, cut);
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      return new Failure(cut.size, error);
    }
    this.noise(start, true);
    this.done = start + cut.size;
    this.events.push(event);
    const { told } = this.search;
    if (told.isNeeded) told.passFrame(event);
    return null;
  }

  /** Go on behind the candidate's first byte, where the next frame may start. */
  private resume(failure: Failure, final: boolean): boolean {
    if (this.isAnywhere) {
      this.giveUp(this.scan + 1);
      this.noise(this.scan, false);
      return true;
    }
    // Behind an end that was taken for a start, the frame's own start may stand.
    const low = this.scan + (this.sharesStart ? 0 : 1);
    const high = this.scan + (failure.size || 1);
    const { starts } = this.search;
    const start = starts.find(this.data, this.size, low, high);
    const end = start < 0 ? high : start;
    if (!final && starts.undecided(this.data, this.size, low) < end) return false;
    if (start === this.scan) {
      this.giveUp(start);
      return true;
    }
    this.invalid(start >= 0 ? start : high, failure.fault.reason, failure.fault.problem);
    this.giveUp(this.done);
    return true;
  }

  private giveUp(scan: number): void {
    this.candidate = null;
    this.failure = null;
    this.sharesStart = false;
    this.scan = scan;
  }

  // --- events --------------------------------------------------------------------------------

  /** The bytes that are kept, for events. */
  private sourceOf(sender: Sender): Source {
    const { data, source } = this;
    if (source?.data === data && source.codec === sender) return source;
    return (this.source = new Source(sender, data, this.offset));
  }

  /** Deliver noise up to `end` by greatest frames, and if it is complete the rest as well. */
  private noise(end: number, isComplete: boolean): void {
    while (end - this.done >= this.greatest) this.invalid(this.done + this.greatest, "noise", "");
    if (isComplete && end > this.done) this.invalid(end, "noise", "");
  }

  private invalid(end: number, reason: Reason, problem: string): void {
    const { done } = this;
    const size = end - done;
    this.done = end;
    const source = this.sourceOf(this.search.senders[0]!);
    this.events.push(new Invalid(this.offset + done, size, source, this.name, reason, problem));
  }
}
