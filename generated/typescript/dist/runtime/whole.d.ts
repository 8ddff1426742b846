/**
 * Frames that are plainly in order, taken as they come in, without a candidate.
 *
 * Whatever is not plain is left to a candidate, which looks at it byte by byte and knows the reason.
 * So what is waited for here, a candidate would wait for as well.
 */
import { Framed, type Source } from "./events.js";
import { type Sender } from "./sender.js";
/** Takes frames of one sender, as far as they have come in. */
export declare class WholeFrames {
    readonly sender: Sender;
    /** True if all that has come of the frame is in order, and more has to come. */
    isWaiting: boolean;
    private readonly head;
    /** What each checksum runs over, where that is one run. */
    private readonly runs;
    /** Bytes of content in front of what is stuffed. */
    private readonly before;
    /** Content where some of it is stuffed. */
    private readonly scratch;
    /** Bytes that the search for starts has compared. */
    private readonly found;
    private readonly frame;
    private readonly transparency;
    private readonly reader;
    /** Bytes that may end a start or an end inside the frame, or have the bit that no payload has. */
    private readonly marks;
    /** Bytes on the wire that are in order. */
    private place;
    /** Bytes of content that are there. */
    private filled;
    /** Bytes on the wire in which nothing stands that would end the frame. */
    private clear;
    /** Parts in front of the payload that are in order. */
    private passed;
    /** Bytes of the payload; -1 while that is not known. */
    private payload;
    private unstuffer;
    private values;
    private group;
    private constructor();
    /** What takes the frames of a sender; null where the frame does not allow that. */
    static of(sender: Sender): WholeFrames | null;
    /** Begin another frame. */
    begin(): void;
    /** The event of the frame there; null: it is not all there yet, or a candidate has to look. */
    take(source: Source, size: number, at: number): Framed | null;
    /** The place behind the frame; -1 where it is not all there, or not plainly one. */
    private reach;
    /** The same where the end has to tell the size. */
    private reachEnd;
    /** The place behind the end, which has to stand here. */
    private behind;
    private wait;
    /** True if nothing stands in the bytes up to a place that would end the frame. */
    private isClear;
    /** True if a frame that ends behind the place `behind` can't have this byte there. */
    private isEnded;
    /** Take content until so much is there. False: more has to come. */
    private fill;
    /** Take content up to the end of what is stuffed. */
    private unstuff;
    /** Take the end of what is stuffed, and what was held back. Throws a Fault. */
    private closeRegion;
    /** Take content that is not stuffed. */
    private copy;
    /** Read the parts in front of the payload that are there. False: one is not plainly right. */
    private readHead;
    /** True if what is there of a literal is right. */
    private begins;
    /** The payload's size where the length has such a value; -1 where no frame has it. */
    private measured;
    /** The payload's size: by a length, or by the identity; -1 if neither tells it plainly. */
    private payloadSize;
    /** The event of the frame; null where it is not right. Throws a Fault. */
    private event;
    private isRight;
    private covered;
}
