/**
 * Frames that stand in the input as a whole and are plainly in order, taken without a candidate.
 *
 * Whatever is not plain is left to a candidate, which looks at it byte by byte and knows the reason.
 */
import { Framed } from "./events.js";
import type { Sender } from "./sender.js";
/** Takes whole frames of one sender. */
export declare class WholeFrames {
    private readonly sender;
    private readonly literals;
    private readonly numbers;
    /** Bytes of content in front of what is stuffed. */
    private readonly before;
    private readonly scratch;
    private readonly reader;
    private values;
    private group;
    private constructor();
    /** What takes the frames of a sender; null where the frame does not allow that. */
    static of(sender: Sender): WholeFrames | null;
    /** The event of the frame there; null: a candidate has to look. */
    take(data: Uint8Array, size: number, at: number, offset: number): Framed | null;
    /** The event of a frame that is right. Throws a Fault where its payload is no message's. */
    private event;
    private find;
    private plain;
    /** The same where some of it is stuffed. */
    private stuffed;
    /** Read the parts in front of the payload. False: they are not plainly those of a frame. */
    private readHead;
    /** The payload's size: by a length, or by the identity, or by all content; -1 if none is plain. */
    private payloadSize;
    /** True if a start stands inside that would end the frame. */
    private startsInside;
    private isRight;
    private covered;
}
