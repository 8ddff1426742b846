/** Frames from their parts: what is always the same, and what each frame has anew. */
import { GivenPart, type Counts, type GivenParts } from "./given.js";
import { Layout, type Values } from "./layout.js";
import type { Value } from "./numbers.js";
import type { MessagePlan } from "./plan.js";
import { type Sender } from "./sender.js";
import type { Writer } from "./writer.js";
/** What makes the frames of a sender, one after another. */
declare class Assembly {
    readonly sender: Sender;
    readonly full: Layout;
    readonly empty: Layout;
    /** Values of the parts of the frame that is made. */
    readonly values: Values;
    readonly parts: readonly GivenPart[];
    private readonly makers;
    constructor(sender: Sender);
    maker(message: MessagePlan): FrameMaker;
    /**
     * Set the values of a frame to what callers give, and to what is usual where they give nothing.
     *
     * True if they give an identity. Throws an EncodeError.
     */
    take(identity: readonly Value[], given: GivenParts, strict: boolean, counts: Counts | null): boolean;
    /** The same of what callers give of the identity; nothing else is left. */
    private takeIdentity;
    /** The frame around a payload of so many bytes, which was written. Throws an EncodeError. */
    wire(writer: Writer, size: number): Uint8Array;
    /** Throw an EncodeError unless a decoder takes exactly these bytes for the frame. */
    check(wire: Uint8Array, payload: Uint8Array): void;
}
/** Makes the frames of a message. */
export declare class FrameMaker {
    private readonly assembly;
    private readonly message;
    /** The first identity of the message. */
    private readonly values;
    /** True if a decoder could take a frame for another one. */
    private readonly isDoubtful;
    /** Bytes of every frame, where all have as many and none are stuffed; else 0. */
    private readonly size;
    /** Where every payload ends, where all have as many bytes; else -1. */
    private readonly end;
    /** Where a payload may end whose zeros at the end are left out; far away where none are. */
    private readonly kept;
    /** What makes a frame in one go, if all that has to be known is in it. */
    private readonly put;
    private readonly headSize;
    /** What the length is without a payload, and its bounds in frames of one. */
    private readonly base;
    private readonly least;
    private readonly greatest;
    constructor(assembly: Assembly, message: MessagePlan);
    get sender(): Sender;
    /**
     * The frame of a message with the values of parts that callers give.
     *
     * Counters that they do not give are those of `counts`, which go on. Throws an EncodeError.
     */
    make(value: unknown, given: GivenParts, strict: boolean, counts?: Counts | null): Uint8Array;
    /** The frame around a payload, by the description of the frame. Throws an EncodeError. */
    private described;
    /** An identity. */
    identity(index: number): number;
    /** The length of a frame whose payload ends there; -1 where it can't be. */
    length(end: number): number;
    /** The value of a part where callers give none. */
    usual(index: number, counts: Counts | null): Value | null;
    /** A value that is a number in these bounds; -1 of another one. */
    number(value: unknown, least: number, greatest: number): number;
    /** The checksum of some bytes. */
    sum(bytes: Uint8Array, from: number, to: number): number;
    /** The frame of content whose payload ends there, with its region stuffed. */
    stuffed(writer: Writer, end: number): Uint8Array;
    /** True if a decoder could take a frame of a given identity for another one. */
    private checkIdentity;
}
/** What makes the frames of a message that the sender sends. */
export declare function makerOf(sender: Sender, message: MessagePlan): FrameMaker;
/** The frame of an unknown message, whose identity is given. Throws an EncodeError. */
export declare function unknownFrameOf(sender: Sender, payload: Uint8Array, given: GivenParts): Uint8Array;
export {};
