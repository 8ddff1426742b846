/** The search for frames: where one may start, and what judges what begins there. */
import { type Verdict } from "./candidate.js";
import type { Sender } from "./sender.js";
import { type Starts } from "./starts.js";
import { Told } from "./told.js";
/** A possible frame of one sender, or of one of several. */
export interface Judge {
    /** The sender that the verdict is about. */
    readonly sender: Sender;
    push(byte: number): Verdict | null;
    flush(): Verdict;
}
/** A place in the first `size` bytes of some data. */
export interface Spot {
    readonly data: Uint8Array;
    readonly size: number;
    readonly place: number;
    /** True if nothing has come in front of it. */
    readonly isFresh: boolean;
}
/** Search for the frames of one sender, or of several forms at once. */
export declare class Search {
    readonly senders: readonly Sender[];
    readonly starts: Starts;
    readonly told: Told;
    private readonly each;
    /** Throws a RangeError where the frames are found in different ways. */
    constructor(senders: readonly Sender[]);
    /** What begins there. */
    candidate(spot: Spot): Judge;
    /** What begins with the end of the frame before. */
    sharing(): Judge;
}
