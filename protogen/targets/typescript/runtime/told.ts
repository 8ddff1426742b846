/** What a receiver is told of identities that are not sent: by its program, or by frames. */

import type { ToldValues } from "./candidate.js";
import type { Framed } from "./events.js";
import type { Value } from "./numbers.js";
import { ownOf, type LengthNumber, type Told as ToldPart } from "./plan.js";
import type { Sender } from "./sender.js";

/** A number, or those of frames that follow each other. */
export type Telling = number | readonly number[];

/** The values of a decoder's told parts, by their names. */
export class Told {
  private readonly parts = new Map<string, ToldPart>();
  private readonly values = new Map<string, number>();
  private readonly following = new Map<string, number[]>();
  private fresh = new Map<string, readonly number[]>();

  constructor(private readonly senders: readonly Sender[]) {
    for (const { frame } of senders) {
      for (const part of frame.told) {
        this.parts.set(part.name, part);
        this.values.set(part.name, part.default);
      }
    }
  }

  /** True if there are such parts. */
  get isNeeded(): boolean {
    return this.parts.size > 0;
  }

  /** Take what was told: it holds for a frame that begins now. */
  beginFrame(): void {
    for (const [name, [first, ...others]] of this.fresh) {
      this.values.set(name, first!);
      this.following.set(name, others);
    }
    this.fresh = new Map();
  }

  /** What holds for the frame that is coming in, by the slots of a sender. */
  valuesFor(sender: Sender): ToldValues {
    const found: (Value | undefined)[] = [];
    for (const part of sender.frame.told) found[part.slot] = this.values.get(part.name);
    return found;
  }

  /** Take values, or those of the frames to come. Throws a RangeError; then nothing is taken. */
  tell(given: Readonly<Record<string, Telling | undefined>>): void {
    const taken = new Map<string, readonly number[]>();
    for (const [name, value] of Object.entries(given)) {
      const part = this.parts.get(name);
      if (!part) throw new RangeError(`no part that is told is called "${name}"`);
      if (value === undefined) continue;
      const listed = typeof value === "number" ? [value] : value;
      const wrong = listed.find(
        (item) => !Number.isInteger(item) || item < 0 || item >= 2 ** part.bits,
      );
      if (wrong !== undefined) {
        throw new RangeError(`${name} can't be ${wrong}: it has ${part.bits} bits`);
      }
      if (part.length) this.checkLengths(part, part.length, listed);
      taken.set(name, listed.length ? listed : [part.default]);
    }
    for (const [name, listed] of taken) this.fresh.set(name, listed);
  }

  /** Throw a RangeError for a length that no frame has, but for the one before any is told. */
  private checkLengths(part: ToldPart, length: LengthNumber, values: readonly number[]): void {
    for (const value of values) {
      const isTaken = this.senders.some(({ frame }) => {
        if (!frame.told.some((item) => item.name === part.name)) return false;
        const greatest = length.base + length.optional + frame.greatestPayload;
        const least = Math.max(length.least, length.base);
        return least <= value && value <= Math.min(length.greatest, greatest);
      });
      if (!isTaken && value !== part.default) {
        throw new RangeError(`${part.name} can't be ${value}: no frame has that length`);
      }
    }
  }

  /** What holds for one frame that is all there is, without lengths that are not given. */
  valuesForOne(sender: Sender, given: Readonly<Record<string, unknown>>, data: number): ToldValues {
    const found = [...this.valuesFor(sender)];
    const isGiven = sender.frame.told.some((part) => part.length && ownOf(given, part.name) !== undefined);
    if (!isGiven) sender.tellSize(found, sender.payloadSize(data - sender.frame.end.length));
    return found;
  }

  /** Take a frame: what was told may hold no more, and it may tell something itself. */
  passFrame(event: Framed): void {
    for (const part of event.source.codec.frame.told) {
      const following = this.following.get(part.name) ?? [];
      if (following.length || part.once) {
        this.values.set(part.name, following.shift() ?? part.default);
      }
    }
    this.hear(event);
  }

  /** Take the numbers of a frame, which may tell something of those behind it. */
  hear(event: Framed): void {
    for (const part of this.parts.values()) {
      for (const teller of part.setBy) {
        const listed = teller.message
          ? ofField(teller, event)
          : ofPart(teller.name, event);
        if (listed) this.fresh.set(part.name, listed.length ? listed : [part.default]);
      }
    }
  }
}

/** The number of a part that was sent. */
function ofPart(name: string, { source, parts }: Framed): readonly number[] | null {
  const { shown, told } = source.codec.frame;
  const isTold = told.some((part) => part.name === name);
  const part = isTold ? undefined : shown.find((item) => item.name === name);
  const value = part && parts[part.key];
  return value === undefined || typeof value === "string" ? null : [Number(value)];
}

function ofField(
  teller: { readonly message: string; readonly name: string },
  { message }: Framed,
): readonly number[] | null {
  if (message?.message !== teller.message) return null;
  const value = (message as unknown as Record<string, unknown>)[teller.name];
  if (value === null || value === undefined) return null;
  return Array.isArray(value) ? value.map(Number) : [Number(value)];
}
