/** A frame's content, read as the frame's parts while it comes in. */
import { Fault } from "./errors.js";
import type { Value } from "./numbers.js";
import type { NumberPart } from "./plan.js";
import { type Sender } from "./sender.js";
/** Takes content byte by byte and says what is known of the frame. */
export declare class Content {
    private readonly sender;
    bytes: Uint8Array;
    size: number;
    /** The values of the parts that are known, by their slots. */
    readonly values: (Value | undefined)[];
    /** The part that is due. */
    index: number;
    /** The payload's size; -1 while it is not known. */
    payloadSize: number;
    /** True if the payload has begun, and only what follows will tell its size. */
    isOpen: boolean;
    /** True if all parts are there. */
    isFull: boolean;
    /** Bytes that the content has at most, as soon as that is known; else -1. */
    limit: number;
    /** Wire bytes up to the end of what is stuffed, where the length says that; else -1. */
    regionEnd: number;
    private group;
    private isMeasuring;
    private next;
    private literal;
    private clearBits;
    constructor(sender: Sender, told: readonly (Value | undefined)[]);
    /** Take what was told, before the first byte. Throws a Fault where no frame has it. */
    begin(): void;
    /** Take the next byte. True: a part was completed, and more may be known. */
    accept(byte: number): boolean;
    /** The verdict on a byte behind the content's last one. */
    surplus(): Fault;
    /** Take the end of the content. Throws a Fault where the frame can't end here. */
    close(): void;
    /** Take the end of all content, where the length says that it is. */
    closeCounted(): void;
    private get part();
    /** The reason where there are more or fewer bytes than announced. */
    private get announced();
    /** Begin the next part that has bytes. */
    private enter;
    private isAbsent;
    /** End the part that is due. */
    private leave;
    /** Take the numbers of a part, and then what they tell. */
    private readPart;
    private learn;
    private read;
    private readLength;
    /** Hold another length against the size that the first one told. */
    private agree;
    /** Find the messages of the identity, and what they say about the size. */
    private identify;
    /** Hold the size that the length tells against those of the identity's messages. */
    private compare;
    private setPayload;
    private enterPayload;
    private openPayload;
    /** Try to read a message that nothing delimits but itself. */
    private measure;
    private closeOpen;
}
/** True if a value is one that the part can have. */
export declare function mayBe(part: NumberPart & {
    readonly kind: "value";
}, value: Value): boolean;
