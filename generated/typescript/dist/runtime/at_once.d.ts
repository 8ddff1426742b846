/**
 * Frames that are there as a whole, taken by the function that is generated for them.
 *
 * It has the places and bounds of a frame as constants, and takes none that is odd in any way: for
 * these, and for frames in pieces, there are others.
 */
import { Framed } from "./events.js";
import type { Value } from "./numbers.js";
import type { Group, TakeWhole } from "./plan.js";
import type { Sender } from "./sender.js";
/** A place in some input, for a generated function. Its methods say if all is well so far. */
export declare class AtOnce {
    private readonly sender;
    private readonly whole;
    /** What came in, from the first byte of the frame on. */
    view: DataView;
    /** What is taken of a frame where it is stuffed. */
    readonly content: DataView;
    private data;
    private size;
    private at;
    private offset;
    /** Place in the input behind the bytes that are taken. */
    private place;
    /** Bytes of content that are taken off. */
    private filled;
    /** Content where it is stuffed, and what came in where it is not. */
    private bytes;
    private readonly steps;
    private readonly scratch;
    private readonly reader;
    private readonly frame;
    /** Bytes that may end a start or an end inside the frame. */
    private readonly marks;
    constructor(sender: Sender, whole: TakeWhole);
    /** Take frames from a start on, one behind another; the place behind the last one. */
    take(data: Uint8Array, size: number, start: number, offset: number, events: unknown[]): number;
    /** Take content that is not stuffed up to a place. */
    reach(place: number): boolean;
    /** Take a few bytes that are not stuffed, and then stuffed ones until so many are there. */
    begin(before: number, due: number): boolean;
    /** Take stuffed bytes until so many are there. */
    fill(due: number): boolean;
    /** True if nothing stands there that may begin another frame or end this one. */
    isClear(from: number, to: number): boolean;
    /** True if the bytes have their most significant bits clear. */
    isSevenBit(from: number, to: number): boolean;
    /** The checksum of bytes. */
    sum(index: number, from: number, to: number): number | bigint;
    /** The messages of frames with these values; undefined where there are none. */
    group(values: readonly Value[]): Group | undefined;
    /** The event of the frame with these values and such a payload. Throws a Fault. */
    event(values: Value[], group: Group | undefined, from: number, to: number): Framed | null;
}
/** The bytes that may end a start or an end inside a frame. */
export declare function marksOf({ frame, completesStart }: Sender): Uint8Array;
