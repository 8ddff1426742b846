/**
 * Frames that are there as a whole, taken by the function that is generated for them.
 *
 * It has the places and bounds of a frame as constants, and takes none that is odd in any way: for
 * these, and for frames in pieces, there are others.
 */
import { Framed, Source, type JoinedParts } from "./events.js";
import type { Group, NamedMessage, TakeWhole } from "./plan.js";
import { Reader } from "./reader.js";
import type { Sender } from "./sender.js";
/** A place in some input, for a generated function. Its methods say if all is well so far. */
export declare class AtOnce {
    readonly sender: Sender;
    private readonly whole;
    /** What came in. */
    data: Uint8Array;
    /** The bytes of it that are there. */
    size: number;
    /** Content without its stuffing; what came in where nothing is stuffed. */
    content: Uint8Array;
    /** The same, for numbers of several bytes. */
    view: DataView;
    private at;
    private source;
    private readonly isStuffed;
    private readonly reader;
    private readonly frame;
    private readonly near;
    private readonly frames;
    private readonly givenUpAt;
    constructor(sender: Sender, whole: TakeWhole);
    /** Take frames from a start on, one behind another; the place behind the last one. */
    take(source: Source, size: number, start: number, events: unknown[]): number;
    /** True if nothing stands there that may begin another frame or end this one. */
    isClear(from: number, to: number): boolean;
    /** True if the bytes have their most significant bits clear. */
    isSevenBit(from: number, to: number): boolean;
    /** The checksum of bytes. */
    sum(index: number, from: number, to: number): number | bigint;
    /** The message of an identity, which is the number of all its parts; undefined: look further. */
    known(identity: number): Known | undefined;
    /** The event of the frame up to a place, with such a payload. Throws a Fault. */
    event(parts: JoinedParts, known: Known | undefined, from: number, to: number, behind: number): Framed | null;
}
/** A message that needs nothing but its payload. */
declare class Known {
    readonly read: (reader: Reader) => NamedMessage;
    /** The payload's size, where it has no other one. */
    readonly fixed: number | null;
    private readonly sizes;
    constructor(group: Group);
    /** True if a frame carries so many bytes of it. */
    holds(size: number): boolean;
}
/** The bytes that may end a start or an end inside a frame. */
export declare function marksOf({ frame, completesStart }: Sender): Uint8Array;
export {};
