/** A sender: its frame, with what is looked up of it. */
import type { JoinedParts, PartValues } from "./events.js";
import type { PartNumber, Value } from "./numbers.js";
import type { Frame, Group, HeldParts, LengthNumber, MessagePlan } from "./plan.js";
import type { NamedMessage, NumberPart, Part, ValueNumber } from "./plan.js";
import { Writer } from "./writer.js";
/** The numbers of parts, those that are bits of others among them. */
export declare function numbersOf(parts: readonly Part[]): readonly NumberPart[];
/** A part of the identity; without a number where it is not sent. */
export interface IdentityPart {
    readonly name: string;
    readonly slot: number;
    readonly number: PartNumber | null;
}
export declare class Sender {
    readonly frame: Frame;
    /** Those of which each identity has one value. */
    private listed;
    private readonly wide;
    private readonly messages;
    /** Parts of the identity, also those that are told. */
    readonly identityParts: readonly IdentityPart[];
    /** Values that callers give. */
    readonly valueParts: readonly ValueNumber[];
    /** How many values each part has that events show. */
    private readonly shownCounts;
    /** Where each part begins without the bytes of the payload, and where the last one ends. */
    readonly offsets: readonly number[];
    /** The same where the payload is empty. */
    readonly offsetsEmpty: readonly number[];
    private readonly slots;
    /** Bytes that complete a start. None where the same literal ends frames. */
    readonly completesStart: Uint8Array<ArrayBuffer>;
    /** A start and an end with nothing between them, which is never a frame. */
    readonly emptyFrame: Uint8Array;
    readonly startSize: number;
    readonly hasWireSum: boolean;
    readonly isFitted: boolean;
    /** The length that tells where a frame ends. */
    readonly length: LengthNumber | null;
    /** The same where it is not sent, and a receiver is told it. */
    readonly toldLength: LengthNumber | null;
    constructor(frame: Frame);
    private list;
    get key(): string;
    /** The identity among the values of a frame. */
    identity(values: readonly (Value | undefined)[]): Value[];
    /** The messages of an identity; undefined where it is unknown. */
    group(values: readonly (Value | undefined)[]): Group | undefined;
    /** The value of a part that is not sent; null where the identity gives it none. */
    virtual(index: number, values: readonly (Value | undefined)[]): Uint8Array | null;
    tailSize(payload: number): number;
    /** The payload's size where the content has that size; -1 if there is none. */
    payloadSize(content: number): number;
    /** What a receiver has to be told of the size of a frame, by its slot. */
    tellSize(values: (Value | undefined)[], payload: number): void;
    /** The parts of a frame that are fields of the message, among the values of the frame. */
    held(message: MessagePlan, values: readonly (Value | undefined)[]): HeldParts;
    /** Bytes that are known of a payload; null where its fields take all of it. */
    private knownOf;
    /** What a frame has of a payload, cut or filled up to its size; null: that varies. */
    fitted(payload: Uint8Array, size: number | null): Uint8Array;
    private leaves;
    /** The message of a frame's payload and values. Throws a Fault. */
    read(group: Group, payload: Uint8Array, values: readonly (Value | undefined)[]): NamedMessage;
    /** The parts that events show, out of one number. */
    separated(joined: JoinedParts): PartValues;
    /** The message called `name`, if the endpoint sends one. */
    named(name: string): MessagePlan | undefined;
}
/** The message of a payload's bytes; `held` has the parts that are fields. Throws a Fault. */
export declare function readPayload<M>(message: MessagePlan<M>, payload: Uint8Array, held?: HeldParts): M;
/** The payload of a message. Throws an EncodeError. */
export declare function writePayload(message: MessagePlan, value: unknown, strict: boolean): Uint8Array;
/**
 * What writes a payload behind so many bytes. It is that of all frames, one after another.
 *
 * With a size, it writes into an array of so many bytes, which are all that it has to write.
 */
export declare function writerOf(strict: boolean, from: number, size?: number): Writer;
/** Throw an EncodeError unless a message can have a payload of so many bytes. */
export declare function checkSize(message: MessagePlan, size: number): void;
/** Bytes at the start of `data` that the message takes. Throws a Fault. */
export declare function prefixSize(message: MessagePlan, data: Uint8Array, held: HeldParts): number;
