/** The codec of a protocol: encode, decode, and an encoder that counts. */
import { type Framed } from "./events.js";
import { type GivenParts } from "./given.js";
import type { Frame, NamedMessage } from "./plan.js";
import { Sender } from "./sender.js";
import { type Telling } from "./told.js";
/** Choices of an encoder. */
export interface EncodeOptions<Parts = GivenParts, Name extends string = string> {
    /** The endpoint; needed where several send the message in different frames. */
    readonly sender?: Name | undefined;
    /** The form of the frame. Without it, the first that fits is taken. */
    readonly form?: string | undefined;
    /** False: take whatever fits the wire, also values that the schema forbids. */
    readonly strict?: boolean | undefined;
    /** Counters and other values of the frame. */
    readonly parts?: Parts | undefined;
}
/** Choices of `decode`. */
export interface DecodeOptions<Name extends string = string> {
    /** The endpoint that sent the frame. Without it, any may have. */
    readonly sender?: Name | undefined;
    /** Identities that are not sent, by the names of their parts. */
    readonly told?: Readonly<Record<string, Telling | undefined>> | undefined;
}
/** The senders of a protocol. */
export declare class Protocol {
    /** Give the frame of each sender; they are asked when one is first needed. */
    private readonly frames;
    /** Names of the senders whose frames are alike, so that any may stand for the others. */
    private readonly alike;
    private kept;
    private readonly chosen;
    /** The one that was chosen last, and most often is chosen again. */
    private recent;
    constructor(
    /** Give the frame of each sender; they are asked when one is first needed. */
    frames: readonly (() => Frame)[], 
    /** Names of the senders whose frames are alike, so that any may stand for the others. */
    alike: readonly (readonly string[])[]);
    private get made();
    /** An endpoint as a sender, in each form of its frames. Throws a RangeError. */
    senders(name?: string): readonly Sender[];
    /** The event of exactly one frame. Throws a DecodeError. */
    read(frame: Uint8Array, options?: DecodeOptions): Framed;
    /** The message of exactly one frame. Throws a DecodeError. Modules know its type. */
    decode(frame: Uint8Array, options?: DecodeOptions): any;
    /** The frame of a message. Throws an EncodeError. */
    encode(message: NamedMessage, options?: EncodeOptions<object>): Uint8Array;
    private maker;
    /** The same of a message that was not made with these options last. Throws an EncodeError. */
    private another;
    /** An endpoint that sends a message, in the forms that carry it. Throws an EncodeError. */
    private choose;
}
/** Makes the frames of one endpoint, one after another, and advances their counters. */
export declare class Encoder<Message extends NamedMessage = NamedMessage, Parts = GivenParts> {
    private readonly senders;
    private readonly counts;
    /** By the names of messages. */
    private readonly known;
    constructor(protocol: Protocol, sender: string);
    /**
     * The frame of a message, with the next value of each counter that `parts` does not give.
     *
     * A given value is used once and does not change the count, nor does an EncodeError.
     */
    encode(message: Message, options?: Omit<EncodeOptions<Parts>, "sender">): Uint8Array;
    private maker;
}
