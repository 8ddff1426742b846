/**
 * One possible frame, taken byte by byte until it is complete or proves to be none.
 *
 * A candidate starts where a frame may start. It decides as early as the bytes allow, and looks at
 * nothing but them, so that it does not matter how they arrive.
 */
import { Fault } from "./errors.js";
import type { Value } from "./numbers.js";
import { type Sum } from "./plan.js";
import type { Sender } from "./sender.js";
/** A complete frame whose length and checksums are right. */
export declare class Cut {
    readonly size: number;
    readonly values: (Value | undefined)[];
    readonly payload: Uint8Array;
    constructor(size: number, values: (Value | undefined)[], payload: Uint8Array);
}
/** The first `size` bytes of a candidate, which are no frame. */
export declare class Failure {
    readonly size: number;
    readonly fault: Fault;
    constructor(size: number, fault: Fault);
}
export type Verdict = Cut | Failure;
/** Values that a receiver was told, by their slots. */
export type ToldValues = readonly (Value | undefined)[];
export declare const NOTHING_TOLD: ToldValues;
/** A possible frame of one sender. Of no use after its verdict. */
export declare class Candidate {
    readonly sender: Sender;
    private wire;
    private wireSize;
    /** Bytes in front that are those of the frame before. */
    private shared;
    /** Bytes at the end that are not the candidate's own. */
    private behind;
    private readonly content;
    private cut;
    /** Delimiters that are looked for; bytes that may begin one are held back. */
    private delimiters;
    private held;
    /** Bytes still to come of an end that stands in a known place. */
    private endLeft;
    /** True if the next start ends the frame, and nothing else does. */
    private endsAtStart;
    /** Place on the wire where the payload of such a frame begins. */
    private openFrom;
    private regionBegun;
    private unstuffer;
    /** Bytes that were released together with the one that is taken. */
    private waiting;
    /** Wire bytes still to come of a region that holds nothing. */
    private emptyLeft;
    /** Wire bytes that were taken as content or stuffing. */
    private passed;
    /** As many as were passed, for each byte of content. */
    private readonly wireEnds;
    private refused;
    /** With `sharesStart`, the end of the frame before is also this one's start. */
    constructor(sender: Sender, told: ToldValues, sharesStart?: boolean);
    /** Bytes of content so far. */
    get contentSize(): number;
    /** True if the bytes so far begin with what marks a start. */
    get beginsWithStart(): boolean;
    /** Take the next byte. Null: the candidate needs more. */
    push(byte: number): Verdict | null;
    /** Take the end of the input, or a silence. */
    flush(): Verdict;
    private get ownSize();
    private take;
    /** The size of a start that the wire ends with and that ends this candidate, or 0. */
    private startInside;
    private meetStart;
    private isEmpty;
    private rejectEmpty;
    /** Look for the delimiter; let pass what can't begin it. */
    private search;
    private isBegun;
    private matchEnd;
    private closeAtFlush;
    /** End the frame here, whatever is known of its size. */
    private close;
    /** Take a byte that begins no delimiter. */
    private pass;
    /** Do what is due where the length says that something ends. */
    private reach;
    private unstuff;
    private accept;
    /** Do what is due between two parts. */
    private cross;
    /** From now on only a delimiter, or a silence, can tell where the frame ends. */
    private open;
    private meetFull;
    private crossRegion;
    /** End the region. What was held back until now is content, or a surplus of it. */
    private finishRegion;
    private complete;
    private check;
    /** The bytes of something that a checksum runs over. */
    private covered;
}
/** The value of a checksum, where the algorithm has this result. */
export declare function dueOf(sum: Sum, result: number | bigint): number | bigint;
/** True if the bytes at a place are those of a checksum with this result. */
export declare function sumIsRight(sum: Sum, result: number | bigint, bytes: Uint8Array, place: number): boolean;
/** The verdict on a candidate that is the whole input, and the offset of the byte that gave it. */
export declare function verdictOn(sender: Sender, data: Uint8Array, told: ToldValues): readonly [Verdict, number];
