/** What a generated module says of a sender: its frame, as the compiler worked it out. */

import type { FrameMaker } from "./assembly.js";
import type { AtOnce } from "./at_once.js";
import type { Checksum } from "./checksums.js";
import type { Framed, PartValues } from "./events.js";
import type { Counts, GivenParts } from "./given.js";
import type { PartNumber, Value } from "./numbers.js";
import type { Reader } from "./reader.js";
import type { Transparency } from "./transparency.js";
import type { Writer } from "./writer.js";

/** A place in the content of a frame: behind the payload, some bytes are absent if it is empty. */
export interface Place {
  readonly isTail: boolean;
  readonly offset: number;
  readonly absent: number;
}

/** What a checksum runs over: a run of content, literal bytes, or a part that is not sent. */
export type Covered =
  | { readonly from: Place; readonly to: Place; readonly stuffed: boolean }
  | { readonly bytes: Uint8Array }
  | { readonly virtual: number };

interface Named {
  readonly name: string;
  /** Bytes of content. */
  readonly size: number;
  /** True if it is absent where the payload is empty. */
  readonly isOptional?: boolean;
}

interface Numbered {
  readonly name: string;
  readonly number: PartNumber;
  /** Place of its value among those of the frame. */
  readonly slot: number;
}

export interface Literal extends Named {
  readonly kind: "literal";
  readonly bytes: Uint8Array;
}

export interface Payload extends Named {
  readonly kind: "payload";
}

export interface IdentityNumber extends Numbered {
  readonly kind: "identity";
}

/** A number of bytes: for an empty payload `base`, for another one `optional` and its size more. */
export interface LengthNumber extends Numbered {
  readonly kind: "length";
  readonly base: number;
  readonly optional: number;
  readonly least: number;
  readonly greatest: number;
  /** True if it counts stuffed bytes. */
  readonly overWire?: boolean;
  /** True of another length than the one that tells where the frame ends. */
  readonly isFurther?: boolean;
  /** Wire bytes up to the end of what is stuffed, in a frame with the value `base`. */
  readonly regionEnd?: number;
}

/** A number that callers give, within bounds. */
export interface ValueNumber extends Numbered {
  readonly kind: "value";
  readonly least: Value;
  readonly greatest: Value;
  readonly default: Value | null;
  readonly isCounter?: boolean;
  /** Values that it can have, where it is one of several literals. */
  readonly values?: readonly Value[];
  /** The least and the greatest character of a text. */
  readonly between?: string;
  /** True if receivers hold it to its bounds. */
  readonly isHeld?: boolean;
}

export type NumberPart = IdentityNumber | LengthNumber | ValueNumber;

/** A number that is a part. */
export interface Single extends Named {
  readonly kind: "number";
  readonly part: NumberPart;
}

/** A number as a part. */
export function single(part: NumberPart): Single {
  return { kind: "number", name: part.name, size: part.number.size, part };
}

/** Bits that follow from another number. */
export interface Mirror {
  readonly name: string;
  readonly number: PartNumber;
  /** Place of the other number's value. */
  readonly of: number;
  readonly flips: bigint;
}

/** A checksum, which lies in the bits of a part or is one. */
export interface Sum {
  readonly name: string;
  readonly number: PartNumber;
  readonly algorithm: Checksum;
  readonly covers: readonly Covered[];
  readonly overWire?: boolean;
  /** Where the bytes of the part lie that has it. */
  readonly place: Place;
  readonly size: number;
  readonly isOptional?: boolean;
  /** True if it is some bits of a part, from bit `lowest` of the result on. */
  readonly isBits?: boolean;
  readonly lowest: number;
  /** The greatest value of these bits. */
  readonly greatest: number;
}

/** A part that holds a checksum. */
export interface SumPart extends Named {
  readonly kind: "sum";
  /** Index of the checksum among those of the frame. */
  readonly sum: number;
}

/** A number whose bits are parts. */
export interface Bits extends Named {
  readonly kind: "bits";
  readonly number: PartNumber;
  readonly members: readonly NumberPart[];
  readonly mirrors: readonly Mirror[];
  /** Indices of the checksums in its bits. */
  readonly sums: readonly number[];
  readonly mask: bigint;
  readonly fixed: bigint;
}

export type Part = Literal | Payload | Single | SumPart | Bits;

