/** The places of a frame's parts, and what makes those that are not always the same. */
import type { PartNumber, Value } from "./numbers.js";
import { type Sender } from "./sender.js";
import type { Writer } from "./writer.js";
/** Values of the parts of a frame, by their slots. */
export type Values = (Value | undefined)[];
/** The error of a part, whose number does not take its value. */
export declare function inside(error: unknown, name: string): unknown;
/** Write the number of a part. Throws an EncodeError. */
export declare function put(number: PartNumber, value: Value, out: Uint8Array, at: number, name: string): void;
/** How frames of a sender are put together, those with a payload or those with an empty one. */
export declare class Layout {
    private readonly sender;
    private readonly isEmpty;
    /** What stands in front of the payload, and behind it up to the end of the frame. */
    private readonly head;
    private readonly tail;
    /** Where each part begins, and where the last one ends. */
    private readonly spots;
    /** What is stuffed; null where nothing is. */
    private readonly region;
    private readonly steps;
    /** The length that a receiver is told. */
    private readonly told;
    private readonly isPlanned;
    constructor(sender: Sender, isEmpty: boolean);
    /** Bytes in front of the payload and behind it, before any stuffing. */
    get size(): number;
    /** The frame around the payload that was written. Throws an EncodeError. */
    wire(writer: Writer, payload: number, values: Values): Uint8Array;
    private isAbsent;
    private regionOf;
    private spot;
    private plan;
    /** Plan all parts of a run of content. */
    private planRun;
    /** A part that is a number, and what gives its value. */
    private numbered;
    /** The value of a slot: one that is known, or a length. */
    private slot;
    private length;
    /** Bytes that stuffing adds; null where nothing is stuffed. */
    private stuffing;
    private bits;
    private mirror;
    private sum;
    /** The bounds of a run of content, all of whose parts are planned. */
    private run;
    private covered;
    private virtual;
}
