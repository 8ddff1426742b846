/**
 * Frames without rare things, put together around their payload in one go.
 *
 * What is always the same is made once for each message. Whatever is odd is left to a layout, which
 * knows all frames, and what is wrong with one.
 */
import { type Counts, type GivenPart, type GivenParts } from "./given.js";
import type { Value } from "./numbers.js";
import type { Sender } from "./sender.js";
import type { Writer } from "./writer.js";
/** Puts the frames of a message together. */
export declare class PlainFrame {
    private readonly parts;
    /** What stands in front of the payload, and behind it up to the end of the frame. */
    private readonly head;
    private readonly tail;
    /** Where the parts lie whose values callers give. */
    private readonly spots;
    private readonly length;
    /** What the length is without a payload, and its bounds. */
    private readonly base;
    private readonly least;
    private readonly greatest;
    private readonly sum;
    private readonly frame;
    /** Where the stuffed bytes begin, and how many there are between the payload and their end. */
    private readonly stuffed;
    private readonly stuffedBehind;
    private constructor();
    /** What puts the frames of a message with that identity together; null: there are rare things. */
    static of(sender: Sender, parts: readonly GivenPart[], identity: readonly Value[]): PlainFrame | null;
    /** The frame around the payload that was written; null where something is odd. */
    around(writer: Writer, given: GivenParts, counts: Counts | null): Uint8Array | null;
    /** The frame with its region stuffed and summed up by a printed function. */
    private stuff;
    /** Put the values of parts in their places. False: callers give something odd. */
    private takes;
    /** Put the length in its place. False: no frame has such a payload. */
    private measures;
}