/** An identity part that is not sent. */
export interface Told {
  readonly name: string;
  readonly slot: number;
  readonly default: number;
  readonly bits: number;
  /** True if what was told holds for one frame. */
  readonly once: boolean;
  /** Numbers of frames that tell it: those of a part, or of a message's field. */
  readonly setBy: readonly { readonly message: string; readonly name: string }[];
  /** What it is where it tells the size of frames, not what they are. */
  readonly length: LengthNumber | null;
}

/** Values of each identity part: runs from the first to the last. */
export type Runs = readonly (readonly (readonly [Value, Value])[])[];

/** A part that goes into checksums and is not sent. */
export interface Virtual {
  readonly name: string;
  readonly number: PartNumber;
  readonly values: readonly { readonly identities: Runs; readonly value: Value }[];
  readonly default: Value | null;
}

/** A part that events show. */
export interface Shown {
  readonly name: string;
  /** The name in generated code. */
  readonly key: string;
}

/** Sizes in bytes: `least`, `least + step`, ... up to `greatest`; a step of 0 is one size. */
export interface Sizes {
  readonly least: number;
  readonly greatest: number;
  readonly step: number;
}

/** Values of parts of the frame that are fields of a message, by the names of the parts. */
export type HeldParts = Readonly<Record<string, Value>>;

/** What an object has of its own by a name: every object inherits a `constructor`, for example. */
export function ownOf<T>(given: Readonly<Record<string, T>>, name: string): T | undefined {
  return Object.prototype.hasOwnProperty.call(given, name) ? given[name] : undefined;
}

/** None of them. */
export const NO_PARTS: HeldParts = {};

/** A message: an object with its name. */
export interface NamedMessage {
  readonly message: string;
}

/** A message: how its payload is read and written. */
export interface MessagePlan<M = NamedMessage> {
  readonly name: string;
  readonly identities: Runs;
  readonly sizes: Sizes;
  /** Bytes that are known of a payload; null where its fields say how long it is. */
  readonly known: number | null;
  /** True if its size varies, and its fields say where they end. */
  readonly tellsItsEnd: boolean;
  /** Parts of the frame that are fields; payloads have no bytes of them. */
  readonly held: readonly string[];
  readonly read: (reader: Reader) => M;
  readonly write: (writer: Writer, message: never) => void;
}

/**
 * The plan of a message of one size, or of sizes from the least to the greatest in steps.
 *
 * Without `more`, it has no parts of the frame as fields, and what is known of it is its one size.
 */
export function plan<M>(
  name: string,
  identities: Runs,
  [least, greatest = least, step = 0]: readonly [number, number?, number?],
  read: (reader: Reader) => M,
  write: (writer: Writer, message: never) => void,
  more: Partial<Pick<MessagePlan, "known" | "tellsItsEnd" | "held">> = {},
): MessagePlan<M> {
  const sizes = { least, greatest, step };
  const { known = step ? null : least, tellsItsEnd = false, held = [] } = more;
  return { name, identities, sizes, known, tellsItsEnd, held, read, write };
}

/** The messages behind one identity, in the order in which they are tried. */
export interface Group {
  readonly identities: Runs;
  readonly messages: readonly MessagePlan[];
  /** The payload's size, where no message and no frame has another one. */
  readonly fixed: number | null;
  readonly greatest: number;
  /** Sizes in which frames carry each of the messages. */
  readonly carried: readonly Sizes[];
}

/** A group; without `more`, its identities and the sizes in frames are those of its messages. */
export function group(
  messages: readonly MessagePlan[],
  more: { readonly identities?: Runs; readonly carried?: readonly Sizes[] } = {},
): Group {
  const { identities = messages[0]!.identities } = more;
  const { carried = messages.map((message) => message.sizes) } = more;
  const [{ least }] = carried as readonly [Sizes];
  const isFixed = carried.every((sizes) => sizes.least === least && sizes.greatest === least);
  const greatest = Math.max(...messages.map((message) => message.sizes.greatest));
  return { identities, messages, fixed: isFixed ? least : null, greatest, carried };
}

/** Takes the frame that stands at a place; null where it is not plainly one. Throws a Fault. */
export type TakeWhole = (frames: AtOnce, at: number) => Framed | null;

/** Puts a frame around the payload that was written; null where it is not plainly one. */
export type PutTogether = (
  maker: FrameMaker,
  writer: Writer,
  given: GivenParts,
  counts: Counts | null,
) => Uint8Array | null;

