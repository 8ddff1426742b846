/** A sender: its frame, with what is looked up of it. */
import type { Value } from "./numbers.js";
import type { Frame, Group, HeldParts, LengthNumber, MessagePlan } from "./plan.js";
import type { NumberPart, Part } from "./plan.js";
/** The numbers of parts, those that are bits of others among them. */
export declare function numbersOf(parts: readonly Part[]): readonly NumberPart[];
export declare class Sender {
    readonly frame: Frame;
    private readonly listed;
    private readonly wide;
    private readonly slots;
    /** Bytes that complete a start. None where the same literal ends frames. */
    readonly completesStart: Uint8Array<ArrayBuffer>;
    /** A start and an end with nothing between them, which is never a frame. */
    readonly emptyFrame: Uint8Array;
    readonly startSize: number;
    readonly hasWireSum: boolean;
    /** The length that tells where a frame ends. */
    readonly length: LengthNumber | null;
    /** The same where it is not sent, and a receiver is told it. */
    readonly toldLength: LengthNumber | null;
    constructor(frame: Frame);
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
    get isFitted(): boolean;
    /** The parts of a frame that are fields of the message, among the values of the frame. */
    held(message: MessagePlan, values: readonly (Value | undefined)[]): HeldParts;
    /** Bytes that are known of a payload; null where its fields take all of it. */
    private knownOf;
    /** What a frame has of a payload, cut or filled up to its size; null: that varies. */
    fitted(payload: Uint8Array, size: number | null): Uint8Array;
    private leaves;
    /** The message of a frame's payload and values, and its plan. Throws a Fault. */
    read(group: Group, payload: Uint8Array, values: readonly (Value | undefined)[]): readonly [MessagePlan, unknown];
    /** The bytes of a message's payload that an encoder puts into a frame. */
    trimmed(payload: Uint8Array): Uint8Array;
    /** The message called `name`, if the endpoint sends one. */
    named(name: string): MessagePlan | undefined;
}
/** The message of a payload's bytes; `held` has the parts that are fields. Throws a Fault. */
export declare function readPayload(message: MessagePlan, payload: Uint8Array, held?: HeldParts): unknown;
/** The payload of a message. Throws an EncodeError. */
export declare function writePayload(message: MessagePlan, value: unknown, strict: boolean): Uint8Array;
/** The payload of a message, and its fields that are parts. Throws an EncodeError. */
export declare function payloadOf(message: MessagePlan, value: unknown, strict: boolean): {
    readonly payload: Uint8Array;
    readonly held: HeldParts;
};
/** Bytes at the start of `data` that the message takes. Throws a Fault. */
export declare function prefixSize(message: MessagePlan, data: Uint8Array, held: HeldParts): number;
