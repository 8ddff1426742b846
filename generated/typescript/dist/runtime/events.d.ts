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
export type Event<Message = unknown, Parts = unknown> = MessageEvent<Message, Parts> | UnknownEvent<Parts> | InvalidEvent;
/** Bytes that came in, which nobody changes, and what reads them. Many events have the same. */
export declare class Source {
    /** What knows the frames. */
    readonly codec: Sender;
    readonly data: Uint8Array;
    /** Of the first of these bytes, counted from the start of the input. */
    readonly offset: number;
    constructor(
    /** What knows the frames. */
    codec: Sender, data: Uint8Array, 
    /** Of the first of these bytes, counted from the start of the input. */
    offset: number);
    /** The bytes that an event covers. */
    raw({ offset, size }: {
        readonly offset: number;
        readonly size: number;
    }): Uint8Array;
}
/** Values of the parts of a frame that events show. */
export type PartValues = Readonly<Record<string, Value | undefined>>;
/** The same in one number, each part above those behind it. */
export type JoinedParts = number;
/** A valid frame. What is seldom asked for is looked up then, so that there is less of each. */
export declare class Framed {
    readonly offset: number;
    readonly size: number;
    readonly source: Source;
    private readonly shown;
    readonly message: NamedMessage | null;
    constructor(offset: number, size: number, source: Source, shown: PartValues | JoinedParts, message: NamedMessage | null);
    get parts(): PartValues;
    get kind(): "message" | "unknown";
    get raw(): Uint8Array;
    get sender(): string;
    get form(): string;
}
/** A valid frame whose identity belongs to no message. */
export declare class UnknownFrame extends Framed {
    readonly payload: Uint8Array;
    constructor(offset: number, size: number, source: Source, parts: PartValues, payload: Uint8Array);
}
/** Bytes that are no frame. */
export declare class Invalid {
    readonly offset: number;
    readonly size: number;
    private readonly source;
    readonly sender: string;
    readonly reason: Reason;
    readonly problem: string;
    readonly kind = "invalid";
    constructor(offset: number, size: number, source: Source, sender: string, reason: Reason, problem: string);
    get raw(): Uint8Array;
}
export type AnyEvent = Framed | Invalid;
/** The event of a complete frame, with the message of its payload. Throws a Fault. */
export declare function framed(source: Source, offset: number, { size, values, payload }: Cut): Framed;