/** A sender's frame. Sizes are in bytes; content is what is there before any stuffing. */
export interface Frame {
  /** The endpoint. */
  readonly sender: string;
  /** Form of its frames; empty where it has one. */
  readonly form: string;
  /** All parts but the end literals. */
  readonly parts: readonly Part[];
  readonly payloadIndex: number;
  readonly headSize: number;
  readonly tailSize: number;
  readonly tailSizeEmpty: number;
  readonly slots: number;
  /** Slots of the identity parts, those that are told first. */
  readonly identity: readonly number[];
  /** Slot of the last identity part that is sent; -1 if there is none. */
  readonly lastIdentity: number;
  readonly identityIsEarly: boolean;
  readonly told: readonly Told[];
  readonly virtual: readonly Virtual[];
  readonly shown: readonly Shown[];
  /** The same of a frame with such values, by their slots. */
  readonly partsOf: (values: readonly (Value | undefined)[]) => PartValues;
  readonly sums: readonly Sum[];
  readonly start: "word" | "after_end" | "anywhere";
  /** What a frame starts with; of one size. */
  readonly startWords: readonly Uint8Array[];
  /** The start literal; empty where something else marks the start. */
  readonly startBytes: Uint8Array;
  readonly startIsUnique: boolean;
  readonly end: Uint8Array;
  readonly endIsUnique: boolean;
  /** True if the end of a frame may also be the start of the next. */
  readonly sharesDelimiter: boolean;
  /** Bytes in front of a frame that no end is looked for in. */
  readonly markSize: number;
  /** True if a silence ends a frame, and no byte. */
  readonly endsIdle: boolean;
  readonly transparency: Transparency | null;
  /** Indices of the first and the last stuffed part; -1 where there is none. */
  readonly firstStuffed: number;
  readonly lastStuffed: number;
  /** Bytes between what is stuffed and the end. */
  readonly behindRegion: number;
  readonly least: number;
  readonly greatest: number;
  readonly givenUpAt: number;
  readonly greatestPayload: number;
  readonly sevenBit: boolean;
  readonly rescans: boolean;
  /** True if a frame that stands in the input can be taken as a whole. */
  readonly takesWhole: boolean;
  /** What takes a frame that is there as a whole; null where nothing is generated for that. */
  readonly whole: TakeWhole | null;
  /** What makes a frame in one go; null where nothing is generated for that. */
  readonly put: PutTogether | null;
  readonly cutAmbiguous: boolean;
  readonly isBounded: boolean;
  /** Bytes that stay, at least, where zeros at the payload's end are left out; else null. */
  readonly kept: number | null;
  /** True if receivers leave what is behind the bytes of a payload that they know. */
  readonly isCut: boolean;
  readonly groups: readonly Group[];
  /** Messages that no decoder yields, as nothing tells them from others. */
  readonly encodeOnly: readonly MessagePlan[];
}

/** What is so of most frames. */
const USUAL = {
  form: "",
  startIsUnique: false,
  endIsUnique: false,
  sharesDelimiter: false,
  endsIdle: false,
  sevenBit: false,
  rescans: false,
  takesWhole: false,
  whole: null,
  put: null,
  cutAmbiguous: false,
  isBounded: false,
  isCut: false,
  identityIsEarly: false,
  told: [],
  virtual: [],
  shown: [],
  sums: [],
  groups: [],
  transparency: null,
  kept: null,
  encodeOnly: [],
};

/** A frame, of which is said what is not so of most. */
export function frame(given: Partial<Frame> & Omit<Frame, keyof typeof USUAL>): Frame {
  return { ...USUAL, ...given };
}

/** The place in the content of a frame with such a payload. */
export function at(place: Place, headSize: number, payload: number): number {
  if (!place.isTail) return place.offset;
  return headSize + payload + place.offset - (payload ? 0 : place.absent);
}

export function holds(sizes: Sizes, size: number): boolean {
  if (size < sizes.least || size > sizes.greatest) return false;
  return sizes.step === 0 || (size - sizes.least) % sizes.step === 0;
}

/** True if the values are some of these identities. */
export function areAmong(identities: Runs, values: readonly Value[]): boolean {
  return identities.every((runs, index) => {
    const value = values[index]!;
    return runs.some(([first, last]) => first <= value && value <= last);
  });
}
