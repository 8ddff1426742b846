/** Events of a decoder: each covers some bytes of the input, and all of them cover all of it. */

import type { Cut } from "./candidate.js";
import type { Reason } from "./errors.js";
import type { Value } from "./numbers.js";
import type { NamedMessage } from "./plan.js";
import type { Sender } from "./sender.js";

/** A valid frame of a known message. */
export interface MessageEvent<Message = unknown, Parts = unknown> {
  readonly kind: "message";
  /** Of the first byte, counted from the start of the input. */
  readonly offset: number;
  /** Bytes on the wire. */
  readonly size: number;
  /** The bytes on the wire. */
  readonly raw: Uint8Array;
  /** The endpoint whose bytes are decoded. */
  readonly sender: string;
  /** The form of the frame; empty where the endpoint has only one. */
  readonly form: string;
  /** The frame's identity, counters and values. */
  readonly parts: Parts;
  readonly message: Message;
}

/** A valid frame whose identity belongs to no message. */
export interface UnknownEvent<Parts = unknown> {
  readonly kind: "unknown";
  readonly offset: number;
  readonly size: number;
  readonly raw: Uint8Array;
  readonly sender: string;
  readonly form: string;
  readonly parts: Parts;
  readonly payload: Uint8Array;
}

/** Bytes that are no frame. */
export interface InvalidEvent {
  readonly kind: "invalid";
  readonly offset: number;
  readonly size: number;
  readonly raw: Uint8Array;
  /** The endpoint whose bytes are decoded; empty where there are several. */
  readonly sender: string;
  readonly reason: Reason;
  /** The reason in more words. */
  readonly problem: string;
}

/** What a decoder yields. */
export type Event<Message = unknown, Parts = unknown> =
  | MessageEvent<Message, Parts>
  | UnknownEvent<Parts>
  | InvalidEvent;

/** Bytes that came in, which nobody changes, and what reads them. Many events have the same. */
export class Source {
  constructor(
    /** What knows the frames. */
    readonly codec: Sender,
    readonly data: Uint8Array,
    /** Of the first of these bytes, counted from the start of the input. */
    readonly offset: number,
  ) {}

  /** The bytes that an event covers. */
  raw({ offset, size }: { readonly offset: number; readonly size: number }): Uint8Array {
    const start = offset - this.offset;
    return this.data.subarray(start, start + size);
  }
}

/** Values of the parts of a frame that events show. */
export type PartValues = Readonly<Record<string, Value | undefined>>;

/** The same in one number, each part above those behind it. */
export type JoinedParts = number;

/** A valid frame. What is seldom asked for is looked up then, so that there is less of each. */
export class Framed {
  constructor(
    readonly offset: number,
    readonly size: number,
    readonly source: Source,
    private readonly shown: PartValues | JoinedParts,
    readonly message: NamedMessage | null,
  ) {}

  get parts(): PartValues {
    const { shown } = this;
    return typeof shown === "number" ? this.source.codec.separated(shown) : shown;
  }

  get kind(): "message" | "unknown" {
    return this.message ? "message" : "unknown";
  }

  get raw(): Uint8Array {
    return this.source.raw(this);
  }

  get sender(): string {
    return this.source.codec.frame.sender;
  }

  get form(): string {
    return this.source.codec.frame.form;
  }
}

/** A valid frame whose identity belongs to no message. */
export class UnknownFrame extends Framed {
  constructor(
    offset: number,
    size: number,
    source: Source,
    parts: PartValues,
    readonly payload: Uint8Array,
  ) {
    super(offset, size, source, parts, null);
  }
}

/** Bytes that are no frame. */
export class Invalid {
  readonly kind = "invalid";

  constructor(
    readonly offset: number,
    readonly size: number,
    private readonly source: Source,
    readonly sender: string,
    readonly reason: Reason,
    readonly problem: string,
  ) {}

  get raw(): Uint8Array {
    return this.source.raw(this);
  }
}

export type AnyEvent = Framed | Invalid;

/** The event of a complete frame, with the message of its payload. Throws a Fault. */
export function framed(source: Source, offset: number, { size, values, payload }: Cut): Framed {
  const { codec } = source;
  const parts = codec.frame.partsOf(values);
  const group = codec.group(values);
  if (!group) return new UnknownFrame(offset, size, source, parts, payload);
  return new Framed(offset, size, source, parts, codec.read(group, payload, values));
}
