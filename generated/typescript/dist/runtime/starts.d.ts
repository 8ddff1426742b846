/** Search for places where a frame may start. */
import type { Frame } from "./plan.js";
/** Finds places where a frame may begin, in the first `size` bytes of some data. */
export interface Starts {
    /** Bytes in front of a place that tell whether it is a start. */
    readonly context: number;
    /** The first start from `low` on that lies before `high`; -1 if there is none. */
    find(data: Uint8Array, size: number, low: number, high: number): number;
    /** The first place from `low` on that more bytes may yet make a start; else the end. */
    undecided(data: Uint8Array, size: number, low: number): number;
}
/** The search for the starts of such frames. */
export declare function startsOf(frame: Frame): Starts;
/** The search for the starts of frames of several forms. */
export declare function startsOfForms(each: readonly Starts[]): Starts;
